// SPDX-License-Identifier: GPL-3.0-or-later
// interface.geometry: reading numbers or lists over slip, and what is wrong with them and with what
// stands beside them.
#include "case/sections.h"

const lac_param lac_geometry_rows[LAC_GEOMETRY_ROWS] = {
    LAC_OWN("angle", "dip of the base, an angle, or a list of one for each slip; must be given"),
    LAC_OWN("thickness", "of the sliding mass, measured vertically: a length at the start, after "
                         "which its weight stays the same, or a list of one for each slip; if "
                         "absent load.normal says the weight at the start"),
    LAC_OWN("slip", "[...]: mean slips, rising, at which the lists have their values"),
    LAC_REAL("radius", "m", offsetof(lac_case, geometry.radius), NAN, 0, 1e9,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "of a circular base: its dip falls by slip/radius from the angle at the start"),
};

// What a value may be; LAC_STEEPEST of the loads, to either side.
static const lac_param angle_row = LAC_REAL("angle", "rad", 0, NAN, -1.57, 1.57, 0, "");
static const lac_param thickness_row =
    LAC_REAL("thickness", "m", 0, NAN, 0, 1e9, LAC_ABOVE_MIN, "");
static const lac_param slip_row = LAC_REAL("slip", "m", 0, NAN, -1e9, 1e9, 0, "");

// A number, or a list of at least two. @return how many; 0 where one is wrong, which is reported
static size_t read_values(lac_reader *reader, const lac_node *map, const lac_param *row,
                          double *value)
{
    const lac_node *node = lac_node_child(map, row->key);
    if (node == NULL || node->bad) {
        return 0;
    }
    const bool list = node->kind == LAC_NODE_LIST;
    if (list && (node->count < 2 || node->count > LAC_MOST_NODES)) {
        lac_add_error(reader, node, "has %zu values; a list must have from 2 to %d", node->count,
                      LAC_MOST_NODES);
        return 0;
    }
    const size_t count = list ? node->count : 1;
    bool good = true;
    for (size_t i = 0; i < count; i++) {
        const lac_node *item = list ? node->child[i] : node;
        const bool read = lac_read_number(reader, item, row->unit, &value[i]) &&
                          lac_in_range(reader, item, row, value[i]);
        good = good && read;
    }
    return good ? count : 0;
}

void lac_read_geometry(lac_reader *reader, const lac_node *node, lac_case *c)
{
    lac_geometry_def *def = &c->geometry;
    const lac_node *slips = lac_node_child(node, slip_row.key);
    bool rises = true;
    if (slips != NULL && slips->kind != LAC_NODE_LIST) {
        lac_add_error(reader, slips, "must be a list such as [0 m, 10 m]");
    } else {
        def->nodes = read_values(reader, node, &slip_row, def->slip);
    }
    for (size_t i = 1; i < def->nodes && rises; i++) {
        rises = def->slip[i] > def->slip[i - 1];
        if (!rises) {
            lac_add_error(reader, slips->child[i], "must be above the one before");
        }
    }
    def->angles = read_values(reader, node, &angle_row, def->angle);
    def->thicknesses = read_values(reader, node, &thickness_row, def->thickness);
}

void lac_put_geometry(struct lac_writer *w, const lac_case *c)
{
    const lac_geometry_def *def = &c->geometry;
    lac_put_list(w, "angle", "rad", def->angle, def->angles);
    if (def->thicknesses > 0) {
        lac_put_list(w, "thickness", "m", def->thickness, def->thicknesses);
    }
    if (def->nodes > 0) {
        lac_put_list(w, "slip", "m", def->slip, def->nodes);
    }
}

// The weight on a bent base may be all there is.
bool lac_case_has_load(const lac_case *c)
{
    return c->normal.info != NULL || c->shear.count > 0 || c->pore.count > 0 ||
           c->history.count > 0;
}

double lac_case_pressure(const lac_case *c)
{
    const lac_normal_load *normal = (const void *)c->normal.info;
    return normal != NULL ? normal->pressure(c->normal.params, c->material.density)
                          : lac_geometry_weigh(&c->geometry, c->material.density).pressure;
}

#define OF(key) "interface.geometry." key

// What is wrong with the lists together.
static void check_lists(lac_reader *reader, const lac_geometry_def *def)
{
    const struct {
        const char *key;
        size_t count;
    } lists[] = {{OF("angle"), def->angles}, {OF("thickness"), def->thicknesses}};
    bool any = false;
    for (size_t i = 0; i < 2; i++) {
        const bool listed = lists[i].count > 1;
        any = any || listed;
        (void)lac_refuse(reader, listed && lists[i].count != def->nodes, lists[i].key,
                         def->nodes == 0 ? "is a list, which needs interface.geometry.slip"
                                         : "has %zu values, and interface.geometry.slip has %zu",
                         lists[i].count, def->nodes);
    }
    (void)lac_refuse(reader, !HAS(OF("angle")), OF("angle"),
                     "is missing: must be an angle such as \"30 degree\", or a list of them");
    (void)lac_refuse(reader, def->nodes > 0 && !any, OF("slip"),
                     "has no effect: neither angle nor thickness is a list");
    (void)lac_refuse(reader, !isnan(def->radius) && def->angles > 1, OF("radius"),
                     "goes with one angle, that at the start, not with a list");
}

// What says again, or otherwise, what the base says.
static void check_beside(lac_reader *reader, const lac_case *c)
{
    static const char says[] = "has an angle, which interface.geometry says: leave one of them out";
    const lac_normal_load *normal = (const void *)c->normal.info;
    const bool weighs = HAS(OF("thickness"));
    char key[LAC_KEY_LENGTH];
    (void)snprintf(key, sizeof key, "load.normal.%s", normal != NULL ? normal->info.name : "");
    (void)(lac_refuse(reader, normal != NULL && normal->slope, key, "%s", says) ||
           lac_refuse(reader, normal != NULL && weighs, key,
                      "is given beside interface.geometry.thickness, which says the weight: leave "
                      "one of them out"));
    for (size_t i = 0; i < c->shear.count; i++) {
        const lac_load_kind *kind = (const void *)c->shear.item[i].info;
        (void)snprintf(key, sizeof key, "load.shear.%zu.%s", i, kind->info.name);
        (void)lac_refuse(reader, kind->slope, key, "%s", says);
    }
    (void)lac_refuse(reader, weighs && lac_clean(reader, "material") && !HAS("material.density"),
                     "material.density",
                     "is missing: needed by interface.geometry.thickness; must be a density such "
                     "as \"2700 kg/m3\"");
    (void)lac_refuse(reader, HAS("initial.slip_rate") && HAS("initial.state"), "interface.geometry",
                     "fixes the shear load, which follows from initial.slip_rate and "
                     "initial.state: drop one of them");
}

// A lake at the toe floats what the base carries; where there is none, or no thickness, it cannot.
static void check_toe(lac_reader *reader, const lac_case *c)
{
    const char *lacks = !HAS(OF("thickness")) ? "interface.geometry with a thickness"
                        : !HAS("interface.size")
                            ? "interface.size, the length of the mass on its base"
                            : NULL;
    char key[LAC_KEY_LENGTH];
    size_t count = 0;
    for (size_t i = 0; i < c->pore.count && lac_clean(reader, "load"); i++) {
        const lac_load_kind *kind = (const void *)c->pore.item[i].info;
        (void)snprintf(key, sizeof key, "load.pore_pressure.%zu.%s", i, kind->info.name);
        count += kind->on_base ? 1 : 0;
        (void)(lac_refuse(reader, kind->on_base && lacks != NULL, key, "needs %s", lacks) ||
               lac_refuse(reader, kind->on_base && count > 1, key,
                          "is a second lake at the toe: there is one"));
    }
}

// What cannot follow a load that goes with slip.
static void check_solvers(lac_reader *reader, lac_case *c)
{
    const lac_friction_params *law = c->friction.params;
    const bool held = c->formulation == LAC_FORMULATION_AUTO ||
                      c->formulation == LAC_FORMULATION_SLIP ||
                      c->formulation == LAC_FORMULATION_INERTIA;
    char key[LAC_KEY_LENGTH];
    const bool together =
        c->run.fidelity != LAC_FIDELITY_ASYNC && c->run.fidelity != LAC_FIDELITY_STATIC;
    (void)lac_refuse(reader, !held && together, "solver.formulation",
                     "does not hold the slip that interface.geometry follows: leave it out, or "
                     "slip");
    if (c->formulation == LAC_FORMULATION_AUTO && together) {
        c->formulation = LAC_FORMULATION_SLIP;
    }
    (void)lac_refuse(reader, c->slip == LAC_SLIP_VECTOR, "interface.geometry",
                     "bends one way, and slip goes two: leave it or interface.slip: vector out");
    (void)lac_refuse(reader, c->weakening.count > 0, "weakening",
                     "is not followed on a base that bends: leave it or interface.geometry out");
    (void)snprintf(key, sizeof key, "friction.%s.alpha", law != NULL ? c->friction.info->name : "");
    (void)lac_refuse(reader, law != NULL && !isnan(law->alpha), key,
                     "responds to the normal stress, which interface.geometry changes with slip: "
                     "that is not followed; leave one of them out");
}

void lac_check_geometry(lac_reader *reader, lac_case *c)
{
    if (lac_clean(reader, "interface")) {
        check_toe(reader, c);
    }
    if (!HAS("interface.geometry") || !lac_clean(reader, "interface.geometry")) {
        return;
    }
    check_lists(reader, &c->geometry);
    if (lac_clean(reader, "load")) {
        check_beside(reader, c);
    }
    check_solvers(reader, c);
}
