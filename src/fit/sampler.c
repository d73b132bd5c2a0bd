// SPDX-License-Identifier: GPL-3.0-or-later
// Draws from a given density by an ensemble of walkers, the same for any number of threads; and the
// density made of the walkers' places, from which it draws new places, also far away.
#include <gsl/gsl_sort.h>
#include <omp.h>

#include "base/rng.h"
#include "fit/sampler.h"

// Degrees of freedom: tails so long that no walker is stranded where the density has none.
static const double freedom = 4.0;

// Of the walkers' number: how many about one tell its spread. Of that spread: what of it is taken
// alike in all directions, as few walkers know theirs badly; and how wide the t is.
static const double neighbours = 0.3;
static const double alike = 0.2;
static const double width = 0.7;

// A density made of walkers: about each a Student t with four degrees of freedom, whose spread is
// that of the walkers next to it. So it follows valleys that bend and widen, and reaches far. It
// turns and stretches with the walkers: an affine map of them maps it.
typedef struct kernels {
    size_t count, dimension, next;
    bool usable;       //< the walkers do not lie in a plane
    double *place;     //< [count][dimension] the walkers in coordinates of unit covariance
    double *mean;      //< [dimension]
    double *root;      //< [dimension][dimension] lower triangle L: x = mean + L place
    double *local;     //< [count][dimension][dimension] lower triangles of the spreads
    double *log_scale; //< [count] -ln of their determinants
    double *away;      //< [2 count] scratch: squared distances
} kernels;

static lac_status kernels_create(size_t count, size_t dimension, kernels *out, lac_error *err)
{
    size_t d = dimension;
    size_t next = (size_t)(neighbours * (double)count);
    *out = (kernels){.count = count, .dimension = d, .next = next > d + 2 ? next : d + 2};
    out->next = out->next < count ? out->next : count - 1;
    double *room = calloc(count * (d + d * d + 3) + d * d + d, sizeof *room);
    LAC_FAIL_MEMORY_IF(room == NULL, err);
    out->place = room;
    out->root = out->place + count * d;
    out->mean = out->root + d * d;
    out->local = out->mean + d;
    out->log_scale = out->local + count * d * d;
    out->away = out->log_scale + count;
    return LAC_OK;
}

bool lac_fit_factor(size_t d, size_t stride, double *a)
{
    bool full = true;
    for (size_t j = 0; j < d; j++) {
        double *pivot = &a[j * stride + j];
        double whole = *pivot;
        for (size_t i = j; i < d; i++) {
            double sum = a[i * stride + j];
            for (size_t k = 0; k < j; k++) {
                sum -= a[i * stride + k] * a[j * stride + k];
            }
            full = full && (i != j || sum > 1e-12 * whole);
            a[i * stride + j] = i == j ? sqrt(fmax(sum, 0.0)) : *pivot > 0.0 ? sum / *pivot : 0.0;
        }
    }
    return full;
}

void lac_fit_solve(size_t d, const double *l, double *x)
{
    for (size_t i = 0; i < d; i++) {
        for (size_t k = 0; k < i; k++) {
            x[i] -= l[i * d + k] * x[k];
        }
        x[i] /= l[i * d + i];
    }
}

// x = from + L z
static void multiply(size_t d, const double *l, const double *from, const double *z, double *x)
{
    for (size_t i = 0; i < d; i++) {
        x[i] = from[i];
        for (size_t k = 0; k <= i; k++) {
            x[i] += l[i * d + k] * z[k];
        }
    }
}

// Adds the lower triangle of (x - y)(x - y)^T.
static void add_square(size_t d, const double *x, const double *y, double *sum)
{
    for (size_t i = 0; i < d; i++) {
        for (size_t k = 0; k <= i; k++) {
            sum[i * d + k] += (x[i] - y[i]) * (x[k] - y[k]);
        }
    }
}

static double distance(size_t d, const double *x, const double *y)
{
    double sum = 0.0;
    for (size_t i = 0; i < d; i++) {
        sum += (x[i] - y[i]) * (x[i] - y[i]);
    }
    return sum;
}

// Coordinates in which the walkers have no mean and unit covariance.
static bool set_places(kernels *k, const double *x)
{
    size_t d = k->dimension;
    memset(k->mean, 0, d * sizeof *k->mean);
    memset(k->root, 0, d * d * sizeof *k->root);
    for (size_t i = 0; i < k->count * d; i++) {
        k->mean[i % d] += x[i] / (double)k->count;
    }
    for (size_t i = 0; i < k->count; i++) {
        add_square(d, x + i * d, k->mean, k->root);
    }
    for (size_t i = 0; i < d * d; i++) {
        k->root[i] /= (double)k->count;
    }
    if (!lac_fit_factor(d, d, k->root)) {
        return false;
    }
    for (size_t i = 0; i < k->count * d; i++) {
        k->place[i] = x[i] - k->mean[i % d];
    }
    for (size_t i = 0; i < k->count; i++) {
        lac_fit_solve(d, k->root, k->place + i * d);
    }
    return true;
}

// The spread about a walker, from those next to it.
static bool set_spread(kernels *k, size_t which)
{
    size_t d = k->dimension;
    double *s = k->local + which * d * d;
    const double *at = k->place + which * d;
    double *sorted = k->away + k->count;
    double trace = 0.0;
    for (size_t i = 0; i < k->count; i++) {
        k->away[i] = sorted[i] = distance(d, k->place + i * d, at);
    }
    gsl_sort(sorted, 1, k->count);
    memset(s, 0, d * d * sizeof *s);
    for (size_t i = 0; i < k->count; i++) {
        if (k->away[i] <= sorted[k->next]) {
            add_square(d, k->place + i * d, at, s);
        }
    }
    double share = width / (double)k->next;
    for (size_t i = 0; i < d; i++) {
        trace += share * s[i * d + i];
    }
    for (size_t i = 0; i < d * d; i++) {
        s[i] *= (1.0 - alike) * share;
        s[i] += i % (d + 1) == 0 ? alike * trace / (double)d : 0.0;
    }
    if (!lac_fit_factor(d, d, s)) {
        return false;
    }
    k->log_scale[which] = 0.0;
    for (size_t i = 0; i < d; i++) {
        k->log_scale[which] -= log(s[i * d + i]);
    }
    return true;
}

// Makes the density of walkers. @param x  [count][dimension]
static void kernels_set(kernels *k, const double *x)
{
    k->usable = set_places(k, x);
    for (size_t i = 0; k->usable && i < k->count; i++) {
        k->usable = set_spread(k, i);
    }
}

// A place drawn from the density.
// @param which  of the walkers, each as likely
// @param z      [dimension] standard normal numbers; overwritten
// @param share  uniform in (0, 1), twice: of the t
static void kernels_draw(const kernels *k, size_t which, double *z, const double share[2],
                         double *x)
{
    size_t d = k->dimension;
    // chi-squared with four degrees of freedom: two exponentials
    double t = sqrt(freedom / (-2.0 * log(share[0] * share[1])));
    multiply(d, k->local + which * d * d, k->place + which * d, z, x);
    for (size_t i = 0; i < d; i++) {
        z[i] = k->place[which * d + i] + t * (x[i] - k->place[which * d + i]);
    }
    multiply(d, k->root, k->mean, z, x);
}

// ln of the density at a place, up to a constant. @param scratch  [2 dimension]
static double kernels_log(const kernels *k, const double *x, double *scratch)
{
    size_t d = k->dimension;
    double *at = scratch;
    double *by = scratch + d;
    double top = -INFINITY;
    double sum = 0.0;
    for (size_t i = 0; i < d; i++) {
        at[i] = x[i] - k->mean[i];
    }
    lac_fit_solve(d, k->root, at);
    for (size_t j = 0; j < k->count; j++) {
        double squares = 0.0;
        for (size_t i = 0; i < d; i++) {
            by[i] = at[i] - k->place[j * d + i];
        }
        lac_fit_solve(d, k->local + j * d * d, by);
        for (size_t i = 0; i < d; i++) {
            squares += by[i] * by[i];
        }
        double term = k->log_scale[j] - 0.5 * (freedom + (double)d) * log1p(squares / freedom);
        sum = term > top ? sum * exp(top - term) + 1.0 : sum + exp(term - top);
        top = fmax(top, term);
    }
    return top + log(sum);
}

// Proposals reach from 1/a to a times the distance to another walker.
static const double stretch = 2.0;

// Walkers that a density is made of: so many tell it, and more cost.
enum { MOST_KERNELS = 128 };

// An ensemble on its way.
typedef struct ensemble {
    const lac_sampler_def *def;
    lac_kept *kept;      // NULL: nobody keeps the steps
    double *x;           // [walkers][dimension] where the walkers are
    double *log_density; // [walkers] behind it, and
    bool *moved;         // [walkers] in the step just made: what is kept of a step
    double *proposal;    // [walkers][dimension]
    kernels made;        // of the half that stands still
    double *scratch;     // [walkers][3 dimension + 1]
} ensemble;

static size_t size_of_step(const ensemble *e)
{
    return e->def->walkers * ((e->def->dimension + 1) * sizeof *e->x + sizeof *e->moved);
}

void lac_chain_free(lac_chain *chain) { free(chain); }

static lac_status chain_create(const lac_sampler_def *def, lac_chain **out, lac_error *err)
{
    const size_t draws = def->steps * def->walkers;
    lac_chain *chain =
        calloc(1, sizeof *chain + (draws * (def->dimension + 1) + def->walkers) * sizeof *chain->x +
                      draws * sizeof *chain->moved);
    *out = chain;
    LAC_FAIL_MEMORY_IF(chain == NULL, err);
    chain->dimension = def->dimension;
    chain->walkers = def->walkers;
    chain->x = (double *)(chain + 1);
    chain->log_density = chain->x + draws * def->dimension;
    chain->acceptance = chain->log_density + draws;
    chain->moved = (bool *)(chain->acceptance + def->walkers);
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
    kernels_draw(&e->made, (size_t)(bits[0] % e->made.count), z, share, y);
    return kernels_log(&e->made, e->x + k * d, z) - kernels_log(&e->made, y, z);
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
    if (kind < def->drawing && e->made.usable) {
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
        kernels_set(&e->made, e->x + other * d);
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

// The first record is where the walkers begin: steps that began elsewhere are of something else.
static lac_status compare_start(ensemble *e, lac_error *err)
{
    const size_t size = size_of_step(e);
    void *before = malloc(size);
    LAC_FAIL_MEMORY_IF(before == NULL, err);
    lac_status status = LAC_OK;
    if (!lac_kept_read(e->kept, before, size)) {
        status = lac_kept_put(e->kept, e->x, size, err);
    } else if (memcmp(before, e->x, size) != 0) {
        status =
            lac_fail(err, LAC_EINPUT,
                     "--resume: the steps that were kept began elsewhere: a file that the case "
                     "reads has changed, or the program; without it the fit begins anew");
    }
    free(before);
    return status;
}

static lac_status begin(ensemble *e, const double *start, lac_error *err)
{
    const lac_sampler_def *def = e->def;
    const int walkers = (int)def->walkers;
    size_t d = def->dimension;
    e->proposal = calloc(def->walkers, (5 * d + 2) * sizeof *e->x + sizeof *e->moved);
    if (e->proposal == NULL) {
        (void)lac_fail_memory(err);
        return LAC_ENOMEM; // said here, where clang's analyzer sees it
    }
    e->scratch = e->proposal + def->walkers * d;
    e->x = e->scratch + def->walkers * (3 * d + 1);
    e->log_density = e->x + def->walkers * d;
    e->moved = (bool *)(e->log_density + def->walkers);
    memcpy(e->x, start, def->walkers * d * sizeof *e->x);
#pragma omp parallel for schedule(dynamic) num_threads(def->threads > 1 ? def->threads : 1)
    for (int k = 0; k < walkers; k++) {
        e->log_density[k] = density(def, start + (size_t)k * d);
    }
    for (size_t k = 0; k < def->walkers; k++) {
        LAC_FAIL_IF(!isfinite(e->log_density[k]), err, LAC_EINPUT,
                    "walker %zu starts where the density is zero", k);
    }
    return def->first == 0 ? compare_start(e, err) : LAC_OK;
}

static void keep(const ensemble *e, lac_chain *chain)
{
    size_t walkers = chain->walkers;
    size_t d = chain->dimension;
    memcpy(chain->x + chain->steps * walkers * d, e->x, walkers * d * sizeof *e->x);
    memcpy(chain->log_density + chain->steps * walkers, e->log_density,
           walkers * sizeof *e->log_density);
    memcpy(chain->moved + chain->steps * walkers, e->moved, walkers * sizeof *e->moved);
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
        if (!lac_kept_read(e->kept, e->x, size_of_step(e))) {
            move_half(e, def->first + step, 0, half);
            move_half(e, def->first + step, half, 0);
            LAC_TRY_RETURN(lac_kept_put(e->kept, e->x, size_of_step(e), err));
        }
        if (step >= def->burn) {
            keep(e, chain);
        }
        lac_fit_tell(def->watch, "steps of the sampler", step + 1, total);
        LAC_FAIL_IF(lac_fit_interrupted(def->watch), err, LAC_EINTERRUPT,
                    "interrupted at step %zu of %zu", step + 1, total);
    }
    return LAC_OK;
}

lac_status lac_sampler_run(const lac_sampler_def *def, const double *start, lac_chain **out,
                           lac_error *err)
{
    lac_status status = LAC_OK;
    ensemble e = {.def = def, .kept = def->watch != NULL ? def->watch->kept : NULL};
    *out = NULL;
    LAC_FAIL_IF(def->dimension == 0 || def->walkers % 2 != 0 ||
                    def->walkers < 2 * def->dimension + 2,
                err, LAC_EINPUT, "%zu walkers in %zu dimensions: must be even and at least %zu",
                def->walkers, def->dimension, 2 * def->dimension + 2);
    LAC_TRY(chain_create(def, out, err));
    size_t half = def->walkers / 2;
    size_t walkers = half < MOST_KERNELS ? half : MOST_KERNELS;
    LAC_TRY(kernels_create(walkers, def->dimension, &e.made, err));
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
    free(e.made.place);
    free(e.proposal);
    return status;
}
