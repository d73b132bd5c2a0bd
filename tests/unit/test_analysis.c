// SPDX-License-Identifier: GPL-3.0-or-later
// The counts that an analysis keeps up to date, against counting afresh, as random cells begin to
// slip and cease; and what it says of fixed points.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/analysis.h"
#include "analysis/slipping.h"
#include "base/rng.h"
#include "fractal/fractal.h"
#include "support/test.h"

typedef struct place {
    size_t nx, ny;
    bool periodic;
    double kept; // part of the cells that touch
} place;

static const place places[] = {
    {1, 1, true, 1.0},   {1, 1, false, 1.0},   {2, 2, true, 1.0},   {2, 1, true, 1.0},
    {16, 1, true, 0.8},  {1, 16, true, 0.8},   {16, 1, false, 0.8}, {3, 2, true, 1.0},
    {16, 16, true, 0.6}, {16, 16, false, 0.6}, {12, 20, true, 0.5}, {13, 7, false, 0.9},
};

static lac_domain *make_domain(const place *p, uint64_t seed)
{
    const lac_grid grid = {p->nx, p->ny, 0.5, 2.0, p->periodic};
    const size_t cells = lac_grid_cells(&grid);
    double *pressure = calloc(cells, sizeof *pressure);
    lac_domain *domain = NULL;
    assert_non_null(pressure);
    pressure[cells / 2] = 1.0;
    for (size_t i = 0; i < cells; i++) {
        if (lac_random_uniform(seed, LAC_STREAM_TEST, i, 0) < p->kept) {
            pressure[i] = 1.0;
        }
    }
    assert_int_equal(lac_domain_create(&grid, pressure, &domain, NULL), LAC_OK);
    free(pressure);
    return domain;
}

// Longest side of a cluster, by the clusters of the slipping cells alone.
static double longest(const lac_domain *domain, const uint8_t *slips)
{
    const lac_grid *grid = &domain->grid;
    double *pressure = calloc(lac_grid_cells(grid), sizeof *pressure);
    lac_domain *part = NULL;
    lac_clusters *clusters = NULL;
    double extent = 0.0;
    assert_non_null(pressure);
    for (size_t i = 0; i < domain->n; i++) {
        pressure[domain->index[i]] = slips[i];
    }
    if (lac_domain_create(grid, pressure, &part, NULL) == LAC_OK) {
        assert_int_equal(lac_clusters_create(part, &clusters, NULL), LAC_OK);
        for (size_t c = 0; c < clusters->n; c++) {
            double across = grid->ny > 1 ? clusters->depth[c] * grid->dy : 0.0;
            extent = fmax(extent, fmax(clusters->width[c] * grid->dx, across));
        }
    }
    lac_clusters_free(clusters);
    lac_domain_free(part);
    free(pressure);
    return extent;
}

static size_t whole_blocks(const lac_hierarchy *h, size_t level, const uint8_t *slips)
{
    size_t count = 0;
    const uint32_t *first = lac_hierarchy_offsets(h, level);
    for (size_t b = 0; b < lac_hierarchy_blocks(h, level); b++) {
        bool whole = true;
        for (uint32_t i = first[b]; i < first[b + 1]; i++) {
            whole = whole && slips[i];
        }
        count += whole;
    }
    return count;
}

// Some cells change; mostly they begin to slip, now and then some cease.
static size_t change(const lac_domain *domain, uint64_t seed, uint64_t step, uint8_t *slips,
                     uint32_t *changed)
{
    size_t changes = 0;
    for (size_t i = 0; i < domain->n; i++) {
        double u = lac_random_uniform(seed, LAC_STREAM_TEST, i, step + 1);
        bool now = step % 4 == 3 ? slips[i] && u < 0.8 : slips[i] || u < 0.15;
        if (now != (bool)slips[i]) {
            slips[i] = now;
            changed[changes++] = (uint32_t)i;
        }
    }
    return changes;
}

static void follow(const place *p, uint64_t seed)
{
    lac_domain *domain = make_domain(p, seed);
    lac_hierarchy *h = NULL;
    lac_slip_blocks blocks;
    lac_slip_clusters clusters;
    uint8_t *slips = calloc(domain->n, 1);
    uint32_t *changed = malloc(domain->n * sizeof *changed);
    size_t known = 0;
    assert_true(slips != NULL && changed != NULL);
    assert_int_equal(lac_hierarchy_create(domain, &h, NULL), LAC_OK);
    assert_int_equal(lac_slip_blocks_create(h, &blocks, NULL), LAC_OK);
    assert_int_equal(lac_slip_clusters_create(domain, &clusters, NULL), LAC_OK);
    for (uint64_t step = 0; step < 12; step++) {
        size_t changes = change(domain, seed, step, slips, changed);
        for (size_t k = 0; k < changes; k++) {
            lac_slip_blocks_change(&blocks, changed[k], slips[changed[k]]);
        }
        size_t slipping = blocks.slipping[0];
        lac_slip_clusters_update(&clusters, slips, slipping, changed, changes);
        // In every other run of steps without waiting until the clusters are known.
        for (int wait = 0; isnan(clusters.extent) && seed % 2 == 0; wait++) {
            assert_true(wait < 10);
            lac_slip_clusters_update(&clusters, slips, slipping, changed, 0);
        }
        if (!isnan(clusters.extent)) {
            assert_true(fabs(clusters.extent - longest(domain, slips)) < 1e-12);
            known++;
        }
        for (size_t level = 0; level <= lac_hierarchy_levels(h); level++) {
            assert_int_equal(blocks.slipping[level], whole_blocks(h, level, slips));
        }
    }
    assert_true(known >= (seed % 2 == 0 ? 12 : 6));
    lac_slip_clusters_clear(&clusters);
    lac_slip_blocks_clear(&blocks);
    lac_hierarchy_free(h);
    lac_domain_free(domain);
    free(changed);
    free(slips);
}

static void test_counts(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        for (uint64_t seed = 1; seed <= 6; seed++) {
            follow(&places[i], seed);
        }
    }
}

static lac_rg_result with_map(double lambda, double value)
{
    return (lac_rg_result){.fit.map = {.points = 17, .lambda = lambda},
                           .fit.fixed_point = {.value = value, .low = 0.3, .high = 0.5}};
}

static void test_fixed_points(void **state)
{
    (void)state;
    lac_rg_result r = with_map(1.2, 0.4);
    lac_critical_fraction c = lac_critical_fraction_of(&r, "so", 0.6);
    assert_true(c.value == 0.4 && c.low == 0.3 && c.high == 0.5 && c.beta == 0.6);
    assert_string_equal(c.source, "static cascade: so");
    static const struct {
        double lambda, value;
        const char *words;
    } none[] = {{NAN, NAN, "17 pairs"},
                {0.9, NAN, "lambda = 0.9"},
                {1.2, 0.99, "at 0.99 only"},
                {1.2, 0.01, "at 0.01 only"}};
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
        r = with_map(none[i].lambda, none[i].value);
        c = lac_critical_fraction_of(&r, "so", 0.6);
        assert_true(isnan(c.value) && isnan(c.low) && isnan(c.high) && c.beta == 0.6);
        assert_true(strstr(c.source, "none: ") == c.source);
        assert_non_null(strstr(c.source, none[i].words));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_counts),
        cmocka_unit_test(test_fixed_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
