// SPDX-License-Identifier: GPL-3.0-or-later
// The readings of a series on the clock of a run.
#include <math.h>
#include <stdlib.h>

#include "fit/internal.h"

void lac_fit_data_clear(lac_fit_data *data)
{
    free(data->time);
    *data = (lac_fit_data){0};
}

static lac_status check_reading(const lac_case *c, const lac_series *series, size_t i, double sigma,
                                lac_error *err)
{
    LAC_FAIL_IF(c->fit.sigma != NULL && !isnan(series->displacement[i]) && !(sigma > 0.0), err,
                LAC_EINPUT, "line %zu: %s: the standard error of a displacement must be > 0",
                series->line[i], c->fit.sigma);
    return LAC_OK;
}

static lac_status keep(const lac_case *c, const lac_series *series, lac_fit_data *out,
                       lac_error *err)
{
    double shift = series->dated ? c->start_date : 0.0;
    for (size_t i = 0; i < series->n; i++) {
        double t = series->time[i] - shift;
        double slip = series->displacement != NULL ? series->displacement[i] : NAN;
        double rate = series->velocity != NULL ? series->velocity[i] : NAN;
        double sigma = c->fit.sigma != NULL ? series->value[i] : 1.0;
        LAC_TRY_RETURN(check_reading(c, series, i, sigma, err));
        out->not_positive += rate <= 0.0 ? 1 : 0;
        rate = rate > 0.0 ? rate : NAN;
        if (!(t >= 0.0) || t > c->run.end) {
            out->outside++;
            continue;
        }
        if (isnan(slip) && isnan(rate)) {
            continue;
        }
        out->time[out->n] = t;
        out->displacement[out->n] = slip;
        out->log_rate[out->n] = log(rate);
        out->sigma[out->n] = sigma;
        out->displacements += isnan(slip) ? 0 : 1;
        out->velocities += isnan(rate) ? 0 : 1;
        out->n++;
    }
    return LAC_OK;
}

lac_status lac_fit_data_read(const lac_case *c, const lac_series *series, lac_fit_data *out,
                             lac_error *err)
{
    *out = (lac_fit_data){.missing = series->missing};
    LAC_FAIL_IF(series->dated && !c->dated, err, LAC_EINPUT,
                "the series has dates, so time.start of %s must be a date", c->path);
    out->time = malloc(4 * (series->n + 1) * sizeof *out->time);
    LAC_FAIL_MEMORY_IF(out->time == NULL, err);
    out->displacement = out->time + series->n + 1;
    out->log_rate = out->displacement + series->n + 1;
    out->sigma = out->log_rate + series->n + 1;
    lac_status status = keep(c, series, out, err);
    size_t readings = out->displacements + out->velocities;
    size_t least = c->fit.count + 3;
    if (status == LAC_OK && readings < least) {
        status = lac_fail(err, LAC_EINPUT,
                          "%zu readings between time.start and time.end (%zu lie outside) are too "
                          "few for %zu parameters: at least %zu",
                          readings, out->outside, c->fit.count, least);
    }
    return status;
}
