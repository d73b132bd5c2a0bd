// SPDX-License-Identifier: GPL-3.0-or-later
// load.history: reading its steps, and what is wrong with them taken one after the other.
#include "case/sections.h"

#define STEP(name) offsetof(lac_history_step, name)

const lac_param lac_step_rows[LAC_STEP_ROWS] = {
    LAC_REAL("pressure", "Pa", STEP(pressure), NAN, 0, 1e15, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "mean normal stress over the nominal area; as before if absent"),
    LAC_REAL("ratio_x", "1", STEP(ratio[0]), NAN, -1, 1, LAC_OPTIONAL,
             "shear load along x as part of f P, what friction holds; of ratio, shear and shift at "
             "most one along each axis"),
    LAC_REAL("ratio_y", "1", STEP(ratio[1]), NAN, -1, 1, LAC_OPTIONAL, "the same along y"),
    LAC_REAL("shear_x", "Pa", STEP(shear[0]), NAN, -1e15, 1e15, LAC_OPTIONAL,
             "mean shear traction along x over the nominal area"),
    LAC_REAL("shear_y", "Pa", STEP(shear[1]), NAN, -1e15, 1e15, LAC_OPTIONAL, "the same along y"),
    LAC_REAL("shift_x", "m", STEP(shift[0]), NAN, -1e9, 1e9, LAC_OPTIONAL,
             "shift of one body against the other along x since the start"),
    LAC_REAL("shift_y", "m", STEP(shift[1]), NAN, -1e9, 1e9, LAC_OPTIONAL, "the same along y"),
    LAC_INTEGER("count", STEP(count), 1, 1, 10000, 0,
                "equal increments from the state before, each a step of the output"),
};

enum { MOST_STEPS = 10000 }; // of all entries with their counts

// Of ratio, shear and shift along an axis at most one.
static void check_axis(lac_reader *reader, const lac_node *node, char axis)
{
    static const char *const controls[] = {"ratio", "shear", "shift"};
    const lac_node *first = NULL;
    for (size_t i = 0; i < sizeof controls / sizeof controls[0]; i++) {
        char key[16];
        (void)snprintf(key, sizeof key, "%s_%c", controls[i], axis);
        const lac_node *given = lac_node_child(node, key);
        if (given != NULL && first != NULL) {
            lac_add_error(reader, given, "is given beside %s; exactly one is allowed along %c",
                          first->key, axis);
        }
        first = first == NULL ? given : first;
    }
}

static void read_step(lac_reader *reader, const lac_node *node, lac_history_step *step)
{
    const lac_section *table = lac_section_find("load.history.steps");
    size_t errors = reader->report->errors;
    lac_table_reset(table, step);
    if (!lac_expect_map(reader, node, "a mapping such as {ratio_x: 0.3}")) {
        return;
    }
    lac_read_table(reader, node, table, NULL, step);
    check_axis(reader, node, 'x');
    check_axis(reader, node, 'y');
    bool nothing = isnan(step->pressure);
    for (int i = 0; i < 2; i++) {
        nothing =
            nothing && isnan(step->ratio[i]) && isnan(step->shear[i]) && isnan(step->shift[i]);
    }
    if (nothing && reader->report->errors == errors) {
        lac_add_error(reader, node, "must name what changes, such as {ratio_x: 0.3}");
    }
}

void lac_read_steps(lac_reader *reader, const lac_node *node, lac_case *c)
{
    lac_history_def *history = &c->history;
    int64_t total = 0;
    if (node->kind != LAC_NODE_LIST || node->count == 0) {
        lac_add_error(reader, node,
                      "must be a list of steps such as [{ratio_x: 0.3}, {ratio_x: 0}]");
        return;
    }
    history->step = lac_reader_array(reader, node->count, sizeof *history->step);
    history->count = history->step != NULL ? node->count : 0;
    for (size_t i = 0; i < history->count; i++) {
        read_step(reader, node->child[i], &history->step[i]);
        total += history->step[i].count;
    }
    if (total > MOST_STEPS) {
        lac_add_error(reader, node, "makes %lld steps with all counts; at most %d are allowed",
                      (long long)total, MOST_STEPS);
    }
}

// What is pressed and sheared.
static void check_joint(lac_reader *reader)
{
    bool near = HAS("load.normal.approach"), domain = HAS("interface.domain");
    (void)lac_refuse(reader, near || HAS("load.normal.dimension"),
                     near ? "load.normal.approach" : "load.normal.dimension",
                     "is no load, from which load.history could start: pressure, depth or slope");
    (void)lac_refuse(reader, !HAS("interface.surface") && !domain, "load.history",
                     "needs interface.surface or interface.domain: a single block has no cells "
                     "that stick or slip");
    (void)lac_refuse(reader, domain && !HAS("material.shear_modulus"), "material.shear_modulus",
                     "is missing: needed by load.history; must be a pressure such as \"20 GPa\"");
}

void lac_find_coulomb(lac_reader *reader, const lac_case *c, const char *key, double *friction)
{
    char path[LAC_KEY_LENGTH];
    (void)snprintf(path, sizeof path, "%s.friction", key);
    if (HAS(path)) {
        return;
    }
    if (c->friction.info == NULL) {
        (void)lac_refuse(reader, !HAS("friction") && !lac_needs_run(reader), path,
                         "is missing: Coulomb's coefficient, which no friction law gives either");
        return;
    }
    *friction = ((const lac_friction_params *)c->friction.params)->f0;
    if (lac_refuse(reader, !(*friction > 0), path,
                   "is missing, and f0 of the friction law is %g; must be > 0", *friction)) {
        *friction = NAN;
    }
    if (((const lac_friction_params *)c->friction.params)->cohesion > 0) {
        lac_warn(reader, key, "takes f0 alone; the friction law's cohesion has no effect on it");
    }
    if (lac_heterogeneity_has(&c->friction_spread, "f0")) {
        lac_warn(reader, key,
                 "takes the nominal f0 for every cell; friction.spread.f0 has no effect on it");
    }
}

// Load along the way; the shear load of an axis under shift control is not known and counts as 0.
typedef struct way {
    double pressure, shear[2];
} way;

static void follow(lac_reader *reader, const lac_node *node, way *at, const lac_history_step *step,
                   double f)
{
    at->pressure = isnan(step->pressure) ? at->pressure : step->pressure;
    for (int i = 0; i < 2; i++) {
        if (!isnan(step->ratio[i])) {
            at->shear[i] = step->ratio[i] * f * at->pressure;
        } else if (!isnan(step->shear[i])) {
            at->shear[i] = step->shear[i];
        } else if (!isnan(step->shift[i])) {
            at->shear[i] = 0;
        }
    }
    double shear = hypot(at->shear[0], at->shear[1]);
    if (!(shear < f * at->pressure)) {
        char high[64], low[64];
        lac_add_error(
            reader, node,
            "shears by %s, which must be below f P = %s, where the joint slides as a whole",
            lac_units_format(shear, "Pa", high, sizeof high),
            lac_units_format(f * at->pressure, "Pa", low, sizeof low));
    }
}

void lac_check_history(lac_reader *reader, lac_case *c, double pressure)
{
    const lac_node *steps = lac_node_at(reader->root, "load.history.steps");
    check_joint(reader);
    lac_find_coulomb(reader, c, "load.history", &c->history.friction);
    double f = c->history.friction;
    way at = {.pressure = pressure};
    for (size_t i = 0; isfinite(f) && isfinite(pressure) && i < c->history.count; i++) {
        follow(reader, steps->child[i], &at, &c->history.step[i], f);
    }
}
