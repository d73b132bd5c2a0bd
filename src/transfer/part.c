// SPDX-License-Identifier: GPL-3.0-or-later
// A transfer as the ranks of a team have it: the part of their cells where the kind knows of parts,
// else the whole on every rank, for which they hand each other all that it is applied to.
#include "transfer/transfer.h"

// It stands for the kind that it is made of.
typedef struct whole {
    lac_transfer_kind kind;
    lac_transfer of;
    lac_range range;
} whole;

// An array of all cells, from those of each rank, at the end of which the next one begins.
static double *gather(const whole *w, const double *x, double *all)
{
    memset(all, 0, w->range.all * sizeof *all);
    memcpy(all + w->range.first, x, w->range.n * sizeof *all);
    lac_team_join(w->range.team, all, w->range.all);
    return all + w->range.all;
}

static void take(const whole *w, const double *all, double *x)
{
    memcpy(x, all + w->range.first, w->range.n * sizeof *x);
}

static size_t work(const void *state)
{
    const whole *w = state;
    return 2 * w->range.all + w->of.kind->work(w->of.state);
}

static void apply(const void *state, const double *slip, double *force, double *scratch)
{
    const whole *w = state;
    double *out = gather(w, slip, scratch);
    w->of.kind->apply(w->of.state, scratch, out, out + w->range.all);
    take(w, out, force);
}

static bool solve(const void *state, double k_mean, const double *diagonal, const double *y,
                  double *x, double *scratch)
{
    const whole *w = state;
    double *all = gather(w, diagonal, scratch), *rest = gather(w, y, all);
    const bool good = w->of.kind->solve(w->of.state, k_mean, scratch, all, all, rest);
    take(w, all, x);
    return good;
}

static double stiffness(const void *state, size_t level)
{
    const whole *w = state;
    return w->of.kind->stiffness(w->of.state, level);
}

static size_t pair_work(const void *state)
{
    const whole *w = state;
    return 5 * w->range.all + w->of.kind->pair->work(w->of.state);
}

static void pair_apply(const void *state, const double *const slip[2], double *const force[2],
                       double *scratch)
{
    const whole *w = state;
    double *y = gather(w, slip[0], scratch);
    double *const to[2] = {gather(w, slip[1], y), scratch + 3 * w->range.all};
    w->of.kind->pair->apply(w->of.state, (const double *const[2]){scratch, y}, to,
                            scratch + 4 * w->range.all);
    take(w, to[0], force[0]);
    take(w, to[1], force[1]);
}

static bool pair_solve(const void *state, double k_mean, const double *const diagonal[3],
                       double *const x[2], double *scratch)
{
    const whole *w = state;
    double *all[6] = {scratch};
    for (int k = 0; k < 5; k++) {
        all[k + 1] = gather(w, k < 3 ? diagonal[k] : x[k - 3], all[k]);
    }
    const bool good =
        w->of.kind->pair->solve(w->of.state, k_mean, (const double *const *)all, all + 3, all[5]);
    take(w, all[3], x[0]);
    take(w, all[4], x[1]);
    return good;
}

static const lac_transfer_pair pair = {.work = pair_work, .apply = pair_apply, .solve = pair_solve};

static lac_status hold_whole(const lac_transfer *of, const lac_range *range, lac_transfer *out,
                             lac_error *err)
{
    whole *w = malloc(sizeof *w);
    LAC_FAIL_MEMORY_IF(w == NULL, err);
    *w = (whole){.kind = *of->kind, .of = *of, .range = *range};
    w->kind.free = free;
    w->kind.work = work;
    w->kind.apply = apply;
    w->kind.solve = solve;
    w->kind.stiffness = stiffness;
    w->kind.pair = of->kind->pair != NULL ? &pair : NULL;
    *out = (lac_transfer){&w->kind, w};
    return LAC_OK;
}

lac_status lac_transfer_part(const lac_transfer *of, bool both, const lac_range *range,
                             lac_transfer *out, lac_error *err)
{
    *out = (lac_transfer){0};
    if (of->kind->part == NULL || both) {
        return hold_whole(of, range, out, err);
    }
    void *state = NULL;
    const lac_status status = of->kind->part(of->state, range, &state, err);
    *out = state != NULL ? (lac_transfer){of->kind, state} : *out;
    return status;
}
