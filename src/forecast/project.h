/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_FORECAST_PROJECT_H
#define LACUNA_FORECAST_PROJECT_H

#include "base/least_squares.h"
#include "forecast/kinds.h"

enum { LAC_SHAPES_MAX = 3 };

/// A curve d = sum of c_j column_j(t; p) fitted to the displacements of a window. The c_j follow
/// from p by linear least squares (variable projection: Golub & Pereyra 1973), so that p alone is
/// searched: p[0] is ln of the remaining time, the others shape the curve.
typedef struct lac_projection {
    const lac_window *window;
    size_t columns, shapes; ///< number of c_j, of p_j
    /// Writes the columns at p.
    void (*curve)(const struct lac_projection *self, const double *p, double *columns);
    const void *context;
    const double *centre, *width; ///< [shapes] normal prior of p; a width of INFINITY: none
    double scale;                 ///< residual that one width of the prior weighs [m]; 0: no prior
    double *column;               ///< [columns][n] work
    double *residual;             ///< [n] of the last curve looked at, weighted [m]
    double c[LAC_LEAST_SQUARES_MAX]; ///< of it
} lac_projection;

/// @return LAC_OK; LAC_ENOMEM
lac_status lac_projection_create(lac_projection *self, lac_error *err);
void lac_projection_clear(lac_projection *self);

/// Sum of squared weighted residuals at p, without the prior; residual and c are of p afterwards.
double lac_projection_at(lac_projection *self, const double *p);

/// Keeps p where it is better than the worst of the best so far, which are in the order of their
/// sums.
typedef struct lac_starts {
    size_t count;
    double sum[4], p[4][LAC_SHAPES_MAX];
} lac_starts;
void lac_starts_offer(lac_starts *starts, size_t shapes, const double *p, double sum);

/// Refines the starts (GSL, Levenberg-Marquardt), takes the best, and fills in the fit: remaining,
/// its error (linearised; residuals taken as a first-order autoregression), rms, misfit, points.
/// @param p  [shapes] the best
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_projection_refine(lac_projection *self, const lac_starts *starts, double *p,
                                 lac_finding *fit, lac_error *err);

/// ln remaining times to start from: `count` values, from a thirtieth of the last interval to
/// thirty times the window, evenly.
double lac_projection_start(const lac_window *window, size_t index, size_t count);

#endif
