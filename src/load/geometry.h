/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

// The base of a sliding mass whose dip and thickness follow its mean slip: docs/theory/loads.md,
// "Geometry that changes with slip".

#include "base/base.h"

enum { LAC_MOST_NODES = 64 };

/// What a case says of the base. A number holds for all slip; a table has a value for each `slip`.
typedef struct lac_geometry_def {
    size_t nodes;       ///< of the tables; 0: there is none
    size_t angles;      ///< 0: the case names no geometry; 1: a number; else `nodes`
    size_t thicknesses; ///< 0: the normal load is the weight at the start; 1: a number; `nodes`
    double slip[LAC_MOST_NODES];      ///< [nodes] rising [m]
    double angle[LAC_MOST_NODES];     ///< [angles] dip [rad]; a number: at the start
    double thickness[LAC_MOST_NODES]; ///< [thicknesses] vertical [m]; a number: at the start
    double radius;                    ///< of a circular base [m]; NaN: none
} lac_geometry_def;

/// The same made ready. Immutable.
typedef struct lac_geometry lac_geometry;

/// The base at one slip, each value with its derivative with respect to slip.
typedef struct lac_slab {
    double angle, angle_slope;         ///< alpha [rad], [rad/m]
    double angle_bend;                 ///< of its slope [rad/m2]
    double thickness, thickness_slope; ///< H, vertical [m], [1]; NaN where no thickness is known
    double normal, normal_slope;       ///< P over P at the start [1], [1/m]
    double pull, pull_slope;           ///< Q of the weight over P at the start [1], [1/m]
} lac_slab;

/// @return LAC_OK; LAC_ENOMEM
lac_status lac_geometry_create(const lac_geometry_def *def, lac_geometry **out, lac_error *err);
void lac_geometry_free(lac_geometry *geometry);

/// P = rho g H cos^2(alpha), Q = P tan(alpha), over those at slip 0. A thickness of one number, or
/// none, leaves the weight on the base as it is at the start, H cos(alpha) = const: what a rigid
/// block does. Between the nodes of a table by Steffen's monotone cubic, whose slope is continuous;
/// before the first and beyond the last as there.
/// @param slip  mean slip since the start [m]
/// @return      P <= 0, or NaN, where the base stands upright or beyond
/// @cost        O(log nodes); allocates nothing
/// @source      Skempton & DeLory (1957) for the slab; Steffen (1990) for the table
lac_slab lac_geometry_at(const lac_geometry *geometry, double slip);

/// A lake that the lower end of the mass stands in.
typedef struct lac_lake {
    double level;       ///< [m]
    double foot;        ///< elevation of the base's lower end at slip 0 [m]
    double unit_weight; ///< of the water [Pa/m]; 0: there is no lake
    double angle;       ///< alpha_t, dip of the base there [rad]; NaN: alpha, that of all of it
} lac_lake;

/// What the lake takes off the weight, over the nominal area, and its derivatives with slip.
typedef struct lac_buoyancy {
    double lift, lift_slope; ///< off P: gamma h cos^2(alpha_t) [Pa], [Pa/m]
    double back, back_slope; ///< off Q: gamma h sin(alpha_t) cos(alpha_t) [Pa], [Pa/m]
} lac_buoyancy;

/// Buoyancy of the part of a slab below the level, h the mean height of it over the base:
///     h = 1/L int_0^L min(max(level - z(s), 0), H) ds,   z(s) = foot - fall + s sin(alpha)
/// fall = int sin(alpha) dslip, by which the mass has come down. Water in the rock stands as in the
/// lake. The slope of h is continuous.
/// @param length  L, of the slab along its dip [m]
/// @source        Archimedes' principle; Lambe & Whitman (1969) Soil Mechanics, ch. 24, submerged
///                infinite slope
lac_buoyancy lac_geometry_float(const lac_geometry *geometry, double slip, double length,
                                const lac_lake *lake);

/// What the weight does at the start.
typedef struct lac_geometry_load {
    double pressure; ///< mean over the nominal area, rho g H cos^2(alpha) [Pa]; NaN: no thickness
    double ratio;    ///< Q/P, tan(alpha) [1]
} lac_geometry_load;

/// @param density  of the rock [kg/m3]
/// @return         no pressure and a ratio of 0 where the case names no geometry, or memory is
/// short
lac_geometry_load lac_geometry_weigh(const lac_geometry_def *def, double density);

/// The greatest of |d(Q/P(0))/dslip| + |d(P/P(0))/dslip| along the base [1/m].
double lac_geometry_steepest(const lac_geometry *geometry);
