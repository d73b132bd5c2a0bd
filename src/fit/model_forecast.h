/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "fit/fit.h"
#include "forecast/forecast.h"

/// A case that forecasts: the method lac_forecast_case, the slope's own model of one cell or many.
typedef struct lac_model_forecast {
    const lac_case *source; ///< has a section `fit`; outlives the model
    bool dated;             ///< the motion's times are seconds since 1970, else the run's own
    int threads;
    const lac_fit_watch *watch; ///< NULL: nobody; its `kept` holds the steps of all fits in turn
} lac_model_forecast;

/// Fits the case to the motion up to the time of issue (lac_fit_run) and runs it on: the time of
/// failure is that of the best fit, its error the least squares' or, where the case samples, its
/// posterior the draws'. The displacements are fitted, or the velocities where there are no others;
/// what counts against it is the rms beyond the noise. No forecast where the best fit, or one draw
/// in twenty, does not fail by time.end, where the case cannot be fitted, or where its chain is far
/// from converged. Ends the set of forecasts with LAC_EINPUT where the motion has dates and the
/// case none, with LAC_EINTERRUPT, LAC_ENOMEM.
/// @param how  outlives the model
lac_forecast_model lac_model_forecast_method(lac_model_forecast *how);
