/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

/// Few points that stand for many: a sum over all of them of any of some functions is the same over
/// the few, each counted as often as its weight says.
typedef struct lac_cubature {
    size_t points, functions;
    double least; ///< a function that is no more than this but for those before it is not kept
    /// Values of all functions at a point. The sum over all points of none may vanish beside its
    /// values but by chance.
    /// @param value  [functions]; overwritten
    void (*at)(const void *context, size_t point, double *value);
    const void *context;
} lac_cubature;

/// Thins the points: at most as many stay as there are functions, with weights > 0.
/// @param kept    [points] numbers of those that stay, rising; overwritten
/// @param weight  [points] their weights; overwritten
/// @param count   how many stay
/// @return LAC_OK; LAC_ENOMEM
/// @cost   twice the functions at all points, and some 8 functions^3 log2(points/functions)
/// @source Tchakaloff (1957); by groups, Litterer & Lyons (2012), doi 10.1214/11-AAP786
lac_status lac_cubature_thin(const lac_cubature *of, uint32_t *kept, double *weight, size_t *count,
                             lac_error *err);
