// SPDX-License-Identifier: GPL-3.0-or-later
#include "lacuna/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/internal.h"

static lac_status make_friction(const lac_case *c, const lac_domain *domain, lac_friction **out,
                                lac_error *err)
{
    lac_status status = LAC_OK;
    double *values = NULL;
    lac_friction *friction = NULL;
    LAC_TRY(lac_friction_create(&c->friction, domain->n, &friction, err));
    if (c->friction_spread.count > 0) {
        values = malloc(domain->n * sizeof *values);
        if (values == NULL) {
            status = lac_fail_memory(err);
            goto out;
        }
    }
    const lac_descriptor *about = c->friction.about;
    for (size_t k = 0; k < c->friction_spread.count; k++) {
        const lac_spread *spread = &c->friction_spread.item[k];
        for (size_t i = 0, column = 0; i < about->param_count; i++) {
            if ((about->params[i].flags & LAC_CELLWISE) == 0) {
                continue;
            }
            if (strcmp(about->params[i].key, spread->key) == 0) {
                lac_spread_fill(spread, domain, friction->column[column], values);
            }
            column++;
        }
        status = lac_friction_set(friction, spread->key, values, err);
        if (status != LAC_OK) {
            (void)lac_fail_within(err, status, "friction.spread.%s", spread->key);
            goto out;
        }
    }
    *out = friction;
    friction = NULL;
out:
    free(values);
    lac_friction_free(friction);
    return status;
}

// One array of initial values over the cells where a spread asks for it, NULL where not.
static lac_status spread_initial(const lac_spread_list *list, const char *key, double nominal,
                                 const lac_domain *domain, double **out, lac_error *err)
{
    const lac_spread *spread = lac_spread_find(list, key);
    *out = NULL;
    if (spread == NULL) {
        return LAC_OK;
    }
    double *values = malloc(domain->n * sizeof *values);
    if (values == NULL) {
        return lac_fail_memory(err);
    }
    for (size_t i = 0; i < domain->n; i++) {
        values[i] = nominal;
    }
    lac_spread_fill(spread, domain, values, values);
    *out = values;
    return LAC_OK;
}

static lac_status make_problem(lac_scene *scene, lac_error *err)
{
    lac_status status = LAC_OK;
    const lac_case *c = scene->source;
    const lac_domain *domain = scene->contact.domain;
    lac_initial_def initial = c->initial;
    double *rates = NULL;
    double *states = NULL;
    double *start = malloc(2 * domain->n * sizeof *start);
    if (start == NULL) {
        return lac_fail_memory(err);
    }
    LAC_TRY(
        spread_initial(&c->initial_spread, "slip_rate", initial.slip_rate, domain, &rates, err));
    LAC_TRY(spread_initial(&c->initial_spread, "state", initial.state_value, domain, &states, err));
    initial.rates = rates;
    initial.states = states;
    status = lac_initial_solve(&initial, domain, scene->friction, &scene->loads, scene->damping,
                               start, start + domain->n, err);
    if (status != LAC_OK) {
        (void)lac_fail_within(err, status, "initial");
        goto out;
    }
    lac_problem_def def = {.domain = domain,
                           .friction = scene->friction,
                           .transfer = &scene->transfer,
                           .loads = scene->loads,
                           .damping = scene->damping,
                           .log_rate = start,
                           .log_state = start + domain->n};
    LAC_TRY(lac_problem_create(&def, &scene->problem, err));
out:
    free(start);
    free(rates);
    free(states);
    return status;
}

lac_status lac_scene_create(const lac_case *c, lac_scene **out, lac_error *err)
{
    lac_status status = LAC_OK;
    *out = NULL;
    if (c->friction.about == NULL) {
        return lac_fail(err, LAC_EINPUT, "friction: is missing: a static case cannot be run");
    }
    lac_scene *scene = calloc(1, sizeof *scene);
    if (scene == NULL) {
        return lac_fail_memory(err);
    }
    scene->source = c;
    scene->damping = lac_damping_of(&c->material);
    scene->loads = (lac_load_set){.shear = c->shear.item,
                                  .shear_count = c->shear.count,
                                  .pore = c->pore.item,
                                  .pore_count = c->pore.count};
    LAC_TRY(lac_scene_contact_solve(c, false, &scene->contact, err));
    LAC_TRY(lac_hierarchy_create(scene->contact.domain, &scene->hierarchy, err));
    lac_transfer_scene from = {.domain = scene->contact.domain,
                               .hierarchy = scene->hierarchy,
                               .shear_modulus = c->material.shear_modulus,
                               .poisson = c->material.poisson,
                               .line = c->interface.shape == LAC_LINE};
    status = lac_transfer_create(&c->transfer, &from, &scene->transfer, err);
    if (status != LAC_OK) {
        (void)lac_fail_within(err, status, "transfer");
        goto out;
    }
    LAC_TRY(make_friction(c, scene->contact.domain, &scene->friction, err));
    LAC_TRY(make_problem(scene, err));
    *out = scene;
    scene = NULL;
out:
    lac_scene_free(scene);
    return status;
}

void lac_scene_free(lac_scene *scene)
{
    if (scene == NULL) {
        return;
    }
    lac_problem_free(scene->problem);
    lac_friction_free(scene->friction);
    lac_transfer_clear(&scene->transfer);
    lac_hierarchy_free(scene->hierarchy);
    lac_scene_contact_clear(&scene->contact);
    free(scene);
}
