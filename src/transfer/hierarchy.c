// SPDX-License-Identifier: GPL-3.0-or-later
// Cells tied in blocks of doubling size: each level has a stiffness, given or elastic.
#include "base/rows.h"

#include "transfer/calibrate.h"

typedef struct hierarchy {
    const lac_hierarchy *h;
    lac_hierarchy *own; // where it is a part
    size_t levels;
    double *across; // [levels] of slip along y; NULL: the same
    double k[];     // [levels] stiffness of each level [Pa/m]
} hierarchy;

static void destroy(void *state)
{
    hierarchy *self = state;
    if (self != NULL) {
        lac_hierarchy_free(self->own);
        free(self->across);
        free(self);
    }
}

static const char *const stiffness_choices[] = {"elastic", NULL};

static const lac_param params[] = {
    LAC_CHOICE("stiffness", offsetof(lac_transfer_hierarchy, stiffness), NAN, stiffness_choices,
               LAC_OPTIONAL,
               "elastic: of every level, from the elastic half-space on this contact domain"),
    LAC_REAL("k0", "Pa/m", offsetof(lac_transfer_hierarchy, k0), NAN, 0, 1e30, LAC_OPTIONAL,
             "stiffness of the finest level, where it is given instead of elastic"),
    LAC_REAL("ratio", "1", offsetof(lac_transfer_hierarchy, ratio), NAN, 0, 1e3, LAC_OPTIONAL,
             "with k0: stiffness of a level over that of the next finer one (0.5 if absent, the "
             "elastic scaling; 0: only the finest level)"),
    LAC_SEED(offsetof(lac_transfer_hierarchy, seed), 1, 0,
             "of the random probes that calibrate the elastic stiffness"),
};

static lac_status create(const void *given, const lac_transfer_scene *scene, void **state,
                         lac_error *err)
{
    const lac_transfer_hierarchy *p = given;
    lac_status status = LAC_OK;
    size_t levels = lac_hierarchy_levels(scene->hierarchy);
    hierarchy *self = *state = calloc(1, sizeof *self + levels * sizeof *self->k);
    LAC_FAIL_MEMORY_IF(self == NULL, err);
    self->h = scene->hierarchy;
    self->levels = levels;
    if (p->stiffness >= 0) {
        LAC_TRY(lac_calibrate_elastic(scene, false, (uint64_t)p->seed, self->k, err));
    }
    for (size_t l = 0; l < levels && p->stiffness < 0; l++) {
        self->k[l] = p->k0 * pow(isnan(p->ratio) ? 0.5 : p->ratio, (double)l);
    }
out:
    LAC_MADE(status, state, destroy);
}

static lac_status part(const void *state, const lac_range *range, void **out, lac_error *err)
{
    const hierarchy *of = state;
    const size_t size = sizeof *of + of->levels * sizeof *of->k;
    hierarchy *self = malloc(size);
    LAC_FAIL_MEMORY_IF(self == NULL, err);
    memcpy(self, of, size);
    self->across = NULL; // along x alone
    self->own = NULL;
    const lac_status status = lac_hierarchy_split(of->h, range, &self->own, err);
    self->h = self->own;
    *out = self;
    return status;
}

static size_t work(const void *state)
{
    const hierarchy *self = state;
    return lac_hierarchy_work(self->h);
}

static void apply(const void *state, const double *slip, double *force, double *scratch)
{
    const hierarchy *self = state;
    lac_hierarchy_apply(self->h, self->k, slip, force, scratch);
}

static bool solve(const void *state, double k_mean, const double *diagonal, const double *y,
                  double *x, double *scratch)
{
    const hierarchy *self = state;
    return lac_hierarchy_solve(self->h, self->k, k_mean, diagonal, y, x, scratch);
}

// Elastic rock is stiffer along slip than across it, so that blocks of a domain that is not alike
// both ways have two stiffnesses.
static lac_status direct(const void *given, const lac_transfer_scene *scene, void *state,
                         lac_error *err)
{
    const lac_transfer_hierarchy *p = given;
    hierarchy *self = state;
    if (p->stiffness < 0) {
        return LAC_OK;
    }
    self->across = malloc((self->levels + 1) * sizeof *self->across);
    LAC_FAIL_MEMORY_IF(self->across == NULL, err);
    return lac_calibrate_elastic(scene, true, (uint64_t)p->seed, self->across, err);
}

static size_t pair_work(const void *state)
{
    const hierarchy *self = state;
    return lac_hierarchy_pair_work(self->h) + lac_hierarchy_work(self->h);
}

static void pair_apply(const void *state, const double *const slip[2], double *const force[2],
                       double *scratch)
{
    const hierarchy *self = state;
    const double *across = self->across != NULL ? self->across : self->k;
    lac_hierarchy_apply(self->h, self->k, slip[0], force[0], scratch);
    lac_hierarchy_apply(self->h, across, slip[1], force[1], scratch);
}

static bool pair_solve(const void *state, double k_mean, const double *const diagonal[3],
                       double *const x[2], double *scratch)
{
    const hierarchy *self = state;
    const double *const k[2] = {self->k, self->across != NULL ? self->across : self->k};
    return lac_hierarchy_solve_pair(self->h, k, k_mean, diagonal, x, scratch);
}

static const lac_transfer_pair pair = {
    .direct = direct, .work = pair_work, .apply = pair_apply, .solve = pair_solve};

static double stiffness(const void *state, size_t level)
{
    const hierarchy *self = state;
    return level < self->levels ? self->k[level] : 0;
}

static const lac_hierarchy *blocks(const void *state)
{
    const hierarchy *self = state;
    return self->h;
}

static lac_transfer_outline outline(const void *given)
{
    const lac_transfer_hierarchy *p = given;
    return (lac_transfer_outline){
        .rock = p->stiffness >= 0 ? ".stiffness: elastic" : NULL, .k0 = p->k0, .ratio = p->ratio};
}

static void check_place(const void *given, const lac_transfer_place *place,
                        lac_transfer_validate *fault)
{
    const lac_transfer_hierarchy *p = given;
    const bool elastic = p->stiffness >= 0;
    (void)place;
    if (elastic != isnan(p->k0)) {
        fault[0] =
            (lac_transfer_validate){"", elastic ? "needs either stiffness: elastic or k0, not both"
                                                : "needs stiffness: elastic, or k0 (and ratio)"};
    }
    if (elastic && !isnan(p->ratio)) {
        fault[1] = (lac_transfer_validate){".ratio", "goes with k0, not with stiffness: elastic"};
    }
}

const lac_transfer_kind lac_hierarchy_kind = {
    .info =
        LAC_ABOUT("hierarchy", "at every scale a block's slip relative to its parent's is resisted",
                  "docs/theory/transfer.md, eq. 1; blocks as Borri-Brunetto, Carpinteri & "
                  "Chiaia (2004) Rock Mech. Rock Eng. 37, 117",
                  LAC_ROWS(params, lac_transfer_hierarchy)),
    .create = create,
    .free = destroy,
    .work = work,
    .apply = apply,
    .solve = solve,
    .part = part,
    .pair = &pair,
    .stiffness = stiffness,
    .blocks = blocks,
    .outline = outline,
    .check = check_place,
};
