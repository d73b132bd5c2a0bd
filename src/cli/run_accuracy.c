// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna run --accuracy: pilot runs, and what is said of them.
#include "cli/run_accuracy.h"

#include <inttypes.h>
#include <math.h>

#include "cli/words.h"

static const char *method_name(lac_method method)
{
    static const char *const names[] = {
        [LAC_BDF] = "bdf", [LAC_ADAMS] = "adams", [LAC_ERK] = "erk"};
    return names[method];
}

static void on_progress(void *context, const lac_progress *now) { cli_progress_show(context, now); }

const char *cli_accuracy_text(const lac_accuracy_pick *pick, char *text, size_t size)
{
    (void)snprintf(text, size,
                   "rtol %g, method %s, formulation %s: error of the %s %.1e, asked %g, by %" PRId64
                   " pilot runs",
                   pick->rtol, method_name(pick->method), lac_formulation_name(pick->formulation),
                   lac_accuracy_of_name(pick->of), pick->estimated, pick->asked, pick->pilots);
    return text;
}

lac_status cli_accuracy_pick(cli_progress *progress, const cli_request *request, lac_scene *scene,
                             lac_case *c, lac_accuracy_pick *pick, lac_error *err)
{
    char text[CLI_ACCURACY_TEXT];
    if (isnan(c->accuracy)) {
        return LAC_OK;
    }
    lac_run_def how = lac_run_default();
    how.progress = on_progress;
    how.context = progress;
    cli_say(request, "pilot runs for an error of %g", c->accuracy);
    cli_progress_start(progress, request);
    lac_status status = lac_accuracy_choose(scene, c, &how, pick, err);
    cli_progress_clear(progress);
    if (status == LAC_OK && !cli_given(request, CLI_OPT_QUIET)) {
        cli_note("accuracy: %s", cli_accuracy_text(pick, text, sizeof text));
    }
    return status;
}

void cli_accuracy_print(const lac_accuracy_pick *pick)
{
    char text[CLI_ACCURACY_TEXT];
    if (pick != NULL) {
        cli_row_wrap("accuracy", cli_accuracy_text(pick, text, sizeof text));
    }
}

void cli_accuracy_json(cli_json *json, const lac_accuracy_pick *pick)
{
    if (pick == NULL) {
        cli_json_null(json, "accuracy");
        return;
    }
    cli_json_open(json, "accuracy", '{');
    cli_json_number(json, "asked", pick->asked);
    cli_json_number(json, "estimated", pick->estimated);
    cli_json_text(json, "quantity", lac_accuracy_of_name(pick->of));
    cli_json_number(json, "rtol", pick->rtol);
    cli_json_text(json, "method", method_name(pick->method));
    cli_json_text(json, "formulation", lac_formulation_name(pick->formulation));
    cli_json_integer(json, "pilots", pick->pilots);
    cli_json_integer(json, "pilot_rhs_evaluations", pick->evaluations);
    cli_json_close(json, '}');
}
