/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/grid.h"
#include "base/param.h"
#include "base/strip.h"

/// Wavelengths between which a spectrum is fitted [m]; NaN: a quarter of the shorter side, four
/// cells. Keep them within the power law: beyond the rolloff, above what an instrument smooths.
typedef struct lac_wave_range {
    double longest, shortest;
} lac_wave_range;

/// Steps at which rock engineers measure profiles: 0.25, 0.5 and 1 mm.
enum { LAC_PROFILE_STEPS = 3 };

/// Profiles along x at one step.
typedef struct lac_profile_measure {
    double step;   ///< [m]
    double z2;     ///< rms slope at this step [1]
    double jrc;    ///< 32.2 + 32.47 log10 z2, as it comes; NaN where flat
    double jrc_yu; ///< 60.32 z2 - 4.51, found at 0.25 mm; NaN at other steps
} lac_profile_measure;

/// What a height field looks like.
typedef struct lac_surface_measures {
    double rms_height;               ///< [m]
    double rms_slope_x, rms_slope_y; ///< of the differences of neighbours [1]
    double hurst, hurst_error; ///< and its standard error; NaN where the range has no three shells
    double hurst_misfit;       ///< mean square misfit over that of a power law, about 1 [1]; NaN
    double fit_longest, fit_shortest; ///< wavelengths fitted [m]
    double z2, z2_step;               ///< rms slope of the profiles along x, at this step [1, m]
    double jrc;      ///< from z2, as it comes (0 to 20 makes sense); NaN where flat
    size_t profiles; ///< steps that the cells make, to a tenth
    lac_profile_measure profile[LAC_PROFILE_STEPS];
} lac_surface_measures;

/// What a file was found to hold, and what became of it.
typedef struct lac_file_report {
    const char *path;   ///< the parameter's own
    const char *format; ///< static
    size_t nx, ny;
    double dx, dy; ///< spacing [m]; NaN where neither file nor case says it
    char height_unit[32], lateral_unit[32];
    size_t masked; ///< samples without a height
    int fit;       ///< 0: cropped, 1: padded, 2: resampled
} lac_file_report;

/// What the measures of a report are of.
typedef enum lac_measured {
    LAC_MEASURED_INTERFACE = 0, ///< the heights of the interface
    LAC_MEASURED_FILE,          ///< all of a file, before detrending and tapering
    LAC_MEASURED_PART,          ///< as that, but only what lies on the interface
    LAC_MEASURED_COMPOSITE,     ///< both faces on the interface, before detrending and tapering
} lac_measured;

/// What a surface is like and where it came from.
typedef struct lac_surface_stats {
    lac_measured measured;
    lac_surface_measures measures;
    size_t files; ///< 0, 1, or 2: the upper face and the lower one
    lac_file_report file[2];
} lac_surface_stats;

/// Where the composite heights of an interface come from (peaks up, zero mean).
typedef struct lac_surface_source {
    lac_model_info info;
    /// @param heights  [ny * nx] composite height of each cell [m]; overwritten
    /// @param report   NULL; left alone by a source without files, whose heights are then measured
    /// @param team     where `shared`: of each rank the rows of lac_strip_rows; NULL: all of them
    lac_status (*generate)(const void *params, const lac_grid *grid, lac_team *team,
                           double *heights, lac_surface_stats *report, lac_error *err);
    /// Where the spectrum is a power law [m], NaN where the grid says; NULL: not known.
    lac_wave_range (*waves)(const void *params, const lac_grid *grid);
    bool shared; ///< each rank can make its own rows
} lac_surface_source;

extern const lac_surface_source lac_surface_self_affine, lac_surface_joint, lac_surface_benchmark,
    lac_surface_from_file;

/// Parameters of `self-affine`.
typedef struct lac_self_affine {
    double hurst;      ///< Hurst exponent [1]
    double rms_height; ///< of the full band, rolloff to shortest [m]; NaN: rms_slope says it
    double rms_slope;  ///< of the gradient of the full band [1]; NaN: rms_height says it
    double rolloff;    ///< wavelength above which the spectrum is flat [m]; NaN: the longest wave
    double shortest;   ///< shortest wavelength kept [m]; NaN: two cells
    int64_t seed;
    double anisotropy; ///< correlation length along `direction` over that across [1]
    double direction;  ///< from x towards y [rad]
    double skewness;   ///< of the heights [1]
    int sampling;      ///< of waves that a grid does not resolve: low-pass, point, block-mean
} lac_self_affine;

/// Surfaces of `benchmark`.
enum { LAC_BENCHMARK_A08, LAC_BENCHMARK_J07 };

/// Parameters of `benchmark`.
typedef struct lac_benchmark {
    int name;            ///< LAC_BENCHMARK_...
    double rms_slope;    ///< of all waves [1]; NaN: not what fixes the scale
    double height_ratio; ///< rms height of all waves over the side [1]; NaN likewise
    int64_t seed;        ///< INT64_MIN: that of the surface
} lac_benchmark;

/// Parameters of `joint`.
typedef struct lac_joint {
    double hurst;      ///< Hurst exponent of each face [1]
    double rms_height; ///< of the full band of each face [m]
    double rolloff;    ///< wavelength above which the spectrum is flat [m]; NaN: the longest wave
    double shortest;   ///< shortest wavelength kept [m]; NaN: two cells
    int64_t seed;
    double mating; ///< wavelength from which on the faces are the same [m]; NaN: nowhere
    double offset; ///< of the lower face along x [m]
    int sampling;  ///< as of self-affine
} lac_joint;

/// Parameters of `file`.
typedef struct lac_surface_file {
    char *path;         ///< composite heights; with `lower` those of the upper face
    char *unit;         ///< of the heights, where the file says none; NULL: m
    char *lateral_unit; ///< of the file's spacing, where it says none; NULL: `unit`
    double spacing;     ///< of the samples, where the file says none [m]; NaN: not given
    int nodata;         ///< refuse, nearest, mean
    int fit;            ///< crop, pad, resample
    int detrend;        ///< none, mean, plane
    double taper;       ///< part of each side over which the heights fade to zero at either end [1]
    char *lower;        ///< the lower face, `path` being the upper one; NULL: `path` is composite
    int lower_view;     ///< same-frame, mirror-x, mirror-y
    double offset;      ///< of the lower face along x [m]
} lac_surface_file;

enum { LAC_UNIT_SIZE = 32 }; ///< of the units that files say

/// Measured heights as a file holds them. Row 0 is at the smallest y, whatever the file's order.
typedef struct lac_height_map {
    const char *format; ///< name of the format; static
    size_t nx, ny;
    double dx, dy; ///< spacing [lateral_unit]; NaN where the file says none
    double x, y;   ///< of the first sample [lateral_unit]; NaN where the file says none
    char lateral_unit[LAC_UNIT_SIZE], height_unit[LAC_UNIT_SIZE]; ///< "" where it says none
    size_t masked;                                                ///< samples without a height
    double *heights; ///< [ny * nx], x fastest [height_unit]; NaN where masked, else finite
} lac_height_map;

/// The index-th source in the registry, NULL past the end.
const lac_surface_source *lac_surface_source_get(size_t index);

/// Heights of the chosen source on a grid.
/// @param heights  [ny * nx] [m]; overwritten
/// @param report   what the surface is like; NULL: it is not measured
lac_status lac_surface_generate(const lac_model *model, const lac_grid *grid, double *heights,
                                lac_surface_stats *report, lac_error *err);

/// The same in two steps: the rows of each rank, of which a source that does not make these alone
/// makes all on each; then what all of them are like.
/// @param heights  [rows of lac_strip_rows * nx]; of the second [ny * nx]
/// @param report   as from the first; NULL
lac_status lac_surface_share(const lac_model *model, const lac_grid *grid, lac_team *team,
                             double *heights, lac_surface_stats *report, lac_error *err);
lac_status lac_surface_look(const lac_model *model, const lac_grid *grid, const double *heights,
                            lac_surface_stats *report, lac_error *err);

/// rms slope between cells `lag` apart along x (or y); 0 where there are none.
double lac_rms_slope(const lac_grid *grid, const double *heights, bool along_x, size_t lag);

/// Measures a height field, its mean and, unless periodic, its mean plane taken off:
/// docs/theory/surface.md, Measures. @param known  where the spectrum is a power law narrows the
/// wavelengths fitted; NULL
/// @source Tse & Cruden (1979), doi 10.1016/0148-9062(79)90241-9
lac_status lac_surface_measure(const lac_grid *grid, const double *heights,
                               const lac_wave_range *known, lac_surface_measures *out,
                               lac_error *err);

/// Reads measured heights; what the file holds tells its format (docs/surfaces-from-files.md).
/// @param map  set on success; the caller frees it
lac_status lac_height_map_read(const char *path, lac_height_map **map, lac_error *err);
void lac_height_map_free(lac_height_map *map);
