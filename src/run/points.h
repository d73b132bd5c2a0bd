/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "contact/contact.h"

/// A place that a case names in output.points.
typedef struct lac_point_def {
    char *name;
    double x, y;   ///< on the axes of the cells [m]; NaN: the middle
    double radius; ///< of the circle that it stands for [m]; 0: the nearest contact cell alone
} lac_point_def;

/// A place at which a run is watched, and the contact cells that tell of it: those whose centres
/// lie within its radius, or where none does the nearest one.
typedef struct lac_point {
    char *name;
    double x, y;           ///< as named [m]
    double cell_x, cell_y; ///< centre of the nearest contact cell [m]
    double distance;       ///< from the place to the edge of that cell [m]; 0: it lies within
    bool beside;           ///< out of contact, as is all within its radius
    size_t cells, *cell;   ///< [cells] that the values are means over
} lac_point;

typedef struct lac_points {
    size_t n;
    lac_point *point; ///< [n]
} lac_points;

/// What is told of a point at a record, in the order of lac_observation.points.
typedef enum lac_point_value {
    LAC_POINT_SLIP = 0,
    LAC_POINT_RATE,
    LAC_POINT_TRACTION,
    LAC_POINT_STATE,
    LAC_POINT_VALUES,
} lac_point_value;

/// Components of slip, slip rate and traction, in the order of lac_observation.points_along.
enum { LAC_POINT_ALONG = 6 };

/// Finds the cells of places. Distances go round periodic edges; of cells equally near the first
/// counts.
/// @param def  [n] within the interface; copied
/// @return LAC_OK; LAC_ENOMEM
/// @cost   O(n cells)
lac_status lac_points_create(const lac_domain *domain, size_t n, const lac_point_def *def,
                             lac_points **out, lac_error *err);
void lac_points_free(lac_points *points);

/// What is told of every point.
/// @param fields  [LAC_POINT_VALUES] over the cells of the domain, of the state its logarithm
/// @param value   [n][LAC_POINT_VALUES]; overwritten
void lac_points_read(const lac_points *points, const double *const *fields, double *value);

/// The mean of a field over the cells of a point. @param field  [cells of the domain]
double lac_point_mean(const lac_point *point, const double *field);
