/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_FORECAST_POSTERIOR_H
#define LACUNA_FORECAST_POSTERIOR_H

#include "forecast/project.h"

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
/// @param draw       [LAC_POSTERIOR_DRAWS]
/// @cost  some 600 curves
void lac_posterior_draw(lac_projection *law, const double *p, double effective, double least,
                        lac_draw *draw);

/// Quantiles of ln of the remaining time over all places, and as its error half their 90 % interval
/// over that of a normal distribution; nothing where none has a weight.
/// @param draw  [n] sorted and normalised afterwards
void lac_posterior_finish(size_t n, lac_draw *draw, lac_finding *fit);

#endif
