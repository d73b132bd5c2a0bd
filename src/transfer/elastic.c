// SPDX-License-Identifier: GPL-3.0-or-later
// The rock itself as stress transfer: a filter on full contact, an iteration where there are gaps.
#include "base/rows.h"
#include "base/statistics.h"
#include "transfer/calibrate.h"
#include "transfer/elastic_solve.h"

enum { IN_PLANE, ANTIPLANE };
enum { UNLOADED, CREEPING };
enum { NO_BOUNDARY, FREE_SURFACE };

static const char *const modes[] = {"in-plane", "antiplane", NULL};
static const char *const surroundings[] = {"unloaded", "creeping", NULL};
static const char *const boundaries[] = {"none", "free-surface", NULL};

static const lac_param params[] = {
    LAC_CHOICE("mode", offsetof(lac_transfer_elastic, mode), IN_PLANE, modes, 0,
               "in-plane: slip along x in rock with Poisson's ratio; antiplane: the scalar "
               "problem, no Poisson's ratio; on a line, slip across it"),
    LAC_CHOICE("outside", offsetof(lac_transfer_elastic, outside), UNLOADED, surroundings, 0,
               "beyond a free border: unloaded, the faces apart; creeping, slip uniform at the "
               "rate of load.shear.back-slip (none: held), on full contact only"),
    LAC_CHOICE(
        "boundary", offsetof(lac_transfer_elastic, boundary), NO_BOUNDARY, boundaries, 0,
        "of the rock: none; free-surface, where it ends at x = 0 of an antiplane line, or at "
        "y = 0 of a plane that stands upright and slips along x; with outside: creeping"),
    LAC_REAL("thickness", "m", offsetof(lac_transfer_elastic, thickness), NAN, 0, 1e9,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "of the rock on either side, its far face rigid: gives the mean slip the stiffness "
             "G/(2 thickness); half-spaces if absent; periodic interfaces only"),
    LAC_REAL("tolerance", "1", offsetof(lac_transfer_elastic, tolerance), 1e-9, 1e-14, 1e-2, 0,
             "relative, of the stress where gaps make it an iteration; tighter than solver.rtol"),
    LAC_REAL("newton_tolerance", "1", offsetof(lac_transfer_elastic, newton_tolerance), 1e-3, 1e-14,
             0.1, 0, "relative, of the linear solve in each Newton iteration of bdf"),
};

static const char *fault(const void *given)
{
    const lac_transfer_elastic *p = given;
    bool both = p->outside == CREEPING && !isnan(p->thickness);
    return both ? "outside: creeping needs a free border, thickness a periodic one: not both"
           : p->boundary == FREE_SURFACE && p->outside != CREEPING
               ? "boundary: free-surface needs outside: creeping"
               : NULL;
}

static bool is_full(const lac_domain *domain) { return domain->n == lac_grid_cells(&domain->grid); }

static void destroy(void *state)
{
    lac_elastic *e = state;
    if (e != NULL) {
        lac_compliance_free(e->rock);
        free(e->k);
        free(e->last);
        free(e->k_across);
        lac_compliance_free(e->across);
        lac_compliance_free(e->cross);
        free(e);
    }
}

// The preconditioner's stiffness of every level. It need not know what holds the mean slip.
static lac_status calibrate(const lac_transfer_scene *scene, double poisson, lac_elastic *e,
                            lac_error *err)
{
    lac_transfer_scene from = *scene;
    e->k = calloc(lac_hierarchy_levels(scene->hierarchy) + 1, sizeof *e->k);
    from.poisson = poisson;
    return e->k != NULL ? lac_calibrate_elastic(&from, false, 1, e->k, err) : lac_fail_memory(err);
}

// NaN stands for no slip yet; it is also its own stress.
static lac_status make_last(lac_elastic *e, lac_error *err)
{
    e->last = malloc(2 * e->n * sizeof *e->last);
    LAC_FAIL_MEMORY_IF(e->last == NULL, err);
    for (size_t i = 0; i < 2 * e->n; i++) {
        e->last[i] = NAN;
    }
    return LAC_OK;
}

// Stiffness of the mean slip: the mean traction under unit slip, or as little as a unit mean
// traction asks for.
static lac_status find_anchor(lac_elastic *e, lac_team *team, lac_error *err)
{
    double *x = lac_team_alloc(team, e->n * sizeof *x);
    LAC_FAIL_MEMORY_IF(x == NULL, err);
    for (size_t i = 0; i < e->n; i++) {
        x[i] = 1;
    }
    if (e->direct) {
        lac_compliance_traction(e->rock, x, x);
    } else {
        lac_compliance_slip(e->rock, x, x);
    }
    double mean = lac_mean(e->n, x);
    free(x);
    e->anchor = e->direct ? mean : 1 / mean;
    return LAC_OK;
}

static lac_rock rock_of(const lac_transfer_elastic *p, const lac_transfer_scene *scene)
{
    return (lac_rock){.shear_modulus = scene->shear_modulus,
                      .poisson = p->mode == ANTIPLANE ? 0 : scene->poisson,
                      .thickness = isnan(p->thickness) ? INFINITY : p->thickness,
                      .antiplane = p->mode == ANTIPLANE,
                      .line = scene->line,
                      .measure = scene->measure,
                      .team = scene->team,
                      .creeping = p->outside == CREEPING,
                      .surface = p->boundary == FREE_SURFACE};
}

// The rock of some parameters on a domain, without what a Newton iteration needs beside it.
static lac_status begin(const lac_transfer_elastic *p, const lac_transfer_scene *scene,
                        lac_rock *rock, lac_elastic **out, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_elastic *e = *out = calloc(1, sizeof *e);
    LAC_FAIL_MEMORY_IF(e == NULL, err);
    *rock = rock_of(p, scene);
    e->n = scene->domain->n;
    e->h = scene->hierarchy;
    e->direct = is_full(scene->domain) && (scene->domain->grid.periodic || rock->creeping);
    e->floating = isinf(rock->thickness) && !rock->creeping;
    e->tolerance = p->tolerance;
    e->newton_tolerance = p->newton_tolerance;
    LAC_TRY(lac_compliance_create(scene->domain, rock, &e->rock, err));
out:
    LAC_MADE(status, out, destroy);
}

static lac_status create(const void *given, const lac_transfer_scene *scene, void **state,
                         lac_error *err)
{
    lac_status status = LAC_OK;
    lac_elastic *e = NULL;
    lac_rock rock = {0};
    LAC_TRY(begin(given, scene, &rock, &e, err));
    LAC_TRY(calibrate(scene, rock.poisson, e, err));
    if (!e->floating) {
        LAC_TRY(find_anchor(e, scene->team, err));
    }
    if (!e->direct) {
        LAC_TRY(make_last(e, err));
    }
out:
    *state = e;
    LAC_MADE(status, state, destroy);
}

// C tau = 1 where the rock behind holds the cells; else tau = 1 - K C 1, whose slip is uniform.
static lac_status tie(const lac_elastic *e, lac_team *team, double *share, lac_error *err)
{
    size_t n = e->n;
    double sum = 0, rest = 0;
    double *slip = lac_team_alloc(team, (n + lac_elastic_work(e)) * sizeof *slip);
    LAC_FAIL_MEMORY_IF(slip == NULL, err);
    for (size_t i = 0; i < n; i++) {
        slip[i] = 1;
    }
    if (e->floating) {
        lac_compliance_slip(e->rock, slip, slip);
    }
    int iterations = lac_elastic_apply(e, slip, share, slip + n);
    free(slip);
    for (size_t i = 0; i < n; i++) {
        share[i] = e->floating ? 1 - share[i] : share[i];
        sum += share[i];
    }
    for (size_t i = 0; i < n; i++) {
        share[i] *= (double)n / sum;
        rest += 1 - share[i];
    }
    for (size_t i = 0; i < n; i++) {
        share[i] += rest / (double)n;
    }
    LAC_FAIL_IF(iterations < 0 || !isfinite(rest), err, LAC_ENUMERIC,
                "the tractions of %zu cells that slip alike were not found in %d iterations", n,
                LAC_ELASTIC_ITERATIONS);
    return LAC_OK;
}

lac_status lac_transfer_tied(const lac_model *model, const lac_transfer_scene *scene, double *share,
                             lac_error *err)
{
    lac_transfer_elastic p;
    lac_rock rock = {0};
    lac_elastic *e = NULL;
    lac_status status;
    lac_params_default(&lac_elastic_kind.info, &p);
    if (model->info == &lac_elastic_kind.info) {
        p = *(const lac_transfer_elastic *)model->params;
    }
    p.tolerance = 1e-11;
    LAC_TRY(begin(&p, scene, &rock, &e, err));
    LAC_TRY(tie(e, scene->team, share, err));
out:
    destroy(e);
    return status;
}

static size_t work(const void *state) { return lac_elastic_work(state); }

// A Newton iteration asks again for what the rates it starts from have asked. The stress is a
// function of the slip alone, so what is remembered is what would be computed.
static void apply(const void *state, const double *slip, double *force, double *scratch)
{
    const lac_elastic *e = state;
    size_t bytes = e->n * sizeof *slip;
    if (e->direct) {
        (void)lac_elastic_apply(e, slip, force, scratch);
        return;
    }
    if (memcmp(e->last, slip, bytes) != 0) {
        (void)lac_elastic_apply(e, slip, force, scratch);
        memcpy(e->last, slip, bytes);
        memcpy(e->last + e->n, force, bytes);
        return;
    }
    memcpy(force, e->last + e->n, bytes);
}

static bool solve(const void *state, double k_mean, const double *diagonal, const double *y,
                  double *x, double *scratch)
{
    return lac_elastic_solve(state, k_mean, diagonal, y, x, scratch) >= 0;
}

static lac_status direct(const void *given, const lac_transfer_scene *scene, void *state,
                         lac_error *err)
{
    const lac_rock rock = rock_of(given, scene);
    return lac_elastic_direct(scene, &rock, state, err);
}

static const lac_transfer_pair pair = {.direct = direct,
                                       .work = lac_elastic_pair_work,
                                       .apply = lac_elastic_pair_apply,
                                       .solve = lac_elastic_pair_solve};

// Of the hierarchy that is nearest.
static double stiffness(const void *state, size_t level)
{
    const lac_elastic *e = state;
    return level < lac_hierarchy_levels(e->h) ? e->k[level] : 0;
}

static lac_transfer_outline outline(const void *given)
{
    const lac_transfer_elastic *p = given;
    return (lac_transfer_outline){.rock = "",
                                  .k0 = NAN,
                                  .ratio = NAN,
                                  .anchored = !isnan(p->thickness) || p->outside != 0,
                                  .surface = p->boundary == FREE_SURFACE};
}

static void check_place(const void *given, const lac_transfer_place *place,
                        lac_transfer_validate *fault)
{
    const lac_transfer_elastic *p = given;
    if (!isnan(p->thickness) && !place->periodic) {
        fault[0] = (lac_transfer_validate){".thickness", "needs interface.boundary: periodic"};
    }
    if (p->outside != 0 && (place->periodic || !place->full)) {
        fault[1] = (lac_transfer_validate){
            ".outside", "needs interface.boundary: free and interface.domain: {full: {}}"};
    }
    if (p->boundary == FREE_SURFACE && place->line != (p->mode == ANTIPLANE)) {
        fault[2] = (lac_transfer_validate){
            ".boundary", "goes with mode: antiplane on a line, and with in-plane on a plane"};
    }
}

const lac_transfer_kind lac_elastic_kind = {
    .info = LAC_ABOUT("elastic", "two elastic half-spaces or slabs, gaps slipping freely",
                      "Johnson (1985) Contact Mechanics, doi 10.1017/CBO9781139171731; "
                      "docs/theory/transfer.md",
                      LAC_ROWS(params, lac_transfer_elastic), .validate = fault),
    .create = create,
    .free = destroy,
    .work = work,
    .apply = apply,
    .solve = solve,
    .pair = &pair,
    .stiffness = stiffness,
    .transforms = true,
    .outline = outline,
    .check = check_place,
};
