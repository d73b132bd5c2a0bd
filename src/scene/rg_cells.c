// SPDX-License-Identifier: GPL-3.0-or-later
// The cascade on cells that are known with their tractions: those of a snapshot.
#include <math.h>
#include <stdlib.h>

#include "base/statistics.h"
#include "scene/internal.h"
#include "scene/rg.h"

// Effective over total normal pressure at a time, as in the run itself.
static lac_status find_share(const lac_case *c, double time, double *share, lac_error *err)
{
    const lac_load_models models = {.pore = c->pore.item, .pore_count = c->pore.count};
    const lac_load_clock clock = {.dated = c->dated, .start = c->start_date, .end = time};
    lac_load_set loads;
    lac_load_state at;
    *share = 1.0;
    if (isnan(time) || c->pore.count == 0) {
        return LAC_OK;
    }
    LAC_TRY_RETURN(lac_load_set_create(&models, &clock, &loads, err));
    lac_load_evaluate(&loads, time, &at);
    lac_load_set_clear(&loads);
    double total = lac_case_pressure(c);
    *share = 1.0 - at.pore / total;
    LAC_FAIL_IF(!(*share > 0.0 && isfinite(*share)), err, LAC_EINPUT,
                "at %g s the pore pressure, %g Pa, is not below the normal stress, %g Pa", time,
                at.pore, total);
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
static void look(const lac_scene_joint *j, const double *shear, double share, lac_scene_rg_now *now)
{
    const lac_domain *domain = j->contact.domain;
    const lac_grid *grid = &domain->grid;
    size_t weakest = 0;
    double nominal = 0.0;
    double carried = 0.0;
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
    lac_scene_joint j = {.contact = {.grid = cells->domain->grid, .e_star = NAN}};
    double share = 1.0;
    lac_status status;
    *out = (lac_scene_rg){.grid = cells->domain->grid, .seeds = 1};
    LAC_TRY(find_share(c, cells->time, &share, err));
    LAC_TRY(copy_domain(cells->domain, share, &j.contact.domain, err));
    LAC_TRY(lac_scene_contact_count(&j.contact, err));
    LAC_TRY(lac_scene_joint_strengths(c, &j, err));
    LAC_TRY(lac_rg_path_further(cells->domain->n, j.strength, cells->shear, &j.path, err));
    LAC_TRY(lac_scene_rg_begin(c, out, err));
    LAC_TRY(lac_scene_rg_add(c, &j, out, err));
    j.contact.mean_pressure = mean_pressure(j.contact.domain);
    lac_scene_rg_note(&j.contact, INT64_MIN, 0, out);
    LAC_TRY(lac_scene_rg_end(c, out, err));
    look(&j, cells->shear, share, &out->now);
    out->domain = j.contact.domain;
    j.contact.domain = NULL;
out:
    lac_scene_joint_clear(&j);
    if (status != LAC_OK) {
        lac_scene_rg_clear(out);
    }
    return status;
}
