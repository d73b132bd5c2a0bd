// SPDX-License-Identifier: GPL-3.0-or-later
// What a trade came to, as tables: the variables of its file, a row a run, and its JSON.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "data/describe.h"
#include "trade/trade.h"

const char *lac_trade_command(const lac_trade_plan *plan, size_t run)
{
    const lac_trade_of of = lac_trade_of_run(plan, run);
    return of == LAC_OF_CASCADE ? "rg" : of == LAC_OF_CONTACT ? "contact" : "run";
}

const char *lac_trade_end_name(lac_trade_end end)
{
    return end == LAC_TRADE_DONE ? "done" : end == LAC_TRADE_GIVEN_UP ? "given up" : "broken";
}

const char *lac_trade_settings_text(const lac_trade_outcome *o, size_t run,
                                    char text[LAC_TEXT_ROOM])
{
    size_t used = 0;
    text[0] = '\0';
    for (size_t d = 0; d < o->plan->settings && used < LAC_TEXT_ROOM; d++) {
        used += (size_t)snprintf(text + used, LAC_TEXT_ROOM - used, "%s%s=%s", d > 0 ? " " : "",
                                 o->plan->setting[d].setting->key, o->settings[run].label[d]);
    }
    return text;
}

const char *lac_trade_options(const lac_trade_outcome *o, size_t run, char text[LAC_TEXT_ROOM])
{
    size_t used = 0;
    text[0] = '\0';
    for (size_t d = 0; d < o->plan->settings && used < LAC_TEXT_ROOM; d++) {
        const lac_trade_setting *setting = &o->plan->setting[d];
        const int at = o->plan->run[run].at[d];
        const char *label = o->settings[run].label[d];
        const char *yaml = at >= 0 ? setting->value[at].yaml : label;
        const bool named = at >= 0 && strcmp(yaml, setting->value[at].label) != 0;
        const char *quote = strpbrk(yaml, " {") != NULL ? "'" : "";
        if (named || strcmp(label, o->own->label[d]) != 0) {
            used +=
                (size_t)snprintf(text + used, LAC_TEXT_ROOM - used, "%s--set %s%s=%s%s",
                                 used > 0 ? " " : "", quote, setting->setting->key, yaml, quote);
        }
    }
    return text;
}

// Numbers by value, from small to large; else by name.
static int compare_labels(const char *a, const char *b)
{
    char *end_a, *end_b;
    const double x = strtod(a, &end_a), y = strtod(b, &end_b);
    const bool numbers = end_a != a && end_b != b && *end_a == '\0' && *end_b == '\0';
    return !numbers ? strcmp(a, b) : (x > y) - (x < y);
}

// The order of a table: what is turned against a rung of the ladder stays together.
static bool stands_before(const lac_trade_outcome *o, size_t a, size_t b)
{
    const lac_trade_plan *plan = o->plan;
    for (size_t d = 0; d < plan->settings; d++) {
        const int order = compare_labels(o->settings[a].label[d], o->settings[b].label[d]);
        if (d != plan->ladder && order != 0) {
            return order < 0;
        }
    }
    return plan->ladder != SIZE_MAX &&
           plan->run[a].at[plan->ladder] < plan->run[b].at[plan->ladder];
}

lac_status lac_trade_list(lac_trade_outcome *o, lac_error *err)
{
    o->row = calloc(o->plan->runs + 1, sizeof *o->row);
    o->refused = calloc(o->plan->runs + 1, sizeof *o->refused);
    o->reference = (lac_trade_row){o, o->verdict->reference};
    o->recommended = (lac_trade_row){o, o->verdict->recommended};
    LAC_FAIL_MEMORY_IF(o->row == NULL || o->refused == NULL, err);
    for (size_t i = 0; i < o->plan->runs; i++) {
        const lac_trade_end end = o->measure[i].end;
        if (end == LAC_TRADE_REFUSED) {
            o->refused[o->refusals++] = i;
        }
        if ((o->plan->run[i].why & LAC_TRADE_TRIED) != 0 &&
            (end == LAC_TRADE_DONE || end == LAC_TRADE_BROKEN || end == LAC_TRADE_GIVEN_UP)) {
            size_t at = o->rows++;
            for (; at > 0 && stands_before(o, i, o->row[at - 1].run); at--) {
                o->row[at] = o->row[at - 1];
            }
            o->row[at] = (lac_trade_row){o, i};
        }
    }
    return LAC_OK;
}

void lac_trade_outcome_clear(lac_trade_outcome *o)
{
    free(o->row);
    free(o->refused);
}

#define OUTCOME const lac_trade_outcome *o = of
#define VERDICT const lac_trade_result *v = ((const lac_trade_outcome *)of)->verdict
#define ABOUT \
    VERDICT;  \
    const lac_quantity_about *info = lac_quantity_about_of(v->quantity)
#define RUN                                                     \
    const lac_trade_row *r = (const lac_trade_row *)of + at[0]; \
    const lac_trade_outcome *o = r->of
#define MEASURE \
    RUN;        \
    const lac_trade_measure *m = &o->measure[r->run]

LAC_TEXT_GETTER(title, OUTCOME, o->title)
LAC_TEXT_GETTER(sentence, OUTCOME, o->sentence)
LAC_TEXT_GETTER(complete, (void)of, "complete")
LAC_TEXT_GETTER(quantity, ABOUT, info->name)
LAC_TEXT_GETTER(quantity_unit, ABOUT, info->unit)
LAC_TEXT_GETTER(quantity_doc, ABOUT, info->doc)
LAC_TEXT_GETTER(reference_settings, OUTCOME,
                lac_trade_settings_text(o, o->verdict->reference, room))
LAC_TEXT_GETTER(recommended_settings, OUTCOME,
                o->verdict->recommended != SIZE_MAX
                    ? lac_trade_settings_text(o, o->verdict->recommended, room)
                    : NULL)
LAC_GETTER(double, reference_value, VERDICT, v->value)
LAC_GETTER(double, reference_uncertainty, VERDICT, v->uncertainty)
LAC_TEXT_GETTER(refused, OUTCOME, o->measure[o->refused[at[0]]].message)

LAC_TEXT_GETTER(settings, RUN, lac_trade_settings_text(o, r->run, room))
LAC_TEXT_GETTER(label_of_row, RUN, o->settings[r->run].label[at[1]])
LAC_TEXT_GETTER(label_of_one, const lac_trade_row *r = of, r->of->settings[r->run].label[at[0]])
LAC_TEXT_GETTER(key_of_row, RUN, o->plan->setting[at[1]].setting->key)
LAC_TEXT_GETTER(key_of_one, const lac_trade_row *r = of, r->of->plan->setting[at[0]].setting->key)
LAC_TEXT_GETTER(command, RUN, lac_trade_command(o->plan, r->run))
LAC_TEXT_GETTER(options, RUN, lac_trade_options(o, r->run, room))
LAC_TEXT_GETTER(end, MEASURE, lac_trade_end_name(m->end))
LAC_TEXT_GETTER(message, MEASURE, m->message[0] != '\0' ? m->message : NULL)
LAC_GETTER(double, value, MEASURE,
           m->end == LAC_TRADE_DONE ? m->value[o->verdict->quantity] : (double)NAN)
LAC_GETTER(double, error, RUN, o->verdict->error[r->run])
LAC_GETTER(double, uncertainty, RUN, o->verdict->uncertainty)
LAC_GETTER(double, wall_time, MEASURE, m->wall_time)
LAC_GETTER(double, cpu_time, MEASURE, m->cpu_time)
LAC_GETTER(double, memory, MEASURE, (double)m->memory)
LAC_GETTER(double, output, MEASURE, (double)m->output)
LAC_GETTER(double, steps, MEASURE, (double)m->steps)
LAC_GETTER(double, evaluations, MEASURE, (double)m->evaluations)
LAC_GETTER(double, cells, MEASURE, (double)m->cells)
LAC_GETTER(double, on_front, RUN, o->verdict->on_front[r->run] ? 1.0 : 0.0)

static const lac_variable of_trade[] = {
    {.json = "title", T(title)},
    {.name = "status", T(complete)},
    {.name = "quantity", .json = "quantity", T(quantity)},
    {.name = "quantity_unit", .json = "unit", T(quantity_unit)},
    {.name = "quantity_long_name", T(quantity_doc)},
    {.name = "reference_settings", T(reference_settings)},
    {.name = "recommended_settings", T(recommended_settings)},
    {.name = "recommendation", T(sentence)},
    {.name = "reference_value", G(reference_value)},
    {.name = "reference_uncertainty", G(reference_uncertainty)},
};

// What is told of a run. @param F  whether a file has it: F(name, unit, what it is)
#define OF_RUN(in, dims_, which, F)                                                                \
    {F("settings", NULL, "settings of the run, keys of its case"), T(settings)},                   \
        {.json = in "settings{}",                                                                  \
         .dims = (dims_),                                                                          \
         T(label_of_##which),                                                                      \
         .label = key_of_##which,                                                                  \
         .flags = LAC_NUMERAL},                                                                    \
        {.json = in "command", T(command)}, {.json = in "options", T(options)},                    \
        {F("end", NULL, "how it ended: done, broken, given up"), .json = in "end", T(end)},        \
        {.json = in "message", T(message)}, {.json = in "value", G(value)},                        \
        {F("error", NULL, "difference from the reference, relative"), .json = in "error",          \
         G(error), .flags = LAC_MISSING},                                                          \
        {F("error_uncertainty", NULL, "error of the reference itself, relative"),                  \
         .json = in "error_uncertainty", G(uncertainty), .flags = LAC_MISSING},                    \
        {F("wall_time", "s", "time on the clock"), .json = in "wall_time_s", G(wall_time),         \
         .flags = LAC_MISSING},                                                                    \
        {F("cpu_time", "s", "time of the processor"), .json = in "cpu_time_s", G(cpu_time),        \
         .flags = LAC_MISSING},                                                                    \
        {F("peak_memory", "byte", "largest resident memory"), .json = in "peak_memory_bytes",      \
         G(memory), .flags = LAC_MISSING},                                                         \
        {F("output_size", "byte", "size of the run's file"), .json = in "output_bytes", G(output), \
         .flags = LAC_MISSING},                                                                    \
        {F("steps", NULL, "steps of the integrator"), .json = in "steps", G(steps),                \
         .flags = LAC_MISSING},                                                                    \
        {F("rhs_evaluations", NULL, "evaluations of the right-hand side"),                         \
         .json = in "rhs_evaluations", G(evaluations), .flags = LAC_MISSING},                      \
        {.json = in "n_cells", G(cells)},                                                          \
    {                                                                                              \
        F("on_front", NULL, "1: no other run errs and costs less; else 0"),                        \
            .json = in "on_front", G(on_front), .flags = LAC_WHOLE | LAC_TRUTH                     \
    }
#define IN_FILE(name_, unit_, long_) .name = (name_), .unit = (unit_), .long_name = (long_)
#define IN_NONE(name_, unit_, long_) .name = NULL

static const lac_variable of_reference[] = {OF_RUN("reference/", "dial", one, IN_NONE)};
static const lac_variable of_rows[] = {OF_RUN("runs[]/", "run dial", row, IN_FILE)};
static const lac_variable of_recommended[] = {OF_RUN("recommended/", "dial", one, IN_NONE)};
static const lac_variable of_refused[] = {{.json = "refused[]", T(refused)}};
static const lac_variable of_end[] = {{.json = "recommendation", T(sentence)}};

lac_status lac_trade_describe(const lac_trade_outcome *o, lac_dataset **out, lac_error *err)
{
    static const lac_variable of_value = {.dims = "run", G(value), .flags = LAC_MISSING};
    const lac_named named = {.name = "value",
                             .long_name = "quantity as the run has it",
                             .unit = lac_quantity_about_of(o->verdict->quantity)->unit};
    const bool any = o->verdict->recommended != SIZE_MAX;
    const lac_extent dims[] = {
        {"run", o->rows}, {"dial", o->plan->settings}, {"refused", o->refusals}};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_trade, "", 0), o},
        {LAC_VARIABLES(of_reference, "", 0), &o->reference},
        {LAC_VARIABLES(of_rows, "run", 0), o->row},
        {LAC_VARIABLES(of_refused, "refused", 0), o},
        {LAC_VARIABLES(of_recommended, "", 0), any ? &o->recommended : NULL},
        {LAC_VARIABLES(of_end, "", 0), o},
    };
    lac_status status;
    LAC_TRY(lac_dataset_create(
        "Error against cost of a case at different settings: one run a row, measured in a process "
        "of its own, with the Pareto front and what is recommended.",
        out, err));
    LAC_TRY(lac_dataset_dims(*out, dims, sizeof dims / sizeof *dims, err));
    LAC_TRY(lac_dataset_add(*out, laid, sizeof laid / sizeof *laid, err));
    LAC_TRY(lac_dataset_add_named(*out, &of_value, &named, o->row, err));
out:
    return lac_dataset_described(out, status);
}
