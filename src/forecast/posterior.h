/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_FORECAST_POSTERIOR_H
#define LACUNA_FORECAST_POSTERIOR_H

#include "forecast/project.h"

/// Weighted draws of ln of the remaining time.
typedef struct lac_draw {
    double x, weight; ///< weight is its logarithm until lac_posterior_finish
} lac_draw;

enum { LAC_POSTERIOR_DRAWS = 256 }; ///< that one curve adds

/// Draws from the posterior of a fitted curve of two shapes. The standard error of a reading and
/// the two linear parameters are integrated out (flat in ln error, c_0 and ln c_1), which leaves
/// sum^(-(effective - 2)/2) times the prior of the shapes; ln of the remaining time is flat up to
/// the farthest. Importance sampling by a t distribution that is moved once to where the draws are;
/// the points are a Kronecker sequence, so that the same window gives the same bits.
/// @param p          [2] the best
/// @param effective  number of residuals, as many as white ones would tell
/// @param least      sum of squares that has the weight 1
/// @param draw       [LAC_POSTERIOR_DRAWS]
void lac_posterior_draw(lac_projection *law, const double *p, double effective, double least,
                        lac_draw *draw);

/// Quantiles of ln of the remaining time over all draws, and as its error half their 90 % interval
/// over that of a normal distribution; nothing where no draw has a weight.
/// @param draw  [n] sorted and normalised afterwards
void lac_posterior_finish(size_t n, lac_draw *draw, lac_finding *fit);

#endif
