// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna check CASE: says what is wrong with a case and what it would cost, without running it.
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/common/command.h"
#include "cli/common/failure.h"
#include "cli/common/progress.h"
#include "cli/common/words.h"
#include "cli/report/compare.h"
#include "cli/report/report.h"
#include "cli/run/estimate.h"
#include "scene/scene.h"
#include "transfer/transfer.h"

// A scene of up to this many grid cells is built whole: quick, and the surest check.
static const double small_grid = 4096;

static lac_status try_contact(const lac_case *c, lac_error *err)
{
    lac_scene_contact contact = {0};
    lac_status status = lac_scene_contact_solve(c, false, &contact, err);
    lac_scene_contact_clear(&contact);
    return status;
}

// What `check` has found beyond the text of the case.
typedef struct findings {
    const lac_case *source;
    lac_case_report *report; // where each is added
    lac_status status;       // the first's
} findings;

static lac_status add_finding(findings *f, const char *key, const lac_error *why, lac_status status,
                              lac_error *err)
{
    lac_case_report *report = f->report;
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
static lac_status try_loads(findings *f, const char *list, const lac_slot_list *slots,
                            const lac_load_clock *clock, lac_error *err)
{
    lac_status status = LAC_OK;
    for (size_t i = 0; i < slots->count && status == LAC_OK; i++) {
        const lac_slot *slot = &slots->item[i];
        const lac_load_kind *kind = (const void *)slot->about;
        void *state = NULL;
        lac_error why = {""};
        char key[100];
        status = kind->prepare == NULL ? LAC_OK : kind->prepare(slot->params, clock, &state, &why);
        if (state != NULL) {
            kind->release(state);
        }
        if (status == LAC_ENOMEM) {
            return lac_fail_memory(err);
        }
        (void)snprintf(key, sizeof key, "load.%s.%zu.%s", list, i, kind->about.name);
        status = status == LAC_OK ? status : add_finding(f, key, &why, status, err);
    }
    return status;
}

// Whether the maps of a spread are there; where the scene is built they are read too.
static lac_status try_maps(findings *f, const char *section, const lac_spread_list *list,
                           lac_error *err)
{
    lac_status status = LAC_OK;
    for (size_t i = 0; i < list->count && status == LAC_OK; i++) {
        const bool is_map = list->item[i].slot.about == &lac_spread_map_kind.about;
        const lac_spread_map *map = list->item[i].slot.params;
        FILE *file = is_map ? fopen(map->path, "rb") : NULL;
        if (is_map && file == NULL) {
            lac_error why = {""};
            char key[200];
            (void)lac_fail(&why, LAC_EIO, "%s: %s", map->path, strerror(errno));
            (void)snprintf(key, sizeof key, "%s.spread.%s", section, list->item[i].key);
            status = add_finding(f, key, &why, LAC_EIO, err);
        } else if (file != NULL) {
            (void)fclose(file);
        }
    }
    return status;
}

// Opens all files that the case names beside its surface and domain, which the estimate needs.
static lac_status try_files(findings *f, lac_load_files *files, lac_error *err)
{
    const lac_case *c = f->source;
    const lac_load_clock clock = {
        .dated = c->dated, .start = c->start_date, .end = c->run.end, .files = files};
    lac_status status;
    LAC_TRY(try_loads(f, "shear", &c->shear, &clock, err));
    LAC_TRY(try_loads(f, "pore_pressure", &c->pore, &clock, err));
    LAC_TRY(try_maps(f, "interface", &c->interface_spread, err));
    LAC_TRY(try_maps(f, "friction", &c->friction_spread, err));
    LAC_TRY(try_maps(f, "initial", &c->initial_spread, err));
    status = f->status;
out:
    return status;
}

// Whether a spring or the rock around holds the mean slip.
static bool is_held(const lac_case *c, const lac_load_state *start)
{
    lac_transfer_outline outline;
    return start->spring_stiffness > 0.0 ||
           (lac_transfer_outline_of(&c->transfer, &outline) && outline.anchored);
}

// What counts as failure of a joint whose cells are not known: of one that slips evenly, by the
// case's own values.
static lac_failure failure_about(const lac_case *c, const lac_load_state *start, double pressure)
{
    const lac_friction_params *law = c->friction.params;
    const lac_grid grid = lac_interface_grid(&c->interface);
    double force = pressure - start->pore;
    const lac_failure_start at = {
        .rate = c->initial.slip_rate,
        .direct = law->a * force,
        .excess = (law->b - law->a) * force,
        .eta = lac_inertia_mass(c) > 0.0 ? 0.0 : lac_damping_of(&c->material),
        .held = is_held(c, start),
        .length = fmax((double)grid.nx * grid.dx, (double)grid.ny * grid.dy)};
    return lac_failure_from(&at, c->run.failure_rate, c->run.failure_slip);
}

// What the loads come to at the start of a run whose scene is too large to be built.
static lac_status try_start(const lac_case *c, lac_load_files *files, lac_failure *failure,
                            lac_error *err)
{
    const lac_normal_load *normal = (const void *)c->normal.about;
    const double pressure = normal->pressure(c->normal.params, c->material.density);
    const lac_load_slots slots = {c->shear.item, c->shear.count, c->pore.item, c->pore.count};
    const lac_load_clock clock = {c->dated, c->start_date, c->run.end, files};
    const bool by_load = isnan(c->initial.slip_rate) || c->initial.state == LAC_STATE_FROM_LOAD;
    lac_load_set loads;
    lac_load_state sum;
    lac_status status = lac_load_set_create(&slots, &clock, &loads, err);
    if (status != LAC_OK) {
        return status;
    }
    lac_load_evaluate(&loads, 0.0, &sum);
    lac_load_set_clear(&loads);
    if (!(sum.pore < pressure)) {
        return lac_fail(err, LAC_EINPUT,
                        "initial: pore pressure %g Pa is not below the normal pressure %g Pa at "
                        "the start",
                        sum.pore, pressure);
    }
    if (by_load && !(lac_load_shear(&sum, pressure) > 0.0)) {
        return lac_fail(err, LAC_EINPUT, "load.shear: comes to %g Pa at the start; must be > 0",
                        lac_load_shear(&sum, pressure));
    }
    if (!isnan(c->initial.slip_rate)) {
        *failure = failure_about(c, &sum, pressure);
    }
    return LAC_OK;
}

static lac_status try_scene(const lac_case *c, cli_estimate *estimate, lac_load_files *files,
                            lac_error *err)
{
    lac_scene *scene = NULL;
    const bool runs = c->friction.about != NULL && !isnan(c->run.end);
    if (estimate->grid_cells > small_grid) {
        return runs ? try_start(c, files, &estimate->failure, err) : LAC_OK;
    }
    if (!runs) {
        return try_contact(c, err);
    }
    lac_status status = lac_scene_create_with(c, files, &scene, err);
    if (status == LAC_OK) {
        status = lac_run_check(scene->problem, &c->run, err);
        estimate->failure =
            lac_problem_failure(scene->problem, c->run.failure_rate, c->run.failure_slip);
    }
    lac_scene_free(scene);
    return status;
}

// What is wrong with the scene as a whole stands at no line of the case.
static void write_errors(lac_json *json, const lac_case_report *report, const char *path,
                         lac_error *err)
{
    lac_case_issue issue = {
        .file = (char *)path, .key = (char *)"", .value = (char *)"", .message = err->message};
    lac_case_report whole = {.count = 1, .errors = 1, .issue = &issue};
    bool late = report->errors == 0 && err->message[0] != '\0';
    cli_report_json(json, "errors", late ? &whole : report, false);
}

static void write_json(const lac_case_report *report, const char *path, const char *scene,
                       const cli_estimate *estimate, lac_error *err)
{
    lac_json json = {.out = stdout};
    lac_json_open(&json, NULL, '{');
    lac_json_boolean(&json, "ok", estimate != NULL);
    write_errors(&json, report, path, err);
    cli_report_json(&json, "warnings", report, true);
    lac_json_text(&json, "scene", scene);
    cli_estimate_json(&json, estimate);
    lac_json_close(&json, '}');
}

static lac_status examine(const cli_request *request, const lac_case *c, lac_case_report *report,
                          char **scene, cli_estimate *estimate, lac_error *err)
{
    findings f = {.source = c, .report = report};
    lac_load_files *files = NULL;
    cli_compare compare = {0};
    lac_status status;
    *scene = lac_case_text(c);
    if (*scene == NULL) {
        return lac_fail_memory(err);
    }
    LAC_TRY(lac_load_files_create(&files, err));
    LAC_TRY(try_files(&f, files, err));
    LAC_TRY(cli_compare_read(request, c, &compare, err));
    LAC_TRY(cli_estimate_make(c, estimate, err));
    LAC_TRY(try_scene(c, estimate, files, err));
out:
    cli_compare_clear(&compare);
    lac_load_files_free(files);
    return status;
}

lac_status cli_check(const cli_request *request, lac_error *err)
{
    lac_case *c = NULL;
    lac_case_report report = {0};
    cli_estimate estimate;
    char *scene = NULL;
    bool json = cli_given(request, CLI_OPT_JSON);
    lac_status status = cli_case_read(request, LAC_FOR_CHECK, &c, &report, err);
    if (status == LAC_OK) {
        status = examine(request, c, &report, &scene, &estimate, err);
    }
    if (json && (status == LAC_OK || status == LAC_EINPUT || report.errors > 0)) {
        write_json(&report, request->argument[0], scene, status == LAC_OK ? &estimate : NULL, err);
    } else if (status == LAC_OK) {
        printf("%s", scene);
        cli_estimate_print(&estimate);
    }
    if (status == LAC_OK) {
        cli_failure_warn(&estimate.failure);
    }
    status = report.errors > 0 ? status : cli_blame(c, status, err); // else said already
    free(scene);
    lac_case_free(c);
    lac_case_report_clear(&report);
    return status;
}
