// SPDX-License-Identifier: GPL-3.0-or-later
// How far a modelled motion is from readings, by its slip and rate at their times.
#include <gsl/gsl_interp.h>
#include <math.h>

#include "base/statistics.h"
#include "series/series.h"

// v = v0^(1-w) v1^w, or linear where a rate is not positive.
static double between_rates(double v0, double v1, double w)
{
    if (v0 > 0 && v1 > 0) {
        return exp((1.0 - w) * log(v0) + w * log(v1));
    }
    return (1.0 - w) * v0 + w * v1;
}

bool lac_history_eval(const lac_history *h, double t, double *slip, double *rate)
{
    if (h->n == 0 || !(t >= h->time[0] && t <= h->time[h->n - 1])) {
        return false;
    }
    size_t i = gsl_interp_bsearch(h->time, t, 0, h->n);
    *slip = h->slip[i];
    *rate = h->rate[i];
    if (t > h->time[i]) {
        double w = (t - h->time[i]) / (h->time[i + 1] - h->time[i]);
        *slip = (1.0 - w) * h->slip[i] + w * h->slip[i + 1];
        *rate = between_rates(h->rate[i], h->rate[i + 1], w);
    }
    return true;
}

void lac_series_compare(const lac_series *series, const lac_history *history, lac_misfit *misfit)
{
    lac_line offset = {0}; // level
    size_t rates = 0;
    double squares = 0.0;
    *misfit = (lac_misfit){0};
    for (size_t i = 0; i < series->n; i++) {
        double slip = 0.0;
        double rate = 0.0;
        double d = series->displacement != NULL ? series->displacement[i] : NAN;
        double v = series->velocity != NULL ? series->velocity[i] : NAN;
        if (isnan(d) && isnan(v)) {
            continue;
        }
        if (!lac_history_eval(history, series->time[i], &slip, &rate)) {
            misfit->outside++;
            continue;
        }
        if (!isnan(d)) {
            lac_line_add(&offset, 0.0, d - slip);
        }
        if (v > 0 && rate > 0) {
            double decades = log10(v / rate);
            squares += decades * decades;
            rates++;
        }
    }
    misfit->displacement_count = (size_t)offset.n;
    misfit->velocity_count = rates;
    misfit->displacement_offset = offset.n > 0 ? lac_line_at(&offset, 0.0) : NAN;
    misfit->displacement_rms = sqrt(offset.rest / offset.n);
    misfit->log_rate_rms = rates > 0 ? sqrt(squares / (double)rates) : NAN;
}
