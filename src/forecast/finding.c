// SPDX-License-Identifier: GPL-3.0-or-later
// What a method says of its fit: numbers, how well they fit, or why there is no forecast.
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "forecast/kinds.h"

lac_status lac_forecast_fit_refuse(lac_forecast_fit *fit, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    (void)vsnprintf(fit->reason, sizeof fit->reason, format, args);
    va_end(args);
    return LAC_OK;
}

void lac_forecast_fit_add(lac_forecast_fit *fit, const char *key, double value)
{
    if (fit->count < LAC_FORECAST_VALUES) {
        fit->value[fit->count++] = (lac_fitted){key, value};
    }
}

void lac_forecast_fit_add_within(lac_forecast_fit *fit, const char *key, double value, double low,
                                 double high)
{
    const double near = 0.01 * (high - low);
    lac_forecast_fit_add(fit, key, value);
    if (fit->ends < LAC_FORECAST_VALUES && (value <= low + near || value >= high - near)) {
        fit->end[fit->ends++] = key;
    }
}

void lac_forecast_fit_judge_inverse(size_t n, const double *time, const double *velocity,
                                    double scale, lac_forecast_fit *fit)
{
    double mean = 0.0;
    double all = 0.0;
    double left = 0.0;
    for (size_t i = 0; i < n; i++) {
        mean += 1.0 / velocity[i] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        const double inverse = 1.0 / velocity[i];
        const double residual = inverse - (fit->remaining - time[i]) / scale;
        left += residual * residual;
        all += (inverse - mean) * (inverse - mean);
    }
    fit->points = n;
    fit->rms = sqrt(left / (double)n);
    fit->rms_unit = "s/m";
    fit->misfit = all > 0.0 ? sqrt(left / all) : NAN;
}
