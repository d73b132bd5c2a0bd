/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/rows.h"
#include "base/statistics.h"
#include "forecast/forecast.h"

extern const lac_forecast_kind lac_forecast_inv8, lac_forecast_inv, lac_forecast_slo,
    lac_forecast_saito, lac_forecast_log, lac_forecast_voight, lac_forecast_block,
    lac_forecast_lppls, lac_forecast_persistence;

/// The methods that a definition asks: the registry's, its own model last but one.
size_t lac_forecast_count(const lac_forecast_def *def);
const lac_forecast_kind *lac_forecast_kind_of(const lac_forecast_def *def, size_t index);

/// The first of n times, in order, that is not before `start`; n: none.
size_t lac_first_at(size_t n, const double *time, double start);

/// The motion since `start`, thinned to 200 displacements by means of consecutive ones, the first
/// and the last apart. @param out  one piece, for free
lac_status lac_window_create(const lac_motion *motion, double start, lac_window **out,
                             lac_error *err);

/// Asks a method of the window, or of the motion where it is a model of its own: fills in all of
/// the forecast but its kind.
lac_status lac_forecast_ask(const lac_forecast_def *def, const lac_motion *motion,
                            const lac_window *window, lac_forecast *forecast, lac_error *err);

enum { LAC_POOLED = 3 }; ///< methods that a pooled window needs

/// The verdict on a set whose motion, trend, drivers and forecasts are there.
void lac_verdict_find(const lac_forecast_def *def, lac_forecast_set *o);

enum { LAC_SHAPES_MAX = 3 };

/// A curve d = sum of c_j column_j(t; p) fitted to the displacements of a window. The c_j follow
/// from p by linear least squares (variable projection: Golub & Pereyra 1973), so that p alone is
/// searched: p[0] is ln of the remaining time, the others shape the curve.
typedef struct lac_projection {
    const lac_window *window;
    size_t columns, shapes; ///< number of c_j, of p_j
    /// Writes the columns at p.
    void (*curve)(const struct lac_projection *self, const double *p, double *columns);
    /// Where the search starts along a shape but the first: at `part` of the way, in (0, 1).
    double (*place)(const struct lac_projection *self, size_t shape, double part);
    size_t grid[LAC_SHAPES_MAX]; ///< [shapes] number of places along each
    const void *context;
    const double *centre, *width; ///< [shapes] normal prior of p, INFINITY: none; NULL: of no shape
    double scale;                 ///< residual that one width of the prior weighs [m]; 0: no prior
    double *column;               ///< [columns][n] work
    double *residual;             ///< [n] of the last curve looked at, weighted [m]
    double c[LAC_LEAST_SQUARES_MAX]; ///< of it
    double effective;                ///< number of residuals, as many as white ones would tell
    double covariance[LAC_SHAPES_MAX][LAC_SHAPES_MAX]; ///< of p at the best, linearised
} lac_projection;

/// Fits it: from the best four places of the grid by Levenberg-Marquardt (GSL). ln of the remaining
/// time starts from a thirtieth of the last interval to thirty windows. Fills in remaining, its
/// error (linearised; residuals taken as a first-order autoregression), rms, misfit, points.
/// @param self  afterwards at the best; lac_projection_clear frees its work, whatever the status
lac_status lac_projection_fit(lac_projection *self, double *p, lac_forecast_fit *fit,
                              lac_error *err);
void lac_projection_clear(lac_projection *self);

/// Sum of squared weighted residuals at p, without the prior; residual and c are of p afterwards.
double lac_projection_eval(lac_projection *self, const double *p);

/// A place in ln of the remaining time and what it weighs.
typedef struct lac_draw {
    double x, weight; ///< weight is its logarithm until lac_posterior_finish
} lac_draw;

enum { LAC_POSTERIOR_DRAWS = 257 }; ///< places of one curve

/// The posterior of a fitted curve of two shapes at places along ln of the remaining time, the
/// other shape integrated out. The standard error of a reading and the two linear parameters are
/// too (flat in ln error, c_0 and ln c_1), which leaves sum^(-(effective - 2)/2) times the prior of
/// the shapes; ln of the remaining time is flat up to the farthest.
/// @param p          [2] the best
/// @param effective  number of residuals, as many as white ones would tell
/// @param least      sum of squares that has the weight 1
/// @cost  some 600 curves
void lac_posterior_draw(lac_projection *law, const double *p, double effective, double least,
                        lac_draw *draw);

/// Quantiles of ln of the remaining time over all places, and as its error half their 90 % interval
/// over that of a normal distribution; nothing where none has a weight.
/// @param draw  [n] sorted and normalised afterwards
void lac_posterior_finish(size_t n, lac_draw *draw, lac_forecast_fit *fit);
