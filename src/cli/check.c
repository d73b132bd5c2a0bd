// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdlib.h>

#include "cli/command.h"
#include "cli/compare.h"
#include "cli/estimate.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "lacuna/scene.h"

// A scene of up to this many grid cells is built whole: quick, and the surest check.
static const double small_grid = 4096;

static lac_status try_contact(const lac_case *c, lac_error *err)
{
    lac_scene_contact contact = {0};
    lac_status status = lac_scene_contact_solve(c, false, &contact, err);
    lac_scene_contact_clear(&contact);
    return status;
}

static lac_status try_scene(const lac_case *c, const cli_estimate *estimate, lac_error *err)
{
    lac_scene *scene = NULL;
    if (estimate->grid_cells > small_grid) {
        return LAC_OK;
    }
    if (c->friction.about == NULL || isnan(c->run.end)) {
        return try_contact(c, err);
    }
    lac_status status = lac_scene_create(c, &scene, err);
    if (status == LAC_OK) {
        status = lac_run_check(scene->problem, &c->run, err);
    }
    lac_scene_free(scene);
    return status;
}

// What is wrong with the scene as a whole stands at no line of the case.
static void write_errors(cli_json *json, const lac_case_report *report, const char *path,
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
    cli_json json = {.out = stdout};
    cli_json_open(&json, NULL, '{');
    cli_json_boolean(&json, "ok", estimate != NULL);
    write_errors(&json, report, path, err);
    cli_report_json(&json, "warnings", report, true);
    cli_json_text(&json, "scene", scene);
    cli_estimate_json(&json, estimate);
    cli_json_close(&json, '}');
}

static lac_status examine(const cli_request *request, const lac_case *c, char **scene,
                          cli_estimate *estimate, lac_error *err)
{
    *scene = lac_case_text(c);
    if (*scene == NULL) {
        return lac_fail_memory(err);
    }
    cli_compare compare = {0};
    lac_status status = cli_compare_read(request, c, &compare, err);
    cli_compare_clear(&compare);
    if (status == LAC_OK) {
        status = cli_estimate_make(c, estimate, err);
    }
    return status == LAC_OK ? try_scene(c, estimate, err) : status;
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
        status = examine(request, c, &scene, &estimate, err);
    }
    if (json && (status == LAC_OK || status == LAC_EINPUT)) {
        write_json(&report, request->argument[0], scene, status == LAC_OK ? &estimate : NULL, err);
    } else if (status == LAC_OK) {
        printf("%s", scene);
        cli_estimate_print(&estimate);
    }
    status = cli_blame(c, status, err);
    free(scene);
    lac_case_free(c);
    lac_case_report_clear(&report);
    return status;
}
