// SPDX-License-Identifier: GPL-3.0-or-later
// Draws from a given density by an ensemble of walkers, the same for any number of threads.
#include "fit/sampler.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "fit/kernel.h"

// Proposals reach from 1/a to a times the distance to another walker.
static const double stretch = 2.0;

// Walkers that a density is made of: so many tell it, and more cost.
enum { MOST_KERNELS = 128 };

// An ensemble on its way.
typedef struct ensemble {
    const lac_sampler_def *def;
    double *x;           // [walkers][dimension] where the walkers are
    double *log_density; // [walkers]
    double *proposal;    // [walkers][dimension]
    bool *moved;         // [walkers] in the step just made
    lac_kernels kernels; // of the half that stands still
    double *scratch;     // [walkers][3 dimension + 1]
} ensemble;

void lac_chain_free(lac_chain *chain)
{
    if (chain == NULL) {
        return;
    }
    free(chain->x);
    free(chain->log_density);
    free(chain->acceptance);
    free(chain);
}

static lac_status chain_create(const lac_sampler_def *def, lac_chain **out, lac_error *err)
{
    lac_chain *chain = calloc(1, sizeof *chain);
    *out = chain;
    LAC_FAIL_MEMORY_IF(chain == NULL, err);
    chain->dimension = def->dimension;
    chain->walkers = def->walkers;
    size_t room = def->steps * def->walkers;
    chain->x = malloc(room * def->dimension * sizeof *chain->x + 1);
    chain->log_density = malloc(room * sizeof *chain->log_density + 1);
    chain->acceptance = calloc(def->walkers, sizeof *chain->acceptance);
    LAC_FAIL_MEMORY_IF(chain->x == NULL || chain->log_density == NULL || chain->acceptance == NULL,
                       err);
    return LAC_OK;
}

static lac_status check(const lac_sampler_def *def, lac_error *err)
{
    LAC_FAIL_IF(def->dimension == 0 || def->walkers % 2 != 0 ||
                    def->walkers < 2 * def->dimension + 2,
                err, LAC_EINPUT, "%zu walkers in %zu dimensions: must be even and at least %zu",
                def->walkers, def->dimension, 2 * def->dimension + 2);
    return LAC_OK;
}

static double density(const lac_sampler_def *def, const double *x)
{
    double found = def->log_density(def->context, omp_get_thread_num(), x);
    return isnan(found) ? -INFINITY : found;
}

// Uniform in (0, 1).
static double uniform(uint64_t bits) { return ((double)(bits >> 11) + 0.5) * 0x1p-53; }

// Y = X_j + z (X_k - X_j), z from g(z) ~ 1/sqrt(z): along the line to a walker of the other half.
// @return ln z^(d-1), by which the chance is raised
static double stretch_to(const ensemble *e, const uint64_t bits[4], size_t k, size_t other,
                         double *proposal)
{
    size_t d = e->def->dimension;
    const double *from = e->x + k * d;
    const double *to = e->x + (other + (size_t)(bits[0] % (e->def->walkers / 2))) * d;
    double root = 1.0 / sqrt(stretch) + uniform(bits[1]) * (sqrt(stretch) - 1.0 / sqrt(stretch));
    double z = root * root;
    for (size_t i = 0; i < d; i++) {
        proposal[i] = to[i] + z * (from[i] - to[i]);
    }
    return (double)(d - 1) * log(z);
}

// Y = X_k + g (X_i - X_j): by the difference of two walkers of the other half, which the reverse
// move takes as likely; g scatters about 2.38/sqrt(2 d) and is 1 now and then.
static void differ_by(const ensemble *e, const uint64_t bits[4], size_t k, size_t other,
                      double *proposal)
{
    size_t d = e->def->dimension;
    size_t half = e->def->walkers / 2;
    size_t i = (size_t)(bits[0] % half);
    size_t j = (i + 1 + (size_t)(bits[1] % (half - 1))) % half;
    const double *plus = e->x + (other + i) * d;
    const double *minus = e->x + (other + j) * d;
    double share = uniform(bits[3]);
    double g = share < 0.1 ? 1.0 : 2.38 / sqrt(2.0 * (double)d) * (0.5 + (share - 0.1) / 0.9);
    for (size_t c = 0; c < d; c++) {
        proposal[c] = e->x[k * d + c] + g * (plus[c] - minus[c]);
    }
}

// Y from the density q made of the other half, wherever the walker stands.
// @return ln q(X_k) - ln q(Y), by which the chance is raised
static double draw_anew(const ensemble *e, const uint64_t bits[4], const uint64_t choice[4],
                        uint64_t step, size_t k)
{
    const uint64_t apart = UINT64_C(1) << 60; // from the numbers of the other moves
    size_t d = e->def->dimension;
    double *z = e->scratch + k * (3 * d + 1);
    double *y = e->proposal + k * d;
    const double share[2] = {uniform(choice[2]), uniform(choice[3])};
    for (size_t i = 0; i < d; i += 2) { // z has room for an odd last one
        lac_random_normal(e->def->seed, LAC_STREAM_SAMPLER, apart + step, (k << 16) + i, z + i);
    }
    lac_kernels_draw(&e->kernels, (size_t)(bits[0] % e->kernels.count), z, share, y);
    return lac_kernels_log(&e->kernels, e->x + k * d, z) - lac_kernels_log(&e->kernels, y, z);
}

// One walker's move, taken with probability min(1, p(Y)/p(X_k)), of a stretch with z^(d-1) before,
// of a draw with q(X_k)/q(Y). The walkers of the other half do not move meanwhile.
static void move(ensemble *e, uint64_t step, size_t k, size_t other)
{
    const lac_sampler_def *def = e->def;
    uint64_t bits[4];
    uint64_t choice[4];
    double *proposal = e->proposal + k * def->dimension;
    double bonus = 0.0;
    lac_random(def->seed, LAC_STREAM_SAMPLER, step, 2 * k, bits);
    lac_random(def->seed, LAC_STREAM_SAMPLER, step, 2 * k + 1, choice);
    double kind = uniform(choice[0]);
    if (kind < def->drawing && e->kernels.usable) {
        bonus = draw_anew(e, bits, choice, step, k);
    } else if (kind < def->drawing + def->stretching) {
        bonus = stretch_to(e, bits, k, other, proposal);
    } else {
        differ_by(e, bits, k, other, proposal);
    }
    double found = density(def, proposal);
    e->moved[k] = isfinite(found) && log(uniform(bits[2])) < bonus + found - e->log_density[k];
    if (e->moved[k]) {
        e->log_density[k] = found;
    }
}

// Moves one half of the walkers, which only look at the other.
static void move_half(ensemble *e, uint64_t step, size_t first, size_t other)
{
    size_t d = e->def->dimension;
    const int half = (int)(e->def->walkers / 2);
    if (e->def->drawing > 0.0) {
        lac_kernels_set(&e->kernels, e->x + other * d);
    }
#pragma omp parallel for schedule(dynamic) num_threads(e->def->threads > 1 ? e->def->threads : 1)
    for (int i = 0; i < half; i++) {
        move(e, step, first + (size_t)i, other);
    }
    for (size_t k = first; k < first + (size_t)half; k++) {
        if (e->moved[k]) {
            memcpy(e->x + k * d, e->proposal + k * d, d * sizeof *e->x);
        }
    }
}

static lac_status begin(ensemble *e, const double *start, lac_error *err)
{
    const lac_sampler_def *def = e->def;
    const int walkers = (int)def->walkers;
    size_t d = def->dimension;
    e->x = malloc(def->walkers * d * sizeof *e->x);
    e->proposal = malloc(def->walkers * d * sizeof *e->proposal);
    e->log_density = malloc(def->walkers * sizeof *e->log_density);
    e->moved = calloc(def->walkers, sizeof *e->moved);
    e->scratch = malloc(def->walkers * (3 * d + 1) * sizeof *e->scratch);
    if (e->x == NULL || e->proposal == NULL || e->log_density == NULL || e->moved == NULL ||
        e->scratch == NULL) {
        (void)lac_fail_memory(err);
        return LAC_ENOMEM; // said here, where clang's analyzer sees it
    }
    memcpy(e->x, start, def->walkers * d * sizeof *e->x);
#pragma omp parallel for schedule(dynamic) num_threads(def->threads > 1 ? def->threads : 1)
    for (int k = 0; k < walkers; k++) {
        e->log_density[k] = density(def, start + (size_t)k * d);
    }
    for (size_t k = 0; k < def->walkers; k++) {
        LAC_FAIL_IF(!isfinite(e->log_density[k]), err, LAC_EINPUT,
                    "walker %zu starts where the density is zero", k);
    }
    return LAC_OK;
}

static void keep(const ensemble *e, lac_chain *chain)
{
    size_t walkers = chain->walkers;
    size_t d = chain->dimension;
    memcpy(chain->x + chain->steps * walkers * d, e->x, walkers * d * sizeof *e->x);
    memcpy(chain->log_density + chain->steps * walkers, e->log_density,
           walkers * sizeof *e->log_density);
    for (size_t k = 0; k < walkers; k++) {
        chain->acceptance[k] += e->moved[k] ? 1.0 : 0.0;
    }
    chain->steps++;
}

static lac_status walk(ensemble *e, lac_chain *chain, lac_error *err)
{
    const lac_sampler_def *def = e->def;
    size_t half = def->walkers / 2;
    size_t total = def->burn + def->steps;
    for (size_t step = 0; step < total; step++) {
        move_half(e, def->first + step, 0, half);
        move_half(e, def->first + step, half, 0);
        if (step >= def->burn) {
            keep(e, chain);
        }
        if (def->progress != NULL) {
            def->progress(def->context, step + 1, total);
        }
        LAC_FAIL_IF(def->interrupted != NULL && def->interrupted(def->context), err, LAC_EINTERRUPT,
                    "interrupted at step %zu of %zu", step + 1, total);
    }
    return LAC_OK;
}

lac_status lac_sampler_run(const lac_sampler_def *def, const double *start, lac_chain **out,
                           lac_error *err)
{
    lac_status status = LAC_OK;
    ensemble e = {.def = def};
    *out = NULL;
    LAC_TRY(check(def, err));
    LAC_TRY(chain_create(def, out, err));
    size_t half = def->walkers / 2;
    size_t kernels = half < MOST_KERNELS ? half : MOST_KERNELS;
    LAC_TRY(lac_kernels_create(kernels, def->dimension, &e.kernels, err));
    LAC_TRY(begin(&e, start, err));
    status = walk(&e, *out, err);
    for (size_t k = 0; k < def->walkers && (*out)->steps > 0; k++) {
        (*out)->acceptance[k] /= (double)(*out)->steps;
    }
out:
    if (status != LAC_OK && status != LAC_EINTERRUPT) {
        lac_chain_free(*out);
        *out = NULL;
    }
    lac_kernels_clear(&e.kernels);
    free(e.scratch);
    free(e.x);
    free(e.proposal);
    free(e.log_density);
    free(e.moved);
    return status;
}
