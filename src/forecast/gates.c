// SPDX-License-Identifier: GPL-3.0-or-later
// What keeps a forecast from being issued, in the order in which it is asked: window.c and
// set of forecasts.c.
#include "base/rows.h"
#include "forecast/forecast.h"

static const lac_forecast_gate gates[] = {
    {"resets", "of any method: more than one reading in twenty would be a reset of the sensor "
               "(--raw takes them as they are)"},
    {"range",
     "of any method: a velocity or displacement above 1e150 m/s or m, or all below 1e-150"},
    {"readings",
     "of any method: fewer velocities than the long mean of the onset is of (7); not with --since"},
    {"acceleration", "of any method: the mean of the last 3 velocities is not above that of the "
                     "last 7 (--onset) by more than the numbers' last digits; with --since: nor "
                     "are the readings since then off a steady motion by more than these"},
    {"noise", "of any method: the last 3 intervals, or those that --smooth takes where more, moved "
              "the slope by no more than 3 errors of a difference of two readings"},
    {"points", "fewer readings or velocities since the onset than the method needs"},
    {"fit", "no time of failure follows from the fit, or one that is over"},
    {"misfit",
     "rms of the residuals over the range of what was fitted above what the method may have"},
    {"vagueness", "standard error of ln(tc - t) above 1.5"},
};

LAC_ROWS_AT(lac_forecast_gate, lac_forecast_gate_get, gates)
