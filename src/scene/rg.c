// SPDX-License-Identifier: GPL-3.0-or-later
// The cascade of a case: interface by interface, the contact under falling load, then the blocks.
#include "scene/rg.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/statistics.h"
#include "scene/internal.h"

void lac_scene_joint_clear(lac_scene_joint *j)
{
    lac_scene_contact_clear(&j->contact);
    lac_rg_path_free(j->path);
    free(j->strength);
    free(j->drop);
    *j = (lac_scene_joint){0};
}

// Pressures under the falling load, and the gaps that follow.
static lac_status elastic_path(const lac_case *c, const lac_scene_contact *contact,
                               lac_rg_path **path, lac_error *err)
{
    const size_t n = contact->domain->n;
    const size_t loads = (size_t)c->rg.contacts;
    const lac_contact_def def = lac_scene_contact_def(contact);
    double part[LAC_RG_MOST_LOADS];
    double *pressure = malloc(loads * n * sizeof *pressure);
    lac_status status = pressure != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    LAC_TRY(lac_rg_series_solve(&def, contact->domain, loads, pressure, err));
    lac_rg_loads(loads, part);
    const lac_rg_series series = {n, loads, part, pressure, c->rg.friction};
    LAC_TRY(lac_rg_path_elastic(&series, path, err));
out:
    free(pressure);
    return status == LAC_OK ? LAC_OK : lac_fail_within(err, status, "contact under less load");
}

lac_status lac_scene_joint_strengths(const lac_case *c, lac_scene_joint *j, lac_error *err)
{
    const lac_domain *domain = j->contact.domain;
    j->strength = malloc(domain->n * sizeof *j->strength);
    j->drop = malloc(domain->n * sizeof *j->drop);
    LAC_FAIL_MEMORY_IF(j->strength == NULL || j->drop == NULL, err);
    for (size_t i = 0; i < domain->n; i++) {
        j->strength[i] = c->rg.friction * domain->pressure[i];
    }
    return LAC_OK;
}

static lac_status make_joint(const lac_case *c, lac_scene_joint *j, lac_error *err)
{
    lac_status status;
    LAC_TRY(lac_scene_contact_make(c, LAC_SCENE_FIELDS, &j->contact, err));
    const lac_domain *domain = j->contact.domain;
    LAC_TRY(lac_scene_joint_strengths(c, j, err));
    lac_rg_path *path = NULL;
    switch ((lac_rg_field)c->rg.field) {
    case LAC_RG_ELASTIC:
        status = elastic_path(c, &j->contact, &path, err);
        break;
    case LAC_RG_EQUAL:
        status = lac_rg_path_further(domain->n, j->strength, NULL, &path, err);
        break;
    case LAC_RG_UNIFORM:
        status = lac_rg_path_uniform(domain->n, j->strength, &path, err);
        break;
    }
    j->path = path;
out:
    if (status != LAC_OK) {
        lac_scene_joint_clear(j);
    }
    return status;
}

// 1 - beta after arrest under friction without healing: the larger root of
// x = (b/f0) ln[x f0 p/(eta v0)]; NaN where there is none up to 1. docs/theory/rg.md eq. 5.
static double drop_after_arrest(const lac_friction_params *law, double strength, double damping)
{
    const double s = law->b / law->f0;
    const double k = strength / (damping * law->v0);
    // f(x) = x - s ln(k x) falls to x = s and rises beyond, where Newton's steps stay on the right.
    if (!(s > 0.0 && s < 1.0 && s - s * log(k * s) < 0.0 && 1.0 - s * log(k) >= 0.0)) {
        return NAN;
    }
    double x = 1.0;
    for (int i = 0; i < 100; i++) {
        double next = x - (x - s * log(k * x)) / (1.0 - s / x);
        if (!(next < x)) {
            break;
        }
        x = next;
    }
    return x;
}

static lac_status drops_from_friction(const lac_case *c, lac_scene_joint *j, double *sum,
                                      lac_error *err)
{
    const lac_friction_params *law = c->friction.params;
    const double damping = lac_damping_of(&c->material);
    const lac_domain *domain = j->contact.domain;
    for (size_t i = 0; i < domain->n; i++) {
        double x = drop_after_arrest(law, law->f0 * domain->pressure[i], damping);
        LAC_FAIL_IF(!(x > 0.0), err, LAC_EINPUT,
                    "rg.beta: from-friction: a cell under %.4g Pa arrests at no strength between 0 "
                    "and f0 p, with b/f0 = %.4g, v0 = %.4g m/s and a damping of %.4g Pa s/m",
                    domain->pressure[i], law->b / law->f0, law->v0, damping);
        j->drop[i] = x * j->strength[i];
        *sum += (1.0 - x) / (double)domain->n;
    }
    return LAC_OK;
}

lac_status lac_scene_rg_add(const lac_case *c, lac_scene_joint *j, lac_scene_rg *out,
                            lac_error *err)
{
    const lac_domain *domain = j->contact.domain;
    const lac_contact_def contact = lac_scene_contact_def(&j->contact);
    const lac_rg_resolve_def press = {&contact, domain, c->rg.friction};
    const bool solved = c->rg.path == LAC_RG_SOLVE && c->rg.field == LAC_RG_ELASTIC;
    lac_status status = LAC_OK;
    for (size_t k = 0; k < out->betas; k++) {
        if (c->rg.betas == 0) {
            LAC_TRY(drops_from_friction(c, j, &out->beta[k], err));
        }
        for (size_t i = 0; i < domain->n && c->rg.betas > 0; i++) {
            j->drop[i] = (1.0 - out->beta[k]) * j->strength[i];
        }
        const lac_rg_joint part = {domain, j->strength, j->drop, j->path, solved ? &press : NULL};
        LAC_TRY(lac_rg_study_add(out->study[k], &part, err));
    }
    double total = lac_sum(domain->n, j->strength);
    out->strength += total / (double)lac_grid_cells(&domain->grid) / (double)out->seeds;
out:
    return status;
}

// The seed of the interface at hand, else that of its first random spread; INT64_MIN where it has
// none.
static int64_t seed_now(const lac_case *c)
{
    const int64_t *seed = lac_model_seed(c->surface.info != NULL ? &c->surface : &c->domain);
    const lac_heterogeneity_list *spreads = &c->interface_spread;
    for (size_t k = 0; seed == NULL && k < spreads->count; k++) {
        seed = lac_model_seed(&spreads->item[k].model);
    }
    return seed != NULL ? *seed : INT64_MIN;
}

void lac_scene_rg_note(const lac_scene_contact *contact, int64_t seed, size_t i, lac_scene_rg *out)
{
    const double cells = (double)lac_grid_cells(&contact->grid);
    const double n = (double)out->seeds;
    lac_rg_interface *one = &out->interface[i];
    *one = (lac_rg_interface){
        .seed = seed,
        .pressure = contact->mean_pressure,
        .contact_fraction = (double)contact->domain->n / cells,
        .dimension = contact->counted ? contact->boxes.dimension : NAN,
        .dyadic = contact->blocks.dimension,
    };
    out->mean.seed = INT64_MIN;
    out->mean.pressure += one->pressure / n;
    out->mean.contact_fraction += one->contact_fraction / n;
    out->mean.dimension += one->dimension / n;
    out->mean.dyadic += one->dyadic / n;
}

lac_status lac_scene_rg_begin(const lac_case *c, lac_scene_rg *out, lac_error *err)
{
    lac_rg_study_def def = lac_rg_study_default();
    lac_status status = LAC_OK;
    def.rule = (lac_rg_rule)c->rg.rule;
    def.places = (size_t)c->rg.shifts;
    def.loads = (size_t)c->rg.loads;
    out->interface = calloc(out->seeds, sizeof *out->interface);
    status = out->interface != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    out->betas = c->rg.betas > 0 ? c->rg.betas : 1;
    for (size_t k = 0; k < out->betas; k++) {
        out->beta[k] = c->rg.betas > 0 ? c->rg.beta[k] : 0.0;
        LAC_TRY(lac_rg_study_create(&def, &out->study[k], err));
    }
out:
    return status;
}

// The next interface: of what makes it every seed, one higher.
static void next_seed(const lac_case *c)
{
    int64_t *seed = lac_model_seed(c->surface.info != NULL ? &c->surface : &c->domain);
    if (seed != NULL) {
        ++*seed;
    }
    for (size_t k = 0; k < c->interface_spread.count; k++) {
        int64_t *of_spread = lac_model_seed(&c->interface_spread.item[k].model);
        if (of_spread != NULL) {
            ++*of_spread;
        }
    }
}

static lac_status all_seeds(const lac_case *c, const lac_rg_watch *watch, lac_scene_rg *out,
                            lac_error *err)
{
    lac_status status = LAC_OK;
    lac_scene_joint j = {0};
    for (size_t i = 0; i < out->seeds; i++) {
        if (watch != NULL && !watch->go_on(watch->context, i, out->seeds)) {
            status = lac_fail(err, LAC_EINTERRUPT, "interrupted after %zu of %zu interfaces", i,
                              out->seeds);
            goto out;
        }
        LAC_TRY(make_joint(c, &j, err));
        LAC_TRY(lac_scene_rg_add(c, &j, out, err));
        lac_scene_rg_note(&j.contact, seed_now(c), i, out);
        if (i + 1 == out->seeds) {
            out->domain = j.contact.domain;
            j.contact.domain = NULL;
        }
        lac_scene_joint_clear(&j);
        next_seed(c);
    }
out:
    lac_scene_joint_clear(&j);
    return status;
}

// Parameters of a model's own, so that its seed can be set; their texts stay the case's.
static lac_status own_params(lac_model *model, lac_error *err)
{
    size_t size = model->info != NULL ? model->info->params_size : 0;
    const void *given = model->params;
    model->params = malloc(size + 1);
    LAC_FAIL_MEMORY_IF(model->params == NULL, err);
    if (size > 0) {
        memcpy(model->params, given, size);
    }
    return LAC_OK;
}

static void free_source(const lac_case *own, const lac_model *model)
{
    free(model->params);
    for (size_t k = 0; k < own->interface_spread.count; k++) {
        free(own->interface_spread.item[k].model.params);
    }
    free(own->interface_spread.item);
}

// The case with parameters of its own for what makes the interface.
static lac_status own_source(const lac_case *c, lac_case *own, lac_model **model, lac_error *err)
{
    const lac_heterogeneity_list *given = &c->interface_spread;
    *own = *c;
    *model = c->surface.info != NULL ? &own->surface : &own->domain;
    lac_heterogeneity_list *list = &own->interface_spread;
    *list = (lac_heterogeneity_list){.item = malloc((given->count + 1) * sizeof *list->item)};
    lac_status status = own_params(*model, err);
    if (status == LAC_OK && list->item == NULL) {
        status = lac_fail_memory(err);
    }
    for (size_t k = 0; status == LAC_OK && k < given->count; k++) {
        list->item[k] = given->item[k]; // its key stays the case's
        list->count++;
        status = own_params(&list->item[k].model, err);
    }
    if (status != LAC_OK) {
        free_source(own, *model);
    }
    return status;
}

lac_status lac_scene_rg_end(const lac_case *c, lac_scene_rg *out, lac_error *err)
{
    lac_status status = LAC_OK;
    out->beta[0] /= c->rg.betas == 0 ? (double)out->seeds : 1.0;
    for (size_t k = 0; k < out->betas; k++) {
        LAC_TRY(lac_rg_study_finish(out->study[k], &out->result[k], err));
    }
out:
    return status;
}

lac_status lac_scene_rg_run(const lac_case *c, const lac_rg_watch *watch, lac_scene_rg *out,
                            lac_error *err)
{
    lac_case own;
    lac_model *model = NULL;
    lac_status status = own_source(c, &own, &model, err);
    *out = (lac_scene_rg){.grid = lac_interface_grid(&c->interface), .seeds = (size_t)c->rg.seeds};
    if (status != LAC_OK) {
        return status;
    }
    LAC_TRY(lac_scene_rg_begin(c, out, err));
    LAC_TRY(all_seeds(&own, watch, out, err));
    LAC_TRY(lac_scene_rg_end(c, out, err));
out:
    free_source(&own, model);
    if (status != LAC_OK) {
        lac_scene_rg_clear(out);
    }
    return status;
}

void lac_scene_rg_clear(lac_scene_rg *rg)
{
    for (size_t k = 0; k < rg->betas; k++) {
        lac_rg_study_free(rg->study[k]);
    }
    lac_domain_free(rg->domain);
    free(rg->interface);
    *rg = (lac_scene_rg){0};
}
