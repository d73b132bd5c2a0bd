// SPDX-License-Identifier: GPL-3.0-or-later
// What is wrong with a case as a whole: keys that are each right and still do not go together.
#include "case/sections.h"

bool lac_present(const lac_reader *reader, const char *key)
{
    return lac_node_at(reader->root, key) != NULL;
}

bool lac_clean(const lac_reader *reader, const char *key)
{
    size_t n = strlen(key);
    for (size_t i = 0; i < reader->report->count; i++) {
        const lac_case_issue *issue = &reader->report->issue[i];
        if (!issue->warning && issue->key != NULL && strncmp(issue->key, key, n) == 0) {
            return false;
        }
    }
    return true;
}

static void check_material(lac_reader *reader, const lac_case *c)
{
    if (!lac_clean(reader, "material")) {
        return;
    }
    const lac_normal_load *normal = (const void *)c->normal.info;
    (void)lac_refuse(
        reader, normal != NULL && normal->needs_density && !HAS("material.density"),
        "material.density",
        "is missing: needed by load.normal.%s; must be a density such as \"2700 kg/m3\"",
        normal != NULL ? normal->info.name : "");
    (void)lac_refuse(
        reader, HAS("interface.surface") && !HAS("material.shear_modulus"),
        "material.shear_modulus",
        "is missing: needed to press interface.surface; must be a pressure such as \"20 GPa\"");
    if (HAS("material.shear_speed") && !HAS("material.shear_modulus")) {
        lac_warn(reader, "material.shear_speed", "has no effect without shear_modulus");
    }
}

static bool holds_mean_slip(const lac_case *c)
{
    lac_transfer_outline outline;
    return lac_transfer_outline_of(&c->transfer, &outline) && outline.anchored;
}

static void check_transfer(lac_reader *reader, const lac_case *c, bool material_read)
{
    const lac_transfer_kind *kind = (const void *)c->transfer.info;
    const lac_domain_source *domain = (const void *)c->domain.info;
    const lac_transfer_place place = {.periodic = c->interface.boundary == LAC_PERIODIC,
                                      .full = c->surface.info == NULL &&
                                              (domain == NULL || domain->full),
                                      .line = c->interface.shape == LAC_LINE};
    lac_transfer_validate fault[LAC_TRANSFER_FAULTS] = {0};
    lac_transfer_outline outline;
    char key[100];
    if (kind == NULL || !lac_clean(reader, "transfer")) {
        return;
    }
    if (kind->check != NULL) {
        kind->check(c->transfer.params, &place, fault);
    }
    for (size_t i = 0; i < LAC_TRANSFER_FAULTS; i++) {
        (void)snprintf(key, sizeof key, "transfer.%s%s", kind->info.name,
                       fault[i].text != NULL ? fault[i].key : "");
        (void)lac_refuse(reader, fault[i].text != NULL, key, "%s", fault[i].text);
    }
    bool stiff =
        material_read && lac_transfer_outline_of(&c->transfer, &outline) && outline.rock != NULL;
    (void)lac_refuse(reader, stiff && !HAS("material.shear_modulus"), "material.shear_modulus",
                     "is missing: needed by transfer.%s%s; must be a pressure such as \"20 GPa\"",
                     kind->info.name, stiff ? outline.rock : "");
}

// What a shear load needs, or goes without: of all loads one thing after the other.
static void check_shear(lac_reader *reader, const lac_case *c, bool fixed)
{
    for (size_t i = 0; fixed && i < c->shear.count && lac_clean(reader, "load"); i++) {
        char key[100];
        const lac_load_kind *kind = (const void *)c->shear.item[i].info;
        (void)snprintf(key, sizeof key, "load.shear.%zu", i);
        (void)lac_refuse(reader, kind->fixes_shear, key,
                         "%s fixes the shear load, which follows from initial.slip_rate and "
                         "initial.state: drop one of them",
                         kind->info.name);
    }
}

static double dip_of(const lac_model *slope)
{
    const lac_model_info *info = slope->info;
    const lac_param *angle = lac_param_find(info->params, info->param_count, "angle");
    return *(const double *)(const void *)((const char *)slope->params + angle->offset);
}

static void warn_dips(lac_reader *reader, const lac_case *c)
{
    const lac_normal_load *normal = (const void *)c->normal.info;
    for (size_t i = 0; i < c->shear.count && normal != NULL && normal->slope; i++) {
        char key[100];
        const lac_load_kind *kind = (const void *)c->shear.item[i].info;
        (void)snprintf(key, sizeof key, "load.shear.%zu.slope.angle", i);
        if (kind->slope && fabs(dip_of(&c->shear.item[i]) - dip_of(&c->normal)) > 1e-9) {
            lac_warn(reader, key, "is not that of load.normal.slope: a joint has one dip");
        }
    }
}

static void check_back_slip(lac_reader *reader, const lac_case *c)
{
    for (size_t i = 0; i < c->shear.count && lac_clean(reader, "load"); i++) {
        char key[100];
        const lac_load_kind *kind = (const void *)c->shear.item[i].info;
        (void)snprintf(key, sizeof key, "load.shear.%zu", i);
        (void)lac_refuse(reader, kind->needs_anchor && !holds_mean_slip(c), key,
                         "%s acts through a transfer that holds the mean slip: elastic with a "
                         "thickness, or with outside: creeping",
                         kind->info.name);
    }
}

static void check_share(lac_reader *reader, const lac_case *c)
{
    bool cells = c->surface.info != NULL || c->domain.info != NULL;
    bool bare = !cells || !HAS("material.shear_modulus");
    bool read = lac_clean(reader, "interface") && lac_clean(reader, "material");
    for (size_t i = 0; read && i < c->shear.count && lac_clean(reader, "load"); i++) {
        char key[100];
        const lac_model *model = &c->shear.item[i];
        (void)snprintf(key, sizeof key, "load.shear.%zu.%s.share", i, model->info->name);
        (void)lac_refuse(reader, bare && lac_load_models_share(model) == LAC_SHARE_ELASTIC, key,
                         "needs %s",
                         !cells ? "cells to be shared by: interface.domain or interface.surface"
                                : "material.shear_modulus, such as \"20 GPa\"");
    }
}

// An approach or a dimension takes the place of a normal stress: the load follows from pressing the
// surface.
static void check_statics(lac_reader *reader, const lac_case *c)
{
    const lac_normal_load *normal = (const void *)c->normal.info;
    (void)lac_refuse(reader, c->pressing.count > 0 && HAS("load.history"), "load.normal_stress",
                     "is for runs; a step of load.history names its normal load itself");
    if (normal == NULL || (normal->approach == NULL && normal->dimension == NULL)) {
        return;
    }
    (void)lac_refuse(reader, c->pressing.count > 0, "load.normal_stress",
                     "is for runs, whose normal load is pressure, depth or slope");
    const char *key = normal->approach != NULL ? "load.normal.approach" : "load.normal.dimension";
    (void)(lac_refuse(
               reader, lac_needs_run(reader), key,
               "is for statics (lacuna contact); a run needs a load: pressure, depth or slope") ||
           lac_refuse(reader, !HAS("interface.surface"), key,
                      "needs interface.surface: only heights tell the load that follows") ||
           lac_refuse(reader,
                      normal->approach != NULL && c->interface.boundary == LAC_PERIODIC &&
                          !(normal->approach(c->normal.params) > 0),
                      key,
                      "must be > 0 m between periodic faces: without a gap any load would do"));
}

// The mean normal stress; NaN where the case is wrong about it.
static double normal_stress(const lac_reader *reader, const lac_case *c)
{
    const bool clean = lac_clean(reader, "material") && lac_clean(reader, "interface.geometry");
    return clean ? lac_case_pressure(c) : NAN;
}

static void check_forces(lac_reader *reader, const lac_case *c, double pressure,
                         bool fixed_by_initial)
{
    const lac_load_models models = lac_case_loads(c);
    lac_load_set loads;
    lac_load_state sum;
    // What files hold is looked at when the scene is built.
    if (lac_load_models_traits(&models).files) {
        return;
    }
    if (lac_load_set_create(&models, &(lac_load_clock){.end = c->run.end}, &loads, NULL) !=
        LAC_OK) {
        reader->no_memory = true;
        return;
    }
    lac_load_evaluate(&loads, 0.0, &sum);
    lac_load_set_clear(&loads);
    char high[64], low[64];
    const double pressed = pressure + sum.normal;
    (void)(lac_refuse(reader, !(pressed > 0.0), "load.normal_stress",
                      "sums to %s at the start, which must leave some of the normal stress, %s",
                      lac_units_format(sum.normal, "Pa", high, sizeof high),
                      lac_units_format(pressure, "Pa", low, sizeof low)) ||
           lac_refuse(reader, !(sum.pore < pressed), "load.pore_pressure",
                      "sums to %s, which must be below the normal stress, %s",
                      lac_units_format(sum.pore, "Pa", high, sizeof high),
                      lac_units_format(pressed, "Pa", low, sizeof low)));
    bool wanted = lac_needs_run(reader) && !fixed_by_initial && lac_clean(reader, "initial");
    sum.ratio += lac_geometry_weigh(&c->geometry, c->material.density).ratio;
    (void)lac_refuse(reader, wanted && !(lac_load_shear(&sum, pressure) > 0.0),
                     c->geometry.angles > 0 ? "interface.geometry.angle" : "load.shear",
                     "must give a shear load at the start, such as [{ratio: {value: 0.58}}], "
                     "unless initial gives both slip_rate and state");
}

static void check_load(lac_reader *reader, const lac_case *c)
{
    bool fixed_by_initial = HAS("initial.slip_rate") && HAS("initial.state");
    check_shear(reader, c, fixed_by_initial);
    double pressure = normal_stress(reader, c);
    if (isfinite(pressure) && lac_clean(reader, "load")) {
        warn_dips(reader, c);
        check_forces(reader, c, pressure, fixed_by_initial);
    } else {
        (void)lac_refuse(reader, c->normal.info != NULL && isinf(pressure), "load.normal",
                         "is too large to compute with");
    }
}

// Whether the case starts where nothing changes but by rounding, which grows as b > a.
static bool starts_unstable(const lac_case *c)
{
    const lac_initial_def *initial = &c->initial;
    const lac_friction_params *law = c->friction.params;
    bool alike = c->initial_spread.count == 0 &&
                 (c->friction_spread.count == 0 || !isnan(initial->slip_rate));
    const bool steady = initial->state == LAC_STATE_STEADY ||
                        (initial->state == LAC_STATE_RATIO && initial->state_value == 1.0);
    return steady && law->b > law->a && alike;
}

bool lac_case_left_to_rounding(const lac_case *c)
{
    const lac_load_models loads = lac_case_loads(c);
    return c->friction.params != NULL && starts_unstable(c) && !holds_mean_slip(c) &&
           c->geometry.angles == 0 && lac_load_models_traits(&loads).constant;
}

// Whether the state at the start is the same for any ratio to the steady one, as the law has it.
static void check_ratio(lac_reader *reader, const lac_case *c)
{
    static const double others[] = {0.1, 0.5, 2.0, 10.0};
    const double u = log(c->initial.slip_rate);
    lac_friction *friction = NULL;
    char text[64];
    lac_status status = lac_friction_create(&c->friction, 1, &friction, NULL);
    if (status != LAC_OK) {
        reader->no_memory = reader->no_memory || status == LAC_ENOMEM;
        return; // else said where the scene is made
    }
    const double w = lac_friction_state_at_ratio(friction, 0, u, c->initial.state_value);
    bool idle = c->friction_spread.count == 0 && isfinite(w);
    for (size_t i = 0; idle && i < sizeof others / sizeof others[0]; i++) {
        idle = fabs(lac_friction_state_at_ratio(friction, 0, u, others[i]) - w) <= 1e-9;
    }
    if (idle) {
        lac_warn(reader, "initial.state", "has no effect where b = a: theta is %s for any ratio",
                 lac_units_format(exp(w), "s", text, sizeof text));
    }
    lac_friction_free(friction);
}

static void check_initial(lac_reader *reader, const lac_case *c)
{
    const lac_initial_def *initial = &c->initial;
    bool scaled = initial->state == LAC_STATE_TIME || initial->state == LAC_STATE_RATIO;
    (void)lac_refuse(reader, HAS("initial.spread.slip_rate") && !HAS("initial.slip_rate"),
                     "initial.spread.slip_rate", "needs initial.slip_rate");
    (void)lac_refuse(
        reader, HAS("initial.spread.state") && lac_clean(reader, "initial.state") && !scaled,
        "initial.spread.state", "needs initial.state as a time or {ratio_to_steady: x}");
    if (c->friction.info == NULL || !lac_clean(reader, "initial")) {
        return;
    }
    if (initial->state == LAC_STATE_RATIO && !isnan(initial->slip_rate)) {
        check_ratio(reader, c);
    }
    if (!starts_unstable(c)) {
        return;
    }
    if (!lac_refuse(reader, !isnan(c->accuracy) && lac_case_left_to_rounding(c), "solver.accuracy",
                    "cannot be kept: the case starts steady with b > a and no load changes, so "
                    "rounding decides what it does")) {
        lac_warn(
            reader, HAS("initial.state") ? "initial.state" : "friction",
            "starts steady with b > a, the unstable fixed point: rounding decides when it fails");
    }
}

double lac_inertia_mass(const lac_case *c)
{
    if (!isnan(c->inertia.mass_per_area)) {
        return c->inertia.mass_per_area;
    }
    double mass = c->inertia.thickness * c->material.density;
    return isnan(mass) ? 0.0 : mass;
}

// An explicit method follows the time m v/(a p) in which a massive cell comes into balance.
static void warn_explicit(lac_reader *reader, const lac_case *c, double pressure)
{
    const double many = 1e6;
    const lac_friction_params *law = c->friction.params;
    if (c->friction.info == NULL || c->run.method == LAC_BDF || isnan(c->initial.slip_rate)) {
        return;
    }
    double time = lac_inertia_mass(c) * c->initial.slip_rate / (law->a * pressure);
    if (time > 0.0 && c->run.end > many * time) {
        lac_warn(reader, "solver.method",
                 "takes steps of about m v/(a p) = %.2g s while the block creeps; bdf does not",
                 time);
    }
}

// What is wrong with the mass of the block, which chooses the formulation.
// @param pressure  mean normal stress [Pa]; NaN where the case is wrong about it
static void check_inertia(lac_reader *reader, lac_case *c, double pressure)
{
    bool named = HAS("inertia");
    bool thick = !isnan(c->inertia.thickness), given = !isnan(c->inertia.mass_per_area);
    bool chosen = c->formulation == LAC_FORMULATION_INERTIA;
    if (!lac_clean(reader, "inertia")) {
        return;
    }
    (void)(lac_refuse(reader, named && thick == given, "inertia",
                      "needs either thickness (with material.density) or mass_per_area%s",
                      thick ? ", not both" : "") ||
           lac_refuse(reader, thick && lac_clean(reader, "material") && isnan(c->material.density),
                      "material.density",
                      "is missing: needed by inertia.thickness; must be a density such as \"2700 "
                      "kg/m3\""));
    (void)lac_refuse(reader, named && !chosen && c->formulation != LAC_FORMULATION_AUTO,
                     "solver.formulation", "knows no inertia: leave it out, or leave out inertia");
    (void)lac_refuse(reader, !named && chosen, "solver.formulation",
                     "needs inertia, such as inertia: {mass_per_area: \"5e5 kg/m2\"}");
    if (named) {
        c->formulation = LAC_FORMULATION_INERTIA;
        warn_explicit(reader, c, pressure);
    }
}

// Chooses the formulation where the case leaves it open.
static void check_solver(lac_reader *reader, lac_case *c)
{
    c->method_given = HAS("solver.method");
    c->formulation_given = c->formulation != LAC_FORMULATION_AUTO;
    static const struct {
        const char *name;
        int lowest, highest;
    } orders[] = {
        [LAC_BDF] = {"bdf", 1, 5}, [LAC_ADAMS] = {"adams", 1, 12}, [LAC_ERK] = {"erk", 2, 8}};
    const lac_friction_params *friction = c->friction.params;
    lac_friction_form form = c->friction.info == NULL || friction->form == LAC_FORM_PLAIN
                                 ? LAC_FORM_PLAIN
                                 : LAC_FORM_REGULARISED;
    (void)lac_refuse(reader, !isnan(c->accuracy) && reader->purpose == LAC_FOR_FIT,
                     "solver.accuracy",
                     "is for lacuna run, which picks settings by pilot runs; here rtol counts");
    if (c->run.fidelity == LAC_FIDELITY_ASYNC) {
        lac_check_events(reader, c);
        return;
    }
    c->formulation = (int)lac_formulation_choose(c->formulation, c->run.method, form);
    int64_t order = c->run.max_order;
    const int low = orders[c->run.method].lowest, high = orders[c->run.method].highest;
    (void)lac_refuse(reader,
                     lac_clean(reader, "solver") && order != 0 && (order < low || order > high),
                     "solver.max_order", "must be from %d to %d with method %s", low, high,
                     orders[c->run.method].name);
}

bool lac_case_implies_safety(const lac_case *c)
{
    const lac_normal_load *normal = (const void *)c->normal.info;
    const lac_load_models loads = lac_case_loads(c);
    return (normal != NULL && normal->slope) || lac_load_models_traits(&loads).slope ||
           c->geometry.angles > 0 || !isnan(c->run.stop_safety) ||
           (c->fields & (unsigned)LAC_FIELD_SAFETY) != 0;
}

static bool maps(const lac_node *node) { return node != NULL && node->kind == LAC_NODE_MAP; }

void lac_check_case(lac_reader *reader, lac_case *c)
{
    bool material_read = lac_clean(reader, "material");
    c->rg.named = maps(lac_node_at(reader->root, "rg"));
    c->fit.named = maps(lac_node_at(reader->root, "fit"));
    if (HAS("initial.slip_rate") && !HAS("initial.state")) {
        c->initial.state = LAC_STATE_FROM_LOAD;
    }
    lac_check_interface(reader, &c->interface);
    check_material(reader, c);
    check_transfer(reader, c, material_read);
    // a spread is about one pressure
    (void)lac_refuse(reader,
                     lac_clean(reader, "interface") && c->interface_spread.count > 0 &&
                         c->domain.info == &lac_domain_from_file.info &&
                         ((const lac_domain_file *)c->domain.params)->pressures !=
                             LAC_PRESSURES_EQUAL,
                     "interface.spread", "needs interface.domain.file.pressures: equal to vary");
    check_statics(reader, c);
    check_load(reader, c);
    check_back_slip(reader, c);
    check_share(reader, c);
    if (c->history.count > 0 && lac_clean(reader, "load")) {
        lac_check_history(reader, c, normal_stress(reader, c));
    }
    check_initial(reader, c);
    check_inertia(reader, c, normal_stress(reader, c));
    lac_check_geometry(reader, c);
    lac_check_vector(reader, c);
    lac_check_lumped(reader, c);
    check_solver(reader, c);
    lac_check_weakening(reader, c);
    lac_check_rg(reader, c);
    lac_check_analysis(reader, c);
    lac_check_fit(reader, c);
    lac_check_points(reader, c);
    lac_check_point_names(reader, c);
    lac_check_cadences(reader, c);
    // where the factor of safety is written, maps of the cells have it too
    c->safety.asked = c->safety.asked || lac_case_implies_safety(c);
    c->fields |= c->safety.asked && c->fields != 0 ? (unsigned)LAC_FIELD_SAFETY : 0U;
    c->run.cell_safety = (c->fields & (unsigned)LAC_FIELD_SAFETY) != 0;
}
