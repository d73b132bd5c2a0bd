// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/rg.h"

#include <stdio.h>
#include <stdlib.h>

#include "cli/command.h"
#include "cli/libraries.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "cli/run_outcome.h"
#include "cli/signals.h"
#include "cli/words.h"
#include "lacuna/store_rg.h"

typedef struct watching {
    const cli_request *request;
} watching;

static bool go_on(void *context, size_t done, size_t seeds)
{
    const watching *w = context;
    if (seeds > 1) {
        cli_say(w->request, "interface %zu of %zu", done + 1, seeds);
    }
    return !cli_signals_stop();
}

static lac_status write_file(const cli_request *request, const lac_case *c, const lac_scene_rg *rg,
                             const char *path, lac_error *err)
{
    char libraries[256];
    char *text = lac_case_text(c);
    if (text == NULL) {
        return lac_fail_memory(err);
    }
    const lac_rg_view view = {.rule = cli_rg_rule(c),
                              .field = cli_rg_field(c),
                              .grid = &rg->grid,
                              .domain = rg->domain,
                              .betas = rg->betas,
                              .beta = rg->beta,
                              .result = rg->result,
                              .interface = rg->interface,
                              .strength = rg->strength};
    lac_provenance provenance =
        cli_provenance(request, c, text, cli_libraries(libraries, sizeof libraries));
    lac_status status =
        lac_store_rg(path, cli_given(request, CLI_OPT_FORCE), &provenance, &view, err);
    free(text);
    return status;
}

static void write_result(const lac_case *c, const lac_scene_rg *rg, const char *path)
{
    cli_json json = {.out = stdout};
    cli_json_open(&json, NULL, '{');
    cli_rg_json(&json, c, rg);
    cli_json_number(&json, "cpu_time_s", cli_cpu_time());
    cli_json_text(&json, "output", path);
    cli_json_close(&json, '}');
}

lac_status cli_rg(const cli_request *request, lac_error *err)
{
    lac_case *c = NULL;
    lac_scene_rg rg = {0};
    char *path = NULL;
    lac_status status;
    watching w = {request};
    const lac_rg_watch watch = {&w, go_on};
    LAC_TRY(cli_case_read(request, LAC_FOR_RG, &c, NULL, err));
    LAC_TRY(cli_output_path(request, c, NULL, "-rg.nc", &path, err));
    cli_say(request, "following the cascade of %s", request->argument[0]);
    cli_signals_hold();
    LAC_TRY(cli_blame(c, lac_scene_rg_run(c, &watch, &rg, err), err));
    LAC_TRY(write_file(request, c, &rg, path, err));
    if (cli_given(request, CLI_OPT_JSON)) {
        write_result(c, &rg, path);
    } else {
        if (c->title != NULL) {
            puts(c->title);
        }
        cli_rg_print(c, &rg, cli_given(request, CLI_OPT_VERBOSE));
        cli_row("file", "%s", path);
    }
out:
    lac_scene_rg_clear(&rg);
    lac_case_free(c);
    free(path);
    return status;
}
