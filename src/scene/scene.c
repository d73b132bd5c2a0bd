// SPDX-License-Identifier: GPL-3.0-or-later
// A case made into what a run needs: contact, friction of every cell, loads, start, problem.
#include "scene/scene.h"

#include "scene/internal.h"

double lac_damping_of(const lac_material_def *material)
{
    double g = material->shear_modulus, cs = material->shear_speed;
    if (isnan(cs) && !isnan(material->density)) {
        cs = sqrt(g / material->density);
    }
    return isnan(g) || isnan(cs) ? 0.0 : 0.5 * g / cs;
}

static lac_status spread_friction(const lac_case *c, const lac_heterogeneity_place *place,
                                  const lac_param *param, lac_friction *friction, double *values,
                                  lac_error *err)
{
    double nominal;
    memcpy(&nominal, (const char *)c->friction.params + param->offset, sizeof nominal);
    lac_status status = lac_heterogeneity_fill(place, &c->friction_spread, param->key, param->unit,
                                               nominal, values, err);
    if (status == LAC_OK) {
        status = lac_friction_set(friction, param->key, values, err);
    }
    return lac_fail_within(err, status, "friction.spread.%s", param->key);
}

static lac_status make_friction(const lac_case *c, const lac_heterogeneity_place *place,
                                lac_friction **out, lac_error *err)
{
    lac_status status = LAC_OK;
    double *values = NULL;
    const lac_model_info *info = c->friction.info;
    LAC_TRY(lac_friction_create(&c->friction, place->domain->n, out, err));
    if (c->friction_spread.count > 0) {
        values = malloc(place->domain->n * sizeof *values);
        LAC_TRY(values != NULL ? LAC_OK : lac_fail_memory(err));
    }
    for (size_t i = 0; i < info->param_count; i++) {
        if (lac_heterogeneity_has(&c->friction_spread, info->params[i].key)) {
            LAC_TRY(spread_friction(c, place, &info->params[i], *out, values, err));
        }
    }
    LAC_TRY(lac_fail_within(err, lac_friction_check(*out, err), "friction.spread"));
out:
    free(values);
    LAC_MADE(status, out, lac_friction_free);
}

// What `initial` spreads: a nominal value and, where asked for, an array of them.
typedef struct initial_value {
    const char *key, *unit;
    double nominal;
    double *values; // [n], NULL where not spread
} initial_value;

static lac_status spread_initial(const lac_heterogeneity_list *list,
                                 const lac_heterogeneity_place *place, initial_value *of,
                                 lac_error *err)
{
    if (!lac_heterogeneity_has(list, of->key)) {
        return LAC_OK;
    }
    of->values = malloc(place->domain->n * sizeof *of->values);
    LAC_FAIL_MEMORY_IF(of->values == NULL, err);
    lac_status status =
        lac_heterogeneity_fill(place, list, of->key, of->unit, of->nominal, of->values, err);
    return lac_fail_within(err, status, "initial.spread.%s", of->key);
}

// Which way the cells slip at the start, where slip has two directions: as the loads pull them, or
// as the case says where nothing but that fixes what they carry.
static lac_status find_heading(const lac_scene *scene, double *heading, lac_error *err)
{
    const lac_case *c = scene->source;
    if (!isnan(c->initial.slip_rate) && c->initial.state != LAC_STATE_FROM_LOAD) {
        *heading = isnan(c->initial_azimuth) ? 0.0 : c->initial_azimuth;
        return LAC_OK;
    }
    return lac_load_set_heading(&scene->loads, scene->contact.mean_pressure, heading, err);
}

// All that its problem is made of, but for the start.
static lac_problem_def problem_def(const lac_scene *scene)
{
    const lac_case *c = scene->source;
    return (lac_problem_def){.domain = scene->contact.domain,
                             .friction = scene->friction,
                             .transfer = &scene->transfer,
                             .loads = scene->loads,
                             .damping = scene->damping,
                             .mass = lac_inertia_mass(c),
                             .columns = c->inertia.columns,
                             .formulation = (lac_formulation)c->formulation,
                             .safety = c->safety,
                             .weakening = &scene->weakening};
}

lac_lump_source lac_scene_lump_source(const lac_scene *scene)
{
    const lac_problem_parts parts = lac_problem_parts_of(scene->problem);
    lac_lump_source source = {.whole = problem_def(scene),
                              .problem = scene->problem,
                              .blocks = scene->hierarchy,
                              .ends = &scene->source->run};
    source.whole.log_rate = parts.log_rate;
    source.whole.log_state = parts.log_state;
    return source;
}

lac_status lac_scene_lump(lac_scene *scene, const lac_lump *like, lac_error *err)
{
    lac_lump_free(scene->lump);
    scene->lump = NULL;
    lac_lump_source source = lac_scene_lump_source(scene);
    source.like = like;
    return lac_lump_create(&source, &scene->source->lump, &scene->lump, err);
}

// What a run of ranks does not do: it is one of all cells in time, from its start.
static lac_status check_team(const lac_case *c, lac_error *err)
{
    const lac_fidelity fidelity = c->run.fidelity;
    const bool together = fidelity == LAC_FIDELITY_ODE || fidelity == LAC_FIDELITY_AUTO;
    const char *what = !together              ? "solver.fidelity other than ode"
                       : !isnan(c->accuracy)  ? "solver.accuracy"
                       : c->from.file != NULL ? "initial.run"
                                              : NULL;
    return c->team == NULL || what == NULL
               ? LAC_OK
               : lac_fail(err, LAC_EINPUT,
                          "%s is not shared by ranks: run this case on one, with lacuna", what);
}

static lac_status make_problem(lac_scene *scene, const lac_heterogeneity_place *place,
                               lac_error *err)
{
    lac_status status = LAC_OK;
    const lac_case *c = scene->source;
    const lac_domain *domain = scene->contact.domain;
    lac_initial_def initial = c->initial;
    initial_value rate = {"slip_rate", "m/s", initial.slip_rate, NULL};
    initial_value state = {"state", initial.state == LAC_STATE_TIME ? "s" : "1",
                           initial.state_value, NULL};
    double *start = malloc(2 * domain->n * sizeof *start);
    LAC_FAIL_MEMORY_IF(start == NULL, err);
    LAC_TRY(spread_initial(&c->initial_spread, place, &rate, err));
    LAC_TRY(spread_initial(&c->initial_spread, place, &state, err));
    initial.rates = rate.values;
    initial.states = state.values;
    lac_load_set loads = scene->loads;
    double heading = 0.0;
    if (c->slip == LAC_SLIP_VECTOR) {
        LAC_TRY(find_heading(scene, &heading, err));
        loads = lac_load_set_along(&scene->loads, cos(heading), sin(heading));
    }
    status = lac_initial_solve(&initial, domain, scene->friction, &loads,
                               lac_damping_over(domain, scene->damping, lac_inertia_mass(c) > 0.0),
                               start, start + domain->n, err);
    LAC_TRY(lac_fail_within(err, status, "initial"));
    lac_problem_def def = problem_def(scene);
    def.log_rate = start;
    def.log_state = start + domain->n;
    def.heading = heading;
    def.team = c->team;
    LAC_TRY(
        lac_weakening_set_create(c->weakening.item, c->weakening.count, &scene->weakening, err));
    LAC_TRY(lac_team_agree(c->team, LAC_OK, err)); // all have come so far
    LAC_TRY(lac_problem_create(&def, &scene->problem, err));
    if (c->run.fidelity == LAC_FIDELITY_LUMPED) {
        LAC_TRY(lac_scene_lump(scene, NULL, err));
    }
out:
    free(start);
    free(rate.values);
    free(state.values);
    return status;
}

lac_status lac_scene_loads_create(const lac_case *c, lac_load_files *files, lac_load_set *out,
                                  lac_error *err)
{
    const lac_load_models models = lac_case_loads(c);
    const lac_load_clock clock = {c->dated, c->start_date, c->run.end, files};
    lac_status status = lac_load_set_create(&models, &clock, out, err);
    if (status == LAC_OK && c->geometry.angles > 0) {
        status = lac_geometry_create(&c->geometry, &out->geometry, err);
        out->length = c->interface.size;
        if (status != LAC_OK) {
            lac_load_set_clear(out);
        }
    }
    return status;
}

// What follows from friction and initial values.
static lac_status make_motion(lac_scene *scene, lac_error *err)
{
    const lac_heterogeneity_place place = {scene->contact.domain, scene->hierarchy};
    lac_status status = make_friction(scene->source, &place, &scene->friction, err);
    return status == LAC_OK ? make_problem(scene, &place, err) : status;
}

static lac_status share_loads(const lac_case *c, const lac_transfer_scene *from,
                              lac_load_set *loads, lac_error *err)
{
    if (!loads->shaped) {
        return LAC_OK;
    }
    loads->shape = malloc(from->domain->n * sizeof *loads->shape);
    LAC_FAIL_MEMORY_IF(loads->shape == NULL, err);
    lac_status status = lac_transfer_tied(&c->transfer, from, loads->shape, err);
    return lac_fail_within(err, status, "load.shear: share: elastic");
}

// Where the cells are, for loads that differ between them.
static lac_status place_loads(lac_scene *scene, lac_error *err)
{
    const lac_domain *domain = scene->contact.domain;
    const lac_load_places places = {&domain->grid, domain->index, domain->n};
    return lac_load_set_place(&scene->loads, &places, err);
}

lac_status lac_scene_renew(lac_scene *scene, lac_load_files *files, bool loads, lac_error *err)
{
    lac_lump_free(scene->lump);
    scene->lump = NULL;
    lac_problem_free(scene->problem);
    scene->problem = NULL;
    lac_friction_free(scene->friction);
    scene->friction = NULL;
    if (loads) {
        double *shape = scene->loads.shape; // of the contact, which stays
        scene->loads.shape = NULL;
        lac_load_set_clear(&scene->loads);
        lac_status status = lac_scene_loads_create(scene->source, files, &scene->loads, err);
        scene->loads.shape = shape;
        LAC_TRY_RETURN(status);
        LAC_TRY_RETURN(place_loads(scene, err));
    }
    return make_motion(scene, err);
}

lac_status lac_scene_create(const lac_case *c, lac_load_files *files, lac_scene **out,
                            lac_error *err)
{
    lac_status status = LAC_OK;
    *out = NULL;
    LAC_FAIL_IF(c->friction.info == NULL, err, LAC_EINPUT,
                "friction: is missing: a static case cannot be run");
    LAC_TRY_RETURN(check_team(c, err));
    lac_scene *scene = *out = calloc(1, sizeof *scene);
    LAC_TRY(scene != NULL ? LAC_OK : lac_fail_memory(err));
    scene->source = c;
    scene->damping = lac_damping_of(&c->material);
    LAC_TRY(lac_scene_loads_create(c, files, &scene->loads, err));
    LAC_TRY(lac_scene_contact_solve(c, LAC_SCENE_DOMAIN, &scene->contact, err));
    LAC_TRY(place_loads(scene, err));
    LAC_TRY(lac_hierarchy_create(scene->contact.domain, &scene->hierarchy, err));
    lac_transfer_scene from = {.domain = scene->contact.domain,
                               .hierarchy = scene->hierarchy,
                               .shear_modulus = c->material.shear_modulus,
                               .poisson = c->material.poisson,
                               .measure = c->fft_planning != 0 && c->team == NULL,
                               .team = c->team,
                               .line = c->interface.shape == LAC_LINE};
    LAC_TRY(lac_transfer_create(&c->transfer, &from, &scene->transfer, err));
    if (c->slip == LAC_SLIP_VECTOR) {
        LAC_TRY(lac_transfer_direct(&c->transfer, &from, &scene->transfer, err));
    }
    LAC_TRY(share_loads(c, &from, &scene->loads, err));
    LAC_TRY(make_motion(scene, err));
out:
    status = lac_team_agree(c->team, status, err);
    LAC_MADE(status, out, lac_scene_free);
}

void lac_scene_free(lac_scene *scene)
{
    if (scene == NULL) {
        return;
    }
    lac_lump_free(scene->lump);
    lac_problem_free(scene->problem);
    lac_load_set_clear(&scene->loads);
    lac_friction_free(scene->friction);
    lac_transfer_clear(&scene->transfer);
    lac_hierarchy_free(scene->hierarchy);
    lac_scene_contact_clear(&scene->contact);
    free(scene);
}

lac_provenance lac_case_provenance(const lac_case *c, const char *case_text)
{
    const int64_t *seed = lac_model_seed(c->surface.info != NULL ? &c->surface : &c->domain);
    return (lac_provenance){
        .title = c->title != NULL ? c->title : c->path,
        .institution = c->institution,
        .references = c->references,
        .case_text = case_text,
        .seed = seed != NULL ? *seed : INT64_MIN,
    };
}

lac_status lac_made_from_case(const lac_case *c, lac_made_from *out, lac_error *err)
{
    out->case_text = lac_case_text(c);
    out->provenance = lac_case_provenance(c, out->case_text);
    return out->case_text != NULL ? LAC_OK : lac_fail_memory(err);
}
