// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna check CASE: says what is wrong with a case and what it would cost, without running it.
#include <unistd.h>

#include "cli/common/command.h"
#include "cli/common/memory.h"
#include "cli/common/output.h"
#include "cli/common/progress.h"
#include "cli/common/words.h"
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
    LAC_TRY_RETURN(cli_report_add(report, f->source, key, why->message, false, err));
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

// How a lumped run of a case went.
typedef struct lumped_try {
    bool made;
    size_t cells;
    double error, time; // by estimate; CPU [s]
} lumped_try;

// Runs a case lumped, where it takes it as it stands and its cells slip together: that takes less
// than to build its scene. What does not come to an end, or not to its error, is not told of.
static void try_lumped(const lac_case *c, const lac_estimate *e, lumped_try *out)
{
    const double large = 1e5, together = 3.0;
    lac_simulation *simulation = NULL;
    lac_case own = *c;
    if (!e->integrated || e->choice.fidelity != LAC_FIDELITY_ODE || e->grid_cells > large ||
        !(e->cells > 1.0) || !(e->stiffness_ratio > together) || !isnan(c->accuracy) ||
        !lac_case_admits_lumped(c)) {
        return;
    }
    own.use = NULL;
    own.purpose = LAC_FOR_RUN;
    own.points = 0;
    own.run.fidelity = LAC_FIDELITY_LUMPED;
    own.lump = (lac_lump_def){.level = -1, .nodes = -1, .error = 0.01};
    if (lac_simulation_create(&own, NULL, &simulation, NULL) == LAC_OK) {
        const double before = cli_cpu_time();
        out->made = lac_simulation_run(simulation, NULL, NULL) == LAC_OK;
        out->time = cli_cpu_time() - before;
        out->cells = lac_simulation_outcome(simulation)->scene->lump->domain->n;
        out->error = lac_simulation_result(simulation)->lump_error_estimated;
    }
    lac_simulation_free(simulation);
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
    printf("#   memory          %.10g MB", rounded(e->memory / 1e6, 2));
    if (e->memory > 1e6 * room) {
        printf(": more than the %.10g MB that are free", rounded(room, 2));
    }
    puts("");
    if (e->ranks > 1) {
        printf("#   ranks           up to %.0f, better %.0f (lacuna-mpi), of %.10g MB at most\n",
               e->ranks, ceil(e->ranks / 4), rounded(e->memory_rank / 1e6, 2));
    }
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
        const double least = rounded(e->cost[k].least, 1), most = rounded(e->cost[k].most, 1);
        if (k == 0 || !lac_fidelity_refused(c, why)) {
            printf("#     %-13s error at most %.1g, %s\n", lac_fidelity_name(all[k]),
                   lac_fidelity_error(c, e, all[k]),
                   isnan(most) ? cli_format("at least %.10g s", least).s
                               : cli_format("%.10g to %.10g s", least, most).s);
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

// As comment lines of YAML.
static void print_estimate(const lac_case *c, const lac_estimate *e, const lumped_try *lumped)
{
    char words[LAC_REGIME_ROOM];
    const char *by = c->run.method == LAC_BDF ? " with bdf" : " with bdf, not with its method";
    by = e->own_steps ? " with each cell at its own steps" : e->integrated ? by : "";
    printf("\n# What it will cost%s, roughly\n", by);
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
    lac_regime_words(c, e, words);
    if (words[0] != '\0') {
        printf("#   regime          %s\n", lac_regime_name(lac_regime_of(e)));
        cli_wrap("#     ", words);
    }
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
    const char *branch; // what it goes on from; NULL
    char *scene;        // resolved case, owned; NULL
    bool sound;         // else the case has errors, and what follows says nothing
    lac_estimate estimate;
    lumped_try lumped;
    size_t errors, warnings;                 // how many
    const lac_case_issue **error, **warning; // [errors], [warnings]
    char regime[LAC_REGIME_ROOM];            // words on it
    double kept[2][3]; // of fidelity ode and events: least and most CPU time, error; NaN: refused
} checked;

#define ESTIMATE const lac_estimate *e = &((const checked *)of)->estimate

LAC_GETTER(bool, branches, const checked *c = of, c->branch != NULL)
LAC_GETTER(double, line, const lac_case_issue *i = of, i->line > 0 ? (double)i->line : (double)NAN)

static const lac_variable of_check[] = {
    {.name = "ok", .json = "ok", LAC_HELD(BOOL, checked, sound), .flags = LAC_WHOLE}};

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

#define WHEN_RUN(field) e->integrated ? e->field : (double)NAN
LAC_GETTER(double, contact_cells, ESTIMATE, round(e->contact_cells))
LAC_GETTER(double, unknowns, ESTIMATE, e->unknowns *round(e->contact_cells))
LAC_GETTER(double, memory, ESTIMATE, round(e->memory))
LAC_GETTER(double, memory_rank, ESTIMATE, round(e->memory_rank))
LAC_GETTER(double, records, ESTIMATE, WHEN_RUN(records))
LAC_GETTER(double, file_most, ESTIMATE, WHEN_RUN(file_bytes))
LAC_GETTER(double, failure_rate, ESTIMATE, e->failure.rate > 0.0 ? e->failure.rate : (double)NAN)
LAC_GETTER(double, steps_least, ESTIMATE, WHEN_RUN(steps_least))
LAC_GETTER(double, steps_most, ESTIMATE, WHEN_RUN(steps_most))
LAC_TEXT_GETTER(regime_name, ESTIMATE, lac_regime_name(lac_regime_of(e)))
LAC_GETTER(bool, integrated, ESTIMATE, e->integrated)
LAC_TEXT_GETTER(fidelity, ESTIMATE, lac_fidelity_name(e->choice.fidelity))
LAC_TEXT_GETTER(fidelity_why, ESTIMATE, e->choice.why[0] != '\0' ? e->choice.why : NULL)
LAC_TEXT_GETTER(steps_in_words, ESTIMATE, e->integrated ? steps_class(e) : NULL)

#define OF(kind, field) LAC_HELD(kind, checked, estimate.field)
#define E(name_, unit_, long_, value_, ...)                                       \
    LAC_ROW(name_, NULL, unit_, long_, value_, .flags = LAC_SINGLE | LAC_MISSING, \
            .json = "estimate/" name_ __VA_ARGS__)
#define TRUTH(name_, field)                                                             \
    {                                                                                   \
        .name = (name_), .json = "estimate/" name_, OF(BOOL, field), .flags = LAC_WHOLE \
    }
// What a fidelity costs and keeps.
#define OF_FIDELITY(name_, which)                                                            \
    LAC_ROW(name_ "_cpu_time_least", NULL, "s", "least time with fidelity " name_,           \
            LAC_HELD(REAL, checked, kept[which][0]), .flags = LAC_SINGLE | LAC_MISSING,      \
            .has = integrated, .json = "estimate/fidelities/" name_ "/cpu_time_least_s"),    \
        LAC_ROW(name_ "_cpu_time_most", NULL, "s", "longest time with fidelity " name_,      \
                LAC_HELD(REAL, checked, kept[which][1]), .flags = LAC_SINGLE | LAC_MISSING,  \
                .has = integrated, .json = "estimate/fidelities/" name_ "/cpu_time_most_s"), \
        LAC_ROW(name_ "_error", NULL, "1", "relative error that fidelity " name_ " keeps",   \
                LAC_HELD(REAL, checked, kept[which][2]), .flags = LAC_SINGLE | LAC_MISSING,  \
                .has = integrated, .json = "estimate/fidelities/" name_ "/error")
static const lac_variable of_estimate[] = {
    E("grid_cells", NULL, "cells of the grid", OF(REAL, grid_cells)),
    E("contact_cells", NULL, "contact cells", G(contact_cells)),
    TRUTH("contact_cells_exact", exact),
    E("unknowns", NULL, "unknowns of a run", G(unknowns)),
    E("memory", "byte", "largest resident memory", G(memory), "_bytes"),
    E("ranks_most", NULL, "ranks of lacuna-mpi that can share the run", OF(REAL, ranks)),
    E("memory_rank", "byte", "memory of the first of a fourth of them", G(memory_rank), "_bytes"),
    E("cpu_time_least", "s", "least time on one core", OF(REAL, cpu_time_least), "_s"),
    E("cpu_time_most", "s", "longest time on one core", OF(REAL, cpu_time_most), "_s"),
    E("cascade_time", "s", "time of the cascade", OF(REAL, cascade_time), "_s"),
    E("records_at_times", NULL, "records at stated times", G(records)),
    E("file_most", "byte", "what they and the fields take in the file at most", G(file_most),
      "_bytes"),
    E("stiffness_over_critical", NULL, "stiffness of the finest level over the critical one",
      OF(REAL, stiffness_ratio)),
    E("patch_width", "m", "width from which on a patch slips by itself", OF(REAL, patch), "_m"),
    {.name = "regime", .json = "estimate/regime", T(regime_name)},
    {.name = "regime_words", .json = "estimate/regime_words", LAC_HELD(CHARS, checked, regime)},
    {.name = "faster_fidelity", .json = "estimate/faster_fidelity", OF(TEXT, faster)},
    {.name = "fidelity", .json = "estimate/fidelity", T(fidelity), .has = integrated},
    {.name = "fidelity_why", .json = "estimate/fidelity_why", T(fidelity_why), .has = integrated},
    OF_FIDELITY("ode", 0),
    OF_FIDELITY("events", 1),
    E("failure_rate", "m s-1", "mean slip rate that counts as failure", G(failure_rate), "_m_s"),
    TRUTH("failure_rate_lowered", failure.lowered),
    {.name = "steps_class", .json = "estimate/steps_class", T(steps_in_words)},
    E("steps_least", NULL, "least steps", G(steps_least)),
    E("steps_most", NULL, "most steps", G(steps_most)),
};

static const lac_variable of_lumped[] = {
    LAC_ROW("lumped_cells", NULL, NULL, "cells that would stand for all",
            LAC_HELD(COUNT, checked, lumped.cells), .json = "estimate/lumped/cells"),
    LAC_ROW("lumped_error_estimated", NULL, NULL, "relative error of a lumped run, by estimate",
            LAC_HELD(REAL, checked, lumped.error), .json = "estimate/lumped/error_estimated"),
    LAC_ROW("lumped_cpu_time", NULL, "s", "CPU that its integration takes",
            LAC_HELD(REAL, checked, lumped.time), .json = "estimate/lumped/cpu_time_s"),
};

static lac_status describe(const checked *c, lac_dataset **out, lac_error *err)
{
    const lac_extent dims[] = {{"error", c->errors}, {"warning", c->warnings}};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_check, "", 0), c},
        {LAC_VARIABLES_OF_MANY(of_errors, "error"), c->error},
        {LAC_VARIABLES_OF_MANY(of_warnings, "warning"), c->warning},
        {LAC_VARIABLES(of_scene, "", 0), c},
        {LAC_VARIABLES(of_estimate, "", 0), c->sound ? c : NULL},
        {LAC_VARIABLES(of_lumped, "", 0), c->sound && c->lumped.made ? c : NULL},
    };
    lac_status status;
    LAC_TRY(lac_dataset_create("What is wrong with a case, and what its run will cost.", out, err));
    LAC_TRY(lac_dataset_dims(*out, dims, sizeof dims / sizeof *dims, err));
    LAC_TRY(lac_dataset_add(*out, laid, sizeof laid / sizeof *laid, err));
out:
    LAC_MADE(status, out, lac_dataset_free);
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
    if (c->sound) {
        char why[LAC_FIDELITY_ROOM];
        const lac_estimate *e = &c->estimate;
        lac_regime_words(c->source, e, c->regime);
        for (size_t k = 0; k < 2; k++) {
            const bool refused = !e->integrated || (k == 1 && lac_fidelity_refused(c->source, why));
            const lac_fidelity of = k == 0 ? LAC_FIDELITY_ODE : LAC_FIDELITY_ASYNC;
            c->kept[k][0] = refused ? (double)NAN : e->cost[k].least;
            c->kept[k][1] = refused ? (double)NAN : e->cost[k].most;
            c->kept[k][2] = refused ? (double)NAN : lac_fidelity_error(c->source, e, of);
        }
    }
    LAC_TRY(describe(c, &dataset, &late));
    if (request->pipe != 0) {
        const lac_provenance made = {.seed = INT64_MIN};
        LAC_TRY(cli_put_dataset(request, false, &made, NULL, dataset, &late));
    } else {
        lac_json json = {.out = stdout};
        lac_json_open(&json, NULL, '{');
        lac_dataset_json(dataset, &json);
        lac_json_close(&json, '}');
    }
out:
    lac_dataset_free(dataset);
    free((void *)all);
    if (status != LAC_OK) {
        *err = late;
    }
    return status;
}

static lac_status examine(const cli_request *request, checked *found, lac_case_issues *report,
                          lac_error *err)
{
    const lac_case *c = found->source;
    findings f = {.source = c, .report = report};
    lac_load_clock clock = {c->dated, c->start_date, c->run.end, NULL};
    lac_load_files *files = NULL;
    cli_compare compare = {0};
    lac_status status;
    found->scene = lac_case_text(c);
    LAC_FAIL_MEMORY_IF(found->scene == NULL, err);
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
    LAC_TRY(lac_estimate_make(c, files, &found->estimate, err));
out:
    cli_compare_clear(&compare);
    lac_load_files_free(files);
    return status;
}

lac_status cli_check(const cli_request *request, lac_error *err)
{
    lac_case *c = NULL;
    lac_case_issues report = {0};
    checked found = {.estimate.grid_cells = NAN};
    lac_branch *branch = NULL;
    const bool told = cli_given(request, CLI_OPT_JSON) || request->pipe != 0;
    lac_status status = cli_case_read(request, LAC_FOR_CHECK, &c, &report, err);
    found.source = c;
    if (status == LAC_OK) {
        status = examine(request, &found, &report, err);
    }
    if (status == LAC_OK && c->from.file != NULL) {
        status = lac_branch_open(c, &branch, err);
    }
    found.sound = status == LAC_OK;
    if (found.sound) {
        try_lumped(c, &found.estimate, &found.lumped);
    }
    found.branch = branch != NULL ? branch->text : NULL;
    if (told && (found.sound || status == LAC_EINPUT || report.errors > 0)) {
        const lac_status out = put_out(request, &found, &report, err);
        status = out != LAC_OK ? out : status;
    } else if (found.sound) {
        printf("%s", found.scene);
        print_estimate(c, &found.estimate, &found.lumped);
        if (found.branch != NULL) {
            printf("\n# Branch\n");
            cli_wrap("#   ", found.branch);
        }
    }
    if (status == LAC_OK) {
        cli_failure_warn(&found.estimate.failure);
    }
    status = report.errors > 0 ? status : cli_blame(c, status, err); // else said already
    free(found.scene);
    lac_branch_free(branch);
    lac_case_free(c);
    lac_case_issues_clear(&report);
    return status;
}
