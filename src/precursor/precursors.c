// SPDX-License-Identifier: GPL-3.0-or-later
// All indicators of coming failure, looked at together; one that lacks its data says what it needs.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/rows.h"
#include "precursor/kinds.h"

static const lac_precursor_kind *const kinds[] = {
    &lac_precursor_slip_fraction, &lac_precursor_length,          &lac_precursor_event_rate,
    &lac_precursor_b_value,       &lac_precursor_b_positive,      &lac_precursor_moment,
    &lac_precursor_slowing,       &lac_precursor_log_periodicity,
};

LAC_KINDS_AT(lac_precursor_kind, lac_precursor_kind_get, kinds)

const char *lac_needs_name(lac_needs needs)
{
    static const char *const names[] = {
        [LAC_NEEDS_MOTION] = "series", [LAC_NEEDS_EVENTS] = "events", [LAC_NEEDS_CELLS] = "cells"};
    return names[needs];
}

double lac_precursor_find(const lac_precursor *found, const char *key)
{
    for (size_t i = 0; i < found->found.count; i++) {
        if (strcmp(found->found.value[i].key, key) == 0) {
            return found->found.value[i].value;
        }
    }
    return NAN;
}

lac_status lac_precursors_evaluate(const lac_precursor_inputs *observation, lac_precursor *out,
                                   size_t *count, lac_error *err)
{
    const lac_precursor_kind *kind;
    lac_status status = LAC_OK;
    for (*count = 0; (kind = lac_precursor_kind_get(*count)) != NULL; (*count)++) {
        lac_precursor *p = &out[*count];
        *p = (lac_precursor){.kind = kind};
        if (kind->needs == LAC_NEEDS_EVENTS && observation->events == NULL) {
            (void)lac_forecast_fit_refuse(
                &p->found,
                "needs a catalogue of events: a run of a case with analysis: {events: ...}");
        } else if (kind->needs == LAC_NEEDS_CELLS && observation->slip == NULL) {
            (void)lac_forecast_fit_refuse(&p->found,
                                          "needs cells: a run of a case with analysis: {rg: ...}");
        } else {
            LAC_TRY(kind->evaluate(observation, &p->found, err));
        }
    }
out:
    return status;
}

lac_status lac_precursor_magnitudes(const lac_event_list *events, double **magnitude, size_t *n,
                                    lac_error *err)
{
    *n = 0;
    *magnitude = malloc((events->n > 0 ? events->n : 1) * sizeof **magnitude);
    LAC_FAIL_MEMORY_IF(*magnitude == NULL, err);
    for (size_t i = 0; i < events->n; i++) {
        if (events->moment[i] > 0.0 && isfinite(events->moment[i])) {
            (*magnitude)[(*n)++] = 2.0 / 3.0 * (log10(events->moment[i]) - 9.1);
        }
    }
    return LAC_OK;
}
