// SPDX-License-Identifier: GPL-3.0-or-later
// The methods of forecasting in their order: a case's own comes before the baseline, which is last.
#include <stdarg.h>

#include "forecast/kinds.h"

static const lac_forecast_kind *const kinds[] = {
    &lac_forecast_inv8,  &lac_forecast_inv,   &lac_forecast_slo,
    &lac_forecast_saito, &lac_forecast_log,   &lac_forecast_voight,
    &lac_forecast_block, &lac_forecast_lppls, &lac_forecast_persistence,
};

enum { KINDS = sizeof kinds / sizeof kinds[0] };

LAC_KINDS_AT(lac_forecast_kind, lac_forecast_kind_get, kinds)

size_t lac_forecast_count(const lac_forecast_def *def)
{
    return KINDS + (def->model != NULL ? 1 : 0);
}

const lac_forecast_kind *lac_forecast_kind_of(const lac_forecast_def *def, size_t index)
{
    if (def->model == NULL || index < KINDS - 1) {
        return lac_forecast_kind_get(index);
    }
    return index == KINDS - 1 ? def->model->kind : lac_forecast_kind_get(KINDS - 1);
}

lac_status lac_forecast_fit_refuse(lac_forecast_fit *fit, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    (void)vsnprintf(fit->reason, sizeof fit->reason, format, args);
    va_end(args);
    return LAC_OK;
}

void lac_forecast_fit_weigh(lac_forecast_fit *fit, double rms, double range, double noise,
                            double free)
{
    fit->rms = rms;
    fit->misfit = rms / range;
    fit->excess = lac_unexplained(rms, noise, free) / range;
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

double lac_forecast_fit_find(const lac_forecast_fit *fit, const char *key)
{
    for (size_t i = 0; i < fit->count; i++) {
        if (strcmp(fit->value[i].key, key) == 0) {
            return fit->value[i].value;
        }
    }
    return NAN;
}

// The row of the method whose fit is lac_model_forecast_method's: it stands here for whoever lists
// the methods.
const lac_forecast_kind lac_forecast_case = {
    .info = LAC_ABOUT("case", "the slope's own model, fitted and run on (--case)",
                      "Borri-Brunetto, Carpinteri & Chiaia (2004), Rock Mech. Rock Eng. 37, 117; "
                      "docs/theory/fitting.md"),
    .estimator = "the case of --case, its section fit's parameters fitted to all readings between "
                 "time.start and the time of issue by least squares (and sampled where fit.steps > "
                 "0), run on to failure",
    .least = 5,
    .worst = 0.04,
    .calibration = {0.0, 0.01, -1.6448536269514722, -0.6744897501960817, 0.0, 0.6744897501960817,
                    1.6448536269514722},
};

// The baseline that any method must beat: what has lasted t lasts a further r with the chance
// t/(t + r), which knows nothing of the motion.
static lac_status fit_nothing(const lac_window *w, lac_forecast_fit *fit, lac_error *err)
{
    (void)err;
    fit->remaining = -w->time[0];
    fit->error = 0.0;
    fit->rms = NAN;
    fit->misfit = 0.0;
    fit->excess = 0.0;
    fit->points = w->n;
    return LAC_OK;
}

// ln of 1/19, 1/3, 3, 19
const lac_forecast_kind lac_forecast_persistence = {
    .info = LAC_ABOUT("persistence", "baseline: goes on as long as it has",
                      "Gott (1993), Nature 363, 315-319, doi 10.1038/363315a0"),
    .estimator = "as long again as the window has lasted; below r with the chance r/(t + r)",
    .least = 1,
    .baseline = true,
    .worst = 1.0,
    .calibration = {0.0, 1.0, -2.9444389791664403, -1.0986122886681098, 0.0, 1.0986122886681098,
                    2.9444389791664403},
    .fit = fit_nothing,
};

// What keeps a forecast from being issued, in the order in which it is asked (outlook.c).
static const lac_forecast_gate gates[] = {
    {"resets", "of any method: more than one reading in ten would be a reset of the sensor "
               "(--raw takes them as they are)"},
    {"range",
     "of any method: a velocity or displacement above 1e150 m/s or m, or all below 1e-150"},
    {"acceleration", "of any method: the rate does not rise, or noise forbids to say so, by a test "
                     "of its trend in units of its error (p 0.01); with --onset S,L: the mean of "
                     "the last S velocities is not above that of the last L; with --since: all "
                     "readings since then are those of a steady motion but for the last digits"},
    {"points", "fewer readings or velocities since the onset than the method needs"},
    {"fit", "no time of failure follows from the fit, or one that is over"},
    {"misfit",
     "what of the rms of the residuals the measured noise does not explain (sqrt(rms^2 - noise^2), "
     "0 where chi-square allows it) over the range of what was fitted above what the method may "
     "have"},
    {"vagueness", "standard error of ln(tc - t) above 1.5"},
    {"driver", "of any method but the baseline and --case: a --driver explains the rate, "
               "and what remains does not accelerate"},
};

LAC_ROWS_AT(lac_forecast_gate, lac_forecast_gate_get, gates)
