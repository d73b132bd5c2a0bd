// SPDX-License-Identifier: GPL-3.0-or-later
// What a run of slip in two directions puts out besides: components along x and y of what elsewhere
// are sizes, of the mean, of cells and at points.
#include "data/describe.h"
#include "run/describe.h"

#define PLACE const lac_run_place *p = of

// The k-th is along x where k is even, else along y; of slip, slip rate, and force or traction.
static double of_mean(const lac_observation *seen, size_t k)
{
    const double *const means[] = {seen->slip_along, seen->rate_along, seen->shear_along};
    return means[k / 2][k % 2];
}

static double of_point(const double *values, size_t point, size_t k)
{
    return values != NULL ? values[point * LAC_POINT_ALONG + k] : NAN;
}

LAC_GETTER(double, mean, PLACE, of_mean(&p->record.observation, at[1]))
LAC_GETTER(double, point, PLACE, of_point(p->record.observation.points_along, at[1], at[2]))

// What they are components of, in the order of lac_point_value.
static const struct {
    const char *name, *words, *unit;
    unsigned field;
} quantities[] = {
    {"slip", "slip", "m", LAC_FIELD_SLIP},
    {"slip_rate", "slip rate", "m s-1", LAC_FIELD_RATE},
    {"traction", "shear traction", "Pa", LAC_FIELD_TRACTION},
};

static const lac_variable over_time = {.dims = "time", G(mean), .flags = LAC_FILLED | LAC_ROUGH};
static const lac_variable over_points = {.dims = "time point",
                                         G(point),
                                         .coordinates = "point_name point_x point_y",
                                         .flags = LAC_FILLED | LAC_ROUGH};
static const lac_variable over_cells = {.dims = "snapshot cell",
                                        LAC_HELD(REALS, lac_run_place, snapshot.along[0]),
                                        .coordinates = "snapshot_time x y",
                                        .flags = LAC_FILLED | LAC_ROUGH | LAC_CELLS | LAC_LATE,
                                        .cell_measures = "area: cell_area"};

// The k-th component of what begins with a word; of the mean of the tractions the force.
static lac_status add(lac_dataset *d, const lac_run_place *p, const lac_variable *row,
                      const char *before, const char *where, size_t k, lac_error *err)
{
    char name[64], words[96];
    const bool force = row == &over_time && k / 2 == 2;
    const char axis = k % 2 == 0 ? 'x' : 'y';
    (void)snprintf(name, sizeof name, "%s%s_%c", before,
                   force ? "shear_force" : quantities[k / 2].name, axis);
    (void)snprintf(words, sizeof words, "%s%s along %c",
                   force ? "shear force Q" : quantities[k / 2].words, where, axis);
    const lac_named named = {.name = name,
                             .long_name = words,
                             .unit = force ? "N" : quantities[k / 2].unit,
                             .comment = "component of the variable without _x or _y, its size",
                             .which = k,
                             .cell_methods = (row->flags & LAC_CELLS) != 0 ? NULL
                                             : row == &over_time && !force
                                                 ? "time: point area: mean"
                                                 : "time: point"};
    return lac_dataset_add_named(d, row, &named, p, err);
}

lac_status lac_run_describe_components(lac_dataset *d, const lac_run_place *p, lac_error *err)
{
    const lac_run_output *of = &p->of;
    lac_status status = LAC_OK;
    for (size_t k = 0; of->vector && k < LAC_POINT_ALONG && status == LAC_OK; k++) {
        status = add(d, p, &over_time, "", " of the joint", k, err);
        if (status == LAC_OK && of->points != NULL) {
            status = add(d, p, &over_points, "point_", " at the point", k, err);
        }
        if (status == LAC_OK && of->domain != NULL && (of->fields & quantities[k / 2].field) != 0) {
            lac_variable row = over_cells;
            row.offset += k * sizeof *p->snapshot.along;
            status = add(d, p, &row, "cell_", " of each contact cell", k, err);
        }
    }
    return status;
}
