// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna check CASE: says what is wrong with a case and what it would cost, without running it.
#include <unistd.h>

#include "cli/common/command.h"
#include "cli/common/memory.h"
#include "cli/common/output.h"
#include "cli/common/words.h"
#include "cli/run/check_lumped.h"
#include "cli/run/run_outcome.h"
#include "data/describe.h"
#include "scene/estimate.h"
#include "simulation/branch.h"

// What `check` has found beyond the text of the case.
typedef struct findings {
    const lac_case *source;
    lac_case_issues *report; // where each is added
    lac_status status;       // the first's
} findings;

static lac_status add_finding(findings *f, const char *key, const lac_error *why, lac_status status,
                              lac_error *err)
{
    lac_case_issues *report = f->report;
    char text[2000];
    const lac_status added = cli_report_add(report, f->source, key, why->message, false, err);
    if (added != LAC_OK) {
        return added;
    }
    f->status = f->status == LAC_OK ? status : f->status;
    cli_note("%s", lac_case_issue_format(&report->issue[report->count - 1], text, sizeof text));
    return LAC_OK;
}

// Reads what the loads of a list name, each for itself.
static lac_status try_loads(findings *f, const char *list, const lac_model_list *models,
                            const lac_load_clock *clock, lac_error *err)
{
    lac_status status = LAC_OK;
    for (size_t i = 0; i < models->count && status == LAC_OK; i++) {
        const lac_model *model = &models->item[i];
        const lac_load_kind *kind = (const void *)model->info;
        void *state;
        lac_error why = {""};
        char key[100];
        status = lac_load_prepare(kind, model->params, clock, &state, &why);
        lac_load_release(kind, state);
        LAC_FAIL_MEMORY_IF(status == LAC_ENOMEM, err);
        (void)snprintf(key, sizeof key, "load.%s.%zu.%s", list, i, kind->info.name);
        status = status == LAC_OK ? status : add_finding(f, key, &why, status, err);
    }
    return status;
}

// Whether the maps of a spread are there; where the scene is built they are read too.
static lac_status try_maps(findings *f, const char *section, const lac_heterogeneity_list *list,
                           lac_error *err)
{
    lac_status status = LAC_OK;
    for (size_t i = 0; i < list->count && status == LAC_OK; i++) {
        const lac_model *model = &list->item[i].model;
        const lac_heterogeneity_map *map = model->params;
        if (model->info == &lac_heterogeneity_map_kind.info && access(map->path, R_OK) != 0) {
            lac_error why;
            char key[200];
            (void)lac_fail(&why, LAC_EIO, "%s: %s", map->path, strerror(errno));
            (void)snprintf(key, sizeof key, "%s.spread.%s", section, list->item[i].key);
            status = add_finding(f, key, &why, LAC_EIO, err);
        }
    }
    return status;
}

static double rounded(double x, int digits)
{
    double unit = pow(10, floor(log10(x)) - digits + 1);
    return x > 0 ? round(x / unit) * unit : x;
}

static const char *steps_class(const lac_estimate *e)
{
    return e->own_steps  ? "own"
           : e->changing ? "not estimated"
           : e->stable   ? "hundreds"
                         : "per cell";
}

// One figure where the two are near each other.
static void print_time(const lac_estimate *e)
{
    double least = rounded(e->cpu_time_least, 1), most = rounded(e->cpu_time_most, 1);
    if (isnan(most)) {
        printf("#   time            at least %.10g s on one core\n", least);
    } else if (most < 2.5 * least) {
        printf("#   time            about %.10g s on one core\n", most);
    } else {
        printf("#   time            %.10g to %.10g s on one core\n", least, most);
    }
    if (!isnan(e->cascade_time)) {
        printf("#   cascade         about %.10g s%s\n", rounded(e->cascade_time, 1),
               e->integrated ? " of it" : " (lacuna rg)");
    }
}

static void print_size(const lac_estimate *e)
{
    const double cells = e->contact_cells, room = (double)cli_memory_free("") / 1e6;
    printf("#   grid            %.0f cells\n", e->grid_cells);
    if (!isnan(cells)) {
        printf("#   contact         %s%.3g cells%s\n", e->exact ? "" : "about ", cells,
               e->integrated ? cli_format(", %.3g unknowns", e->unknowns * cells).s : "");
    }
    const cli_text more = cli_format(": more than the %.10g MB that are free", rounded(room, 2));
    printf("#   memory          %.10g MB%s\n", rounded(e->memory / 1e6, 2),
           e->memory > 1e6 * room ? more.s : "");
    if (e->ranks > 1) {
        printf("#   ranks           up to %.0f, better %.0f (lacuna-mpi), of %.10g MB at most\n",
               e->ranks, ceil(e->ranks / 4), rounded(e->memory_rank / 1e6, 2));
    }
}

// CPU time in a few digits.
static cli_text cost_text(const lac_fidelity_cost *cost)
{
    return isnan(cost->most)
               ? cli_format("at least %.10g s", rounded(cost->least, 1))
               : cli_format("%.10g to %.10g s", rounded(cost->least, 1), rounded(cost->most, 1));
}

static void print_fidelity(const lac_case *c, const lac_estimate *e)
{
    const lac_fidelity all[] = {LAC_FIDELITY_ODE, LAC_FIDELITY_ASYNC};
    const lac_fidelity_choice *choice = &e->choice;
    char why[LAC_FIDELITY_ROOM];
    printf("#   fidelity        %s%s\n", lac_fidelity_name(choice->fidelity),
           choice->why[0] != '\0' ? ", chosen" : "");
    if (choice->why[0] != '\0') {
        cli_wrap("#     ", choice->why);
    }
    for (size_t k = 0; k < 2; k++) {
        if (k == 0 || !lac_fidelity_refused(c, why)) {
            printf("#     %-13s error at most %.1g, %s\n", lac_fidelity_name(all[k]),
                   lac_fidelity_error(c, e, all[k]), cost_text(&e->cost[k]).s);
        }
    }
}

// How many steps, and why.
static void print_steps(const lac_estimate *e)
{
    if (e->own_steps) {
        printf("#   steps           of each cell its own, %s\n",
               isnan(e->steps_most) ? cli_format("at least %d", LAC_OWN_FEWEST).s
                                    : cli_format("%d to %d", LAC_OWN_FEWEST, LAC_OWN_STEPS).s);
        cli_wrap("#     ", e->faster != NULL
                               ? "no cell slips by itself: fidelity ode is the faster one"
                               : "a slip costs some hundred, whatever the number of cells");
        return;
    }
    printf("#   steps           %s\n", steps_class(e));
    cli_wrap("#     ",
             e->changing
                 ? "a load changes in time: how often cells slip under it is not known before"
             : e->stable ? "the cells move together, or there is one"
                         : cli_format("%d to %.2g: cells may fail one by one, %d steps each",
                                      LAC_FEWEST_STEPS, e->steps_most, LAC_STEPS_PER_FAILURE)
                               .s);
    if (e->faster != NULL) {
        cli_wrap("#     ", "k_0 < k_crit: fidelity events is the faster one (docs/choosing.md)");
    }
}

static void print_regime(const lac_case *c, const lac_estimate *e)
{
    char words[LAC_REGIME_ROOM];
    lac_regime_words(c, e, words);
    if (words[0] != '\0') {
        printf("#   regime          %s\n", lac_regime_name(lac_regime_of(e)));
        cli_wrap("#     ", words);
    }
}

// As comment lines of YAML.
static void print_estimate(const lac_case *c, const lac_estimate *e, const cli_lumped_try *lumped)
{
    printf("\n# What it will cost%s, roughly\n", e->own_steps ? " with each cell at its own steps"
                                                 : e->integrated ? " with bdf"
                                                                 : "");
    print_size(e);
    print_time(e);
    if (e->file_bytes > 1e8) { // else nothing beside the rest
        printf("#   file            up to %.10g MB: %.3g records at stated times\n",
               rounded(e->file_bytes / 1e6, 2), e->records);
    }
    if (!isnan(e->stiffness_ratio)) {
        printf("#   k_0/k_crit      %.2g\n", e->stiffness_ratio);
    }
    if (lumped->made) {
        printf("#   lumped          would do: k_0/k_crit %.2g, estimated error %.2g %%, %s\n",
               e->stiffness_ratio, 100.0 * lumped->error, cli_amount(lumped->time, "s").s);
        cli_wrap("#     ",
                 cli_format("solver.fidelity: lumped runs %zu cells for all", lumped->cells).s);
    }
    print_regime(c, e);
    if (e->failure.lowered) {
        printf("#   failure rate    %s\n", cli_amount(e->failure.rate, "m/s").s);
        cli_wrap("#     ", cli_failure_lowered);
    }
    if (e->integrated) {
        print_steps(e);
        print_fidelity(c, e);
    }
}

// What `check` found. Texts and what is pointed to are borrowed.
typedef struct checked {
    const lac_case *source;
    const char *scene, *branch;              // resolved case, what it goes on from; NULL
    const lac_estimate *estimate;            // NULL: the case has errors
    const cli_lumped_try *lumped;            // NULL: it would not do
    size_t errors, warnings;                 // how many
    const lac_case_issue **error, **warning; // [errors], [warnings]
    char regime[LAC_REGIME_ROOM];            // words on it
    double kept[2]; // error that fidelity ode and events keep; NaN: refused
} checked;

#define CHECKED const checked *c = of
#define ESTIMATE const lac_estimate *e = ((const checked *)of)->estimate
#define ISSUE const lac_case_issue *i = of

LAC_GETTER(double, ok, CHECKED, c->estimate != NULL)
LAC_GETTER(bool, branches, CHECKED, c->branch != NULL)
LAC_GETTER(double, line, ISSUE, i->line > 0 ? (double)i->line : (double)NAN)

static const lac_variable of_check[] = {
    {.name = "ok", .json = "ok", G(ok), .flags = LAC_WHOLE | LAC_TRUTH}};

#define ISSUES(in)                                                                                 \
    {                                                                                              \
        LAC_ROW(in "_file", NULL, NULL, "file", LAC_HELD(TEXT, lac_case_issue, file),              \
                .json = in "s[]/file"),                                                            \
            LAC_ROW(in "_line", NULL, NULL, "line of it", G(line),                                 \
                    .flags = LAC_WHOLE | LAC_MISSING, .json = in "s[]/line"),                      \
            LAC_ROW(in "_key", NULL, NULL, "key of the case", LAC_HELD(TEXT, lac_case_issue, key), \
                    .json = in "s[]/key"),                                                         \
            LAC_ROW(in "_value", NULL, NULL, "what it is set to",                                  \
                    LAC_HELD(TEXT, lac_case_issue, value), .json = in "s[]/value"),                \
            LAC_ROW(in "_message", NULL, NULL, "what is allowed, or to be known",                  \
                    LAC_HELD(TEXT, lac_case_issue, message), .json = in "s[]/message")             \
    }
static const lac_variable of_errors[] = ISSUES("error");
static const lac_variable of_warnings[] = ISSUES("warning");

static const lac_variable of_scene[] = {
    {.name = "scene", .json = "scene", LAC_HELD(TEXT, checked, scene)},
    {.name = "branch", .json = "branch", LAC_HELD(TEXT, checked, branch), .has = branches},
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
LAC_GETTER(double, ranks, ESTIMATE, e->ranks)
LAC_GETTER(double, memory_rank, ESTIMATE, round(e->memory_rank))
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
LAC_GETTER(bool, integrated, ESTIMATE, e->integrated)
LAC_TEXT_GETTER(fidelity, ESTIMATE, lac_fidelity_name(e->choice.fidelity))
LAC_TEXT_GETTER(fidelity_why, ESTIMATE, e->choice.why[0] != '\0' ? e->choice.why : NULL)
#define COST(k, field) isnan(c->kept[k]) ? (double)NAN : c->estimate->cost[k].field
LAC_GETTER(double, ode_least, CHECKED, COST(0, least))
LAC_GETTER(double, ode_most, CHECKED, COST(0, most))
LAC_GETTER(double, ode_error, CHECKED, c->kept[0])
LAC_GETTER(double, events_least, CHECKED, COST(1, least))
LAC_GETTER(double, events_most, CHECKED, COST(1, most))
LAC_GETTER(double, events_error, CHECKED, c->kept[1])
LAC_TEXT_GETTER(steps_in_words, ESTIMATE, e->integrated ? steps_class(e) : NULL)

#define E(name_, unit_, long_, getter, ...)                                          \
    LAC_ROW(name_, NULL, unit_, long_, G(getter), .flags = LAC_SINGLE | LAC_MISSING, \
            .json = "estimate/" name_ __VA_ARGS__)
#define TRUTH(name_, getter)                                                                  \
    {                                                                                         \
        .name = (name_), .json = "estimate/" name_, G(getter), .flags = LAC_WHOLE | LAC_TRUTH \
    }
// What a fidelity costs and keeps.
#define OF_FIDELITY(name_, getter)                                                         \
    LAC_ROW(name_ "_cpu_time_least", NULL, "s", "least time with fidelity " name_,         \
            G(getter##_least), .flags = LAC_SINGLE | LAC_MISSING, .has = integrated,       \
            .json = "estimate/fidelities/" name_ "/cpu_time_least_s"),                     \
        LAC_ROW(name_ "_cpu_time_most", NULL, "s", "longest time with fidelity " name_,    \
                G(getter##_most), .flags = LAC_SINGLE | LAC_MISSING, .has = integrated,    \
                .json = "estimate/fidelities/" name_ "/cpu_time_most_s"),                  \
        LAC_ROW(name_ "_error", NULL, "1", "relative error that fidelity " name_ " keeps", \
                G(getter##_error), .flags = LAC_SINGLE | LAC_MISSING, .has = integrated,   \
                .json = "estimate/fidelities/" name_ "/error")
static const lac_variable of_estimate[] = {
    E("grid_cells", NULL, "cells of the grid", grid_cells),
    E("contact_cells", NULL, "contact cells", contact_cells),
    TRUTH("contact_cells_exact", exact),
    E("unknowns", NULL, "unknowns of a run", unknowns),
    E("memory", "byte", "largest resident memory", memory, "_bytes"),
    E("ranks_most", NULL, "ranks of lacuna-mpi that can share the run", ranks),
    E("memory_rank", "byte", "memory of the first of a fourth of them", memory_rank, "_bytes"),
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
    {.name = "regime_words", .json = "estimate/regime_words", LAC_HELD(CHARS, checked, regime)},
    {.name = "faster_fidelity", .json = "estimate/faster_fidelity", T(faster)},
    {.name = "fidelity", .json = "estimate/fidelity", T(fidelity), .has = integrated},
    {.name = "fidelity_why", .json = "estimate/fidelity_why", T(fidelity_why), .has = integrated},
    OF_FIDELITY("ode", ode),
    OF_FIDELITY("events", events),
    E("failure_rate", "m s-1", "mean slip rate that counts as failure", failure_rate, "_m_s"),
    TRUTH("failure_rate_lowered", lowered),
    {.name = "steps_class", .json = "estimate/steps_class", T(steps_in_words)},
    E("steps_least", NULL, "least steps", steps_least),
    E("steps_most", NULL, "most steps", steps_most),
};

static const lac_variable of_lumped[] = {
    LAC_ROW("lumped_cells", NULL, NULL, "cells that would stand for all",
            LAC_HELD(COUNT, cli_lumped_try, cells), .json = "estimate/lumped/cells"),
    LAC_ROW("lumped_error_estimated", NULL, NULL, "relative error of a lumped run, by estimate",
            LAC_HELD(REAL, cli_lumped_try, error), .json = "estimate/lumped/error_estimated"),
    LAC_ROW("lumped_cpu_time", NULL, "s", "CPU that its integration takes",
            LAC_HELD(REAL, cli_lumped_try, time), .json = "estimate/lumped/cpu_time_s"),
};

static lac_status describe(const checked *c, lac_dataset **out, lac_error *err)
{
    const lac_extent dims[] = {{"error", c->errors}, {"warning", c->warnings}};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_check, "", 0), c},
        {LAC_VARIABLES_OF_MANY(of_errors, "error"), c->error},
        {LAC_VARIABLES_OF_MANY(of_warnings, "warning"), c->warning},
        {LAC_VARIABLES(of_scene, "", 0), c},
        {LAC_VARIABLES(of_estimate, "", 0), c->estimate != NULL ? c : NULL},
        {LAC_VARIABLES(of_lumped, "", 0), c->lumped},
    };
    lac_status status;
    LAC_TRY(lac_dataset_create("What is wrong with a case, and what its run will cost.", out, err));
    LAC_TRY(lac_dataset_dims(*out, dims, sizeof dims / sizeof *dims, err));
    LAC_TRY(lac_dataset_add(*out, laid, sizeof laid / sizeof *laid, err));
out:
    return lac_dataset_described(out, status);
}

// As JSON, or with --pipe as the dataset that it is.
static lac_status put_out(const cli_request *request, checked *c, const lac_case_issues *report,
                          lac_error *err)
{
    // what is wrong with the scene as a whole stands at no line of the case
    const lac_case_issue whole = {.file = (char *)request->argument[0],
                                  .key = (char *)"",
                                  .value = (char *)"",
                                  .message = err->message};
    const lac_provenance made = {.seed = INT64_MIN};
    lac_dataset *dataset = NULL;
    lac_error late = {""};
    lac_status status;
    const lac_case_issue **all = calloc(2 * report->count + 1, sizeof *all);
    LAC_TRY(all == NULL ? lac_fail_memory(&late) : LAC_OK);
    c->error = all;
    c->warning = all + report->count + 1;
    for (size_t i = 0; i < report->count; i++) {
        const lac_case_issue *issue = &report->issue[i];
        *(issue->warning ? &c->warning[c->warnings++] : &c->error[c->errors++]) = issue;
    }
    if (c->errors == 0 && err->message[0] != '\0') {
        c->error[c->errors++] = &whole;
    }
    if (c->estimate != NULL) {
        char why[LAC_FIDELITY_ROOM];
        lac_regime_words(c->source, c->estimate, c->regime);
        const bool runs = c->estimate->integrated;
        c->kept[0] = runs ? lac_fidelity_error(c->source, c->estimate, LAC_FIDELITY_ODE) : NAN;
        c->kept[1] = !runs || lac_fidelity_refused(c->source, why)
                         ? (double)NAN
                         : lac_fidelity_error(c->source, c->estimate, LAC_FIDELITY_ASYNC);
    }
    LAC_TRY(describe(c, &dataset, &late));
    if (request->pipe != 0) {
        LAC_TRY(cli_put_dataset(request, false, &made, NULL, dataset, &late));
        goto out;
    }
    lac_json json = {.out = stdout};
    lac_json_open(&json, NULL, '{');
    lac_dataset_json(dataset, &json);
    lac_json_close(&json, '}');
out:
    lac_dataset_free(dataset);
    free((void *)all);
    if (status != LAC_OK) {
        *err = late;
    }
    return status;
}

static lac_status examine(const cli_request *request, const lac_case *c, lac_case_issues *report,
                          char **scene, lac_estimate *estimate, lac_error *err)
{
    findings f = {.source = c, .report = report};
    lac_load_clock clock = {c->dated, c->start_date, c->run.end, NULL};
    lac_load_files *files = NULL;
    cli_compare compare = {0};
    lac_status status;
    *scene = lac_case_text(c);
    LAC_FAIL_MEMORY_IF(*scene == NULL, err);
    LAC_TRY(lac_load_files_create(&files, err));
    clock.files = files;
    // all files beside the surface and the domain, which the estimate opens
    LAC_TRY(try_loads(&f, "shear", &c->shear, &clock, err));
    LAC_TRY(try_loads(&f, "pore_pressure", &c->pore, &clock, err));
    LAC_TRY(try_maps(&f, "interface", &c->interface_spread, err));
    LAC_TRY(try_maps(&f, "friction", &c->friction_spread, err));
    LAC_TRY(try_maps(&f, "initial", &c->initial_spread, err));
    LAC_TRY(f.status);
    LAC_TRY(cli_compare_read(request, c, &compare, err));
    LAC_TRY(lac_estimate_make(c, files, estimate, err));
out:
    cli_compare_clear(&compare);
    lac_load_files_free(files);
    return status;
}

lac_status cli_check(const cli_request *request, lac_error *err)
{
    lac_case *c = NULL;
    lac_case_issues report = {0};
    lac_estimate estimate = {.grid_cells = NAN};
    cli_lumped_try lumped = {.made = false};
    lac_branch *branch = NULL;
    char *scene = NULL;
    const bool told = cli_given(request, CLI_OPT_JSON) || request->pipe != 0;
    lac_status status = cli_case_read(request, LAC_FOR_CHECK, &c, &report, err);
    if (status == LAC_OK) {
        status = examine(request, c, &report, &scene, &estimate, err);
    }
    if (status == LAC_OK && c->from.file != NULL) {
        status = lac_branch_open(c, &branch, err);
    }
    if (status == LAC_OK) {
        cli_try_lumped(c, &estimate, &lumped);
    }
    const char *words = branch != NULL ? branch->text : NULL;
    if (told && (status == LAC_OK || status == LAC_EINPUT || report.errors > 0)) {
        checked found = {.source = c,
                         .scene = scene,
                         .branch = words,
                         .estimate = status == LAC_OK ? &estimate : NULL,
                         .lumped = lumped.made ? &lumped : NULL};
        const lac_status out = put_out(request, &found, &report, err);
        status = out != LAC_OK ? out : status;
    } else if (status == LAC_OK) {
        printf("%s", scene);
        print_estimate(c, &estimate, &lumped);
        if (words != NULL) {
            printf("\n# Branch\n");
            cli_wrap("#   ", words);
        }
    }
    if (status == LAC_OK) {
        cli_failure_warn(&estimate.failure);
    }
    status = report.errors > 0 ? status : cli_blame(c, status, err); // else said already
    free(scene);
    lac_branch_free(branch);
    lac_case_free(c);
    lac_case_issues_clear(&report);
    return status;
}
