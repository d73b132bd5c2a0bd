// SPDX-License-Identifier: GPL-3.0-or-later
// Measured heights on the grid of the interface: of one file, or of one a face.
#include "base/rows.h"
#include "base/units.h"
#include "surface/fit.h"

// A file on its way onto the grid.
typedef struct face {
    lac_height_map *map;
    lac_file_report report;
    lac_placement place;
    bool spaced; // by the file itself
} face;

static lac_status scale_of(const char *path, const lac_units *units, const char *what,
                           const char *unit, double *scale, lac_error *err)
{
    double offset = 0.0;
    *scale = 1.0;
    if (unit == NULL) {
        return LAC_OK;
    }
    lac_status status = lac_units_convert(units, unit, "m", scale, &offset, err);
    return lac_fail_within(err, status, "%s: %s: unit \"%s\"", path, what, unit);
}

static lac_status scale_heights(const char *path, double scale, lac_height_map *map, lac_error *err)
{
    for (size_t i = 0; i < map->nx * map->ny; i++) {
        map->heights[i] *= scale;
        LAC_FAIL_IF(fabs(map->heights[i]) > 1e9, err, LAC_EINPUT,
                    "%s: a height of %g m in column %zu of row %zu (from the smallest y); must be "
                    "within 1e9 m: a mark for no data, or a wrong unit?",
                    path, map->heights[i], i % map->nx + 1, i / map->nx + 1);
    }
    return LAC_OK;
}

static const char *unit_of(const char *in_file, const char *in_case)
{
    return in_file[0] != '\0' ? in_file : in_case;
}

// Heights and lengths in metres, by what the file says, else the case.
static lac_status convert(const lac_surface_file *p, face *f, lac_error *err)
{
    lac_status status;
    lac_units *units = NULL;
    lac_height_map *map = f->map;
    lac_file_report *report = &f->report;
    double scale = 1.0;
    const char *vertical = unit_of(map->height_unit, p->unit);
    const char *lateral = unit_of(map->lateral_unit, p->lateral_unit);
    lateral = lateral != NULL ? lateral : vertical;
    f->spaced = !isnan(map->dx) || !isnan(map->dy);
    LAC_TRY(lac_units_create(&units, err));
    LAC_TRY(scale_of(report->path, units, "heights", vertical, &scale, err));
    LAC_TRY(scale_heights(report->path, scale, map, err));
    if (f->spaced) {
        LAC_TRY(scale_of(report->path, units, "spacing", lateral, &scale, err));
    }
    map->dx = f->spaced ? map->dx * scale : p->spacing;
    map->dy = f->spaced ? map->dy * scale : p->spacing;
    map->x *= scale;
    map->y *= scale;
    (void)snprintf(report->height_unit, sizeof report->height_unit, "%s",
                   vertical != NULL ? vertical : "m");
    (void)snprintf(report->lateral_unit, sizeof report->lateral_unit, "%s",
                   f->spaced && lateral != NULL ? lateral : "m");
out:
    lac_units_free(units);
    return status;
}

// Lengths and heights in metres; what has no height filled as `nodata` says.
static lac_status read_face(const lac_surface_file *p, const char *path, face *f, lac_error *err)
{
    f->report.path = path;
    LAC_TRY_RETURN(lac_height_map_read(path, &f->map, err));
    f->report.format = f->map->format;
    f->report.nx = f->map->nx;
    f->report.ny = f->map->ny;
    f->report.masked = f->map->masked;
    LAC_TRY_RETURN(convert(p, f, err));
    f->report.dx = f->map->dx;
    f->report.dy = f->map->dy;
    if (f->map->masked > 0 && p->nodata == LAC_NODATA_MEAN) {
        lac_fill_mean(f->map);
    }
    const bool nearest = f->map->masked > 0 && p->nodata == LAC_NODATA_NEAREST;
    return nearest ? lac_fill_nearest(f->map, err) : LAC_OK;
}

// A unit of the case that each file contradicts.
static lac_status check_unit(const face *upper, const char *key, const char *said, const char *own,
                             const char *lower, lac_error *err)
{
    LAC_FAIL_IF(said != NULL && own[0] != '\0' && strcmp(own, said) != 0 && lower[0] != '\0' &&
                    strcmp(lower, said) != 0,
                err, LAC_EINPUT,
                "%s: the file says %s, but %s is %s; leave %s out, or correct the file",
                upper->report.path, own, key, said, key);
    return LAC_OK;
}

static lac_status check_said(const lac_surface_file *p, const face *upper, const face *lower,
                             lac_error *err)
{
    const lac_height_map *one = upper->map, *two = lower->map != NULL ? lower->map : one;
    LAC_TRY_RETURN(check_unit(upper, "unit", p->unit, one->height_unit, two->height_unit, err));
    LAC_TRY_RETURN(check_unit(upper, "lateral_unit", p->lateral_unit, one->lateral_unit,
                              two->lateral_unit, err));
    LAC_FAIL_IF(!isnan(p->spacing) && upper->spaced && (lower->spaced || lower->map == NULL), err,
                LAC_EINPUT, "%s: the file has a spacing of its own, %g by %g m; leave spacing out",
                upper->report.path, one->dx, one->dy);
    return LAC_OK;
}

static size_t count_missing(const double *heights, size_t n)
{
    size_t missing = 0;
    for (size_t i = 0; i < n; i++) {
        missing += isnan(heights[i]) ? 1 : 0;
    }
    return missing;
}

// Gaps stay NaN only with `nodata: mask`.
static lac_status lay(face *f, const lac_grid *grid, int nodata, double *heights, lac_error *err)
{
    f->report.fit = f->place.fit;
    LAC_TRY_RETURN(lac_fit_map(f->report.path, f->map, &f->place, grid, heights, err));
    const size_t n = lac_grid_cells(grid), missing = count_missing(heights, n);
    LAC_FAIL_IF(nodata != LAC_NODATA_MASK && missing > 0, err, LAC_EINPUT,
                "%s: %zu of the %zu cells of the interface have no height (no data in %zu samples "
                "of the file); choose a smaller interface, or use `nodata: nearest`, `mean` or "
                "`mask`",
                f->report.path, missing, n, f->map->masked);
    return LAC_OK;
}

// One direction of a face, for its place beside the other.
typedef struct span {
    size_t samples;
    double spacing, first; ///< [m]; first is NaN where the file says none
} span;

static span span_of(const face *f, const lac_grid *grid, bool along_x)
{
    const lac_height_map *map = f->map;
    size_t n = along_x ? map->nx : map->ny;
    double spacing = along_x ? lac_fit_spacing(map->dx, n, f->place.fit, grid->nx, grid->dx)
                             : lac_fit_spacing(map->dy, n, f->place.fit, grid->ny, grid->dy);
    return (span){n, spacing, along_x ? map->x : map->y};
}

// The sample of the lower face at the centre of the interface: where the upper face's is by the
// coordinates of both, or as far from the middle of the one face as of the other.
static double lower_centre(span upper, span lower, double centre, bool shared, bool mirrored)
{
    if (shared && !isnan(upper.first) && !isnan(lower.first)) {
        return (upper.first + centre * upper.spacing - lower.first) / lower.spacing;
    }
    double aside = (centre - 0.5 * (double)(upper.samples - 1)) * upper.spacing / lower.spacing;
    return 0.5 * (double)(lower.samples - 1) + (mirrored ? -aside : aside);
}

static lac_status read_lower(const lac_surface_file *p, const lac_grid *grid, const face *upper,
                             face *f, lac_error *err)
{
    LAC_TRY_RETURN(read_face(p, p->lower, f, err));
    bool shared = p->lower_view == LAC_LOWER_SAME_FRAME;
    f->place = (lac_placement){.fit = p->fit,
                               .mirror_x = p->lower_view == LAC_LOWER_MIRROR_X,
                               .mirror_y = p->lower_view == LAC_LOWER_MIRROR_Y};
    span x = span_of(f, grid, true);
    f->place.centre_x = lower_centre(span_of(upper, grid, true), x, upper->place.centre_x, shared,
                                     f->place.mirror_x);
    f->place.centre_y = lower_centre(span_of(upper, grid, false), span_of(f, grid, false),
                                     upper->place.centre_y, shared, f->place.mirror_y);
    // moved by the offset, the face shows at a place what lay as much before it
    f->place.centre_x += (f->place.mirror_x ? p->offset : -p->offset) / x.spacing;
    return LAC_OK;
}

// Heights of one face become those of both, peaks of the composite touching first.
static lac_status add_lower(const lac_surface_file *p, const lac_grid *grid, face *lower,
                            double *heights, lac_error *err)
{
    lac_status status;
    size_t n = lac_grid_cells(grid);
    double *other = malloc(n * sizeof *other);
    LAC_FAIL_MEMORY_IF(other == NULL, err);
    LAC_TRY(lay(lower, grid, p->nodata, other, err));
    for (size_t i = 0; i < n; i++) {
        bool same = p->lower_view == LAC_LOWER_SAME_FRAME;
        heights[i] = other[i] + (same ? -heights[i] : heights[i]);
    }
out:
    free(other);
    return status;
}

// What the heights look like before anything is taken off: all of a file, or what lies on the
// interface where there are two, or gaps in one.
static lac_status measure(const face *one, const lac_grid *grid, const double *heights, bool two,
                          lac_surface_stats *report, lac_error *err)
{
    const lac_height_map *map = one->map;
    lac_grid samples = *grid;
    samples.periodic = false;
    report->measured = two ? LAC_MEASURED_COMPOSITE : LAC_MEASURED_PART;
    if (!two && (map->masked == 0 || count_missing(map->heights, map->nx * map->ny) == 0)) {
        samples.nx = map->nx;
        samples.ny = map->ny;
        samples.dx = span_of(one, grid, true).spacing;
        samples.dy = span_of(one, grid, false).spacing;
        heights = map->heights;
        report->measured = LAC_MEASURED_FILE;
    }
    return lac_surface_measure(&samples, heights, NULL, &report->measures, err);
}

// Cells without a height get that of the nearest one, so that the rest can be measured and
// detrended.
// @param masked  [ny * nx] which they were; NULL where none is, else the caller frees it
static lac_status bridge(const char *path, const lac_grid *grid, double *heights, uint8_t **masked,
                         lac_error *err)
{
    size_t n = lac_grid_cells(grid);
    lac_height_map map = {
        .nx = grid->nx, .ny = grid->ny, .heights = heights, .masked = count_missing(heights, n)};
    *masked = NULL;
    if (map.masked == 0) {
        return LAC_OK;
    }
    LAC_FAIL_IF(map.masked == n, err, LAC_EINPUT, "%s: no cell of the interface has a height",
                path);
    uint8_t *which = malloc(n);
    LAC_FAIL_MEMORY_IF(which == NULL, err);
    for (size_t i = 0; i < n; i++) {
        which[i] = (uint8_t)(isnan(heights[i]) ? 1 : 0);
    }
    *masked = which;
    return lac_fill_nearest(&map, err);
}

// Masked cells come to lie below the deepest by as much as the heights span: they touch last.
static void sink(const lac_grid *grid, const uint8_t *masked, double *heights)
{
    double lowest = INFINITY, highest = -INFINITY;
    for (size_t i = 0; i < lac_grid_cells(grid); i++) {
        lowest = fmin(lowest, heights[i]);
        highest = fmax(highest, heights[i]);
    }
    for (size_t i = 0; masked != NULL && i < lac_grid_cells(grid); i++) {
        heights[i] = masked[i] != 0 ? lowest - (highest - lowest) : heights[i];
    }
}

static lac_status generate(const void *params, const lac_grid *grid, lac_team *team,
                           double *heights, lac_surface_stats *report, lac_error *err)
{
    const lac_surface_file *p = params;
    face faces[2] = {{0}, {0}};
    uint8_t *masked = NULL;
    lac_status status;
    (void)team;
    LAC_TRY(read_face(p, p->path, &faces[0], err));
    faces[0].place = lac_place_centred(faces[0].map, p->fit, grid);
    LAC_TRY(p->lower != NULL ? read_lower(p, grid, &faces[0], &faces[1], err) : LAC_OK);
    LAC_TRY(check_said(p, &faces[0], &faces[1], err));
    LAC_TRY(lay(&faces[0], grid, p->nodata, heights, err));
    if (p->lower != NULL) {
        LAC_TRY(add_lower(p, grid, &faces[1], heights, err));
    }
    LAC_TRY(bridge(p->path, grid, heights, &masked, err));
    if (report != NULL) {
        LAC_TRY(measure(&faces[0], grid, heights, p->lower != NULL, report, err));
        report->files = p->lower != NULL ? 2 : 1;
        report->file[0] = faces[0].report;
        report->file[1] = faces[1].report;
    }
    lac_detrend(p->detrend, grid, heights);
    lac_taper(p->taper, grid, heights);
    if (p->taper > 0.0 && p->detrend != LAC_DETREND_NONE) {
        lac_detrend(LAC_DETREND_MEAN, grid, heights);
    }
    sink(grid, masked, heights);
out:
    free(masked);
    lac_height_map_free(faces[0].map);
    lac_height_map_free(faces[1].map);
    return status;
}

static const char *fault(const void *params)
{
    const lac_surface_file *p = params;
    const bool said = p->offset != 0.0 || p->lower_view != LAC_LOWER_SAME_FRAME;
    return p->lower == NULL && said ? "offset and lower_view need lower, the file of the lower face"
                                    : NULL;
}

#define FIELD(name) offsetof(lac_surface_file, name)

static const char *const nodata_words[] = {"refuse", "nearest", "mean", "mask", NULL};
static const char *const fit_words[] = {"crop", "pad", "resample", NULL};
static const char *const detrend_words[] = {"none", "mean", "plane", NULL};
static const char *const view_words[] = {"same-frame", "mirror-x", "mirror-y", NULL};

static const lac_param file_params[] = {
    LAC_PATH("path", FIELD(path), 0,
             ".npy, ESRI ASCII grid .asc, gridded .xyz, Gwyddion .gsf, ISO 25178-71 .sdf or "
             "netCDF; known by its content: the composite heights, or with `lower` the upper face"),
    LAC_TEXT("unit", FIELD(unit), LAC_OPTIONAL,
             "of the heights where the file says none; m if absent"),
    LAC_TEXT("lateral_unit", FIELD(lateral_unit), LAC_OPTIONAL,
             "of the file's spacing where the file says none; that of the heights if absent"),
    LAC_REAL("spacing", "m", FIELD(spacing), NAN, 0, 1e9, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "of the samples where the file says none; if absent they are cells of the interface, "
             "or with `fit: resample` cover it"),
    LAC_CHOICE("nodata", FIELD(nodata), LAC_NODATA_REFUSE, nodata_words, 0,
               "samples without a height: refuse them, take the nearest height or the mean of all, "
               "or mask their cells, which then touch last"),
    LAC_CHOICE(
        "fit", FIELD(fit), LAC_FIT_CROP, fit_words, 0,
        "the middle of the file on the cells as they are (crop), its edges going on where it is "
        "smaller (pad), or interpolated bilinearly at the centres of the cells (resample)"),
    LAC_CHOICE("detrend", FIELD(detrend), LAC_DETREND_MEAN, detrend_words, 0,
               "taken off the heights of the interface: nothing, their mean, or the plane of least "
               "squares"),
    LAC_REAL(
        "taper", "1", FIELD(taper), 0, 0, 0.5, 0,
        "part of each side over which the heights fade to zero at either end, after detrending"),
    LAC_PATH("lower", FIELD(lower), LAC_OPTIONAL,
             "the lower face, in any of the formats; `path` is then the upper one"),
    LAC_CHOICE(
        "lower_view", FIELD(lower_view), LAC_LOWER_SAME_FRAME, view_words, 0,
        "how `lower` was measured: in the frame of the upper face, heights upwards in both "
        "(same-frame: composite = lower - upper), or each face looked at, peaks up, the joint "
        "opened like a book so that x or y runs backwards in `lower` (composite = upper + lower)"),
    LAC_REAL("offset", "m", FIELD(offset), 0, -1e9, 1e9, 0,
             "by which the lower face is moved along x, the direction of slip"),
};

const lac_surface_source lac_surface_from_file = {
    .info = LAC_ABOUT("file", "measured heights, read from a file, or from two, one a face",
                      "docs/surfaces-from-files.md", LAC_ROWS(file_params, lac_surface_file),
                      .validate = fault),
    .generate = generate,
};
