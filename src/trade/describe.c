// SPDX-License-Identifier: GPL-3.0-or-later
// What a trade came to, as tables: the variables of its file, a row a run, and its JSON.
#include "data/describe.h"
#include "trade/trade.h"

const char *lac_trade_command(const lac_trade_run *run)
{
    const lac_trade_of of = lac_trade_of_run(run->of, run);
    return of == LAC_OF_CASCADE ? "rg" : of == LAC_OF_CONTACT ? "contact" : "run";
}

const char *lac_trade_end_name(lac_trade_end end)
{
    return end == LAC_TRADE_DONE ? "done" : end == LAC_TRADE_GIVEN_UP ? "given up" : "broken";
}

const char *lac_trade_settings_text(const lac_trade_run *run, char text[LAC_TEXT_ROOM])
{
    const lac_trade *trade = run->of;
    text[0] = '\0';
    for (size_t d = 0; d < trade->settings; d++) {
        lac_append(text, LAC_TEXT_ROOM, "%s%s=%s", d > 0 ? " " : "", trade->setting[d].setting->key,
                   run->label[d]);
    }
    return text;
}

const char *lac_trade_options(const lac_trade_run *run, char text[LAC_TEXT_ROOM])
{
    const lac_trade *trade = run->of;
    text[0] = '\0';
    for (size_t d = 0; d < trade->settings; d++) {
        const lac_trade_setting *setting = &trade->setting[d];
        const int at = run->at[d];
        const char *yaml = at >= 0 ? setting->value[at].yaml : run->label[d];
        const bool named = at >= 0 && strcmp(yaml, setting->value[at].label) != 0;
        const char *quote = strpbrk(yaml, " {") != NULL ? "'" : "";
        if (named || strcmp(run->label[d], trade->own[d]) != 0) {
            lac_append(text, LAC_TEXT_ROOM, "%s--set %s%s=%s%s", text[0] != '\0' ? " " : "", quote,
                       setting->setting->key, yaml, quote);
        }
    }
    return text;
}

#define TRADE const lac_trade *t = of
#define RUN const lac_trade_run *r = of
#define RUNS const lac_trade_run *const *r = of

LAC_TEXT_GETTER(complete, (void)of, "complete")
LAC_TEXT_GETTER(quantity, TRADE, lac_quantities[t->quantity].name)
LAC_TEXT_GETTER(quantity_unit, TRADE, lac_quantities[t->quantity].unit)
LAC_TEXT_GETTER(quantity_doc, TRADE, lac_quantities[t->quantity].doc)
LAC_TEXT_GETTER(reference_settings, TRADE, lac_trade_settings_text(t->reference, room))
LAC_TEXT_GETTER(recommended_settings, TRADE,
                t->recommended != NULL ? lac_trade_settings_text(t->recommended, room) : NULL)

LAC_TEXT_GETTER(settings, RUN, lac_trade_settings_text(r, room))
LAC_TEXT_GETTER(label, RUN, r->label[at[0]])
LAC_TEXT_GETTER(key, RUN, r->of->setting[at[0]].setting->key)
LAC_TEXT_GETTER(command, RUN, lac_trade_command(r))
LAC_TEXT_GETTER(options, RUN, lac_trade_options(r, room))
LAC_TEXT_GETTER(end, RUN, lac_trade_end_name(r->end))
LAC_GETTER(double, amount, RUNS, r[at[0]]->value)

#define H(kind, field) LAC_HELD(kind, lac_trade_run, field)

static const lac_variable of_trade[] = {
    LAC_JSON("title", TEXT, lac_trade, title),
    {.name = "status", T(complete)},
    {.name = "quantity", .json = "quantity", T(quantity)},
    {.name = "quantity_unit", .json = "unit", T(quantity_unit)},
    {.name = "quantity_long_name", T(quantity_doc)},
    {.name = "reference_settings", T(reference_settings)},
    {.name = "recommended_settings", T(recommended_settings)},
    {.name = "recommendation", LAC_HELD(CHARS, lac_trade, sentence)},
};

// What is told of a run. @param F  whether a file has it: F(name, unit, what it is)
#define OF_RUN(in, dims_, F)                                                                       \
    {F("settings", NULL, "settings of the run, keys of its case"), T(settings)},                   \
        {.json = in "settings{}", .dims = (dims_), T(label), .label = key, .flags = LAC_NUMERAL},  \
        {.json = in "command", T(command)}, {.json = in "options", T(options)},                    \
        {F("end", NULL, "how it ended: done, broken, given up"), .json = in "end", T(end)},        \
        {.json = in "message", H(CHARS, message), .flags = LAC_MISSING},                           \
        {.json = in "value", H(REAL, value)},                                                      \
        {F("error", NULL, "difference from the reference, relative"), .json = in "error",          \
         H(REAL, error), .flags = LAC_MISSING},                                                    \
        {F("error_uncertainty", NULL, "error of the reference itself, relative"),                  \
         .json = in "error_uncertainty", H(REAL, uncertainty), .flags = LAC_MISSING},              \
        {F("wall_time", "s", "time on the clock"), .json = in "wall_time_s", H(REAL, m.wall_time), \
         .flags = LAC_MISSING},                                                                    \
        {F("cpu_time", "s", "time of the processor"), .json = in "cpu_time_s",                     \
         H(REAL, m.cpu_time), .flags = LAC_MISSING},                                               \
        {F("peak_memory", "byte", "largest resident memory"), .json = in "peak_memory_bytes",      \
         H(REAL, m.memory), .flags = LAC_MISSING},                                                 \
        {F("output_size", "byte", "size of the run's file"), .json = in "output_bytes",            \
         H(REAL, m.output), .flags = LAC_MISSING},                                                 \
        {F("steps", NULL, "steps of the integrator"), .json = in "steps", H(REAL, m.steps),        \
         .flags = LAC_MISSING},                                                                    \
        {F("rhs_evaluations", NULL, "evaluations of the right-hand side"),                         \
         .json = in "rhs_evaluations", H(REAL, m.evaluations), .flags = LAC_MISSING},              \
        {.json = in "n_cells", H(REAL, m.cells)},                                                  \
    {                                                                                              \
        F("on_front", NULL, "1: no other run errs and costs less; else 0"),                        \
            .json = in "on_front", H(BOOL, on_front), .flags = LAC_WHOLE | LAC_TRUTH               \
    }
#define IN_FILE(name_, unit_, long_) .name = (name_), .unit = (unit_), .long_name = (long_)
#define IN_NONE(name_, unit_, long_) .name = NULL

static const lac_variable of_reference[] = {{.name = "reference_value", H(REAL, value)},
                                            {.name = "reference_uncertainty", H(REAL, uncertainty)},
                                            OF_RUN("reference/", "dial", IN_NONE)};
static const lac_variable of_rows[] = {OF_RUN("runs[]/", "run dial", IN_FILE)};
static const lac_variable of_recommended[] = {OF_RUN("recommended/", "dial", IN_NONE)};
static const lac_variable of_refused[] = {
    {.json = "refused[]", H(CHARS, message), .flags = LAC_MISSING}};
static const lac_variable of_end[] = {
    LAC_JSON("recommendation", CHARS, lac_trade, sentence),
    LAC_JSON("wall_time_s", REAL, lac_trade, wall_time),
    LAC_JSON("output", TEXT, lac_trade, path),
};

lac_status lac_trade_describe(const lac_trade *t, lac_dataset **out, lac_error *err)
{
    static const lac_variable of_value = {.dims = "run", .value = amount, .flags = LAC_MISSING};
    const lac_named named = {.name = "value",
                             .long_name = "quantity as the run has it",
                             .unit = lac_quantities[t->quantity].unit};
    const lac_extent dims[] = {{"run", t->rows}, {"dial", t->settings}, {"refused", t->refusals}};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_trade, "", 0), t},
        {LAC_VARIABLES(of_reference, "", 0), t->reference},
        {LAC_VARIABLES_OF_MANY(of_rows, "run"), t->row},
        {LAC_VARIABLES_OF_MANY(of_refused, "refused"), t->row + t->rows},
        {LAC_VARIABLES(of_recommended, "", 0), t->recommended},
        {LAC_VARIABLES(of_end, "", 0), t},
    };
    lac_status status;
    LAC_TRY(lac_dataset_create(
        "Error against cost of a case at different settings: one run a row, measured in a process "
        "of its own, with the Pareto front and what is recommended.",
        out, err));
    LAC_TRY(lac_dataset_dims(*out, dims, sizeof dims / sizeof *dims, err));
    LAC_TRY(lac_dataset_add(*out, laid, sizeof laid / sizeof *laid, err));
    LAC_TRY(lac_dataset_add_named(*out, &of_value, &named, t->row, err));
out:
    LAC_MADE(status, out, lac_dataset_free);
}
