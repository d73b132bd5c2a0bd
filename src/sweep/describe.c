// SPDX-License-Identifier: GPL-3.0-or-later
// An ensemble as tables: its plan, what each member was given, what came of it. The reader of its
// file goes by the same tables.
#include "sweep/describe.h"

#include <ctype.h>

#define ENSEMBLE const lac_ensemble *e = of
#define MEMBER const lac_member *m = of
#define H(kind, field) LAC_HELD(kind, lac_member, field)

LAC_TEXT_GETTER(complete, (void)of, "complete")
LAC_GETTER(double, drawn, ENSEMBLE, e->param[at[1]].value[at[0]])
LAC_TEXT_GETTER(word, ENSEMBLE, e->param[at[1]].word[at[0]])
LAC_TEXT_GETTER(param_key, ENSEMBLE, e->param[at[0]].key)
LAC_TEXT_GETTER(param_said, ENSEMBLE, e->param[at[0]].said)
LAC_GETTER(double, extra, ENSEMBLE, e->member[at[0]]->extra[at[1]])
LAC_GETTER(double, series, MEMBER, (double)m->series[at[0]])
LAC_GETTER(double, place, ENSEMBLE, e->place[at[0]])
LAC_TEXT_GETTER(extra_mark, (void)of, "indicator")

static const lac_variable of_plan[] = {
    {.name = "status", T(complete)},
    {.name = "sweep_design", .json = "design", LAC_HELD(TEXT, lac_ensemble, design)},
    {.name = "sweep_series", LAC_HELD(TEXT, lac_ensemble, series)},
    {.name = "sweep_seed", .json = "seed", LAC_HELD(CHARS, lac_ensemble, seed)},
    {.name = "sweep_mark", LAC_HELD(CHARS, lac_ensemble, mark)},
    LAC_BOTH("sweep_members", "members", LAC_HELD(COUNT, lac_ensemble, members),
             .flags = LAC_WHOLE),
    {.name = "sweep_end_s", .json = "end_s", LAC_HELD(REAL, lac_ensemble, end)},
    {.name = "sweep_files", LAC_HELD(TEXT, lac_ensemble, files)},
};

#define SEEN .flags = LAC_MISSING
const lac_variable lac_ensemble_of_member[] = {
    LAC_ROW("realization", NULL, NULL, "number of the member in its sweep, from 0", H(INT64, index),
            .flags = LAC_WHOLE | LAC_LONG, .standard_name = "realization"),
    LAC_ROW("ended_by", NULL, NULL, "what ended the run", H(INT, ended), .flags = LAC_WHOLE,
            .meanings = "end rate slip stop_when interrupted error rest broken",
            .comment =
                "rate and slip: failure; broken: no run, or one that broke down: its message "
                "says why"),
    LAC_ROW("failure_time", NULL, "s", "time of failure since the start", H(REAL, failure_time),
            SEEN, .comment = "missing: it did not fail until time_reached, or it is broken"),
    LAC_ROW("time_reached", NULL, "s", "time since the start that the run came to",
            H(REAL, end_time), SEEN),
    LAC_ROW("mean_slip", NULL, "m", "mean slip at the end", H(REAL, mean_slip), SEEN),
    LAC_ROW("end_slip_rate", NULL, "m s-1", "mean slip rate at the end", H(REAL, end_rate), SEEN),
    LAC_ROW("max_slip_rate", NULL, "m s-1", "largest slip rate of a cell", H(REAL, max_rate), SEEN),
    LAC_ROW("max_load_ratio", NULL, NULL,
            "largest shear force over f0 times the effective normal "
            "force",
            H(REAL, max_ratio), SEEN),
    LAC_ROW("least_factor_of_safety", NULL, NULL, "least factor of safety", H(REAL, safety), SEEN),
    LAC_ROW("events", NULL, NULL, "events of the catalogue", H(REAL, events), SEEN),
    LAC_ROW("b_value", NULL, NULL, "b of the catalogue's sizes, N(>= M) ~ 10^(-b M)",
            H(REAL, b_value), SEEN, .comment = "missing: no catalogue, or too few events"),
    LAC_ROW("balance_residual", NULL, NULL, "worst relative error of the traction balance",
            H(REAL, balance_residual), SEEN),
    LAC_ROW("steps", NULL, NULL, "steps of the integrator", H(REAL, steps), SEEN),
    LAC_ROW("message", NULL, NULL, "why it is broken", H(CHARS, message), .flags = LAC_CHARS),
};
const size_t lac_ensemble_rows = sizeof lac_ensemble_of_member / sizeof *lac_ensemble_of_member;

// The index-th result of a member; name NULL: past the end.
static lac_ensemble_result result_at(size_t index, size_t extras, const lac_ensemble_extra *extra)
{
    for (size_t i = 0; i < lac_ensemble_rows; i++) {
        const lac_variable *row = &lac_ensemble_of_member[i];
        if (row->held == LAC_HELD_REAL && index-- == 0) {
            const bool time = row->offset == offsetof(lac_member, failure_time);
            return (lac_ensemble_result){row->name, row->unit, row->long_name, row->offset, time};
        }
    }
    if (index >= extras) {
        return (lac_ensemble_result){0};
    }
    const size_t at = offsetof(lac_member, extra) + index * sizeof(double);
    return (lac_ensemble_result){extra[index].name, extra[index].unit, extra[index].long_name, at,
                                 false};
}

lac_status lac_ensemble_result_find(const char *name, size_t extras,
                                    const lac_ensemble_extra *extra, lac_ensemble_result *out,
                                    lac_error *err)
{
    char names[600] = "";
    const char *wanted = name != NULL ? name : "failure_time";
    for (size_t i = 0; (*out = result_at(i, extras, extra)).name != NULL; i++) {
        if (strcmp(out->name, wanted) == 0) {
            return LAC_OK;
        }
        lac_append(names, sizeof names, "%s%s", i > 0 ? ", " : "", out->name);
    }
    return lac_fail(err, LAC_EINPUT, "--of: \"%s\" must be one of %s", wanted, names);
}

const lac_ensemble_axis lac_ensemble_axes[] = {
    [LAC_SERIES_TIME] = {"record_time", "s", "time since the start", "slip_rate", "m s-1",
                         "mean slip rate at record_time"},
    [LAC_SERIES_RATE] =
        {"record_rate", "m s-1", "mean slip rate", "passing_time", "s",
         "time since the start at which the mean slip rate first passes record_rate"},
    [LAC_SERIES_LEFT] = {"record_time_left", "s", "time before failure", "slip_rate", "m s-1",
                         "mean slip rate so long before failure"},
};

void lac_ensemble_name(const char *key, char name[LAC_STORED_NAME])
{
    size_t i = 0;
    for (; key[i] != '\0' && key[i] != '+' && i + 1 < LAC_STORED_NAME; i++) {
        name[i] = isalnum((unsigned char)key[i]) ? key[i] : '_';
    }
    name[i] = '\0';
}

static lac_status add_params(lac_dataset *d, const lac_ensemble *e, lac_error *err)
{
    static const lac_variable number = {
        .dims = "realization", .value = drawn, .flags = LAC_MISSING};
    static const lac_variable text = {.dims = "realization", .text = word, .flags = LAC_CHARS};
    static const lac_variable about[] = {{.name = "sweep_key", T(param_key)},
                                         {.name = "sweep_values", T(param_said)}};
    const lac_laid beside = {LAC_VARIABLES(about, "", 0), e};
    for (size_t p = 0; p < e->params; p++) {
        char name[LAC_STORED_NAME], title[160];
        const lac_ensemble_param *param = &e->param[p];
        lac_ensemble_name(param->key, name);
        (void)snprintf(title, sizeof title, "%s of the member's case", param->key);
        const lac_named named = {.name = name, .long_name = title, .unit = param->unit, .which = p};
        LAC_TRY_RETURN(
            lac_dataset_add_named(d, param->word != NULL ? &text : &number, &named, e, err));
        lac_dataset_attributes(d, &beside);
    }
    return LAC_OK;
}

static lac_status add_extras(lac_dataset *d, const lac_ensemble *e, lac_error *err)
{
    static const lac_variable row = {.dims = "realization", .value = extra, .flags = LAC_MISSING};
    static const lac_variable about[] = {{.name = "sweep_result", T(extra_mark)}};
    const lac_laid beside = {LAC_VARIABLES(about, "", 0), e};
    for (size_t i = 0; i < e->extras; i++) {
        const lac_ensemble_extra *x = &e->extra[i];
        const lac_named named = {
            .name = x->name, .long_name = x->long_name, .unit = x->unit, .which = i};
        LAC_TRY_RETURN(lac_dataset_add_named(d, &row, &named, e, err));
        lac_dataset_attributes(d, &beside);
    }
    return LAC_OK;
}

static lac_status add_series(lac_dataset *d, const lac_ensemble *e, lac_error *err)
{
    static const lac_variable of_place = {.dims = "record", .value = place};
    const lac_ensemble_axis *axis = &lac_ensemble_axes[e->axis];
    const lac_named named = {
        .name = axis->place, .long_name = axis->place_doc, .unit = axis->place_unit};
    return lac_dataset_add_named(d, &of_place, &named, e, err);
}

lac_status lac_ensemble_describe(const lac_ensemble *e, const lac_answers *answers,
                                 lac_dataset **out, lac_error *err)
{
    static const lac_variable of_rate[] = {
        LAC_ROW("slip_rate", "realization record", "m s-1", "mean slip rate at the record's place",
                G(series), .flags = LAC_MISSING | LAC_FLOAT | LAC_CELLS)};
    static const lac_variable of_time[] = {
        LAC_ROW("passing_time", "realization record", "s",
                "time since the start at which the mean slip rate first passes record_rate",
                G(series), .flags = LAC_MISSING | LAC_FLOAT | LAC_CELLS)};
    const lac_variables rates = LAC_VARIABLES_OF_MANY(of_rate, "realization");
    const lac_variables times = LAC_VARIABLES_OF_MANY(of_time, "realization");
    const lac_variables members = {.row = lac_ensemble_of_member,
                                   .rows = lac_ensemble_rows,
                                   .over = "realization",
                                   .pointers = true};
    const lac_extent dims[] = {{"realization", e->n}, {"record", e->records}};
    const lac_laid laid[] = {{LAC_VARIABLES(of_plan, "", 0), e},
                             {members, e->member},
                             {e->axis == LAC_SERIES_RATE ? times : rates, e->member}};
    lac_status status;
    LAC_TRY(lac_dataset_create("Runs of one case with other values of some of its keys: a member a "
                               "realization, with what it was given and what came of it.",
                               out, err));
    LAC_TRY(lac_dataset_dims(*out, dims, sizeof dims / sizeof *dims, err));
    LAC_TRY(lac_dataset_add(*out, laid, 2, err));
    LAC_TRY(add_params(*out, e, err));
    LAC_TRY(add_extras(*out, e, err));
    LAC_TRY(add_series(*out, e, err));
    LAC_TRY(lac_dataset_add(*out, laid + 2, 1, err));
    if (answers != NULL) {
        LAC_TRY(lac_answers_add(answers, *out, err));
    }
out:
    LAC_MADE(status, out, lac_dataset_free);
}
