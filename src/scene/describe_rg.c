// SPDX-License-Identifier: GPL-3.0-or-later
// What a cascade came to, as tables: the variables of its file and the members of its JSON.
#include "data/describe.h"
#include "scene/scene_rg.h"

// Of the outcome o, its study s; of beta at[0] the result r, of which the first has what is common.
#define O const lac_rg_outcome *o = of
#define S const lac_scene_rg *s = ((const lac_rg_outcome *)of)->rg
#define R const lac_rg_result *r = ((const lac_rg_outcome *)of)->rg->result[at[0]]
#define FIRST const lac_rg_result *r = ((const lac_rg_outcome *)of)->rg->result[0]
#define BETA(name, expression) LAC_GETTER(double, name, R, expression)

const char *lac_scene_rg_rule(const lac_case *c) { return lac_rg_rule_names[c->rg.rule]; }

const char *lac_scene_rg_field(const lac_case *c) { return lac_rg_field_names[c->rg.field]; }

LAC_TEXT_GETTER(rule, O, lac_scene_rg_rule(o->source))
LAC_TEXT_GETTER(field, O, lac_scene_rg_field(o->source))
LAC_TEXT_GETTER(status, O; (void)o, "complete")

LAC_GETTER(double, beta, S, s->beta[at[0]])
LAC_GETTER(double, first_beta, S, s->beta[0])
LAC_GETTER(double, first_critical, FIRST, r->critical)
LAC_GETTER(double, first_fixed_point, FIRST, r->fit.fixed_point.value)
LAC_GETTER(double, places, FIRST, (double)r->places)
LAC_GETTER(double, joints, FIRST, (double)r->joints)
LAC_GETTER(double, load, FIRST, r->load[at[0]])
LAC_GETTER(double, blocks, FIRST, r->blocks[at[0]])
BETA(strength, r->size[at[1]].blocks > 0 ? r->size[at[1]].strength : NAN)
BETA(spread, r->size[at[1]].blocks > 0 ? r->size[at[1]].spread : NAN)

static double block_side(const lac_scene_rg *s, size_t level)
{
    return ldexp(fmax(s->grid.dx, s->grid.dy), (int)level);
}

size_t lac_scene_rg_first(const lac_scene_rg *rg, const lac_rg_result *r, double place[2])
{
    size_t first = SIZE_MAX;
    for (size_t i = 0; i < r->last_n; i++) {
        const bool sooner = first == SIZE_MAX || r->cell_load[i] < r->cell_load[first];
        const bool weaker = !sooner && r->cell_load[i] == r->cell_load[first] &&
                            rg->domain->pressure[i] < rg->domain->pressure[first];
        first = !isnan(r->cell_load[i]) && (sooner || weaker) ? i : first;
    }
    place[0] = first != SIZE_MAX ? lac_grid_x(&rg->grid, rg->domain->index[first]) : NAN;
    place[1] = first != SIZE_MAX ? lac_grid_y(&rg->grid, rg->domain->index[first]) : NAN;
    return first;
}

// The cell that slips first: 0 its x, 1 its y, 2 its load.
static double first_cell(const void *of, size_t k, int what)
{
    const lac_scene_rg *s = ((const lac_rg_outcome *)of)->rg;
    double place[2];
    const size_t cell = lac_scene_rg_first(s, s->result[k], place);
    return what < 2 ? place[what] : cell != SIZE_MAX ? s->result[k]->cell_load[cell] : NAN;
}

LAC_GETTER(double, first_x, , first_cell(of, at[0], 0))
LAC_GETTER(double, first_y, , first_cell(of, at[0], 1))
LAC_GETTER(double, first_load, , first_cell(of, at[0], 2))
LAC_GETTER(double, distance, S, s->result[at[0]]->critical - s->now.load)
LAC_GETTER(double, block_size, S, block_side(s, at[0]))
LAC_GETTER(double, level_size, S, block_side(s, at[1]))
LAC_GETTER(double, level, (void)of, (double)at[1])
LAC_GETTER(double, x, S, lac_grid_x(&s->grid, s->domain->index[at[0]]))
LAC_GETTER(double, y, S, lac_grid_y(&s->grid, s->domain->index[at[0]]))
LAC_GETTER(double, pressure, S, s->domain->pressure[at[0]])

LAC_GETTER(double, nominal, S, s->strength)

LAC_GETTER(double, slides_now, const lac_rg_result *r = of, r->begin[r->levels])

#define AND(row) .coordinates = (row)
#define MAYBE .flags = LAC_MISSING
#define H(kind, field) LAC_HELD(kind, lac_rg_result, field)
#define RESULT(path) .json = "results[]/" path
#define IN_LEVELS(path) .json = "results[]/levels[]/" path
// A number of each beta, in file and JSON; in JSON alone.
#define EACH(name, path, field, long_name, ...) \
    LAC_ROW(name, NULL, NULL, long_name, RESULT(path), H(REAL, field), AND("beta"), __VA_ARGS__)
#define ALSO(path, kind, field) LAC_JSON("results[]/" path, kind, lac_rg_result, field)
// The same of an estimate by bootstrap. A member of a struct cannot stand in parentheses.
// NOLINTBEGIN(bugprone-macro-parentheses)
#define BOOTSTRAPPED(name, path, field, long_name)                                          \
    EACH(name, path, field.value, long_name, MAYBE),                                        \
        EACH(name "_error", path "_error", field.error, "its standard error, by bootstrap", \
             MAYBE),                                                                        \
        EACH(name "_low", path "_interval95", field.low,                                    \
             "lower end of its 95 % interval, by bootstrap", MAYBE),                        \
        EACH(name "_high", path "_interval95", field.high,                                  \
             "upper end of its 95 % interval, by bootstrap", MAYBE)
// NOLINTEND(bugprone-macro-parentheses)
// In JSON alone, by a getter.
#define JSON(path, dims_, getter) LAC_JSON_BY("results[]/" path, dims_, getter)

static const lac_variable of_all[] = {
    {.name = "rule", .json = "rule", T(rule)},
    {.name = "field", .json = "field", T(field)},
    {.json = "beta", G(first_beta)},
    {.json = "q_crit_over_q_nom", G(first_critical)},
    {.json = "critical_fraction", G(first_fixed_point)},
    {.name = "interfaces", .json = "interfaces", G(joints), .flags = LAC_WHOLE},
    {.name = "places", .json = "places", G(places), .flags = LAC_WHOLE},
    {.name = "status", T(status)},
};

static const lac_variable of_mean[] = {
    {.json = "mean_pressure_Pa", LAC_HELD(REAL, lac_rg_interface, pressure)},
    {.json = "contact_fraction", LAC_HELD(REAL, lac_rg_interface, contact_fraction)},
    {.json = "d_box", LAC_HELD(REAL, lac_rg_interface, dimension)},
    {.json = "d_blocks", LAC_HELD(REAL, lac_rg_interface, dyadic)},
};

static const lac_variable of_joint[] = {
    {.name = "q_nom_Pa", .unit = "Pa", .json = "q_nom_Pa", G(nominal)},
    {RESULT("rule"), .dims = "beta", T(rule)},
    {RESULT("field"), .dims = "beta", T(field)},
    LAC_ROW("beta", "beta", NULL, "part of the strength left after slipping", RESULT("beta"),
            G(beta), .comment = "a mean over the cells where it follows from the friction law"),
    LAC_ROW("load", "load", NULL, "shear force over f P", G(load)),
    LAC_ROW("block_size", "level", "m", "side of a block", G(block_size)),
    LAC_ROW("n_tot", "level", NULL, "blocks that hold a contact cell", G(blocks),
            .comment = "mean over the ensemble"),
    JSON("levels[]/level", "beta level", level),
    JSON("levels[]/block_size_m", "beta level", level_size),
    LAC_ROW("strength", "beta level", "Pa",
            "shear force on a block when it slips by itself, over its nominal area",
            IN_LEVELS("strength_Pa"), G(strength), AND("beta block_size"), MAYBE),
    JSON("levels[]/strength_spread_Pa", "beta level", spread),
    LAC_ROW("x", "cell", "m", "position of the cell along x", G(x)),
    LAC_ROW("y", "cell", "m", "position of the cell along y", G(y)),
    LAC_ROW("pressure", "cell", "Pa", "normal contact pressure", G(pressure), AND("x y"),
            .comment =
                "of the last interface of the ensemble; of a run's snapshot less pore pressure"),
    JSON("first_to_slip/x_m", "beta", first_x),
    JSON("first_to_slip/y_m", "beta", first_y),
    JSON("first_to_slip/q_over_q_nom", "beta", first_load),
};

static const lac_variable of_results[] = {
    EACH("q_crit_over_q_nom", "q_crit_over_q_nom", critical, "critical shear force over f P"),
    EACH("q_crit_error", "q_crit_error", critical_error, "standard error of its mean", MAYBE),
    EACH("q_crit_sd", "q_crit_sd", critical_sd, "its standard deviation among interfaces", MAYBE,
         .comment = "among places of the blocks where there is one interface"),
    EACH("q_crit_sd_of_places", "q_crit_sd_of_places", place_sd,
         "its standard deviation among places of the blocks", MAYBE),
    BOOTSTRAPPED("critical_fraction", "critical_fraction", fit.fixed_point,
                 "unstable fixed point of the map of slipped fractions"),
    BOOTSTRAPPED("map_slope", "lambda", fit.lambda, "slope of the map in logits"),
    LAC_ROW("map_intercept", NULL, NULL, "intercept of the map in logits", H(REAL, fit.map.g),
            AND("beta"), MAYBE),
    BOOTSTRAPPED("exponent", "exponent", fit.nu,
                 "exponent of the correlation length, ln 2 / ln slope"),
    ALSO("map_points", COUNT, fit.map.points),
    LAC_ROW("cluster_power_law", NULL, NULL, "1 where cluster_length follows a power law",
            RESULT("cluster_length/power_law"), H(BOOL, cluster_law.holds), AND("beta")),
    EACH("cluster_exponent", "cluster_length/exponent", cluster_law.exponent,
         "slope of ln cluster_length on -ln(1 - Q/Q_crit)", MAYBE),
    ALSO("cluster_length/exponent_error", REAL, cluster_law.error),
    ALSO("cluster_length/curvature_over_error", REAL, cluster_law.curvature),
    ALSO("block_length/power_law", BOOL, block_law.holds),
    ALSO("block_length/exponent", REAL, block_law.exponent),
    ALSO("block_length/exponent_error", REAL, block_law.error),
    ALSO("block_length/curvature_over_error", REAL, block_law.curvature),
    LAC_ROW("slip_fraction", "beta load level", NULL, "blocks that slip by themselves, of all",
            H(REALS, fraction), AND("beta load block_size"), .comment = "mean over the ensemble"),
    LAC_ROW("cluster_length", "beta load", "m",
            "longer side of the largest cluster of slipped cells", H(REALS, cluster),
            AND("beta load")),
    LAC_ROW("block_length", "beta load", "m", "side of the largest block slipped as a whole",
            H(REALS, block), AND("beta load")),
    {IN_LEVELS("n_tot"), .dims = "beta level", H(REALS, blocks)},
    LAC_ROW("n_slip_at_q_crit", "beta level", NULL,
            "blocks that slip by themselves just before the joint slides",
            IN_LEVELS("n_slip_at_q_crit"), H(REALS, slipping), AND("beta block_size")),
    LAC_ROW("slip_load", "beta cell", NULL, "shear force over f P at which the cell has slipped",
            H(REALS, cell_load), AND("beta x y"), MAYBE,
            .comment = "of the last interface of the ensemble"),
    LAC_ROW("q_crit_of_interface", "beta interface", NULL,
            "critical shear force over f P of each interface", RESULT("q_crit_of_interfaces[]"),
            H(REALS, of_joint), AND("beta interface_seed"),
            .comment = "mean over the places of the blocks"),
};

#define JOINT(name, unit, path, kind, field, long_name, ...)         \
    LAC_ROW(name, NULL, unit, long_name, .json = "ensemble[]/" path, \
            LAC_HELD(kind, lac_rg_interface, field), __VA_ARGS__)
static const lac_variable of_joints[] = {
    JOINT("interface_seed", NULL, "seed", INT64, seed, "seed of each interface of the ensemble",
          MAYBE),
    JOINT("mean_pressure", "Pa", "mean_pressure_Pa", REAL, pressure,
          "normal force over the nominal area", AND("interface_seed"),
          .comment = "as given, or as the dimension asks for"),
    JOINT("contact_fraction", NULL, "contact_fraction", REAL, contact_fraction,
          "part of the cells in contact", AND("interface_seed")),
    JOINT("d_box", NULL, "d_box", REAL, dimension, "box-counting dimension", AND("interface_seed"),
          MAYBE, .comment = "from random origins, sides of two cells to an eighth of the grid"),
    JOINT("d_blocks", NULL, "d_blocks", REAL, dyadic,
          "dimension of the grid's own blocks of all levels", AND("interface_seed"), MAYBE),
};

// Only where the cells come from a file.
static const lac_variable of_now[] = {
    LAC_ROW("n_slip_now", "beta level", NULL, "blocks that slip by themselves at the snapshot",
            IN_LEVELS("n_slip_now"), H(REALS, begin), AND("beta block_size"),
            .comment = "mean over the places of the blocks; of the last level: the share of places "
                       "at which the joint slides"),
    LAC_ROW("own_level", "beta cell", NULL,
            "level of the largest block around the cell that slips by itself at the snapshot",
            H(REALS, own_level), AND("beta x y"), MAYBE),
};
static const lac_variable of_distance[] = {JSON("distance_to_q_crit", "beta", distance)};
static const lac_variable of_slip_now[] = {
    JSON("slides_now", "beta", slides_now),
    {RESULT("cluster_length_now_m"), H(REALS, cluster)},
    {RESULT("block_length_now_m"), H(REALS, block)},
};

#define C(kind, field) LAC_HELD(kind, lac_stored_cells, field)
#define NOW(field) LAC_HELD(REAL, lac_scene_rg, now.field)
static const char *const kinds[] = {"run", "contact", "history"};
static const lac_variable of_file[] = {
    {.name = "source_file", .json = "source/file", LAC_HELD(TEXT, lac_rg_outcome, file)}};
static const lac_variable of_cells[] = {
    {.json = "source/kind", C(INT, kind), .names = kinds},
    {.name = "source_status", .json = "source/status", C(CHARS, status)},
    {.name = "snapshot", .json = "source/snapshot", C(COUNT, index), .flags = LAC_WHOLE},
    {.json = "source/snapshots", C(COUNT, snapshots)},
    {.name = "snapshot_time_s", .unit = "s", .json = "source/time_s", C(REAL, time)},
};
static const lac_variable of_weakest[] = {
    {.name = "q_over_q_nom", .json = "q_over_q_nom", NOW(load)},
    {.name = "effective_share", .json = "source/effective_share", NOW(share)},
    {.name = "weakest_x_m", .unit = "m", .json = "weakest/x_m", NOW(weakest[0])},
    {.name = "weakest_y_m", .unit = "m", .json = "weakest/y_m", NOW(weakest[1])},
    {.name = "weakest_gap_Pa", .unit = "Pa", .json = "weakest/gap_Pa", NOW(weakest_gap)},
};

lac_status lac_scene_rg_describe(const lac_rg_outcome *o, lac_dataset **out, lac_error *err)
{
    const lac_scene_rg *s = o->rg;
    const lac_rg_result *r = s->result[0];
    const lac_extent dims[] = {{"beta", s->betas},
                               {"load", r->loads},
                               {"level", r->levels + 1},
                               {"cell", s->domain->n},
                               {"interface", r->joints}};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_all, "", 0), o},
        {LAC_VARIABLES(of_mean, "", 0), &s->mean},
        {LAC_VARIABLES(of_joint, "", 0), o},
        {LAC_VARIABLES_OF_MANY(of_results, "beta"), s->result},
        {LAC_VARIABLES(of_joints, "interface", sizeof(lac_rg_interface)), s->interface},
        {LAC_VARIABLES_OF_MANY(of_now, "beta"), s->result},
        {LAC_VARIABLES(of_distance, "", 0), o},
        {LAC_VARIABLES_OF_MANY(of_slip_now, "beta"), s->result},
        {LAC_VARIABLES(of_file, "", 0), o},
        {LAC_VARIABLES(of_cells, "", 0), o->cells},
        {LAC_VARIABLES(of_weakest, "", 0), s},
    };
    const size_t tables = sizeof laid / sizeof *laid - (o->cells != NULL ? 0 : 6);
    lac_status status;
    LAC_TRY(lac_dataset_create("Cascade of slip over the blocks of a rough rock joint: what slips "
                               "at which shear force, scale by scale, and the critical force.",
                               out, err));
    LAC_TRY(lac_dataset_dims(*out, dims, sizeof dims / sizeof *dims, err));
    LAC_TRY(lac_dataset_add(*out, laid, tables, err));
out:
    LAC_MADE(status, out, lac_dataset_free);
}
