// SPDX-License-Identifier: GPL-3.0-or-later
// The events of the interface as a whole: followed in a run, and in the JSON of lacuna run.
#include "cli/run/run_outcome.h"

#include "cli/common/words.h"

lac_status cli_history_step(void *context, const lac_step *step, lac_error *err)
{
    cli_history *h = context;
    if (step->changed == NULL) { // all cells together
        LAC_TRY_RETURN(lac_slip_events_step(&h->slip_events, step, err));
    }
    return h->next.step != NULL ? h->next.step(h->next.context, step, err) : LAC_OK;
}

// What a seismologist looks for; where a run fails, the failure says it.
void cli_slip_events_print(const lac_slip_events *all)
{
    if (all->count == 0) {
        return;
    }
    const double first = all->event[0].start, last = all->event[all->count - 1].start;
    const cli_text from = cli_exact(first, "s"), to = cli_exact(last, "s");
    cli_row("slip events", "%zu above 1 mm/s: %s%s%s%s; --json has all", all->count,
            isnan(first) ? "one as the run begins" : "after ", isnan(first) ? "" : from.s,
            all->count > 1 ? ", the last after " : "", all->count > 1 ? to.s : "");
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
