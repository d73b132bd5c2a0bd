// SPDX-License-Identifier: GPL-3.0-or-later
// An ensemble as tables: the variables of its file, a place a member, and its JSON.
#include <math.h>

#include "base/fail.h"
#include "data/describe.h"
#include "lacuna/simulation.h"
#include "sweep/ensemble.h"

#define E const lac_ensemble *e = of
#define M(kind, field) LAC_HELD(kind, lac_member, field), .flags = LAC_MISSING

LAC_TEXT_GETTER(end_name, const lac_member *m = of,
                m->message[0] != '\0' ? "broken" : lac_end_name((lac_end)m->end))
LAC_GETTER(double, broken, const lac_member *m = of, m->message[0] != '\0' ? 1.0 : 0.0)
LAC_GETTER(double, members, E, (double)e->members)
LAC_GETTER(double, number, (void)of, (double)at[0])
LAC_GETTER(double, seed, E, (double)e->sweep->seed)
LAC_GETTER(double, drawn, E, e->drawn[at[1] * e->members + at[0]])

// Failed members have no rate.
static double rate(const void *of, const size_t *at)
{
    const lac_ensemble *e = of;
    return (double)e->rate[at[0] * LAC_MEMBER_RECORDS + at[1]];
}

static const lac_variable of_sweep[] = {
    {.name = "sweep_design", .json = "design", LAC_HELD(TEXT, lac_ensemble, design)},
    {.name = "sweep_parameters", LAC_HELD(TEXT, lac_ensemble, varied)},
    {.name = "sweep_seed", .json = "seed", G(seed), .flags = LAC_WHOLE | LAC_LONG},
    {.name = "sweep_end_s", .json = "end_s", LAC_HELD(REAL, lac_ensemble, end)},
    {.name = "members", G(members), .flags = LAC_WHOLE},
};

static const lac_variable of_members[] = {
    {.name = "realization",
     .long_name = "number of the member",
     .standard_name = "realization",
     G(number),
     .flags = LAC_WHOLE},
    {.name = "failure_time",
     .unit = "s",
     .long_name = "time of failure",
     .comment = "missing: did not fail, or is broken",
     M(REAL, failure_time)},
    {.name = "time_reached",
     .unit = "s",
     .long_name = "time that the member was followed to",
     M(REAL, time)},
    {.name = "mean_slip", .unit = "m", .long_name = "mean slip at the end", M(REAL, mean_slip)},
    {.name = "max_slip_rate",
     .unit = "m s-1",
     .long_name = "largest slip rate of any cell",
     M(REAL, max_slip_rate)},
    {.name = "least_factor_of_safety",
     .long_name = "least factor of safety",
     .comment = "missing: not asked for",
     M(REAL, least_safety)},
    {.name = "steps", .long_name = "steps of the integrator", M(REAL, steps)},
    {.name = "ended_by", .long_name = "how the member ended", T(end_name)},
    {.name = "broken",
     .long_name = "1: the member could not be computed",
     G(broken),
     .flags = LAC_WHOLE},
    {.name = "message",
     .long_name = "why it could not be computed",
     LAC_HELD(CHARS, lac_member, message)},
};

static const lac_variable of_rates[] = {
    {.name = "record_time",
     .dims = "record",
     .unit = "s",
     .long_name = "time since the start that slip_rate is at",
     .held = LAC_HELD_REAL,
     .offset = offsetof(lac_ensemble, place)},
    {.name = "slip_rate",
     .dims = "realization record",
     .unit = "m s-1",
     .long_name = "mean slip rate, of either sign",
     .comment = "missing after failure, and where the member ended before",
     G(rate),
     .flags = LAC_MISSING | LAC_ROUGH},
};

static lac_status add_drawn(const lac_ensemble *e, lac_dataset *d, lac_error *err)
{
    static const lac_variable row = {.dims = "realization", .value = drawn, .flags = LAC_MISSING};
    for (size_t p = 0; p < e->params; p++) {
        const lac_named named = {.name = e->sweep->param[p].name,
                                 .long_name = e->key[p],
                                 .unit = e->unit[p],
                                 .which = p};
        LAC_TRY_RETURN(lac_dataset_add_named(d, &row, &named, e, err));
    }
    return LAC_OK;
}

lac_status lac_ensemble_describe(const lac_ensemble *e, lac_dataset **out, lac_error *err)
{
    const lac_extent dims[] = {{"realization", e->members}, {"record", LAC_MEMBER_RECORDS}};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_sweep, "", 0), e},
        {LAC_VARIABLES(of_members, "realization", sizeof(lac_member)), e->member},
        {LAC_VARIABLES(of_rates, "", 0), e},
    };
    lac_status status;
    LAC_TRY(lac_dataset_create("Members of a sweep, a run each, and what they say together.", out,
                               err));
    LAC_TRY(lac_dataset_dims(*out, dims, 2, err));
    LAC_TRY(add_drawn(e, *out, err));
    LAC_TRY(lac_dataset_add(*out, laid, 3, err));
    LAC_TRY(lac_answers_add(e->answers, *out, err));
out:
    return lac_dataset_described(out, status);
}
