// SPDX-License-Identifier: GPL-3.0-or-later
// The stiffness of each level as the elastic half-space has it, from a few random probes.
#include "transfer/calibrate.h"

#include "base/rng.h"
#include "transfer/compliance.h"

// All vectors of a band where there are few; else probes until the mean is known well enough.
enum { EXACT_RANK = 32, FEWEST_PROBES = 4, MOST_PROBES = 40 };
static const double probe_error = 0.01;
// The energy converges twice as fast as the traction; at this tolerance it was found good to 1e-3.
static const double energy_tolerance = 1e-2;

typedef struct probe {
    const lac_hierarchy *h;
    size_t level;
    uint64_t seed;
    size_t number; // which basis vector, or which random combination of all of them
    bool random;
} probe;

// The weight of the band's i-th basis vector in a probe.
static double weight(const probe *p, size_t i)
{
    if (!p->random) {
        return i == p->number;
    }
    uint64_t bits[4];
    lac_random(p->seed, LAC_STREAM_PROBE, (uint64_t)p->level << 32 | p->number, i, bits);
    return (bits[0] & 1) != 0 ? 1 : -1;
}

// Adds the unit vector of zero mean that is constant on cells [begin, middle) and [middle, end).
static void add_contrast(double w, size_t begin, size_t middle, size_t end, double *z)
{
    double before = (double)(middle - begin), after = (double)(end - middle);
    double down = w * sqrt(after / (before * (before + after)));
    double up = w * sqrt(before / (after * (before + after)));
    for (size_t i = begin; i < middle; i++) {
        z[i] -= down;
    }
    for (size_t i = middle; i < end; i++) {
        z[i] += up;
    }
}

// Every child but the first of its parent, against the children before it: these contrasts are an
// orthonormal basis of the band P_l - P_{l+1}, and K is nearly diagonal in it, which is why random
// signs in this basis scatter so little.
static void fill_probe(const probe *p, double *z)
{
    const uint32_t *child = lac_hierarchy_offsets(p->h, p->level);
    const uint32_t *parent = lac_hierarchy_offsets(p->h, p->level + 1);
    size_t b = 0, contrast = 0;
    memset(z, 0, lac_hierarchy_cells(p->h) * sizeof *z);
    for (size_t c = 0; c < lac_hierarchy_blocks(p->h, p->level); c++) {
        if (child[c] == parent[b + 1]) {
            b++;
        }
        if (child[c] != parent[b]) {
            double w = weight(p, contrast++);
            if (w != 0) {
                add_contrast(w, parent[b], child[c], child[c + 1], z);
            }
        }
    }
}

// Standard error of the mean of `probes` energies whose squared deviations sum to `squares`. A
// handful can agree by chance, so the scatter of a probe that was seen on many domains, a variance
// of 0.1 mean^2/rank, counts for six more.
static double standard_error(size_t probes, double mean, double squares, size_t rank)
{
    double usual = 0.1 * mean * mean / (double)rank;
    double variance = (squares + 6 * usual) / (double)(probes - 1 + 6);
    return sqrt(variance / (double)probes);
}

// The mean energy of the band's vectors: over a basis, or over random probes of all of it.
static lac_status calibrate_band(const lac_hierarchy *h, size_t level, uint64_t seed,
                                 lac_compliance *c, double *vectors, double *k, double *error,
                                 lac_error *err)
{
    size_t rank = lac_hierarchy_rank(h, level), n = lac_hierarchy_cells(h);
    bool random = rank > EXACT_RANK;
    size_t most = random ? MOST_PROBES : rank;
    double mean = 0, squares = 0, off = 0;
    for (size_t i = 0; i < most; i++) {
        probe p = {.h = h, .level = level, .seed = seed, .number = i, .random = random};
        double energy;
        fill_probe(&p, vectors);
        LAC_TRY_RETURN(
            lac_compliance_invert(c, vectors, energy_tolerance, vectors + n, &energy, err));
        energy /= random ? (double)rank : 1;
        double change = energy - mean;
        mean += change / (double)(i + 1);
        squares += change * (energy - mean);
        off = random ? standard_error(i + 1, mean, squares, rank) : 0;
        if (random && i + 1 >= FEWEST_PROBES && off <= probe_error * mean) {
            break;
        }
    }
    *k = mean;
    *(error != NULL ? error : &off) = off;
    return LAC_OK;
}

static lac_status calibrate(const lac_transfer_scene *scene, bool across, uint64_t seed, double *k,
                            double *error, lac_error *err)
{
    lac_status status = LAC_OK;
    const lac_hierarchy *h = scene->hierarchy;
    lac_compliance *c = NULL;
    double *vectors = NULL;
    lac_rock rock = {.shear_modulus = scene->shear_modulus,
                     .poisson = scene->poisson,
                     .thickness = INFINITY,
                     .line = scene->line,
                     .across = across};
    LAC_TRY(lac_compliance_create(scene->domain, &rock, &c, err));
    vectors = malloc(2 * lac_hierarchy_cells(h) * sizeof *vectors);
    LAC_TRY(vectors != NULL ? LAC_OK : lac_fail_memory(err));
    for (size_t l = 0; l < lac_hierarchy_levels(h); l++) {
        LAC_TRY(
            calibrate_band(h, l, seed, c, vectors, &k[l], error != NULL ? &error[l] : NULL, err));
    }
out:
    free(vectors);
    lac_compliance_free(c);
    return status;
}

lac_status lac_calibrate_elastic(const lac_transfer_scene *scene, uint64_t seed, double *k,
                                 double *error, lac_error *err)
{
    return calibrate(scene, false, seed, k, error, err);
}

lac_status lac_calibrate_along_y(const lac_transfer_scene *scene, uint64_t seed, double *k,
                                 lac_error *err)
{
    return calibrate(scene, true, seed, k, NULL, err);
}
