/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/param.h"
#include "forecast/driver.h"
#include "forecast/verdict.h"

enum {
    LAC_FORECAST_TEXT = 320,
    LAC_FORECAST_VALUES = 20,
    LAC_FORECAST_LEVELS = 5, ///< 5, 25, 50, 75 and 95 %
};

/// What a method is given: the motion since the window's start, nothing after `now`. Times are
/// seconds before now, so <= 0.
typedef struct lac_window {
    double now, start; ///< on the series' clock [s]
    size_t n;
    double *time;         ///< [n] [s]
    double *displacement; ///< [n] [m] from the first one
    double *weight;       ///< [n] 1/sigma over its mean; 1 where sigma is not known
    size_t velocities;
    double *velocity_time;  ///< [velocities] [s]
    double *velocity;       ///< [velocities] [m/s]
    double *velocity_error; ///< [velocities] of each by the noise [m/s]; NaN: not known
    double noise;           ///< of one displacement [m]; NaN: not known
    double error;           ///< of a displacement of weight 1 by it [m]; NaN: not known
    double resolution;      ///< last digit of one [m]; 0: not known
    double step;            ///< median of the last five intervals between readings [s]; 0: one only
    bool integrated;        ///< the displacements are integrals of the velocities
} lac_window;

/// A number that a method fitted.
typedef struct lac_fitted {
    const char *key; ///< ends in its unit where there is one
    double value;
} lac_fitted;

/// What a method found.
typedef struct lac_forecast_fit {
    double remaining;     ///< time from now to failure [s]; NaN: none
    double error;         ///< standard error of ln remaining, by the fit itself
    double rms;           ///< of the residuals, in `rms_unit`
    const char *rms_unit; ///< "m", or "s/m" of inverse velocities
    double misfit;        ///< rms over the range of what was fitted: 0 is a perfect fit
    double excess;        ///< what of it the noise does not explain (lac_unexplained)
    bool poor;            ///< what is left of the readings hangs together: no noise does
    size_t points;        ///< that were fitted
    bool posterior;       ///< the method has a posterior: `quantile` holds
    double quantile[LAC_FORECAST_LEVELS]; ///< of ln remaining by its posterior
    size_t count;
    lac_fitted value[LAC_FORECAST_VALUES];
    size_t ends;
    const char *end[LAC_FORECAST_VALUES]; ///< keys whose best value stands at the end of its range
    char reason[LAC_FORECAST_TEXT];       ///< why there is no forecast; "": there is one
} lac_forecast_fit;

/// Says why there is no forecast, or no value of an indicator.
/// @return LAC_OK, so that it is one statement
lac_status lac_forecast_fit_refuse(lac_forecast_fit *fit, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/// Says how well it fits.
/// @param range  of what was fitted
/// @param noise  rms that the readings' noise alone has residuals of; not > 0: not known
/// @param free   degrees of freedom of the residuals
void lac_forecast_fit_weigh(lac_forecast_fit *fit, double rms, double range, double noise,
                            double free);

/// Adds a fitted number.
void lac_forecast_fit_add(lac_forecast_fit *fit, const char *key, double value);

/// Adds a fitted number that is searched from `low` to `high`, and notes where it stands in the
/// last hundredth at either end.
void lac_forecast_fit_add_within(lac_forecast_fit *fit, const char *key, double value, double low,
                                 double high);

/// The number under a key; NaN: there is none.
double lac_forecast_fit_find(const lac_forecast_fit *fit, const char *key);

/// From a fit to the time that is told, and its intervals. About c = ln R + pull (ln W - ln R), R
/// the remaining time that the method finds and W the length of its window, ln of the remaining
/// time lies below c + E q, E = sqrt(error^2 + spread^2), q = low90, low50, median, high50, high90,
/// in 5, 25, 50, 75 and 95 of 100 simulated failures (docs/theory/forecasting.md says which). Of a
/// method with a posterior R is its median there, and `error` each quantile's distance from it over
/// that of a standard normal distribution, its 90 % interval's half of the median: a posterior that
/// is right has the q of that distribution.
typedef struct lac_calibration {
    double pull, spread, low90, low50, median, high50, high90;
} lac_calibration;

/// A method of forecasting: a row of a table.
typedef struct lac_forecast_kind {
    lac_model_info info;
    const char *estimator; ///< exactly what is computed from what
    size_t least;          ///< readings or velocities that it needs
    bool displacements;    ///< it fits displacements, not velocities
    bool baseline;         ///< stands for no knowledge: what the others must beat
    bool dates;            ///< its time of failure is the one that indicators take
    double worst;          ///< excess above which its forecast is not issued
    lac_calibration calibration;
    /// Fits the window. Whatever is wrong with the data is said in `fit->reason`.
    /// @return LAC_OK; LAC_ENOMEM
    lac_status (*fit)(const lac_window *window, lac_forecast_fit *fit, lac_error *err);
} lac_forecast_kind;

/// The index-th method in the registry, NULL past the end.
const lac_forecast_kind *lac_forecast_kind_get(size_t index);

/// The method `case`, which is none of the registry's: lac_model_forecast_method (model_forecast.h)
/// makes it of a case, and its `fit` is NULL.
extern const lac_forecast_kind lac_forecast_case;

/// What keeps a forecast from being issued, in words.
typedef struct lac_forecast_gate {
    const char *name, *text;
} lac_forecast_gate;

/// The index-th gate in the order in which they are asked, NULL past the end.
const lac_forecast_gate *lac_forecast_gate_get(size_t index);

/// A method that stands beside those of the registry: a model of this very slope.
typedef struct lac_forecast_model {
    const lac_forecast_kind *kind; ///< its own `fit` is NULL
    void *context;
    /// Fits the motion, which ends at `now`, all of it: the window is of methods that know no more
    /// of the slope.
    /// @return LAC_OK, also where it says a reason; what ends the whole set of forecasts
    lac_status (*fit)(void *context, const lac_motion *motion, double now, lac_forecast_fit *found,
                      lac_error *err);
} lac_forecast_model;

/// How forecasts are made.
typedef struct lac_forecast_def {
    lac_motion_def motion;
    double since;     ///< start of what is fitted, accelerating or not [s]; NaN: the onset of it
    bool onset;       ///< the gate is that of means of velocities, not the trend's
    size_t short_run; ///< velocities in the short mean of the onset
    size_t long_run;  ///< in the long one
    const lac_forecast_model *model; ///< asked before the baseline; NULL: none
    size_t drivers;
    const lac_driver *driver; ///< [drivers] what may explain the rate
    size_t window_count;      ///< nothing is known but the last so many readings; 0: all
    lac_levels levels;        ///< what gives a level
    bool all;                 ///< methods are asked also where a gate is closed; it stays so
    double window_time;       ///< nor what is so long before the last one [s]; INFINITY: all
} lac_forecast_def;

/// Velocities as given, from the onset, by means of 3 over 7 velocities (Carla et al. 2017), of all
/// readings.
lac_forecast_def lac_forecast_default(void);

/// A forecast of one method at one time.
typedef struct lac_forecast {
    const lac_forecast_kind *kind;
    bool issued;
    double issue_time;   ///< the last reading it could see [s]
    double window_start; ///< [s]
    double time;         ///< of failure: the calibrated median [s]; NaN: none, or it would be over
    double raw_time;     ///< that the method itself finds [s]; NaN: none
    double low50, high50, low90, high90; ///< about `time` [s]; NaN: none
    lac_forecast_fit fit;                ///< also where it is not issued, as far as it went
} lac_forecast;

/// All methods at the last of the readings given.
typedef struct lac_forecast_set {
    lac_motion *motion; ///< owned; what the methods saw
    bool asked;         ///< the gates before any method are open
    bool accelerating;  ///< and the slope accelerates; else `since` was given
    double issue_time, window_start;
    size_t count;
    lac_forecast *forecast; ///< [count] in the order of the registry, a model last but one
    size_t effects;
    lac_verdict verdict;
    lac_driver_effect *effect; ///< [effects] of the drivers; theirs is owned
} lac_forecast_set;

/// Forecasts from readings up to the present; nothing else is known to it, so that it is causal.
/// @return LAC_OK, also where no method issues one; LAC_EINPUT; LAC_ENOMEM
lac_status lac_forecast_set_create(const lac_forecast_def *def, const lac_readings *readings,
                                   lac_forecast_set **out, lac_error *err);

void lac_forecast_set_free(lac_forecast_set *forecasts);
