// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>

#include "cli/command.h"
#include "cli/estimate.h"
#include "cli/progress.h"
#include "cli/report.h"

static void write_json(const lac_case_report *report, const char *scene,
                       const cli_estimate *estimate, const lac_error *err)
{
    cli_json json = {.out = stdout};
    bool ok = scene != NULL && estimate != NULL;
    cli_json_open(&json, NULL, '{');
    cli_json_boolean(&json, "ok", ok);
    cli_report_json(&json, "errors", report, false);
    cli_report_json(&json, "warnings", report, true);
    // What is wrong with the scene as a whole stands at no line of the case.
    cli_json_text(&json, "scene_error", ok || report->errors > 0 ? NULL : err->message);
    cli_json_text(&json, "scene", scene);
    cli_estimate_json(&json, estimate);
    cli_json_close(&json, '}');
}

lac_status cli_check(const cli_request *request, lac_error *err)
{
    lac_case *c = NULL;
    lac_case_report report = {0};
    cli_estimate estimate;
    char *scene = NULL;
    bool json = cli_given(request, CLI_OPT_JSON);
    lac_status status = cli_case_read(request, &c, &report, err);
    if (status == LAC_OK) {
        scene = lac_case_text(c);
        status = scene == NULL ? lac_fail_memory(err) : cli_estimate_make(c, &estimate, err);
    }
    if (json && (status == LAC_OK || status == LAC_EINPUT)) {
        write_json(&report, scene, status == LAC_OK ? &estimate : NULL, err);
    } else if (status == LAC_OK) {
        printf("%s", scene);
        cli_estimate_print(&estimate);
    }
    free(scene);
    lac_case_free(c);
    lac_case_report_clear(&report);
    return status;
}
