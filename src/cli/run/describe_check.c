// SPDX-License-Identifier: GPL-3.0-or-later
// What lacuna check found, as tables: errors and warnings, the resolved case, what it will cost.
#include "cli/run/check.h"
#include "data/describe.h"

#define CHECKED const cli_checked *c = of
#define ESTIMATE const lac_estimate *e = ((const cli_checked *)of)->estimate
#define ISSUE const lac_case_issue *i = of

LAC_GETTER(double, ok, CHECKED, c->estimate != NULL)
LAC_GETTER(bool, branches, CHECKED, c->branch != NULL)
LAC_GETTER(double, line, ISSUE, i->line > 0 ? (double)i->line : (double)NAN)

static const lac_variable of_check[] = {
    {.name = "ok", .json = "ok", G(ok), .flags = LAC_WHOLE | LAC_TRUTH}};

#define ISSUES(in)                                                                                \
    {LAC_ROW(in "_file", NULL, NULL, "file", LAC_HELD(TEXT, lac_case_issue, file),                \
             .json = in "s[]/file"),                                                              \
     LAC_ROW(in "_line", NULL, NULL, "line of it", G(line), .flags = LAC_WHOLE | LAC_MISSING,     \
             .json = in "s[]/line"),                                                              \
     LAC_ROW(in "_key", NULL, NULL, "key of the case", LAC_HELD(TEXT, lac_case_issue, key),       \
             .json = in "s[]/key"),                                                               \
     LAC_ROW(in "_value", NULL, NULL, "what it is set to", LAC_HELD(TEXT, lac_case_issue, value), \
             .json = in "s[]/value"),                                                             \
     LAC_ROW(in "_message", NULL, NULL, "what is allowed, or to be known",                        \
             LAC_HELD(TEXT, lac_case_issue, message), .json = in "s[]/message")}
static const lac_variable of_errors[] = ISSUES("error");
static const lac_variable of_warnings[] = ISSUES("warning");

static const lac_variable of_scene[] = {
    {.name = "scene", .json = "scene", LAC_HELD(TEXT, cli_checked, scene)},
    {.name = "branch", .json = "branch", LAC_HELD(TEXT, cli_checked, branch), .has = branches},
};

static double rate(const lac_estimate *e)
{
    return e->failure.rate > 0.0 ? e->failure.rate : (double)NAN;
}

#define WHEN_RUN(field) e->integrated ? e->field : (double)NAN
LAC_GETTER(double, grid_cells, ESTIMATE, e->grid_cells)
LAC_GETTER(double, contact_cells, ESTIMATE, round(e->contact_cells))
LAC_GETTER(double, exact, ESTIMATE, e->exact)
LAC_GETTER(double, unknowns, ESTIMATE, e->unknowns *round(e->contact_cells))
LAC_GETTER(double, memory, ESTIMATE, round(e->memory))
LAC_GETTER(double, cpu_least, ESTIMATE, e->cpu_time_least)
LAC_GETTER(double, cpu_most, ESTIMATE, e->cpu_time_most)
LAC_GETTER(double, cascade, ESTIMATE, e->cascade_time)
LAC_GETTER(double, records, ESTIMATE, WHEN_RUN(records))
LAC_GETTER(double, file_most, ESTIMATE, WHEN_RUN(file_bytes))
LAC_GETTER(double, stiffness, ESTIMATE, e->stiffness_ratio)
LAC_GETTER(double, patch, ESTIMATE, e->patch)
LAC_GETTER(double, failure_rate, ESTIMATE, rate(e))
LAC_GETTER(double, lowered, ESTIMATE, e->failure.lowered)
LAC_GETTER(double, steps_least, ESTIMATE, WHEN_RUN(steps_least))
LAC_GETTER(double, steps_most, ESTIMATE, WHEN_RUN(steps_most))
LAC_TEXT_GETTER(regime_name, ESTIMATE, lac_regime_name(lac_regime_of(e)))
LAC_TEXT_GETTER(faster, ESTIMATE, e->faster)
LAC_TEXT_GETTER(steps_class, ESTIMATE, e->integrated ? cli_steps_class(e) : NULL)

#define E(name_, unit_, long_, getter, ...)                                             \
    LAC_ROW(name_, NULL, unit_, long_, G(getter), .flags = LAC_SINGLE | LAC_MISSING,    \
            .json = "estimate/" name_ __VA_ARGS__)
#define TRUTH(name_, getter)                                                              \
    {                                                                                     \
        .name = (name_), .json = "estimate/" name_, G(getter), .flags = LAC_WHOLE | LAC_TRUTH \
    }
static const lac_variable of_estimate[] = {
    E("grid_cells", NULL, "cells of the grid", grid_cells),
    E("contact_cells", NULL, "contact cells", contact_cells),
    TRUTH("contact_cells_exact", exact),
    E("unknowns", NULL, "unknowns of a run", unknowns),
    E("memory", "byte", "largest resident memory", memory, "_bytes"),
    E("cpu_time_least", "s", "least time on one core", cpu_least, "_s"),
    E("cpu_time_most", "s", "longest time on one core", cpu_most, "_s"),
    E("cascade_time", "s", "time of the cascade", cascade, "_s"),
    E("records_at_times", NULL, "records at stated times", records),
    E("file_most", "byte", "what they and the fields take in the file at most", file_most,
      "_bytes"),
    E("stiffness_over_critical", NULL, "stiffness of the finest level over the critical one",
      stiffness),
    E("patch_width", "m", "width from which on a patch slips by itself", patch, "_m"),
    {.name = "regime", .json = "estimate/regime", T(regime_name)},
    {.name = "regime_words",
     .json = "estimate/regime_words",
     LAC_HELD(CHARS, cli_checked, regime)},
    {.name = "faster_fidelity", .json = "estimate/faster_fidelity", T(faster)},
    E("failure_rate", "m s-1", "mean slip rate that counts as failure", failure_rate, "_m_s"),
    TRUTH("failure_rate_lowered", lowered),
    {.name = "steps_class", .json = "estimate/steps_class", T(steps_class)},
    E("steps_least", NULL, "least steps", steps_least),
    E("steps_most", NULL, "most steps", steps_most),
};

lac_status cli_check_describe(const cli_checked *c, lac_dataset **out, lac_error *err)
{
    const lac_extent dims[] = {{"error", c->errors}, {"warning", c->warnings}};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_check, "", 0), c},
        {LAC_VARIABLES_OF_MANY(of_errors, "error"), c->error},
        {LAC_VARIABLES_OF_MANY(of_warnings, "warning"), c->warning},
        {LAC_VARIABLES(of_scene, "", 0), c},
        {LAC_VARIABLES(of_estimate, "", 0), c->estimate != NULL ? c : NULL},
    };
    lac_status status;
    LAC_TRY(lac_dataset_create("What is wrong with a case, and what its run will cost.", out, err));
    LAC_TRY(lac_dataset_dims(*out, dims, sizeof dims / sizeof *dims, err));
    LAC_TRY(lac_dataset_add(*out, laid, sizeof laid / sizeof *laid, err));
out:
    return lac_dataset_described(out, status);
}
