// SPDX-License-Identifier: GPL-3.0-or-later
// The file of a cascade: what slips at which load, level by level, and what was fitted to it.
#include "lacuna/store_rg.h"

#include <math.h>
#include <stdlib.h>

#include "store/nc.h"

enum { BETA, LOAD, LEVEL, CELL, INTERFACE, DIMENSIONS };

typedef struct writer {
    const lac_nc *file;
    const lac_rg_view *view;
    const lac_rg_result *first; // all have the same loads and levels
    int dim[DIMENSIONS];
    size_t length[DIMENSIONS];
    double *row; // [all lengths multiplied that any variable has]
} writer;

// One variable: its dimensions, -1 after the last, and where row k of its betas comes from.
typedef struct variable {
    lac_nc_var var;
    int dims[3];
    void (*fill)(const writer *w, const lac_rg_result *r, size_t k, double *out);
} variable;

static void copy(size_t n, const double *from, double *out)
{
    for (size_t i = 0; i < n; i++) {
        out[i] = isfinite(from[i]) ? from[i] : NC_FILL_DOUBLE;
    }
}

#define SCALAR(name, expression)                                                     \
    static void name(const writer *w, const lac_rg_result *r, size_t k, double *out) \
    {                                                                                \
        (void)w, (void)r, (void)k;                                                   \
        double value = (expression);                                                 \
        copy(1, &value, out);                                                        \
    }
SCALAR(fill_beta, w->view->beta[k])
SCALAR(fill_critical, r->critical)
SCALAR(fill_critical_error, r->critical_error)
SCALAR(fill_critical_sd, r->critical_sd)
SCALAR(fill_place_sd, r->place_sd)
SCALAR(fill_fixed_point, r->fixed_point.value)
SCALAR(fill_fixed_point_error, r->fixed_point.error)
SCALAR(fill_lambda, r->lambda.value)
SCALAR(fill_lambda_error, r->lambda.error)
SCALAR(fill_fixed_point_low, r->fixed_point.low)
SCALAR(fill_fixed_point_high, r->fixed_point.high)
SCALAR(fill_lambda_low, r->lambda.low)
SCALAR(fill_lambda_high, r->lambda.high)
SCALAR(fill_nu_low, r->nu.low)
SCALAR(fill_nu_high, r->nu.high)
SCALAR(fill_intercept, r->map.g)
SCALAR(fill_nu, r->nu.value)
SCALAR(fill_nu_error, r->nu.error)
SCALAR(fill_cluster_exponent, r->cluster_law.exponent)
SCALAR(fill_cluster_power_law, r->cluster_law.holds ? 1.0 : 0.0)

#define ARRAY(name, field, dimension)                                                \
    static void name(const writer *w, const lac_rg_result *r, size_t k, double *out) \
    {                                                                                \
        (void)k;                                                                     \
        copy(w->length[dimension], r->field, out);                                   \
    }
ARRAY(fill_load, load, LOAD)
ARRAY(fill_blocks, blocks, LEVEL)
ARRAY(fill_cluster, cluster, LOAD)
ARRAY(fill_block, block, LOAD)
ARRAY(fill_slipping, slipping, LEVEL)
ARRAY(fill_cell_load, cell_load, CELL)
ARRAY(fill_begin, begin, LEVEL)
ARRAY(fill_own_level, own_level, CELL)
ARRAY(fill_of_joint, of_joint, INTERFACE)

#define LISTED(name, field)                                                          \
    static void name(const writer *w, const lac_rg_result *r, size_t k, double *out) \
    {                                                                                \
        (void)r, (void)k;                                                            \
        for (size_t i = 0; i < w->length[INTERFACE]; i++) {                          \
            copy(1, &w->view->interface[i].field, &out[i]);                          \
        }                                                                            \
    }
LISTED(fill_mean_pressure, pressure)
LISTED(fill_contact_fraction, contact_fraction)
LISTED(fill_dimension, dimension)
LISTED(fill_dyadic, dyadic)

static void fill_seed(const writer *w, const lac_rg_result *r, size_t k, double *out)
{
    (void)r, (void)k;
    for (size_t i = 0; i < w->length[INTERFACE]; i++) {
        int64_t seed = w->view->interface[i].seed;
        out[i] = seed != INT64_MIN ? (double)seed : NC_FILL_DOUBLE;
    }
}

static void fill_fraction(const writer *w, const lac_rg_result *r, size_t k, double *out)
{
    (void)k;
    copy(w->length[LOAD] * w->length[LEVEL], r->fraction, out);
}

static void fill_block_size(const writer *w, const lac_rg_result *r, size_t k, double *out)
{
    (void)r, (void)k;
    for (size_t level = 0; level < w->length[LEVEL]; level++) {
        out[level] = ldexp(fmax(w->view->grid->dx, w->view->grid->dy), (int)level);
    }
}

static void fill_strength(const writer *w, const lac_rg_result *r, size_t k, double *out)
{
    (void)k;
    for (size_t level = 0; level < w->length[LEVEL]; level++) {
        out[level] = r->size[level].blocks > 0 ? r->size[level].strength : NC_FILL_DOUBLE;
    }
}

static void fill_x(const writer *w, const lac_rg_result *r, size_t k, double *out)
{
    (void)r, (void)k;
    const lac_domain *d = w->view->domain;
    for (size_t i = 0; i < d->n; i++) {
        out[i] = ((double)(d->index[i] % d->grid.nx) + 0.5) * d->grid.dx;
    }
}

static void fill_y(const writer *w, const lac_rg_result *r, size_t k, double *out)
{
    (void)r, (void)k;
    const lac_domain *d = w->view->domain;
    for (size_t i = 0; i < d->n; i++) {
        out[i] = ((double)(d->index[i] / d->grid.nx) + 0.5) * d->grid.dy;
    }
}

static void fill_pressure(const writer *w, const lac_rg_result *r, size_t k, double *out)
{
    (void)r, (void)k;
    copy(w->length[CELL], w->view->domain->pressure, out);
}

// All are doubles; what has no unit here has unit 1.
static const variable variables[] = {
    {{.name = "beta",
      .long_name = "part of the strength left after slipping",
      .comment = "a mean over the cells where it follows from the friction law"},
     {BETA, -1},
     fill_beta},
    {{.name = "load", .long_name = "shear force over f P"}, {LOAD, -1}, fill_load},
    {{.name = "block_size", .unit = "m", .long_name = "side of a block"},
     {LEVEL, -1},
     fill_block_size},
    {{.name = "n_tot",
      .long_name = "blocks that hold a contact cell",
      .comment = "mean over the ensemble"},
     {LEVEL, -1},
     fill_blocks},
    {{.name = "q_crit_over_q_nom",
      .long_name = "critical shear force over f P",
      .coordinates = "beta"},
     {BETA, -1},
     fill_critical},
    {{.name = "q_crit_error",
      .long_name = "standard error of its mean",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_critical_error},
    {{.name = "q_crit_sd",
      .long_name = "its standard deviation among interfaces",
      .comment = "among places of the blocks where there is one interface",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_critical_sd},
    {{.name = "q_crit_sd_of_places",
      .long_name = "its standard deviation among places of the blocks",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_place_sd},
    {{.name = "critical_fraction",
      .long_name = "unstable fixed point of the map of slipped fractions",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_fixed_point},
    {{.name = "critical_fraction_error",
      .long_name = "its standard error, by bootstrap",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_fixed_point_error},
    {{.name = "critical_fraction_low",
      .long_name = "lower end of its 95 % interval, by bootstrap",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_fixed_point_low},
    {{.name = "critical_fraction_high",
      .long_name = "upper end of its 95 % interval, by bootstrap",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_fixed_point_high},
    {{.name = "map_slope",
      .long_name = "slope of the map in logits",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_lambda},
    {{.name = "map_slope_error",
      .long_name = "its standard error, by bootstrap",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_lambda_error},
    {{.name = "map_slope_low",
      .long_name = "lower end of its 95 % interval, by bootstrap",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_lambda_low},
    {{.name = "map_slope_high",
      .long_name = "upper end of its 95 % interval, by bootstrap",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_lambda_high},
    {{.name = "map_intercept",
      .long_name = "intercept of the map in logits",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_intercept},
    {{.name = "exponent",
      .long_name = "exponent of the correlation length, ln 2 / ln slope",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_nu},
    {{.name = "exponent_error",
      .long_name = "its standard error, by bootstrap",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_nu_error},
    {{.name = "exponent_low",
      .long_name = "lower end of its 95 % interval, by bootstrap",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_nu_low},
    {{.name = "exponent_high",
      .long_name = "upper end of its 95 % interval, by bootstrap",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_nu_high},
    {{.name = "cluster_exponent",
      .long_name = "slope of ln cluster_length on -ln(1 - Q/Q_crit)",
      .fill = true,
      .coordinates = "beta"},
     {BETA, -1},
     fill_cluster_exponent},
    {{.name = "cluster_power_law",
      .long_name = "1 where cluster_length follows a power law",
      .coordinates = "beta"},
     {BETA, -1},
     fill_cluster_power_law},
    {{.name = "slip_fraction",
      .long_name = "blocks that slip by themselves, of all",
      .comment = "mean over the ensemble",
      .coordinates = "beta load block_size"},
     {BETA, LOAD, LEVEL},
     fill_fraction},
    {{.name = "cluster_length",
      .unit = "m",
      .long_name = "longer side of the largest cluster of slipped cells",
      .coordinates = "beta load"},
     {BETA, LOAD, -1},
     fill_cluster},
    {{.name = "block_length",
      .unit = "m",
      .long_name = "side of the largest block slipped as a whole",
      .coordinates = "beta load"},
     {BETA, LOAD, -1},
     fill_block},
    {{.name = "n_slip_at_q_crit",
      .long_name = "blocks that slip by themselves just before the joint slides",
      .coordinates = "beta block_size"},
     {BETA, LEVEL, -1},
     fill_slipping},
    {{.name = "strength",
      .unit = "Pa",
      .long_name = "shear force on a block when it slips by itself, over its nominal area",
      .coordinates = "beta block_size",
      .fill = true},
     {BETA, LEVEL, -1},
     fill_strength},
    {{.name = "x", .unit = "m", .long_name = "position of the cell along x"}, {CELL, -1}, fill_x},
    {{.name = "y", .unit = "m", .long_name = "position of the cell along y"}, {CELL, -1}, fill_y},
    {{.name = "pressure",
      .unit = "Pa",
      .long_name = "normal contact pressure",
      .comment = "of the last interface of the ensemble; of a run's snapshot less pore pressure",
      .coordinates = "x y"},
     {CELL, -1},
     fill_pressure},
    {{.name = "slip_load",
      .long_name = "shear force over f P at which the cell has slipped",
      .fill = true,
      .comment = "of the last interface of the ensemble",
      .coordinates = "beta x y"},
     {BETA, CELL, -1},
     fill_cell_load},
    {{.name = "interface_seed",
      .long_name = "seed of each interface of the ensemble",
      .fill = true},
     {INTERFACE, -1},
     fill_seed},
    {{.name = "mean_pressure",
      .unit = "Pa",
      .long_name = "normal force over the nominal area",
      .comment = "as given, or as the dimension asks for",
      .coordinates = "interface_seed"},
     {INTERFACE, -1},
     fill_mean_pressure},
    {{.name = "contact_fraction",
      .long_name = "part of the cells in contact",
      .coordinates = "interface_seed"},
     {INTERFACE, -1},
     fill_contact_fraction},
    {{.name = "d_box",
      .long_name = "box-counting dimension",
      .comment = "from random origins, sides of two cells to an eighth of the grid",
      .fill = true,
      .coordinates = "interface_seed"},
     {INTERFACE, -1},
     fill_dimension},
    {{.name = "d_blocks",
      .long_name = "dimension of the grid's own blocks of all levels",
      .fill = true,
      .coordinates = "interface_seed"},
     {INTERFACE, -1},
     fill_dyadic},
    {{.name = "q_crit_of_interface",
      .long_name = "critical shear force over f P of each interface",
      .comment = "mean over the places of the blocks",
      .coordinates = "beta interface_seed"},
     {BETA, INTERFACE, -1},
     fill_of_joint},
};

// Only where the cells come from a file.
static const variable of_origin[] = {
    {{.name = "n_slip_now",
      .long_name = "blocks that slip by themselves at the snapshot",
      .comment = "mean over the places of the blocks; of the last level: the share of places at "
                 "which the joint slides",
      .coordinates = "beta block_size"},
     {BETA, LEVEL, -1},
     fill_begin},
    {{.name = "own_level",
      .long_name =
          "level of the largest block around the cell that slips by itself at the snapshot",
      .fill = true,
      .coordinates = "beta x y"},
     {BETA, CELL, -1},
     fill_own_level},
};

static lac_status put(writer *w, const variable *v, lac_error *err)
{
    int dims[3];
    int rank = 0;
    size_t row = 1;
    const bool each = v->dims[0] == BETA;
    for (; rank < 3 && v->dims[rank] >= 0; rank++) {
        dims[rank] = w->dim[v->dims[rank]];
        row *= v->dims[rank] == BETA ? 1 : w->length[v->dims[rank]];
    }
    lac_nc_var var = v->var;
    var.type = NC_DOUBLE;
    var.unit = var.unit != NULL ? var.unit : "1";
    for (size_t k = 0; k < (each ? w->view->betas : 1); k++) {
        v->fill(w, w->view->result[k], k, w->row + k * row);
    }
    return lac_nc_reals(w->file, &var, rank, dims, 0, w->row, NULL, err);
}

static lac_status put_origin(const lac_nc *file, const lac_rg_origin *o, lac_error *err)
{
    const struct {
        const char *name;
        double value;
    } reals[] = {
        {"snapshot_time_s", o->time},   {"q_over_q_nom", o->load},
        {"effective_share", o->share},  {"weakest_gap_Pa", o->weakest_gap},
        {"weakest_x_m", o->weakest[0]}, {"weakest_y_m", o->weakest[1]},
    };
    lac_status status;
    LAC_TRY(lac_nc_text(file, NC_GLOBAL, "source_file", o->file, err));
    LAC_TRY(lac_nc_text(file, NC_GLOBAL, "source_status", o->status, err));
    LAC_TRY(lac_nc_integer(file, NC_GLOBAL, "snapshot", (long long)o->snapshot, err));
    for (size_t i = 0; i < sizeof reals / sizeof *reals; i++) {
        if (isfinite(reals[i].value)) {
            LAC_TRY(lac_nc_real(file, NC_GLOBAL, reals[i].name, reals[i].value, err));
        }
    }
out:
    return status;
}

static lac_status put_all(const lac_nc *file, void *context, lac_error *err)
{
    writer *w = context;
    w->file = file;
    static const char *const names[DIMENSIONS] = {"beta", "load", "level", "cell", "interface"};
    lac_status status = LAC_OK;
    for (int i = 0; i < DIMENSIONS; i++) {
        LAC_TRY(lac_nc_dim(w->file, names[i], w->length[i], &w->dim[i], err));
    }
    for (size_t i = 0; i < sizeof variables / sizeof variables[0]; i++) {
        LAC_TRY(put(w, &variables[i], err));
    }
    for (size_t i = 0; w->view->origin != NULL && i < sizeof of_origin / sizeof *of_origin; i++) {
        LAC_TRY(put(w, &of_origin[i], err));
    }
    LAC_TRY(w->view->origin != NULL ? put_origin(w->file, w->view->origin, err) : LAC_OK);
    LAC_TRY(lac_nc_text(w->file, NC_GLOBAL, "rule", w->view->rule, err));
    LAC_TRY(lac_nc_text(w->file, NC_GLOBAL, "field", w->view->field, err));
    LAC_TRY(lac_nc_real(w->file, NC_GLOBAL, "q_nom_Pa", w->view->strength, err));
    LAC_TRY(lac_nc_integer(w->file, NC_GLOBAL, "interfaces", (long long)w->first->joints, err));
    LAC_TRY(lac_nc_integer(w->file, NC_GLOBAL, "places", (long long)w->first->places, err));
    LAC_TRY(lac_nc_text(w->file, NC_GLOBAL, "status", "complete", err));
out:
    return status;
}

lac_status lac_store_rg(const char *path, bool force, const lac_provenance *provenance,
                        const lac_rg_view *view, lac_error *err)
{
    static const char *const summary =
        "Cascade of slip over the blocks of a rough rock joint: what slips at which shear force, "
        "scale by scale, and the critical force.";
    const lac_rg_result *first = view->result[0];
    writer w = {
        .view = view,
        .first = first,
        .length = {view->betas, first->loads, first->levels + 1, view->domain->n, first->joints}};
    size_t inner = w.length[LOAD] * w.length[LEVEL];
    inner = inner > w.length[CELL] ? inner : w.length[CELL];
    inner = inner > w.length[INTERFACE] ? inner : w.length[INTERFACE];
    w.row = malloc(view->betas * inner * sizeof *w.row);
    lac_status status = w.row != NULL
                            ? lac_nc_write(path, force, provenance, summary, put_all, &w, err)
                            : lac_fail_memory(err);
    free(w.row);
    return status;
}
