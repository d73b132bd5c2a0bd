// SPDX-License-Identifier: GPL-3.0-or-later
// The fractal measures of a contact, as tables: boxes, clusters, resolutions and specimens, and
// what was fitted to them.
#include <math.h>
#include <stdio.h>

#include "data/describe.h"
#include "scene/internal.h"

#define CONTACT const lac_scene_contact *c = of
#define BOXES const lac_box_count *b = &((const lac_scene_contact *)of)->boxes
#define CLUSTERS const lac_cluster_summary *u = &((const lac_scene_contact *)of)->fractal.clusters
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
    const bool fits = c->fractal.scaled && lac_scaling_fit(&whole, 0, NULL) == LAC_OK;
    return fits ? *(const double *)(const void *)((const char *)&whole + offset) : NAN;
}

LAC_GETTER(bool, counted, CONTACT, c->counted)
LAC_GETTER(double, d_box, BOXES, counted(of, at) ? b->dimension : NAN)
LAC_GETTER(double, d_box_error, BOXES, counted(of, at) ? b->error : NAN)
LAC_GETTER(double, d_box_regression, BOXES, counted(of, at) ? b->regression_error : NAN)
LAC_GETTER(bool, ranged, BOXES,
           counted(of, at) && b->fit_first < b->sizes && b->fit_last < b->sizes)
LAC_GETTER(double, fit_smallest, BOXES, ranged(of, at) ? b->side[b->fit_first] : NAN)
LAC_GETTER(double, fit_largest, BOXES, ranged(of, at) ? b->side[b->fit_last] : NAN)
LAC_GETTER(double, box_few, BOXES, counted(of, at) ? b->few_cells : NAN)
LAC_GETTER(double, box_dense, BOXES, counted(of, at) ? b->dense : NAN)
LAC_GETTER(double, box_weak, BOXES, counted(of, at) && (b->few_cells || b->dense))
LAC_GETTER(double, box_side, BOXES, b->side[at[0]])
LAC_GETTER(double, box_side_m, CONTACT, c->boxes.side[at[0]] * c->grid.dx)
LAC_GETTER(double, box_mean, BOXES, b->count[at[0]])
LAC_GETTER(double, box_minimum, BOXES, b->minimum[at[0]])
LAC_GETTER(double, box_local, BOXES, at[0] + 1 < b->sizes ? -b->slope[at[0]] : (double)NAN)
LAC_GETTER(double, box_local_json, BOXES, -b->slope[at[0]])
LAC_GETTER(double, box_fitted, BOXES, at[0] >= b->fit_first && at[0] <= b->fit_last)
LAC_GETTER(double, d_blocks, CONTACT, c->blocks.dimension)

LAC_GETTER(bool, clustered, CONTACT, c->fractal.clustered)
LAC_GETTER(bool, octaves, CLUSTERS, clustered(of, at) && u->octaves > 0)
LAC_GETTER(double, cluster_number, CLUSTERS, (double)u->n)
LAC_GETTER(double, cluster_largest, CLUSTERS, (double)u->largest)
LAC_GETTER(double, cluster_extent, CLUSTERS, u->largest_extent)
LAC_GETTER(double, cluster_widest, CLUSTERS, u->widest)
LAC_GETTER(double, cluster_mean, CLUSTERS, u->mean)
LAC_GETTER(double, cluster_weighted, CLUSTERS, u->weighted)
LAC_GETTER(double, octave_size, (void)of, ldexp(1, (int)at[0]))
LAC_GETTER(double, octave_count, CLUSTERS, (double)u->count[at[0]])
LAC_GETTER(double, octave_cells, CLUSTERS, (double)u->cells_of[at[0]])

LAC_GETTER(bool, scaled, CONTACT, c->fractal.scaled)
LAC_GETTER(bool, stored, SCALING, scaled(of, at) && s->n > 0)

// A number of the scaling, where there is one.
#define SCALED(name, expression) \
    LAC_GETTER(double, name, SCALING, scaled(of, at) ? (double)(expression) : NAN)
SCALED(delta_s, s->dimension)
SCALED(delta_s_error, s->error)
SCALED(delta_s_regression, s->regression_error)
SCALED(smooth, s->smooth)
SCALED(from_slopes, s->from_slopes)
SCALED(load, s->load)
SCALED(load_error, s->load_error)
SCALED(fractal_area, s->fractal_area)
SCALED(fractal_pressure, s->fractal_pressure)
SCALED(few_cells, s->few_cells)
SCALED(left_out, s->left_out)
LAC_GETTER(double, weak, SCALING, scaled(of, at) && s->few_cells)
LAC_GETTER(double, e_star, CONTACT, c->e_star)
LAC_TEXT_GETTER(none, CONTACT, c->fractal.scaled ? NULL : c->fractal.why.message)
LAC_TEXT_GETTER(coarsening, CONTACT,
                c->fractal.scaled ? lac_coarsening_text(c->fractal.scaling.coarsening) : NULL)

LAC_TEXT_GETTER(area_unit, CONTACT, fractal_unit(c, "m^", room))
LAC_TEXT_GETTER(pressure_unit, CONTACT, fractal_unit(c, "N m^-", room))

LAC_GETTER(double, all, CONTACT, fitted_whole(c, offsetof(lac_scaling, dimension)))
LAC_GETTER(double, all_error, CONTACT, fitted_whole(c, offsetof(lac_scaling, error)))
LAC_GETTER(double, all_regression, CONTACT,
           fitted_whole(c, offsetof(lac_scaling, regression_error)))

LAC_GETTER(double, area_fraction, RESOLUTION,
           r->area / lac_grid_area(&((const lac_scene_contact *)of)->grid))
LAC_GETTER(double, resolution_load, RESOLUTION, r->pressure * r->area)
LAC_GETTER(double, smooth_area, RESOLUTION, lac_smooth_area(r))
LAC_GETTER(double, kappa, RESOLUTION,
           r->area * r->slope * ((const lac_scene_contact *)of)->e_star / s->load)
LAC_GETTER(double, fitted, SCALING, at[0] + s->left_out < s->n)

#define PUBLISHED \
    (void)of;     \
    const lac_size_exponent *x = lac_size_exponent_at(at[0])
LAC_TEXT_GETTER(exponent_of, PUBLISHED, x->quantity)
LAC_TEXT_GETTER(exponent_source, PUBLISHED, x->source)
LAC_GETTER(double, exponent_low, PUBLISHED, x->low)
LAC_GETTER(double, exponent_high, PUBLISHED, x->high)
LAC_GETTER(double, exponent_shortest, PUBLISHED, x->shortest_m)
LAC_GETTER(double, exponent_longest, PUBLISHED, x->longest_m)
LAC_GETTER(double, exponent_stated, PUBLISHED, x->stated)

#define G(getter) .value = (getter)
#define T(getter) .text = (getter)
// One value as an attribute and in JSON.
#define ONE(name_, json_, getter, ...)                           \
    {                                                            \
        .name = (name_), .json = (json_), G(getter), __VA_ARGS__ \
    }
#define WHOLE .flags = LAC_WHOLE
#define TRUTH .flags = LAC_TRUTH

static const lac_variable of_dimension[] = {
    ONE("d_box", "d_box", d_box),
    ONE("d_box_error", "d_box_error", d_box_error),
    ONE("d_box_regression_error", "d_box_regression_error", d_box_regression),
    ONE("d_box_fit_smallest_cells", NULL, fit_smallest),
    ONE("d_box_fit_largest_cells", NULL, fit_largest),
    ONE("d_box_few_cells", NULL, box_few, WHOLE),
    ONE("d_box_dense", NULL, box_dense, WHOLE),
    ONE("d_blocks", "d_blocks", d_blocks),
    ONE(NULL, "d_box_weak", box_weak, TRUTH),
};

static const lac_variable of_scaling[] = {
    ONE("delta_s", "delta_s", delta_s),
    ONE("delta_s_error", "delta_s_error", delta_s_error),
    ONE("delta_s_regression_error", "delta_s_regression_error", delta_s_regression),
    ONE(NULL, "delta_s_all", all),
    ONE(NULL, "delta_s_all_error", all_error),
    ONE(NULL, "delta_s_all_regression_error", all_regression),
    ONE("delta_s_smooth", "delta_s_smooth", smooth),
    ONE("delta_s_from_slopes", "delta_s_from_slopes", from_slopes),
    ONE("delta_s_few_cells", NULL, few_cells, WHOLE),
    ONE("delta_s_left_out", NULL, left_out, WHOLE),
    ONE(NULL, "delta_s_weak", weak, TRUTH),
    {.json = "delta_s_none", T(none)},
    {.name = "coarsening", .json = "coarsening", T(coarsening)},
    ONE(NULL, "e_star_Pa", e_star),
    ONE("load_N", "load_N", load),
    ONE("load_spread", "load_spread", load_error),
    ONE("fractal_pressure", "fractal_pressure", fractal_pressure),
    {.name = "fractal_pressure_unit", .json = "fractal_pressure_unit", T(pressure_unit)},
    ONE("fractal_area", "fractal_area", fractal_area),
    {.name = "fractal_area_unit", .json = "fractal_area_unit", T(area_unit)},
};

static const lac_variable of_boxes[] = {
    LAC_ROW("box_side", "box", NULL, "side of a box, in cells", .json = "boxes[]/side_cells",
            G(box_side)),
    {.json = "boxes[]/side_m", .dims = "box", G(box_side_m)},
    LAC_ROW("box_count", "box", NULL, "boxes that hold a contact cell", .json = "boxes[]/count",
            G(box_mean), .coordinates = "box_side",
            .comment = "mean over random origins of the boxes"),
    LAC_ROW("box_minimum", "box", NULL, "least number of boxes that hold a contact cell",
            .json = "boxes[]/minimum", G(box_minimum), .coordinates = "box_side",
            .comment = "least over random origins of the boxes"),
    LAC_ROW("box_local_dimension", "box", NULL,
            "box-counting dimension between this side and the next larger one", G(box_local),
            .coordinates = "box_side", .flags = LAC_MISSING),
    {.json = "boxes[]/local_d_box", .dims = "box", G(box_local_json)},
    {.json = "boxes[]/fitted", .dims = "box", G(box_fitted), TRUTH},
};

#define CLUSTER(name, json, getter, ...) \
    ONE(name, "clusters/" json, getter, .has = clustered, __VA_ARGS__)
static const lac_variable of_clusters[] = {
    CLUSTER("clusters", "number", cluster_number, WHOLE),
    CLUSTER("largest_cluster_cells", "largest_cells", cluster_largest, WHOLE),
    CLUSTER("largest_cluster_extent_m", "largest_extent_m", cluster_extent),
    CLUSTER("widest_cluster_m", "widest_m", cluster_widest),
    CLUSTER("mean_cluster_cells", "mean_cells", cluster_mean),
    CLUSTER("weighted_mean_cluster_cells", "weighted_mean_cells", cluster_weighted),
    LAC_ROW("cluster_size", "cluster_octave", NULL, "cells of a cluster, least of its octave",
            .json = "clusters/octaves[]/from_cells", G(octave_size),
            .comment = "an octave reaches from this size to one less than twice this size"),
    LAC_ROW("cluster_count", "cluster_octave", NULL,
            "clusters of contact cells in an octave of sizes", .json = "clusters/octaves[]/number",
            G(octave_count), .coordinates = "cluster_size",
            .comment = "cells that touch by a side or a corner are of one cluster"),
    LAC_ROW("cluster_cells", "cluster_octave", NULL,
            "contact cells in the clusters of an octave of sizes",
            .json = "clusters/octaves[]/cells", G(octave_cells), .coordinates = "cluster_size"),
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
    AT("resolution_boundary", "m", "length of the sides of cells that part contact from none",
       "boundary_m", REAL, boundary),
    AT("resolution_slope", NULL, "rms slope of the heights between neighbouring cells", "rms_slope",
       REAL, slope),
    AT("resolution_local_dimension", NULL, "Delta_S between this resolution and the next finer one",
       "local_delta_s", REAL, local, .flags = LAC_MISSING),
};
static const lac_variable beside_resolutions[] = {
    ALSO("area_fraction", area_fraction), ALSO("load_N", resolution_load),
    ALSO("smooth_area_m2", smooth_area),  ALSO("kappa", kappa),
    ALSO("fitted", fitted, TRUTH),
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

static const lac_variable of_exponents[] = {
    {.json = "published_exponents[]/quantity", T(exponent_of)},
    {.json = "published_exponents[]/exponent_low", G(exponent_low)},
    {.json = "published_exponents[]/exponent_high", G(exponent_high)},
    {.json = "published_exponents[]/shortest_m", G(exponent_shortest)},
    {.json = "published_exponents[]/longest_m", G(exponent_longest)},
    {.json = "published_exponents[]/stated", G(exponent_stated), TRUTH},
    {.json = "published_exponents[]/source", T(exponent_source)},
};

static size_t published(void)
{
    size_t n = 0;
    while (lac_size_exponent_at(n) != NULL) {
        n++;
    }
    return n;
}

lac_status lac_describe_dimension(const lac_scene_contact *c, lac_dataset *d, lac_error *err)
{
    const lac_laid laid = {LAC_VARIABLES(of_dimension, "", 0), c};
    return lac_dataset_add(d, &laid, 1, err);
}

lac_status lac_describe_fractal(const lac_scene_contact *c, lac_dataset *d, lac_error *err)
{
    const lac_scene_fractal *f = &c->fractal;
    const size_t none[] = {0};
    const lac_extent dims[] = {{"box", c->counted ? c->boxes.sizes : 0},
                               {"cluster_octave", octaves(c, none) ? f->clusters.octaves : 0},
                               {"resolution", stored(c, none) ? f->scaling.n : 0},
                               {"specimen", f->sizes},
                               {"exponent", f->sizes > 0 ? published() : 0}};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_scaling, "", 0), c},
        {LAC_VARIABLES(of_resolutions, "resolution", sizeof(lac_resolution)), f->scaling.at},
        {LAC_VARIABLES(beside_resolutions, "", 0), c},
        {LAC_VARIABLES(of_boxes, "", 0), c},
        {LAC_VARIABLES(of_clusters, "", 0), c},
        {LAC_VARIABLES(of_specimens, "specimen", sizeof(lac_size_strength)), f->size},
        {LAC_VARIABLES(of_exponents, "exponent", 0), c},
    };
    lac_status status = lac_dataset_dims(d, dims, sizeof dims / sizeof *dims, err);
    return status == LAC_OK ? lac_dataset_add(d, laid, sizeof laid / sizeof *laid, err) : status;
}
