// SPDX-License-Identifier: GPL-3.0-or-later
// A case and a series to the dataset of a fit, in one call.
#include <stdlib.h>

#include "base/ask.h"
#include "data/dataset.h"
#include "fit/fit.h"

// What a dataset is of, which it keeps.
typedef struct fit_made {
    lac_fit *fit;
    lac_fit_result result;
    lac_fit_outcome outcome;
    lac_made_from made;
} fit_made;

static void fit_made_free(void *result)
{
    fit_made *f = result;
    lac_fit_free(f->fit);
    free(f->made.case_text);
    free(f);
}

lac_status lac_fit_series(const lac_case *c, const char *path, lac_series **out, lac_error *err)
{
    lac_series_def def = lac_series_def_default();
    lac_status status;
    LAC_TRY(LAC_NEED(err, c, path, out));
    *out = NULL;
    LAC_TRY(lac_case_serves(c, LAC_FOR_FIT, err));
    def.path = path;
    def.time = c->fit.time;
    def.time_format = c->fit.time_format;
    def.displacement = c->fit.displacement;
    def.displacement_unit = c->fit.displacement_unit;
    def.velocity = c->fit.velocity;
    def.velocity_unit = c->fit.velocity_unit;
    def.value = c->fit.sigma;
    def.value_unit = c->fit.sigma_unit;
    def.value_si = "m";
    status = lac_series_create(&def, out, err);
out:
    return status;
}

// What was computed is handed out whole, also where it was interrupted.
static lac_status hand_out(fit_made *f, lac_status computed, lac_dataset **out, lac_error *err)
{
    LAC_TRY_RETURN(lac_fit_describe(&f->outcome, out, err));
    lac_dataset_keep(*out, f, fit_made_free, &f->made.provenance);
    return computed == LAC_OK ? lac_fit_trust(&f->result, err) : computed;
}

lac_status lac_fit_compute(const lac_case *c, const lac_series *series,
                           const lac_fit_options *options, lac_dataset **out, lac_error *err)
{
    lac_fit_options own = lac_fit_options_default();
    fit_made *f = NULL;
    lac_status status;
    LAC_TRY(LAC_NEED(err, c, series, out));
    *out = NULL;
    LAC_TRY(lac_take_options("lac_fit_options", options, &own, sizeof own, err));
    LAC_TRY(lac_case_serves(c, LAC_FOR_FIT, err));
    f = calloc(1, sizeof *f);
    LAC_TRY(f != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(lac_made_from_case(c, &f->made, err));
    f->made.provenance.seed = c->fit.seed;
    LAC_TRY(lac_fit_create(c, series, own.threads > 0 ? own.threads : 1, &f->fit, err));
    const lac_fit_watch watch = {own.interrupted, own.progress, own.context};
    status = lac_fit_run(f->fit, &watch, &f->result, err);
    f->outcome = (lac_fit_outcome){c, &f->result, status == LAC_OK ? "complete" : "interrupted"};
    if (status == LAC_OK || (status == LAC_EINTERRUPT && f->result.times > 0)) {
        status = hand_out(f, status, out, err);
        f = *out != NULL ? NULL : f;
    }
out:
    if (f != NULL) {
        fit_made_free(f);
    }
    return status;
}
