// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna check CASE: says what is wrong with a case and what it would cost, without running it.
#include <unistd.h>

#include "cli/common/command.h"
#include "cli/common/progress.h"
#include "cli/common/words.h"
#include "cli/run/run_outcome.h"
#include "scene/estimate.h"
#include "simulation/branch.h"
#include "simulation/simulation.h"

// How a lumped run of the case went.
typedef struct lumped_try {
    bool made;
    size_t cells;
    double error, time; // by estimate; CPU [s]
} lumped_try;

// Runs the case lumped, where it takes it as it stands and its cells slip together: that takes less
// than to build its scene. What does not come to an end, or not to its error, is not told of.
static void try_lumped(const lac_case *c, const lac_estimate *e, lumped_try *out)
{
    const double large = 1e5, together = 3.0;
    lac_simulation *simulation = NULL;
    lac_case own = *c;
    *out = (lumped_try){.made = false};
    if (!e->integrated || c->run.fidelity != LAC_FIDELITY_ODE || e->grid_cells > large ||
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
        void *state = NULL;
        lac_error why = {""};
        char key[100];
        status = kind->prepare == NULL ? LAC_OK : kind->prepare(model->params, clock, &state, &why);
        if (state != NULL) {
            kind->release(state);
        }
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
    printf("#   grid            %.0f cells\n", e->grid_cells);
    if (!isnan(e->contact_cells)) {
        printf("#   contact         %s%.3g cells", e->exact ? "" : "about ", e->contact_cells);
        if (e->integrated) {
            printf(", %.3g unknowns", e->unknowns * e->contact_cells);
        }
        puts("");
    }
    printf("#   memory          %.10g MB\n", rounded(e->memory / 1e6, 2));
}

// How many steps, and why.
static void print_steps(const lac_estimate *e)
{
    if (e->own_steps) {
        printf("#   steps           of each cell its own, %d to %d\n", LAC_OWN_FEWEST,
               LAC_OWN_STEPS);
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
static void print_estimate(const lac_case *c, const lac_estimate *e, const lumped_try *lumped)
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
    }
}

static void write_estimate(lac_json *json, const lac_case *c, const lac_estimate *e,
                           const lumped_try *lumped)
{
    char words[LAC_REGIME_ROOM];
    lac_regime_words(c, e, words);
    lac_json_open(json, "estimate", '{');
    lac_json_number(json, "grid_cells", e->grid_cells);
    lac_json_number(json, "contact_cells", round(e->contact_cells));
    lac_json_boolean(json, "contact_cells_exact", e->exact);
    lac_json_number(json, "unknowns", e->unknowns * round(e->contact_cells));
    lac_json_number(json, "memory_bytes", round(e->memory));
    lac_json_number(json, "cpu_time_least_s", e->cpu_time_least);
    lac_json_number(json, "cpu_time_most_s", e->cpu_time_most);
    lac_json_number(json, "cascade_time_s", e->cascade_time);
    lac_json_number(json, "records_at_times", e->integrated ? e->records : NAN);
    lac_json_number(json, "file_most_bytes", e->integrated ? e->file_bytes : NAN);
    lac_json_number(json, "stiffness_over_critical", e->stiffness_ratio);
    lac_json_number(json, "patch_width_m", e->patch);
    lac_json_text(json, "regime", lac_regime_name(lac_regime_of(e)));
    lac_json_text(json, "regime_words", words);
    lac_json_text(json, "faster_fidelity", e->faster);
    if (lumped->made) {
        lac_json_open(json, "lumped", '{');
        lac_json_integer(json, "cells", (int64_t)lumped->cells);
        lac_json_number(json, "error_estimated", lumped->error);
        lac_json_number(json, "cpu_time_s", lumped->time);
        lac_json_close(json, '}');
    }
    lac_json_number(json, "failure_rate_m_s", e->failure.rate > 0.0 ? e->failure.rate : NAN);
    lac_json_boolean(json, "failure_rate_lowered", e->failure.lowered);
    lac_json_text(json, "steps_class", e->integrated ? steps_class(e) : NULL);
    lac_json_number(json, "steps_least", e->integrated ? e->steps_least : NAN);
    lac_json_number(json, "steps_most", e->integrated ? e->steps_most : NAN);
    lac_json_close(json, '}');
}

static void write_json(const lac_case_issues *report, const char *path, const lac_case *c,
                       const char *scene, const char *branch, const lac_estimate *estimate,
                       const lumped_try *lumped, lac_error *err)
{
    lac_json json = {.out = stdout};
    // what is wrong with the scene as a whole stands at no line of the case
    lac_case_issue issue = {
        .file = (char *)path, .key = (char *)"", .value = (char *)"", .message = err->message};
    const lac_case_issues whole = {.count = 1, .errors = 1, .issue = &issue};
    lac_json_open(&json, NULL, '{');
    lac_json_boolean(&json, "ok", estimate != NULL);
    cli_report_json(&json, "errors",
                    report->errors > 0 || err->message[0] == '\0' ? report : &whole, false);
    cli_report_json(&json, "warnings", report, true);
    lac_json_text(&json, "scene", scene);
    if (branch != NULL) {
        lac_json_text(&json, "branch", branch);
    }
    if (estimate != NULL) {
        write_estimate(&json, c, estimate, lumped);
    } else {
        lac_json_null(&json, "estimate");
    }
    lac_json_close(&json, '}');
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
    lumped_try lumped = {.made = false};
    lac_branch *branch = NULL;
    char *scene = NULL;
    bool json = cli_given(request, CLI_OPT_JSON);
    lac_status status = cli_case_read(request, LAC_FOR_CHECK, &c, &report, err);
    if (status == LAC_OK) {
        status = examine(request, c, &report, &scene, &estimate, err);
    }
    if (status == LAC_OK && c->from.file != NULL) {
        status = lac_branch_open(c, &branch, err);
    }
    if (status == LAC_OK) {
        try_lumped(c, &estimate, &lumped);
    }
    const char *words = branch != NULL ? branch->text : NULL;
    if (json && (status == LAC_OK || status == LAC_EINPUT || report.errors > 0)) {
        write_json(&report, request->argument[0], c, scene, words,
                   status == LAC_OK ? &estimate : NULL, &lumped, err);
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
