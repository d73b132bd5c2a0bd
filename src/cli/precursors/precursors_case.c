// SPDX-License-Identifier: GPL-3.0-or-later
// precursors --case: the slope's own model beside the methods that know only its motion.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/common/signals.h"
#include "cli/precursors/precursors.h"
#include "cli/report/report.h"

static bool on_interrupted(void *context)
{
    (void)context;
    return cli_signals_stop();
}

// "column:unit" as the option has it, where that does not say it; without a unit as it stands,
// unless that would be read as one.
static lac_status name_column(const char *column, const char *unit, const char *fallback,
                              const char **word, char **owned, lac_error *err)
{
    if (column == NULL) {
        return LAC_OK;
    }
    unit = unit == NULL && strchr(column, ':') != NULL ? fallback : unit;
    const size_t size = strlen(column) + (unit != NULL ? strlen(unit) : 0) + 2;
    *owned = malloc(size);
    if (*owned == NULL) {
        return lac_fail_memory(err);
    }
    (void)snprintf(*owned, size, "%s%s%s", column, unit != NULL ? ":" : "",
                   unit != NULL ? unit : "");
    *word = *owned;
    return LAC_OK;
}

static lac_status name_columns(cli_foreseer *f, lac_error *err)
{
    const lac_fit_def *fit = &f->source->fit;
    cli_series_words *words = &f->named.series;
    lac_status status = LAC_OK;
    if (words->displacement != NULL || words->velocity != NULL) {
        return LAC_OK;
    }
    LAC_TRY(name_column(fit->displacement, fit->displacement_unit, "m", &words->displacement,
                        &f->words[0], err));
    LAC_TRY(
        name_column(fit->velocity, fit->velocity_unit, "m/s", &words->velocity, &f->words[1], err));
    if (words->sigma == NULL) {
        LAC_TRY(name_column(fit->sigma, fit->sigma_unit, "m", &words->sigma, &f->words[2], err));
    }
    words->time = words->time != NULL ? words->time : fit->time;
    words->time_format = words->time_format != NULL ? words->time_format : fit->time_format;
out:
    return status;
}

lac_status cli_foreseer_read(const cli_request *request, cli_foreseer *out, lac_error *err)
{
    cli_request of_case = *request;
    *out = (cli_foreseer){.named = *request};
    if (request->forecast.case_file == NULL) {
        return request->set_count == 0
                   ? LAC_OK
                   : lac_fail(err, LAC_EINPUT, "--set: overrides a case: --case names one");
    }
    of_case.argument[0] = request->forecast.case_file;
    lac_status status = cli_case_read(&of_case, LAC_FOR_FIT, &out->source, NULL, err);
    if (status != LAC_OK) {
        return status;
    }
    out->watch.interrupted = on_interrupted;
    out->how = (lac_foresight){.source = out->source,
                               .threads = request->threads > 0 ? request->threads : 1,
                               .watch = &out->watch};
    out->model = lac_foresee(&out->how);
    return cli_watched_is_run(request) ? LAC_OK : name_columns(out, err);
}

void cli_foreseer_clear(cli_foreseer *foreseer)
{
    lac_case_free(foreseer->source);
    for (size_t i = 0; i < sizeof foreseer->words / sizeof *foreseer->words; i++) {
        free(foreseer->words[i]);
    }
}
