// SPDX-License-Identifier: GPL-3.0-or-later
// The fractal measures of a contact, as tables: boxes, clusters, resolutions and specimens, and
// what was fitted to them.
#include "data/describe.h"
#include "scene/internal.h"

#define CONTACT const lac_scene_contact *c = of
#define BOXES const lac_box_count *b = &((const lac_scene_contact *)of)->boxes
#define SCALING const lac_scaling *s = &((const lac_scene_contact *)of)->fractal.scaling
#define RESOLUTION \
    SCALING;       \
    const lac_resolution *r = &s->at[at[0]]

static const char *fractal_unit(const lac_scene_contact *c, const char *format,
                                char room[LAC_TEXT_ROOM])
{
    (void)snprintf(room, LAC_TEXT_ROOM, "%s%.3f", format, c->fractal.scaling.dimension);
    return c->fractal.scaled ? room : NULL;
}

// The fit with no resolution left out.
static double fitted_whole(const lac_scene_contact *c, size_t offset)
{
    lac_scaling whole = c->fractal.scaling;
    if (!c->fractal.scaled) {
        return NAN;
    }
    lac_scaling_fit(&whole, 0);
    return *(const double *)(const void *)((const char *)&whole + offset);
}

LAC_GETTER(bool, counted, CONTACT, c->counted)
LAC_GETTER(bool, ranged, BOXES,
           counted(of, at) && b->fit_first < b->sizes && b->fit_last < b->sizes)
LAC_GETTER(double, fit_smallest, BOXES, ranged(of, at) ? b->side[b->fit_first] : NAN)
LAC_GETTER(double, fit_largest, BOXES, ranged(of, at) ? b->side[b->fit_last] : NAN)
LAC_GETTER(double, box_weak, BOXES, counted(of, at) && (b->few_cells || b->dense))
LAC_GETTER(double, box_side_m, CONTACT, c->boxes.side[at[0]] * c->grid.dx)
LAC_GETTER(double, box_local, BOXES, at[0] + 1 < b->sizes ? -b->slope[at[0]] : (double)NAN)
LAC_GETTER(double, box_local_json, BOXES, -b->slope[at[0]])
LAC_GETTER(double, box_fitted, BOXES, at[0] >= b->fit_first && at[0] <= b->fit_last)

LAC_GETTER(double, octave_size, (void)of, ldexp(1, (int)at[0]))

LAC_GETTER(bool, scaled, CONTACT, c->fractal.scaled)

LAC_GETTER(double, weak, SCALING, scaled(of, at) && s->few_cells)
LAC_TEXT_GETTER(none, CONTACT, c->fractal.scaled ? NULL : c->fractal.why.message)
LAC_TEXT_GETTER(coarsening, SCALING, lac_coarsening_text(s->coarsening))

LAC_TEXT_GETTER(area_unit, CONTACT, fractal_unit(c, "m^", room))
LAC_TEXT_GETTER(pressure_unit, CONTACT, fractal_unit(c, "N m^-", room))

LAC_GETTER(double, all, CONTACT, fitted_whole(c, offsetof(lac_scaling, dimension)))
LAC_GETTER(double, all_error, CONTACT, fitted_whole(c, offsetof(lac_scaling, error)))
LAC_GETTER(double, all_regression, CONTACT,
           fitted_whole(c, offsetof(lac_scaling, regression_error)))

LAC_GETTER(double, area_fraction, RESOLUTION,
           r->area / lac_grid_area(&((const lac_scene_contact *)of)->grid))
LAC_GETTER(double, resolution_load, RESOLUTION, r->pressure * r->area)
LAC_GETTER(double, kappa, RESOLUTION,
           r->area * r->slope * ((const lac_scene_contact *)of)->e_star / s->load)
LAC_GETTER(double, fitted, SCALING, at[0] + s->left_out < s->n)

// One value as an attribute and in JSON.
#define ONE(name_, json_, getter, ...)                           \
    {                                                            \
        .name = (name_), .json = (json_), G(getter), __VA_ARGS__ \
    }
// The same of one that is held.
#define HELD(name_, json_, kind, field, ...)                                                    \
    {                                                                                           \
        .name = (name_), .json = (json_), LAC_HELD(kind, lac_scene_contact, field), __VA_ARGS__ \
    }
#define WHOLE .flags = LAC_WHOLE
#define TRUTH .flags = LAC_TRUTH

static const lac_variable of_count[] = {
    HELD("d_box", "d_box", REAL, boxes.dimension),
    HELD("d_box_error", "d_box_error", REAL, boxes.error),
    HELD("d_box_regression_error", "d_box_regression_error", REAL, boxes.regression_error),
    ONE("d_box_fit_smallest_cells", NULL, fit_smallest),
    ONE("d_box_fit_largest_cells", NULL, fit_largest),
    HELD("d_box_few_cells", NULL, BOOL, boxes.few_cells, WHOLE),
    HELD("d_box_dense", NULL, BOOL, boxes.dense, WHOLE),
};
static const lac_variable of_blocks[] = {
    HELD("d_blocks", "d_blocks", REAL, blocks.dimension),
    ONE(NULL, "d_box_weak", box_weak, TRUTH),
};

#define FITTED(name, kind, field, ...) HELD(name, NULL, kind, fractal.scaling.field, __VA_ARGS__)
#define SCALED(name, field) HELD(name, name, REAL, fractal.scaling.field)
static const lac_variable of_fit[] = {
    SCALED("delta_s", dimension),
    SCALED("delta_s_error", error),
    SCALED("delta_s_regression_error", regression_error),
    ONE(NULL, "delta_s_all", all),
    ONE(NULL, "delta_s_all_error", all_error),
    ONE(NULL, "delta_s_all_regression_error", all_regression),
    SCALED("delta_s_from_slopes", from_slopes),
    FITTED("delta_s_few_cells", BOOL, few_cells, WHOLE),
    FITTED("delta_s_left_out", COUNT, left_out, WHOLE),
};
static const lac_variable of_weakness[] = {
    ONE(NULL, "delta_s_weak", weak, TRUTH),
    {.json = "delta_s_none", T(none)},
};
static const lac_variable of_coarsening[] = {
    {.name = "coarsening", .json = "coarsening", T(coarsening)}};
static const lac_variable of_stiffness[] = {HELD(NULL, "e_star_Pa", REAL, e_star)};
static const lac_variable of_scaling[] = {
    HELD("load_N", "load_N", REAL, fractal.scaling.load, .unit = "N"),
    SCALED("load_spread", load_error),
    SCALED("fractal_pressure", fractal_pressure),
    {.name = "fractal_pressure_unit", .json = "fractal_pressure_unit", T(pressure_unit)},
    SCALED("fractal_area", fractal_area),
    {.name = "fractal_area_unit", .json = "fractal_area_unit", T(area_unit)},
};

// Of each box side and octave.
#define BOX(field) LAC_HELD(REAL, lac_scene_contact, boxes.field)
#define CLUSTER(field) LAC_HELD(COUNT, lac_scene_contact, fractal.clusters.field)
static const lac_variable of_clusters[] = {
    HELD("clusters", "clusters/number", COUNT, fractal.clusters.n, WHOLE),
    HELD("largest_cluster_cells", "clusters/largest_cells", COUNT, fractal.clusters.largest, WHOLE),
    HELD("largest_cluster_extent_m", "clusters/largest_extent_m", REAL,
         fractal.clusters.largest_extent, .unit = "m"),
    HELD("widest_cluster_m", "clusters/widest_m", REAL, fractal.clusters.widest, .unit = "m"),
    HELD("mean_cluster_cells", "clusters/mean_cells", REAL, fractal.clusters.mean),
    HELD("weighted_mean_cluster_cells", "clusters/weighted_mean_cells", REAL,
         fractal.clusters.weighted),
    LAC_ROW("cluster_size", "cluster_octave", NULL, "cells of a cluster, least of its octave",
            .json = "clusters/octaves[]/from_cells", G(octave_size),
            .comment = "an octave reaches from this size to one less than twice this size"),
    LAC_ROW("cluster_count", "cluster_octave", NULL,
            "clusters of contact cells in an octave of sizes", .json = "clusters/octaves[]/number",
            CLUSTER(count), .coordinates = "cluster_size",
            .comment = "cells that touch by a side or a corner are of one cluster"),
    LAC_ROW("cluster_cells", "cluster_octave", NULL,
            "contact cells in the clusters of an octave of sizes",
            .json = "clusters/octaves[]/cells", CLUSTER(cells_of), .coordinates = "cluster_size"),
};

#define RES(json_) .json = "resolutions[]/" json_
#define ALSO(json, getter, ...)                                 \
    {                                                           \
        RES(json), .dims = "resolution", G(getter), __VA_ARGS__ \
    }
#define AT(name, unit, long_name, json, kind, field, ...)                                  \
    LAC_ROW(name, NULL, unit, long_name, RES(json), LAC_HELD(kind, lac_resolution, field), \
            __VA_ARGS__)
static const lac_variable of_resolutions[] = {
    AT("resolution", "m", "side of a cell, coarsest first", "cell_size_m", REAL, cell),
    AT("resolution_area", "m2", "real area of contact", "area_m2", REAL, area),
    AT("resolution_pressure", "Pa", "mean pressure over the real area of contact", "pressure_Pa",
       REAL, pressure),
    AT("resolution_cells", NULL, "cells in contact", "cells", COUNT, cells),
    AT("resolution_slope", NULL, "rms slope of the heights between neighbouring cells", "rms_slope",
       REAL, slope),
    AT("resolution_local_dimension", NULL, "Delta_S between this resolution and the next finer one",
       "local_delta_s", REAL, local, .flags = LAC_MISSING),
};
static const lac_variable of_places[] = {
    ALSO("area_fraction", area_fraction),
    ALSO("load_N", resolution_load),
    ALSO("kappa", kappa),
    ALSO("fitted", fitted, TRUTH),
    LAC_ROW("box_side", "box", NULL, "side of a box, in cells", .json = "boxes[]/side_cells",
            BOX(side)),
    {.json = "boxes[]/side_m", .dims = "box", G(box_side_m)},
    LAC_ROW("box_count", "box", NULL, "boxes that hold a contact cell", .json = "boxes[]/count",
            BOX(count), .coordinates = "box_side",
            .comment = "mean over random origins of the boxes"),
    LAC_ROW("box_minimum", "box", NULL, "least number of boxes that hold a contact cell",
            .json = "boxes[]/minimum", BOX(minimum), .coordinates = "box_side",
            .comment = "least over random origins of the boxes"),
    LAC_ROW("box_local_dimension", "box", NULL,
            "box-counting dimension between this side and the next larger one", G(box_local),
            .coordinates = "box_side", .flags = LAC_MISSING),
    {.json = "boxes[]/local_d_box", .dims = "box", G(box_local_json)},
    {.json = "boxes[]/fitted", .dims = "box", G(box_fitted), TRUTH},
};

#define SPECIMEN(name, unit, long_name, json_, field, ...)               \
    LAC_ROW(name, NULL, unit, long_name, .json = "size_effect[]/" json_, \
            LAC_HELD(REAL, lac_size_strength, field), __VA_ARGS__)
#define OF_SIZE .coordinates = "specimen_size"
static const lac_variable of_specimens[] = {
    SPECIMEN("specimen_size", "m", "side of a specimen", "size_m", size),
    SPECIMEN("specimen_strength", NULL, "strength of a specimen over that of this interface",
             "relative_strength", relative, OF_SIZE, .comment = "(b / b_0)^(delta_s - 2)"),
    SPECIMEN("specimen_strength_low", NULL, "lower of its values at delta_s a standard error away",
             "relative_strength_low", low, OF_SIZE),
    SPECIMEN("specimen_strength_high", NULL,
             "higher of its values at delta_s a standard error away", "relative_strength_high",
             high, OF_SIZE),
    SPECIMEN("specimen_pressure", "Pa",
             "apparent mean pressure of a specimen at the same fractal pressure",
             "mean_pressure_Pa", pressure, OF_SIZE),
};

#define PUBLISHED(json_, kind, field) \
    LAC_JSON("published_exponents[]/" json_, kind, lac_size_exponent, field)
static const lac_variable of_exponents[] = {
    PUBLISHED("quantity", TEXT, quantity),   PUBLISHED("exponent_low", REAL, low),
    PUBLISHED("exponent_high", REAL, high),  PUBLISHED("shortest_m", REAL, shortest_m),
    PUBLISHED("longest_m", REAL, longest_m), PUBLISHED("stated", BOOL, stated),
    PUBLISHED("source", TEXT, source),
};

static size_t published(void)
{
    size_t n = 0;
    while (lac_size_exponent_get(n) != NULL) {
        n++;
    }
    return n;
}

lac_status lac_describe_dimension(const lac_scene_contact *c, lac_dataset *d, lac_error *err)
{
    const lac_laid laid[] = {{LAC_VARIABLES(of_count, "", 0), c->counted ? c : NULL},
                             {LAC_VARIABLES(of_blocks, "", 0), c}};
    return lac_dataset_add(d, laid, 2, err);
}

lac_status lac_describe_fractal(const lac_scene_contact *c, lac_dataset *d, lac_error *err)
{
    const lac_scene_fractal *f = &c->fractal;
    const lac_scene_contact *scaled = f->scaled ? c : NULL;
    const lac_extent dims[] = {{"box", c->counted ? c->boxes.sizes : 0},
                               {"cluster_octave", f->clustered ? f->clusters.octaves : 0},
                               {"resolution", f->scaled ? f->scaling.n : 0},
                               {"specimen", f->sizes},
                               {"exponent", f->sizes > 0 ? published() : 0}};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_fit, "", 0), scaled},
        {LAC_VARIABLES(of_weakness, "", 0), c},
        {LAC_VARIABLES(of_coarsening, "", 0), scaled},
        {LAC_VARIABLES(of_stiffness, "", 0), c},
        {LAC_VARIABLES(of_scaling, "", 0), scaled},
        {LAC_VARIABLES(of_resolutions, "resolution", sizeof(lac_resolution)), f->scaling.at},
        {LAC_VARIABLES(of_places, "", 0), c},
        {LAC_VARIABLES(of_clusters, "", 0), f->clustered ? c : NULL},
        {LAC_VARIABLES(of_specimens, "specimen", sizeof(lac_size_strength)), f->size},
        {LAC_VARIABLES(of_exponents, "exponent", sizeof(lac_size_exponent)),
         lac_size_exponent_get(0)},
    };
    lac_status status = lac_dataset_dims(d, dims, sizeof dims / sizeof *dims, err);
    return status == LAC_OK ? lac_dataset_add(d, laid, sizeof laid / sizeof *laid, err) : status;
}
