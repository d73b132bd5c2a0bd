// SPDX-License-Identifier: GPL-3.0-or-later
// The baseline that any method must beat: what has lasted t lasts a further r with the chance
// t/(t + r), which knows nothing of the motion.
#include <math.h>

#include "forecast/kinds.h"

static lac_status fit_nothing(const lac_window *w, lac_forecast_fit *fit, lac_error *err)
{
    (void)err;
    fit->remaining = -w->time[0];
    fit->error = 0.0;
    fit->rms = NAN;
    fit->misfit = 0.0;
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
    .calibration = {1.0, -2.9444389791664403, -1.0986122886681098, 1.0986122886681098,
                    2.9444389791664403},
    .fit = fit_nothing,
};
