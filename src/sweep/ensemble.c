// SPDX-License-Identifier: GPL-3.0-or-later
// All members of a sweep beside what they say of one another: from those that were run, or from
// the file that they left.
#define _GNU_SOURCE // strdup
#include "sweep/ensemble.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/fail.h"
#include "store/store_file.h"

static const char of_design[] = "sweep_design", of_keys[] = "sweep_parameters";

static lac_sample_design kind_of(const char *design)
{
    return strcmp(design, "saltelli") == 0  ? LAC_SAMPLE_SALTELLI
           : strcmp(design, "tornado") == 0 ? LAC_SAMPLE_TORNADO
                                            : LAC_SAMPLE_DRAWN;
}

static lac_status make_room(lac_ensemble *e, lac_error *err)
{
    e->key = calloc(e->params + 1, sizeof *e->key);
    e->unit = calloc(e->params + 1, sizeof *e->unit);
    e->drawn = malloc((e->params * e->members + 1) * sizeof *e->drawn);
    e->result = malloc((e->members + 1) * sizeof *e->result);
    e->followed = malloc((e->members + 1) * sizeof *e->followed);
    e->rate = malloc((e->members * LAC_MEMBER_RECORDS + 1) * sizeof *e->rate);
    return e->key != NULL && e->unit != NULL && e->drawn != NULL && e->result != NULL &&
                   e->followed != NULL && e->rate != NULL
               ? LAC_OK
               : lac_fail_memory(err);
}

static lac_status answer(lac_ensemble *e, uint64_t seed, double by, lac_error *err)
{
    for (size_t r = 0; r < LAC_MEMBER_RECORDS; r++) {
        e->place[r] = e->end * (double)r / (double)(LAC_MEMBER_RECORDS - 1);
    }
    e->sample = (lac_sample){.params = e->params,
                             .members = e->members,
                             .drawn = e->drawn,
                             .result = e->result,
                             .followed = e->followed,
                             .design = kind_of(e->design),
                             .by = by,
                             .seed = seed,
                             .name = "failure_time",
                             .unit = "s",
                             .key = e->key,
                             .key_unit = e->unit};
    return lac_answers_create(&e->sample, &e->answers, err);
}

// Keys, ", " between them.
static char *join(const lac_sweep *sweep)
{
    size_t size = 1;
    for (size_t p = 0; p < sweep->params; p++) {
        size += strlen(sweep->param[p].key) + 2;
    }
    char *text = calloc(size, 1);
    for (size_t p = 0; text != NULL && p < sweep->params; p++) {
        (void)strcat(strcat(text, p > 0 ? ", " : ""), sweep->param[p].key);
    }
    return text;
}

lac_status lac_ensemble_create(const lac_sweep *sweep, lac_member *member, double end, double by,
                               lac_ensemble **out, lac_error *err)
{
    lac_ensemble *e = calloc(1, sizeof *e);
    lac_status status;
    LAC_TRY(e != NULL ? LAC_OK : lac_fail_memory(err));
    e->sweep = sweep;
    e->member = member;
    e->params = sweep->params;
    e->members = sweep->members;
    e->design = lac_sweep_design(sweep);
    e->end = end;
    e->varied = e->texts = join(sweep);
    LAC_TRY(e->texts != NULL ? make_room(e, err) : lac_fail_memory(err));
    for (size_t p = 0; p < e->params; p++) {
        e->key[p] = sweep->param[p].key;
        e->unit[p] = sweep->param[p].unit;
    }
    for (size_t i = 0; i < e->members; i++) {
        const lac_member *m = &member[i];
        for (size_t p = 0; p < e->params; p++) {
            e->drawn[p * e->members + i] = lac_sweep_value(sweep, i, p);
        }
        e->result[i] = m->message[0] != '\0' ? (double)NAN
                       : m->failed           ? m->failure_time
                                             : (double)INFINITY;
        e->followed[i] = m->time;
        memcpy(e->rate + i * LAC_MEMBER_RECORDS, m->rate, sizeof m->rate);
    }
    LAC_TRY(answer(e, sweep->seed, by, err));
    *out = e;
    e = NULL;
out:
    if (e != NULL) {
        e->member = NULL;
    }
    lac_ensemble_free(e);
    return status;
}

void lac_ensemble_free(lac_ensemble *e)
{
    if (e != NULL) {
        lac_answers_free(e->answers);
        free(e->key);
        free(e->unit);
        free(e->drawn);
        free(e->result);
        free(e->followed);
        free(e->rate);
        free(e->texts);
        free(e);
    }
}

bool lac_ensemble_is(const char *path)
{
    lac_stored_file *file = NULL;
    char text[32];
    const bool is = lac_stored_file_open(path, &file, NULL) == LAC_OK &&
                    lac_stored_file_text(file, NULL, of_design, text, sizeof text);
    lac_stored_file_close(file);
    return is;
}

enum { LONGEST = 1 << 16 };

// A variable over the members. @param width  values of each
static lac_status read_values(const lac_stored_file *file, const char *path, const char *name,
                              size_t members, size_t width, double *out, lac_error *err)
{
    lac_stored_values v = {0};
    lac_status status = lac_stored_file_values(file, name, &v, err);
    if (status == LAC_OK && (v.value == NULL || v.n != members || v.width != width)) {
        status = lac_fail(err, LAC_EIO, "%s: is not the file of a sweep: no %s of its members",
                          path, name);
    }
    if (status == LAC_OK) {
        memcpy(out, v.value, members * width * sizeof *out);
    }
    lac_stored_values_clear(&v);
    return status;
}

// The name of a parameter's variable, from the first of its keys.
static void name_of(const char *key, char *name, size_t size)
{
    (void)snprintf(name, size, "%.*s", (int)strcspn(key, "+"), key);
    for (char *at = name; *at != '\0'; at++) {
        *at = strchr(".-", *at) != NULL ? '_' : *at;
    }
}

static lac_status read_members(const lac_stored_file *file, const char *path, lac_ensemble *e,
                               lac_error *err)
{
    const size_t n = e->members;
    lac_stored_values rate = {0};
    char name[256];
    double *broken = malloc((n + 1) * sizeof *broken);
    lac_status status;
    LAC_TRY(broken != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(read_values(file, path, "failure_time", n, 1, e->result, err));
    LAC_TRY(read_values(file, path, "time_reached", n, 1, e->followed, err));
    LAC_TRY(read_values(file, path, "broken", n, 1, broken, err));
    LAC_TRY(lac_stored_file_values(file, "slip_rate", &rate, err));
    LAC_LEAVE_IF(rate.n != n || rate.width != LAC_MEMBER_RECORDS, err, LAC_EIO,
                 "%s: is not the file of a sweep: no slip_rate of its members", path);
    for (size_t i = 0; i < n; i++) {
        const bool failed = !isnan(e->result[i]);
        e->result[i] = broken[i] > 0.0 ? (double)NAN : failed ? e->result[i] : (double)INFINITY;
        for (size_t r = 0; r < LAC_MEMBER_RECORDS; r++) {
            const size_t k = i * LAC_MEMBER_RECORDS + r;
            const double at = e->end * (double)r / (double)(LAC_MEMBER_RECORDS - 1);
            e->rate[k] = at > e->result[i] ? INFINITY : (float)rate.value[k];
        }
    }
    for (size_t p = 0; p < e->params; p++) {
        char *room = e->texts + LONGEST + 64 * p;
        name_of(e->key[p], name, sizeof name);
        LAC_TRY(read_values(file, path, name, n, 1, e->drawn + p * n, err));
        (void)lac_stored_file_text(file, name, "units", room, 64);
        e->unit[p] = room;
    }
out:
    lac_stored_values_clear(&rate);
    free(broken);
    return status;
}

lac_status lac_ensemble_read(const char *path, double by, lac_ensemble **out, lac_error *err)
{
    lac_stored_file *file = NULL;
    lac_ensemble *e = calloc(1, sizeof *e);
    static const char *const designs[] = {"grid", "random", "lhs", "sobol", "saltelli", "tornado"};
    char design[32] = "", *keys = malloc(LONGEST);
    lac_status status;
    *out = NULL;
    LAC_TRY(e != NULL && keys != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(lac_stored_file_open(path, &file, err));
    (void)lac_stored_file_text(file, NULL, of_design, design, sizeof design);
    (void)lac_stored_file_text(file, NULL, of_keys, keys, LONGEST);
    for (size_t k = 0; k < sizeof designs / sizeof *designs; k++) {
        e->design = strcmp(designs[k], design) == 0 ? designs[k] : e->design;
    }
    LAC_LEAVE_IF(e->design == NULL, err, LAC_EIO, "%s: is not the file of a sweep", path);
    e->params = *keys != '\0' ? 1 : 0;
    for (const char *at = keys; (at = strstr(at, ", ")) != NULL; at++) {
        e->params++;
    }
    e->members = (size_t)lac_stored_file_number(file, NULL, "members");
    e->end = lac_stored_file_number(file, NULL, "sweep_end_s");
    e->texts = calloc(LONGEST + 64 * e->params + 1, 1);
    LAC_TRY(e->texts != NULL ? make_room(e, err) : lac_fail_memory(err));
    memcpy(e->texts, keys, strlen(keys));
    e->varied = keys;
    char *at = e->texts;
    for (size_t p = 0; p < e->params; p++) {
        e->key[p] = at;
        at += strcspn(at, ",");
        at += *at != '\0' ? (*at = '\0', 2) : 0;
    }
    LAC_TRY(read_members(file, path, e, err));
    LAC_TRY(answer(e, (uint64_t)lac_stored_file_number(file, NULL, "sweep_seed"), by, err));
    *out = e;
    e = NULL;
out:
    free(keys);
    lac_stored_file_close(file);
    lac_ensemble_free(e);
    return status;
}
