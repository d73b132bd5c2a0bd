// SPDX-License-Identifier: GPL-3.0-or-later
// The catalogue of events: each in time, and how many are larger than what.
#include <gsl/gsl_sort.h>
#include <gsl/gsl_vector.h>

#include "precursor/precursor.h"
#include "report/run.h"

enum { MOST_EVENTS = 3000, STEPS = 160 };

enum { TIME, DURATION, CELLS, POTENCY, MOMENT, SIZE, RATE, CUT, VARIABLES };

static const struct {
    const char *key, *name;
} shown[VARIABLES] = {
    {"time", "event_time"},
    {"duration", "event_duration"},
    {"cells", "event_cells"},
    {"potency", "event_potency"},
    {"moment", "event_moment"},
    {"size", "event_size"},
    {"max_rate", "event_max_slip_rate"},
    {"cut", "event_cut"},
};

// N(>= size) at sizes evenly spaced in their logarithm.
static void write_distribution(lac_page *page, size_t n, const double *sorted)
{
    size_t known = n;
    while (known > 0 && !(sorted[known - 1] > 0.0)) {
        known--;
    }
    double at[STEPS], count[STEPS];
    size_t steps = 0;
    const double span = known > 0 ? log(sorted[0] / sorted[known - 1]) : 0.0;
    double last = INFINITY;
    for (size_t i = 0; i < known; i++) {
        const double now = log(sorted[i]);
        const bool edge = i == 0 || i + 1 == known;
        if (steps < STEPS && (edge || (steps + 1 < STEPS && last - now >= span / (STEPS - 2)))) {
            at[steps] = sorted[i];
            count[steps++] = (double)(i + 1);
            last = now;
        }
    }
    lac_page_column(page, "at_least", steps, at, NULL, 6);
    lac_page_column(page, "count", steps, count, NULL, 17);
}

static void write_indicator(lac_page *page, const lac_precursor_kind *kind,
                            const lac_event_list *events)
{
    const lac_precursor_inputs observation = {.events = events, .tc = NAN, .start = NAN};
    lac_forecast_fit found = {0};
    lac_json *json = &page->json;
    if (lac_page_good(page, kind->evaluate(&observation, &found, page->err))) {
        lac_json_open(json, kind->info.name, '{');
        lac_json_text(json, "reason", found.reason);
        lac_json_integer(json, "points", (int64_t)found.points);
        for (size_t i = 0; i < found.count; i++) {
            lac_json_digits(json, found.value[i].key, found.value[i].value, 4);
        }
        lac_json_close(json, '}');
    }
}

static void write_events(lac_page *page, size_t n, const double *const *values)
{
    double *sorted = lac_page_room(page, n * sizeof *sorted);
    uint8_t *keep = lac_page_room(page, n);
    if (sorted == NULL || keep == NULL) {
        return;
    }
    for (size_t i = 0; i < n; i++) {
        sorted[i] = isfinite(values[POTENCY][i]) ? values[POTENCY][i] : 0.0;
    }
    gsl_sort(sorted, 1, n);
    gsl_vector_view falling = gsl_vector_view_array(sorted, n);
    gsl_vector_reverse(&falling.vector);
    // the larger half of what may stand on the page, and of the others every `stride`th
    const double limit = n > MOST_EVENTS ? sorted[MOST_EVENTS / 2] : -INFINITY;
    const size_t stride = n / (MOST_EVENTS / 2) + 1;
    for (size_t i = 0, others = 0; i < n; i++) {
        keep[i] = values[POTENCY][i] > limit || n <= MOST_EVENTS || others++ % stride == 0;
    }
    lac_json_integer(&page->json, "all", (int64_t)n);
    for (size_t v = 0; v < VARIABLES; v++) {
        lac_page_column(page, shown[v].key, n, values[v], keep, v == TIME ? 12 : 6);
    }
    write_distribution(page, n, sorted);
    const lac_event_list list = {.n = n, .time = values[TIME], .moment = values[MOMENT]};
    const lac_precursor_kind *kind;
    for (size_t i = 0; (kind = lac_precursor_kind_get(i)) != NULL; i++) {
        if (kind->page) {
            write_indicator(page, kind, &list);
        }
    }
}

void lac_page_events(lac_page *page, const char *key)
{
    const double *values[VARIABLES];
    size_t n = SIZE_MAX;
    for (size_t v = 0; v < VARIABLES; v++) {
        const lac_stored_values all = lac_page_values(page, page->file, shown[v].name);
        values[v] = all.value;
        n = all.value == NULL ? 0 : all.n < n ? all.n : n;
    }
    if (n > 0) {
        lac_json_open(&page->json, key, '{');
        write_events(page, n, values);
        lac_json_close(&page->json, '}');
    }
}
