/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "surface/surface.h"

/// Choices of the parameters of `file`, in the order of their words.
enum { LAC_NODATA_REFUSE, LAC_NODATA_NEAREST, LAC_NODATA_MEAN, LAC_NODATA_MASK };
enum { LAC_FIT_CROP, LAC_FIT_PAD, LAC_FIT_RESAMPLE };
enum { LAC_LOWER_SAME_FRAME, LAC_LOWER_MIRROR_X, LAC_LOWER_MIRROR_Y };
enum { LAC_DETREND_NONE, LAC_DETREND_MEAN, LAC_DETREND_PLANE };

/// Gives the masked samples of a map the height of the nearest one that has a height (by steps
/// from neighbour to neighbour).
/// @pre    at least one has
lac_status lac_fill_nearest(lac_height_map *map, lac_error *err);

/// Gives the masked samples of a map the mean of the others.
void lac_fill_mean(lac_height_map *map);

/// How a map lies on a grid: its sample at the centre of the grid, counted from 0, and whether it
/// runs backwards.
typedef struct lac_placement {
    int fit;
    double centre_x, centre_y;
    bool mirror_x, mirror_y;
} lac_placement;

/// The place of a map whose centre is that of the grid (to half a sample unless resampled).
lac_placement lac_place_centred(const lac_height_map *map, int fit, const lac_grid *grid);

/// The distance of samples where n of them lie along a side of `cells` cells: that of the file, or
/// what `fit` makes of one without [m].
double lac_fit_spacing(double spacing, size_t n, int fit, size_t cells, double cell);

/// Lays a map on a grid; spacings in metres.
/// @param heights  [ny * nx] of the grid; overwritten; NaN where the map is masked
lac_status lac_fit_map(const char *path, const lac_height_map *map, const lac_placement *place,
                       const lac_grid *grid, double *heights, lac_error *err);

/// Takes the mean, or the plane of least squares, off the heights.
void lac_detrend(int detrend, const lac_grid *grid, double *heights);

/// Lets the heights fade to zero at the edges as half a cosine over a part of each side.
void lac_taper(double part, const lac_grid *grid, double *heights);
