// SPDX-License-Identifier: GPL-3.0-or-later
// The events of the interface as a whole: followed in a run, and in the JSON of lacuna run.
#include "cli/run/run_outcome.h"

lac_status cli_history_step(void *context, const lac_step *step, lac_error *err)
{
    cli_history *h = context;
    if (step->changed == NULL) { // all cells together
        LAC_TRY_RETURN(lac_slip_events_step(&h->slip_events, step, err));
    }
    return h->next.step != NULL ? h->next.step(h->next.context, step, err) : LAC_OK;
}

void cli_slip_events_json(lac_json *json, const lac_slip_events *all)
{
    if (all == NULL) {
        lac_json_null(json, "slip_events");
        return;
    }
    lac_json_open(json, "slip_events", '[');
    for (size_t i = 0; i < all->count; i++) {
        const lac_slip_event *e = &all->event[i];
        lac_json_open(json, NULL, '{');
        lac_json_number(json, "time_s", e->start);
        lac_json_number(json, "end_time_s", e->end);
        lac_json_number(json, "max_slip_rate_m_s", e->max_rate);
        lac_json_number(json, "max_slip_rate_time_s", e->peak);
        lac_json_close(json, '}');
    }
    lac_json_close(json, ']');
}
