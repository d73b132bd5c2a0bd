// SPDX-License-Identifier: GPL-3.0-or-later
// What is common to runs: settings where none are given, the formulation that suits method and
// friction, words, and sinks that stand before another one.
#include <math.h>

#include "lacuna/simulation.h"
#include "run/run.h"

lac_run_def lac_run_default(void)
{
    return (lac_run_def){.method = LAC_BDF,
                         .wake = 1.0,
                         .rtol = 1e-6,
                         .first_step = NAN,
                         .max_steps = 10000000,
                         .end = NAN,
                         .failure_rate = 1.0,
                         .failure_slip = INFINITY,
                         .stop_slip = NAN,
                         .stop_rate = NAN,
                         .record = {.time = NAN, .steps = 1, .per_decade = NAN},
                         .snapshot = {.time = NAN, .steps = 0, .per_decade = 1.0},
                         .checkpoint = {.time = NAN, .steps = 0, .per_decade = NAN}};
}

lac_formulation lac_formulation_choose(int asked, lac_method method, lac_friction_form form)
{
    if (asked != LAC_FORMULATION_AUTO) {
        return (lac_formulation)asked;
    }
    if (method == LAC_ADAMS) {
        return LAC_FORMULATION_SLIP;
    }
    bool forwards = form == LAC_FORM_PLAIN;
    return method == LAC_BDF && forwards ? LAC_FORMULATION_RATE : LAC_FORMULATION_TRACTION;
}

const char *lac_end_name(lac_end end)
{
    static const char *const names[] = {[LAC_END_TIME] = "end",
                                        [LAC_END_FAILURE] = "rate",
                                        [LAC_END_SLIP] = "slip",
                                        [LAC_END_STOP] = "stop_when",
                                        [LAC_END_INTERRUPT] = "interrupted",
                                        [LAC_END_ERROR] = "error"};
    return (unsigned)end < sizeof names / sizeof *names ? names[end] : NULL;
}

const char *lac_fidelity_name(lac_fidelity fidelity)
{
    static const char *const names[] = {[LAC_FIDELITY_ODE] = "ode",
                                        [LAC_FIDELITY_ASYNC] = "events",
                                        [LAC_FIDELITY_STATIC] = "static"};
    return names[fidelity];
}

#define PASS(what, type)                                                           \
    static lac_status pass_##what(void *context, const type *what, lac_error *err) \
    {                                                                              \
        const lac_sink *next = context;                                            \
        return next->what(next->context, what, err);                               \
    }
PASS(record, lac_record)
PASS(snapshot, lac_snapshot)
PASS(step, lac_step)
PASS(event, lac_event)
PASS(once, double)
PASS(checkpoint, lac_checkpoint)

static void pass_serialize(void *context, lac_archive *archive)
{
    const lac_sink *next = context;
    next->serialize(next->context, archive);
}

lac_sink lac_sink_before(lac_sink *next)
{
    return (lac_sink){.size = sizeof(lac_sink),
                      .context = next,
                      .record = next->record != NULL ? pass_record : NULL,
                      .snapshot = next->snapshot != NULL ? pass_snapshot : NULL,
                      .step = next->step != NULL ? pass_step : NULL,
                      .event = next->event != NULL ? pass_event : NULL,
                      .once = next->once != NULL ? pass_once : NULL,
                      .serialize = next->serialize != NULL ? pass_serialize : NULL,
                      .checkpoint = next->checkpoint != NULL ? pass_checkpoint : NULL};
}
