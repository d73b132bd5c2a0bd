// SPDX-License-Identifier: GPL-3.0-or-later
// The page of an ensemble: its answers as their tables have them, the fan of its members, and some
// of them one by one.
#include "report/run.h"

#include "sweep/answers.h"

enum { MOST_DOTS = 1500 }; // members in the matrix of scatter

// Every so many of them, evenly.
static void write_some(lac_page *page, const char *key, size_t n, const double *value)
{
    const size_t stride = (n + MOST_DOTS - 1) / MOST_DOTS;
    lac_json_open(&page->json, key, '[');
    for (size_t i = 0; i < n; i += stride) {
        lac_json_digits(&page->json, NULL, value[i], 6);
    }
    lac_json_close(&page->json, ']');
}

static void write_fan(lac_page *page)
{
    const lac_page_ensemble *e = page->def->ensemble;
    const size_t members = e->sample->members;
    double *fan = lac_page_room(page, LAC_ANSWERS_QUANTILES * e->records * sizeof *fan);
    bool *use = lac_page_room(page, members * sizeof *use);
    if (fan == NULL || use == NULL) {
        return;
    }
    for (size_t i = 0; i < members; i++) {
        use[i] = lac_answers_counts(e->sample, i);
    }
    if (lac_page_good(page, lac_answers_fan(members, e->records, e->rate, use, fan, page->err))) {
        lac_json_open(&page->json, "fan", '{');
        lac_json_boolean(&page->json, "clock", e->label == NULL);
        lac_json_text(&page->json, "label", e->label);
        lac_page_column(page, "place", e->records, e->place, NULL, 12);
        lac_json_open(&page->json, "rate", '[');
        for (size_t q = 0; q < LAC_ANSWERS_QUANTILES; q++) {
            lac_page_column(page, NULL, e->records, fan + q * e->records, NULL, 6);
        }
        lac_json_close(&page->json, ']');
        lac_json_close(&page->json, '}');
    }
}

static void write_members(lac_page *page)
{
    const lac_sample *s = page->def->ensemble->sample;
    lac_json *json = &page->json;
    lac_json_boolean(json, "members", true);
    lac_json_open(json, "drawn", '[');
    for (size_t p = 0; p < s->params; p++) {
        lac_json_open(json, NULL, '{');
        lac_json_text(json, "parameter", s->key[p]);
        lac_json_text(json, "unit", s->key_unit[p]);
        write_some(page, "value", s->members, s->drawn + p * s->members);
        lac_json_close(json, '}');
    }
    lac_json_close(json, ']');
    write_some(page, "result", s->members, s->result);
}

void lac_page_of_ensemble(lac_page *page, const char *key)
{
    const lac_page_ensemble *e = page->def->ensemble;
    const lac_answers *a = e->answers;
    lac_json *json = &page->json;
    lac_dataset *dataset = NULL;
    lac_json_open(json, key, '{');
    if (lac_page_good(page, lac_dataset_create("Answers.", &dataset, page->err)) &&
        lac_page_good(page, lac_answers_add(a, dataset, page->err))) {
        lac_dataset_json(dataset, json);
    }
    lac_dataset_free(dataset);
    lac_json_open(json, "time", '['); // of the clock
    lac_json_number(json, NULL, 0.0);
    const double last = e->label == NULL && e->records > 0 ? e->place[e->records - 1] : 0.0;
    lac_json_number(json, NULL,
                    a->plain     ? last
                    : a->tornado ? a->base
                                 : a->course[LAC_ANSWERS_TIMES - 1].by);
    lac_json_close(json, ']');
    lac_json_boolean(json, "decides", true);
    if (!a->tornado) {
        lac_json_boolean(json, "likely", true);
        if (e->records > 1) {
            write_fan(page);
        }
        if (e->sample->params > 0) {
            write_members(page);
        }
    }
    lac_json_close(json, '}');
}
