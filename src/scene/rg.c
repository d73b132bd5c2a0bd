// SPDX-License-Identifier: GPL-3.0-or-later
// The cascade of a case: interface by interface, the contact under falling load, then the blocks;
// or on cells that are known with their tractions: those of a snapshot.
#include "base/statistics.h"
#include "scene/internal.h"
#include "scene/scene_rg.h"

// One interface under the cascade.
typedef struct joint {
    lac_scene_contact contact;
    double *strength, *drop; // [n] [Pa]
    lac_rg_path *path;
} joint;

static void clear_joint(joint *j)
{
    lac_scene_contact_clear(&j->contact);
    lac_rg_path_free(j->path);
    free(j->strength);
    *j = (joint){0};
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
    lac_status status;
    LAC_TRY(pressure != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(lac_rg_series_solve(&def, contact->domain, loads, pressure, err));
    lac_rg_loads(loads, part);
    const lac_rg_series series = {n, loads, part, pressure, c->rg.friction};
    LAC_TRY(lac_rg_path_elastic(&series, path, err));
out:
    free(pressure);
    return lac_fail_within(err, status, "contact under less load");
}

// Strengths f p of the domain, and room for the drops.
static lac_status find_strengths(const lac_case *c, joint *j, lac_error *err)
{
    const lac_domain *domain = j->contact.domain;
    j->strength = malloc(2 * domain->n * sizeof *j->strength);
    LAC_FAIL_MEMORY_IF(j->strength == NULL, err);
    j->drop = j->strength + domain->n;
    for (size_t i = 0; i < domain->n; i++) {
        j->strength[i] = c->rg.friction * domain->pressure[i];
    }
    return LAC_OK;
}

static lac_status make_joint(const lac_case *c, joint *j, lac_error *err)
{
    LAC_TRY_RETURN(lac_scene_contact_solve(c, LAC_SCENE_FIELDS, &j->contact, err));
    const lac_domain *domain = j->contact.domain;
    LAC_TRY_RETURN(find_strengths(c, j, err));
    switch ((lac_rg_field)c->rg.field) {
    case LAC_RG_ELASTIC:
        return elastic_path(c, &j->contact, &j->path, err);
    case LAC_RG_EQUAL:
        return lac_rg_path_further(domain->n, j->strength, NULL, &j->path, err);
    case LAC_RG_UNIFORM:
        break;
    }
    return lac_rg_path_uniform(domain->n, j->strength, &j->path, err);
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

// @param mean  is added to
static lac_status drops_from_friction(const lac_case *c, joint *j, double *mean, lac_error *err)
{
    double own = 0.0;
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
        own += (1.0 - x) / (double)domain->n;
    }
    *mean += own;
    return LAC_OK;
}

// Lets all studies run on a joint; sums up what is averaged over joints.
static lac_status add_joint(const lac_case *c, joint *j, lac_scene_rg *out, lac_error *err)
{
    const lac_domain *domain = j->contact.domain;
    const lac_contact_def contact = lac_scene_contact_def(&j->contact);
    const lac_rg_resolve_def press = {&contact, domain, c->rg.friction};
    const bool solved = c->rg.path == LAC_RG_SOLVE && c->rg.field == LAC_RG_ELASTIC;
    for (size_t k = 0; k < out->betas; k++) {
        if (c->rg.betas == 0) {
            LAC_TRY_RETURN(drops_from_friction(c, j, &out->beta[k], err));
        }
        for (size_t i = 0; i < domain->n && c->rg.betas > 0; i++) {
            j->drop[i] = (1.0 - out->beta[k]) * j->strength[i];
        }
        const lac_rg_joint part = {domain, j->strength, j->drop, j->path, solved ? &press : NULL};
        LAC_TRY_RETURN(lac_rg_study_add(out->study[k], &part, err));
    }
    double total = lac_sum(domain->n, j->strength);
    out->strength += total / (double)lac_grid_cells(&domain->grid) / (double)out->seeds;
    return LAC_OK;
}

// What makes the interface: its source, then its spreads; NULL past the end.
static lac_model *maker(const lac_case *c, size_t k)
{
    const lac_model *source = c->surface.info != NULL ? &c->surface : &c->domain;
    const lac_heterogeneity_list *spreads = &c->interface_spread;
    return k == 0 ? (lac_model *)source : k <= spreads->count ? &spreads->item[k - 1].model : NULL;
}

// The first seed of the interface at hand; INT64_MIN where it has none.
static int64_t seed_now(const lac_case *c)
{
    const int64_t *seed = NULL;
    const lac_model *model;
    for (size_t k = 0; seed == NULL && (model = maker(c, k)) != NULL; k++) {
        seed = lac_model_seed(model);
    }
    return seed != NULL ? *seed : INT64_MIN;
}

// What an interface is like.
static lac_rg_interface look_at(const lac_scene_contact *contact, int64_t seed)
{
    const double cells = (double)lac_grid_cells(&contact->grid);
    return (lac_rg_interface){
        .seed = seed,
        .pressure = contact->mean_pressure,
        .contact_fraction = (double)contact->domain->n / cells,
        .dimension = contact->counted ? contact->boxes.dimension : NAN,
        .dyadic = contact->blocks.dimension,
    };
}

// Adds what interface i of the ensemble is like to the list and to the mean.
static void note(const lac_rg_interface *one, size_t i, lac_scene_rg *out)
{
    const double n = (double)out->seeds;
    out->interface[i] = *one;
    out->mean.seed = INT64_MIN;
    out->mean.pressure += one->pressure / n;
    out->mean.contact_fraction += one->contact_fraction / n;
    out->mean.dimension += one->dimension / n;
    out->mean.dyadic += one->dyadic / n;
}

static lac_rg_study_def study_def(const lac_case *c, size_t first)
{
    lac_rg_study_def def = lac_rg_study_default();
    def.rule = (lac_rg_rule)c->rg.rule;
    def.places = (size_t)c->rg.shifts;
    def.loads = (size_t)c->rg.loads;
    def.first = first;
    return def;
}

static size_t betas_of(const lac_case *c) { return c->rg.betas > 0 ? c->rg.betas : 1; }

static lac_status begin(const lac_case *c, size_t first, lac_scene_rg *out, lac_error *err)
{
    const lac_rg_study_def def = study_def(c, first);
    out->interface = calloc(out->seeds, sizeof *out->interface);
    LAC_FAIL_MEMORY_IF(out->interface == NULL, err);
    out->betas = betas_of(c);
    for (size_t k = 0; k < out->betas; k++) {
        out->beta[k] = c->rg.betas > 0 ? c->rg.beta[k] : 0.0;
        LAC_TRY_RETURN(lac_rg_study_create(&def, &out->study[k], err));
    }
    return LAC_OK;
}

// The next interface: of what makes it every seed, one higher.
static void next_seed(const lac_case *c)
{
    const lac_model *model;
    for (size_t k = 0; (model = maker(c, k)) != NULL; k++) {
        int64_t *seed = lac_model_seed(model);
        if (seed != NULL) {
            ++*seed;
        }
    }
}

static lac_status add_seed(const lac_case *c, joint *j, size_t i, lac_scene_rg *out, lac_error *err)
{
    LAC_TRY_RETURN(make_joint(c, j, err));
    LAC_TRY_RETURN(add_joint(c, j, out, err));
    const lac_rg_interface one = look_at(&j->contact, seed_now(c));
    note(&one, i, out);
    return LAC_OK;
}

// What an interface gave that was made elsewhere; behind it the part of each study.
typedef struct part {
    lac_rg_interface one;
    double strength, beta; // what it adds to the means; beta: from the friction law
} part;

static size_t study_part_size(const lac_case *c)
{
    const lac_rg_study_def def = study_def(c, 0);
    const lac_grid grid = lac_interface_grid(&c->interface);
    return lac_rg_study_part_size(&def, &grid);
}

size_t lac_scene_rg_part_size(const lac_case *c)
{
    return sizeof(part) + betas_of(c) * study_part_size(c);
}

static lac_status take_part(const lac_case *c, const part *made, size_t i, lac_scene_rg *out,
                            lac_error *err)
{
    const unsigned char *of_study = (const unsigned char *)(made + 1);
    for (size_t k = 0; k < out->betas; k++, of_study += study_part_size(c)) {
        LAC_TRY_RETURN(lac_rg_study_take(out->study[k], &out->grid, of_study, err));
    }
    out->beta[0] += c->rg.betas == 0 ? made->beta : 0.0;
    out->strength += made->strength;
    note(&made->one, i, out);
    return LAC_OK;
}

static lac_status all_seeds(const lac_case *c, const lac_rg_watch *watch, lac_scene_rg *out,
                            lac_error *err)
{
    lac_status status = LAC_OK;
    joint j = {0};
    for (size_t i = 0; i < out->seeds; i++, next_seed(c)) {
        const void *made = watch != NULL && watch->made != NULL && i + 1 < out->seeds
                               ? watch->made(watch->context, i)
                               : NULL;
        if (made != NULL) {
            LAC_TRY(take_part(c, made, i, out, err));
            continue;
        }
        LAC_LEAVE_IF(watch != NULL && !watch->go_on(watch->context, i, out->seeds), err,
                     LAC_EINTERRUPT, "interrupted after %zu of %zu interfaces", i, out->seeds);
        LAC_TRY(add_seed(c, &j, i, out, err));
        if (i + 1 == out->seeds) {
            out->domain = j.contact.domain;
            j.contact.domain = NULL;
        }
        clear_joint(&j);
    }
out:
    clear_joint(&j);
    return status;
}

static size_t room_for(const lac_model *model)
{
    const size_t size = model->info != NULL ? model->info->params_size : 0;
    return (size / sizeof(max_align_t) + 1) * sizeof(max_align_t);
}

// The case with parameters of its own for what makes the interface, so that seeds can be set; their
// texts stay the case's.
// @return what holds them, to be freed; NULL: no memory
static void *own_source(const lac_case *c, lac_case *own)
{
    const lac_heterogeneity_list *given = &c->interface_spread;
    const lac_model *from;
    size_t size = (given->count + 1) * sizeof *given->item;
    size_t at = size += -size % sizeof(max_align_t);
    for (size_t k = 0; (from = maker(c, k)) != NULL; k++) {
        size += room_for(from);
    }
    char *room = calloc(1, size);
    *own = *c;
    own->interface_spread.item = (void *)room;
    for (size_t k = 0; room != NULL && (from = maker(c, k)) != NULL; k++) {
        if (k > 0) {
            own->interface_spread.item[k - 1] = given->item[k - 1];
        }
        if (from->params != NULL && from->info != NULL) {
            memcpy(room + at, from->params, from->info->params_size);
        }
        maker(own, k)->params = room + at;
        at += room_for(from);
    }
    return room;
}

static lac_status finish(const lac_case *c, lac_scene_rg *out, lac_error *err)
{
    out->beta[0] /= c->rg.betas == 0 ? (double)out->seeds : 1.0;
    for (size_t k = 0; k < out->betas; k++) {
        LAC_TRY_RETURN(lac_rg_study_finish(out->study[k], &out->result[k], err));
    }
    return LAC_OK;
}

lac_status lac_scene_rg_run(const lac_case *c, const lac_rg_watch *watch, lac_scene_rg *out,
                            lac_error *err)
{
    lac_case own;
    lac_status status;
    *out = (lac_scene_rg){.grid = lac_interface_grid(&c->interface), .seeds = (size_t)c->rg.seeds};
    void *room = own_source(c, &own);
    LAC_FAIL_MEMORY_IF(room == NULL, err);
    LAC_TRY(begin(c, 0, out, err));
    LAC_TRY(all_seeds(&own, watch, out, err));
    LAC_TRY(finish(c, out, err));
out:
    free(room);
    if (status != LAC_OK) {
        lac_scene_rg_clear(out);
    }
    return status;
}

lac_status lac_scene_rg_part(const lac_case *c, size_t seed, void *out, lac_error *err)
{
    lac_case own;
    joint j = {0};
    lac_scene_rg one = {.grid = lac_interface_grid(&c->interface), .seeds = (size_t)c->rg.seeds};
    unsigned char *of_study = (unsigned char *)out + sizeof(part);
    lac_status status;
    void *room = own_source(c, &own);
    LAC_FAIL_MEMORY_IF(room == NULL, err);
    LAC_TRY(begin(c, seed, &one, err));
    for (size_t i = 0; i < seed; i++) {
        next_seed(&own);
    }
    LAC_TRY(add_seed(&own, &j, seed, &one, err));
    *(part *)out = (part){one.interface[seed], one.strength, one.beta[0]};
    for (size_t k = 0; k < one.betas; k++, of_study += study_part_size(c)) {
        lac_rg_study_give(one.study[k], of_study);
    }
out:
    clear_joint(&j);
    lac_scene_rg_clear(&one);
    free(room);
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

// Effective over total normal pressure at a time, as in the run itself.
static lac_status find_share(const lac_case *c, double time, double *share, lac_error *err)
{
    const lac_load_models models = {.pore = c->pore.item,
                                    .pore_count = c->pore.count,
                                    .normal = c->pressing.item,
                                    .normal_count = c->pressing.count};
    const lac_load_clock clock = {.dated = c->dated, .start = c->start_date, .end = time};
    lac_load_set loads;
    lac_load_state at;
    *share = 1.0;
    if (isnan(time) || c->pore.count + c->pressing.count == 0) {
        return LAC_OK;
    }
    LAC_TRY_RETURN(lac_load_set_create(&models, &clock, &loads, err));
    lac_load_evaluate(&loads, time, &at);
    const bool varies = loads.varies;
    lac_load_set_clear(&loads);
    LAC_FAIL_IF(varies, err, LAC_EINPUT,
                "load.%s: differs from cell to cell, which rg does not follow",
                c->pressing.count == 0 ? "pore_pressure" : "pore_pressure or load.normal_stress");
    double total = lac_case_pressure(c);
    *share = 1.0 - lac_load_taken(&at) / total;
    LAC_FAIL_IF(!(*share > 0.0 && isfinite(*share)), err, LAC_EINPUT,
                "at %g s the pore pressure, %g Pa, is not below the normal stress, %g Pa", time,
                at.pore, total + at.normal);
    return LAC_OK;
}

static lac_status copy_domain(const lac_domain *from, double share, lac_domain **out,
                              lac_error *err)
{
    lac_domain *domain = calloc(1, sizeof *domain);
    *out = domain;
    LAC_FAIL_MEMORY_IF(domain == NULL, err);
    domain->grid = from->grid;
    domain->n = from->n;
    domain->index = malloc(from->n * sizeof *domain->index);
    domain->pressure = malloc(from->n * sizeof *domain->pressure);
    LAC_FAIL_MEMORY_IF(domain->index == NULL || domain->pressure == NULL, err);
    for (size_t i = 0; i < from->n; i++) {
        domain->index[i] = from->index[i];
        domain->pressure[i] = share * from->pressure[i];
    }
    return LAC_OK;
}

// Normal force over the nominal area.
static double mean_pressure(const lac_domain *domain)
{
    return lac_sum(domain->n, domain->pressure) / (double)lac_grid_cells(&domain->grid);
}

// How loaded the joint is, and its weakest cell.
static void look(const joint *j, const double *shear, double share, lac_scene_rg_now *now)
{
    const lac_domain *domain = j->contact.domain;
    const lac_grid *grid = &domain->grid;
    size_t weakest = 0;
    double nominal = 0.0, carried = 0.0;
    for (size_t i = 0; i < domain->n; i++) {
        double gap = j->strength[i] - shear[i];
        weakest = gap < j->strength[weakest] - shear[weakest] ? i : weakest;
        nominal += j->strength[i];
        carried += shear[i];
    }
    uint32_t at = domain->index[weakest];
    *now = (lac_scene_rg_now){
        .loaded = true,
        .load = carried / nominal,
        .share = share,
        .weakest_gap = j->strength[weakest] - shear[weakest],
        .weakest = {lac_grid_x(grid, at), lac_grid_y(grid, at)},
    };
}

lac_status lac_scene_rg_cells(const lac_case *c, const lac_rg_cells *cells, lac_scene_rg *out,
                              lac_error *err)
{
    joint j = {.contact = {.grid = cells->domain->grid, .e_star = NAN}};
    lac_rg_path *path = NULL;
    double share = 1.0;
    lac_status status;
    *out = (lac_scene_rg){.grid = cells->domain->grid, .seeds = 1};
    LAC_TRY(find_share(c, cells->time, &share, err));
    LAC_TRY(copy_domain(cells->domain, share, &j.contact.domain, err));
    LAC_TRY(lac_scene_contact_count(&j.contact, err));
    LAC_TRY(find_strengths(c, &j, err));
    LAC_TRY(lac_rg_path_further(cells->domain->n, j.strength, cells->shear, &path, err));
    j.path = path;
    LAC_TRY(begin(c, 0, out, err));
    LAC_TRY(add_joint(c, &j, out, err));
    j.contact.mean_pressure = mean_pressure(j.contact.domain);
    const lac_rg_interface one = look_at(&j.contact, INT64_MIN);
    note(&one, 0, out);
    LAC_TRY(finish(c, out, err));
    look(&j, cells->shear, share, &out->now);
    out->domain = j.contact.domain;
    j.contact.domain = NULL;
out:
    clear_joint(&j);
    if (status != LAC_OK) {
        lac_scene_rg_clear(out);
    }
    return status;
}
