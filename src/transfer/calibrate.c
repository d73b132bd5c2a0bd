// SPDX-License-Identifier: GPL-3.0-or-later
// The stiffness of each level as the elastic half-space has it: on small grids from probes of one
// level at a time, on larger ones from a few probes of all levels beside the same on half the grid.
#include "transfer/calibrate.h"

#include "base/rng.h"
#include "transfer/elastic_solve.h"

// On small grids: all vectors of a band where there are few; else probes until the mean is known
// well enough.
enum { SMALL_GRID = 64 * 64, EXACT_RANK = 32, FEWEST_PROBES = 4, MOST_PROBES = 40 };
static const double probe_error = 0.01;
// The energy converges twice as fast as the traction; at this tolerance it was found good to 1e-3,
// on long lines to 3e-2. Larger grids, which begin from a small one, ask for more of it.
static const double energy_tolerance = 1e-2, start_tolerance = 1e-3;

// On larger ones: so many probes, a power of two, that with these cells the finest level is known
// well enough.
enum { FEWEST_SHARED = 2, MOST_SHARED = 32, SHARED_CELLS = 12000 };
// Of their traction. A level's part of the energy was found good to 4e-3 with it.
static const double shared_tolerance = 7e-3;

// The variance of a probe of a band that was seen on many domains, in mean^2/rank.
static const double usual_alone = 0.1;

// A domain that is probed.
typedef struct probed {
    const lac_domain *domain;
    const lac_hierarchy *h;
    uint64_t seed;
    lac_elastic rock;        // its k near enough to precondition
    double *slip, *traction; // [n + 1], [n]
    double *work;            // lac_elastic_work
} probed;

// k of all levels; the parts of shared probes.
typedef struct stiffnesses {
    size_t levels, probes;
    double *k;    // [levels]
    double *part; // [probes * levels] of each probe's energy, as a stiffness
} stiffnesses;

// A contrast: cells [begin, middle) against [middle, end). Every child but the first of its parent,
// against the children before it: these are an orthonormal basis of the band P_l - P_{l+1}, and K
// is nearly diagonal in it, which is why random signs in this basis scatter so little.
typedef struct contrast {
    size_t begin, middle, end;
    double down, up; // values that make it a unit vector of zero mean
} contrast;

// What is done to the i-th contrast of a level.
typedef void contrast_visit(void *context, size_t i, const contrast *at);

static contrast contrast_of(size_t begin, size_t middle, size_t end)
{
    double before = (double)(middle - begin), after = (double)(end - middle);
    return (contrast){begin, middle, end, sqrt(after / (before * (before + after))),
                      sqrt(before / (after * (before + after)))};
}

static void each_contrast(const lac_hierarchy *h, size_t level, contrast_visit *visit,
                          void *context)
{
    const uint32_t *child = lac_hierarchy_offsets(h, level);
    const uint32_t *parent = lac_hierarchy_offsets(h, level + 1);
    size_t b = 0, i = 0;
    for (size_t c = 0; c < lac_hierarchy_blocks(h, level); c++) {
        if (child[c] == parent[b + 1]) {
            b++;
        }
        if (child[c] != parent[b]) {
            contrast at = contrast_of(parent[b], child[c], child[c + 1]);
            visit(context, i++, &at);
        }
    }
}

static void add_contrast(double w, const contrast *at, double *z)
{
    for (size_t i = at->begin; i < at->middle; i++) {
        z[i] -= w * at->down;
    }
    for (size_t i = at->middle; i < at->end; i++) {
        z[i] += w * at->up;
    }
}

static double random_sign(uint64_t seed, uint64_t stream, size_t i)
{
    uint64_t bits[4];
    lac_random(seed, LAC_STREAM_PROBE, stream, i, bits);
    return (bits[0] & 1) != 0 ? 1 : -1;
}

// A probe of one band.
typedef struct band_probe {
    uint64_t seed;
    size_t level, number; // which basis vector, or which random combination of all of them
    bool random;
    double *z;
} band_probe;

static void add_to_band(void *context, size_t i, const contrast *at)
{
    const band_probe *p = context;
    if (p->random || i == p->number) {
        double w = p->random ? random_sign(p->seed, (uint64_t)p->level << 32 | p->number, i) : 1;
        add_contrast(w, at, p->z);
    }
}

// Standard error of the mean of `probes` values whose squared deviations sum to `squares`. A
// handful can agree by chance, so the usual scatter counts for six more.
static double standard_error(size_t probes, double usual, double squares)
{
    double variance = (squares + 6 * usual) / (double)(probes - 1 + 6);
    return sqrt(variance / (double)probes);
}

// The mean energy of the band's vectors: over a basis, or over random probes of all of it.
static lac_status calibrate_band(const probed *on, size_t level, stiffnesses *s, lac_error *err)
{
    size_t rank = lac_hierarchy_rank(on->h, level);
    bool random = rank > EXACT_RANK;
    size_t most = random ? MOST_PROBES : rank;
    double mean = 0, squares = 0;
    double tolerance = s->probes > 0 ? start_tolerance : energy_tolerance;
    for (size_t i = 0; i < most; i++) {
        band_probe p = {on->seed, level, i, random, on->slip};
        double energy;
        memset(on->slip, 0, on->domain->n * sizeof *on->slip);
        each_contrast(on->h, level, add_to_band, &p);
        LAC_TRY_RETURN(
            lac_compliance_invert(on->rock.rock, on->slip, tolerance, on->traction, &energy, err));
        energy /= random ? (double)rank : 1;
        double change = energy - mean;
        mean += change / (double)(i + 1);
        squares += change * (energy - mean);
        double usual = usual_alone * mean * mean / (double)rank;
        if (random && i + 1 >= FEWEST_PROBES &&
            standard_error(i + 1, usual, squares) <= probe_error * mean) {
            break;
        }
    }
    s->k[level] = mean;
    return LAC_OK;
}

// A probe of all bands.
typedef struct shared_probe {
    uint64_t seed;
    size_t probe;
    size_t first;         // number of the level's first contrast, all counted from the root down
    double size;          // of the level's contrasts
    double *z;            // slip
    const double *summed; // traction, summed up to each cell
    double part;          // of the level
} shared_probe;

// A random sign for each contrast, times a column of a Hadamard matrix that goes by its number: of
// as many contrasts in a row as there are probes, none disturbs another's mean over the probes. The
// numbers are the same on half the grid.
static double shared_sign(const shared_probe *p, size_t i)
{
    size_t number = p->first + i;
    double sign = random_sign(p->seed, UINT64_MAX, number);
    return __builtin_popcountll(p->probe & number) % 2 == 0 ? sign : -sign;
}

static void add_to_all(void *context, size_t i, const contrast *at)
{
    const shared_probe *p = context;
    add_contrast(p->size * shared_sign(p, i), at, p->z);
}

static void add_part(void *context, size_t i, const contrast *at)
{
    shared_probe *p = context;
    double before = p->summed[at->middle] - p->summed[at->begin];
    double after = p->summed[at->end] - p->summed[at->middle];
    p->part += shared_sign(p, i) * (at->up * after - at->down * before);
}

// About the same energy from each level, so that the many contrasts of a fine one do not drown the
// few of a coarse one.
static double shared_size(const probed *on, size_t level)
{
    double energy = on->rock.k[level] * (double)lac_hierarchy_rank(on->h, level);
    return energy > 0 ? 1 / sqrt(energy) : 0;
}

static shared_probe shared_at(const probed *on, size_t probe, size_t level)
{
    return (shared_probe){.seed = on->seed,
                          .probe = probe,
                          .first = lac_hierarchy_blocks(on->h, level + 1) - 1,
                          .size = shared_size(on, level),
                          .z = on->slip};
}

// The parts of one shared probe: over all signs each has the trace of its band for its mean.
static lac_status probe_all(const probed *on, size_t probe, double *part, lac_error *err)
{
    size_t levels = lac_hierarchy_levels(on->h), n = on->domain->n;
    double sum = 0;
    memset(on->slip, 0, n * sizeof *on->slip);
    for (size_t l = 0; l < levels; l++) {
        shared_probe p = shared_at(on, probe, l);
        each_contrast(on->h, l, add_to_all, &p);
    }
    int iterations = lac_elastic_apply(&on->rock, on->slip, on->traction, on->work);
    LAC_FAIL_IF(iterations < 0, err, LAC_ENUMERIC,
                "the elastic half-space on %zu contact cells did not converge in %d iterations", n,
                LAC_ELASTIC_ITERATIONS);
    double *summed = on->slip; // [n + 1]
    for (size_t i = 0; i < n; i++) {
        summed[i] = sum;
        sum += on->traction[i];
    }
    summed[n] = sum;
    for (size_t l = 0; l < levels; l++) {
        shared_probe p = shared_at(on, probe, l);
        p.summed = summed;
        each_contrast(on->h, l, add_part, &p);
        size_t rank = lac_hierarchy_rank(on->h, l);
        part[l] = rank > 0 ? p.part / (p.size * (double)rank) : 0;
    }
    return LAC_OK;
}

static lac_status make_room(size_t levels, size_t probes, stiffnesses *s, lac_error *err)
{
    *s = (stiffnesses){levels, probes, malloc((1 + probes) * (levels + 1) * sizeof *s->k), NULL};
    LAC_FAIL_MEMORY_IF(s->k == NULL, err);
    s->part = s->k + levels;
    return LAC_OK;
}

// A level's mean part over the probes.
static double mean_part(const stiffnesses *s, size_t probes, size_t level)
{
    double sum = 0;
    for (size_t p = 0; p < probes; p++) {
        sum += s->part[p * s->levels + level];
    }
    return sum / (double)probes;
}

// Of the level: its mean part; where half the grid has it, too, what is known of it there times the
// ratio of the two mean parts, which scatter together.
static lac_status set_beside(const lac_hierarchy *h, const stiffnesses *half, size_t level,
                             stiffnesses *s, lac_error *err)
{
    bool finest = level == 0;
    double mean = mean_part(s, s->probes, level);
    double there = finest ? 1 : mean_part(half, s->probes, level - 1);
    s->k[level] = 0;
    if (lac_hierarchy_rank(h, level) == 0) {
        return LAC_OK;
    }
    LAC_FAIL_IF(!(mean > 0 && there > 0), err, LAC_ENUMERIC,
                "%zu probes do not determine the stiffness of level %zu: take another seed",
                s->probes, level);
    s->k[level] = (finest ? 1 : half->k[level - 1]) * (mean / there);
    return LAC_OK;
}

// Whether bands are probed one by one.
static bool is_small(const lac_domain *domain, const lac_hierarchy *h)
{
    bool small = true;
    for (size_t l = 0; l < lac_hierarchy_levels(h); l++) {
        small = small && lac_hierarchy_rank(h, l) <= EXACT_RANK;
    }
    return small || lac_grid_cells(&domain->grid) <= SMALL_GRID;
}

// At least those that the grid of twice the cells a side `asks` for.
static size_t shared_probes(size_t cells, size_t asks)
{
    size_t probes = asks > 0 ? asks : FEWEST_SHARED;
    while (probes * cells < SHARED_CELLS) {
        probes *= 2;
    }
    return probes < MOST_SHARED ? probes : MOST_SHARED;
}

// The blocks of two cells a side that hold contact cells, as cells.
static lac_status halve(const lac_domain *domain, lac_domain **out, lac_error *err)
{
    const lac_grid *from = &domain->grid;
    lac_grid grid = {(from->nx + 1) / 2, (from->ny + 1) / 2, 2 * from->dx, 2 * from->dy,
                     from->periodic};
    double *pressure = calloc(lac_grid_cells(&grid), sizeof *pressure);
    LAC_FAIL_MEMORY_IF(pressure == NULL, err);
    for (size_t i = 0; i < domain->n; i++) {
        size_t x = domain->index[i] % from->nx / 2, y = domain->index[i] / from->nx / 2;
        pressure[y * grid.nx + x] = 1;
    }
    lac_status status = lac_domain_create(&grid, pressure, out, err);
    free(pressure);
    return status;
}

static lac_status calibrate_grid(const lac_domain *domain, const lac_rock *rock, uint64_t seed,
                                 stiffnesses *s, lac_error *err);

static lac_status calibrate_half(const lac_domain *domain, const lac_rock *rock, uint64_t seed,
                                 stiffnesses *half, lac_error *err)
{
    lac_status status;
    lac_domain *coarse = NULL;
    LAC_TRY(halve(domain, &coarse, err));
    LAC_TRY(calibrate_grid(coarse, rock, seed, half, err));
out:
    lac_domain_free(coarse);
    return status;
}

// Room, and the rock on the cells; k precondition.
static lac_status prepare(const lac_rock *rock, double *k, probed *on, lac_error *err)
{
    const lac_domain *domain = on->domain;
    size_t n = domain->n;
    on->rock = (lac_elastic){.n = n, .h = on->h, .k = k, .floating = true};
    on->rock.tolerance = shared_tolerance;
    on->rock.direct = domain->grid.periodic && n == lac_grid_cells(&domain->grid);
    on->slip = malloc((2 * n + 1 + lac_elastic_work(&on->rock)) * sizeof *on->slip);
    LAC_FAIL_MEMORY_IF(on->slip == NULL, err);
    on->traction = on->slip + n + 1;
    on->work = on->traction + n;
    return lac_compliance_create(domain, rock, &on->rock.rock, err);
}

// Stiffness by level as half the grid has it, for a start; the finest level's from the next that
// ties anything, as it goes with 1/size.
static void start_from(const stiffnesses *half, stiffnesses *s)
{
    size_t next = 1;
    memcpy(s->k + 1, half->k, half->levels * sizeof *s->k);
    while (next < half->levels && s->k[next] == 0) {
        next++;
    }
    s->k[0] = ldexp(s->k[next], (int)next);
}

static lac_status probe_grid(const probed *on, const stiffnesses *half, stiffnesses *s,
                             lac_error *err)
{
    bool small = half->k == NULL;
    for (size_t l = 0; l < s->levels && small; l++) {
        LAC_TRY_RETURN(calibrate_band(on, l, s, err));
    }
    for (size_t p = 0; p < s->probes; p++) {
        LAC_TRY_RETURN(probe_all(on, p, &s->part[p * s->levels], err));
    }
    for (size_t l = 0; l < s->levels && !small; l++) {
        LAC_TRY_RETURN(set_beside(on->h, half, l, s, err));
    }
    return LAC_OK;
}

// @param s  with the number of shared probes that half a grid is asked for; filled in, its k to be
// freed
static lac_status calibrate_grid(const lac_domain *domain, const lac_rock *rock, uint64_t seed,
                                 stiffnesses *s, lac_error *err)
{
    lac_status status;
    lac_hierarchy *h = NULL;
    stiffnesses half = {0};
    probed on = {.domain = domain, .seed = seed};
    LAC_TRY(lac_hierarchy_create(domain, &h, err));
    on.h = h;
    const bool small = is_small(domain, h);
    half.probes = small ? s->probes : shared_probes(domain->n, s->probes);
    LAC_TRY(make_room(lac_hierarchy_levels(h), half.probes, s, err));
    if (!small) {
        LAC_TRY(calibrate_half(domain, rock, seed, &half, err));
        start_from(&half, s);
    }
    LAC_TRY(prepare(rock, s->k, &on, err));
    LAC_TRY(probe_grid(&on, &half, s, err));
out:
    free(on.slip);
    free(half.k);
    lac_compliance_free(on.rock.rock);
    lac_hierarchy_free(h);
    return status;
}

lac_status lac_calibrate_elastic(const lac_transfer_scene *scene, bool across, uint64_t seed,
                                 double *k, lac_error *err)
{
    lac_status status;
    stiffnesses s = {0};
    lac_rock rock = {.shear_modulus = scene->shear_modulus,
                     .poisson = scene->poisson,
                     .thickness = INFINITY,
                     .line = scene->line,
                     .team = scene->team,
                     .across = across};
    LAC_TRY(calibrate_grid(scene->domain, &rock, seed, &s, err));
    memcpy(k, s.k, s.levels * sizeof *k);
out:
    free(s.k);
    return status;
}
