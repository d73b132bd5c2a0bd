/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_SURFACE_H
#define LACUNA_SURFACE_H

#include "lacuna/grid.h"
#include "lacuna/param.h"

/// Where the composite heights of an interface come from (peaks up, zero mean).
typedef struct lac_surface_source {
    lac_descriptor about;
    /// @param heights  [ny * nx] composite height of each cell [m]; overwritten
    /// @return LAC_OK; LAC_ENOMEM; LAC_EINPUT where the parameters do not fit the grid
    lac_status (*generate)(const void *params, const lac_grid *grid, double *heights,
                           lac_error *err);
} lac_surface_source;

/// Parameters of `self-affine`.
typedef struct lac_self_affine {
    double hurst;      ///< Hurst exponent [1]
    double rms_height; ///< of the full band, rolloff to shortest [m]
    double rolloff;    ///< wavelength above which the spectrum is flat [m]; NaN: the longest wave
    double shortest;   ///< shortest wavelength kept [m]; NaN: two cells
    int64_t seed;
} lac_self_affine;

/// Parameters of `file`.
typedef struct lac_surface_file {
    char *path;
    char *unit;         ///< of the heights, where the file says none; NULL: m
    char *lateral_unit; ///< of the file's spacing, where it says none; NULL: `unit`
    double spacing;     ///< of the samples, where the file says none [m]; NaN: not given
    int nodata;         ///< refuse, nearest, mean
    int fit;            ///< crop, pad, resample
    int detrend;        ///< none, mean, plane
    double taper;       ///< part of each side over which the heights fade to zero at either end [1]
} lac_surface_file;

/// Measured heights as a file holds them. Row 0 is at the smallest y, whatever the file's order.
typedef struct lac_height_map {
    size_t nx, ny;
    double dx, dy;         ///< spacing [lateral_unit]; NaN where the file says none
    char lateral_unit[32]; ///< "" where the file says none
    char height_unit[32];  ///< "" where the file says none
    size_t masked;         ///< samples without a height
    double *heights;       ///< [ny * nx], x fastest [height_unit]; NaN where masked, else finite
} lac_height_map;

/// The index-th source in the registry, NULL past the end.
const lac_surface_source *lac_surface_source_at(size_t index);

/// Heights of the chosen source on a grid.
/// @param slot     a surface source and its parameters
/// @param heights  [ny * nx] [m]; overwritten
/// @return what the source returns
lac_status lac_surface_generate(const lac_slot *slot, const lac_grid *grid, double *heights,
                                lac_error *err);

/// Reads measured heights; what the file holds tells its format (docs/surfaces-from-files.md).
/// @param map  set on success; the caller frees it
/// @return LAC_OK; LAC_EINPUT where the content is refused, with file, line or byte, what was
///         found and what is allowed; LAC_EIO; LAC_ENOMEM
lac_status lac_height_map_read(const char *path, lac_height_map **map, lac_error *err);

/// Frees a map; NULL is fine.
void lac_height_map_free(lac_height_map *map);

#endif
