// SPDX-License-Identifier: GPL-3.0-or-later
// The elastic transfer: iterations and times of the stress and of the Newton solve; the calibration
// of the hierarchy, its cost and its scatter; docs/theory/transfer.md, "Measured".
//   bench_elastic [LARGEST]      calibration on grids from 256 to LARGEST (1024)
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/cost.h"
#include "support/trees.h"
#include "transfer/calibrate.h"
#include "transfer/elastic_solve.h"
#include "transfer/transfer.h"

enum { SIDE = 256 };
static const double solve_tolerance = 1e-6, apply_tolerance = 1e-9;

typedef struct scene {
    lac_domain *domain;
    lac_hierarchy *h;
    lac_transfer transfer;
    lac_elastic *e;
    size_t n;
    double *d, *x, *y, *work;
} scene;

static lac_domain *mask_of(double fraction)
{
    uint8_t *mask = calloc((size_t)SIDE * SIDE, 1);
    if (mask == NULL) {
        abort();
    }
    for (size_t i = 0; i < (size_t)SIDE * SIDE; i++) {
        mask[i] = draw_uniform(7, i, 0, 1) < fraction;
    }
    lac_domain *domain = domain_of(SIDE, SIDE, mask);
    free(mask);
    return domain;
}

static lac_domain *cascade_of(size_t side, double dimension, int64_t seed)
{
    lac_grid grid = {side, side, 1, 1, true};
    lac_cascade cascade = {dimension, seed};
    lac_model source = {&lac_domain_source_get(1)->info, &cascade};
    lac_domain *domain = NULL;
    if (lac_domain_from_source(&source, &grid, 1, &domain, NULL) != LAC_OK) {
        abort();
    }
    return domain;
}

static scene scene_of(lac_domain *domain)
{
    scene s = {.domain = domain, .h = hierarchy_of(domain), .n = domain->n};
    const lac_model_info *info = NULL;
    for (size_t i = 0; lac_transfer_kind_get(i) != NULL; i++) {
        const lac_model_info *row = &lac_transfer_kind_get(i)->info;
        info = strcmp(row->name, "elastic") == 0 ? row : info;
    }
    lac_transfer_elastic params = {
        .thickness = NAN, .tolerance = apply_tolerance, .newton_tolerance = solve_tolerance};
    lac_model model = {info, &params};
    lac_transfer_scene from = {domain, s.h, 1, 0.25, false, false, NULL};
    if (lac_transfer_create(&model, &from, &s.transfer, NULL) != LAC_OK) {
        abort();
    }
    s.e = s.transfer.state;
    s.d = new_doubles(s.n);
    s.x = new_doubles(s.n);
    s.y = new_doubles(s.n);
    s.work = new_doubles(s.transfer.kind->work(s.transfer.state));
    for (size_t i = 0; i < s.n; i++) {
        s.y[i] = draw_uniform(3, i, -1, 1);
    }
    return s;
}

static void scene_free(scene *s)
{
    lac_transfer_clear(&s->transfer);
    lac_hierarchy_free(s->h);
    lac_domain_free(s->domain);
    free(s->d);
    free(s->x);
    free(s->y);
    free(s->work);
}

// Iterations, what remains of the error and how long it takes.
static void row(scene *s, const char *name, bool solve)
{
    double begin = cpu_seconds();
    int iterations = solve ? lac_elastic_solve(s->e, 0, s->d, s->y, s->x, s->work)
                           : lac_elastic_apply(s->e, s->y, s->x, s->work);
    double taken = 1e3 * (cpu_seconds() - begin);
    printf("%-30s  %9d", name, iterations);
    double *best = new_doubles(s->n);
    s->e->tolerance = s->e->newton_tolerance = 1e-13;
    (void)(solve ? lac_elastic_solve(s->e, 0, s->d, s->y, best, s->work)
                 : lac_elastic_apply(s->e, s->y, best, s->work));
    s->e->tolerance = apply_tolerance;
    s->e->newton_tolerance = solve_tolerance;
    printf("  %9.1f ms  %.1e\n", taken, relative_error(s->n, s->x, best));
    free(best);
}

static void bench(const char *name, lac_domain *domain)
{
    double begin = cpu_seconds();
    scene s = scene_of(domain);
    double k0 = s.e->k[0];
    printf("\n%s: %zu cells, made in %.2f s, k_0 = %.3g G/r\n", name, s.n, cpu_seconds() - begin,
           k0);
    printf("%-30s  %9s  %12s  %s\n", "", "iterations", "", "error");
    row(&s, "stress", false);
    static const double level[] = {1e-4, 1e-2, 1, 100};
    for (size_t l = 0; l < 4; l++) {
        char label[64];
        (void)snprintf(label, sizeof label, "solve, D = %g k_0", level[l]);
        for (size_t i = 0; i < s.n; i++) {
            s.d[i] = level[l] * k0;
        }
        row(&s, label, true);
        (void)snprintf(label, sizeof label, "solve, D = 0.01..100 x %g k_0", level[l]);
        for (size_t i = 0; i < s.n; i++) {
            s.d[i] = level[l] * k0 * draw_log(9, i, 0.01, 100);
        }
        row(&s, label, true);
    }
    for (size_t i = 0; i < s.n; i++) {
        s.d[i] = k0 * draw_uniform(9, i, -0.1, 1);
    }
    s.d[0] = -0.1 * k0;
    row(&s, "solve, D = -0.1..1 k_0", true);
    scene_free(&s);
}

// The stiffness of every level on the contacts of tools/studies/fidelity.py.
static void levels(double fraction)
{
    scene s = scene_of(cascade_of(64, 2 + log2(fraction) / 6, 1));
    printf("contact %.2g, %5zu cells: k_l =", fraction, s.n);
    for (size_t l = 0; l < lac_hierarchy_levels(s.h); l++) {
        printf(" %.3f", s.e->k[l]);
    }
    printf(" G/r\n");
    scene_free(&s);
}

// CPU seconds of one pair of transforms of the grid.
static double pair_seconds(const lac_domain *domain)
{
    enum { PAIRS = 5 };
    const lac_rock rock = {.shear_modulus = 1, .poisson = 0.25, .thickness = INFINITY};
    lac_compliance *c = NULL;
    if (lac_compliance_create(domain, &rock, &c, NULL) != LAC_OK) {
        abort();
    }
    double *x = new_doubles(domain->n), begin = cpu_seconds();
    for (size_t i = 0; i < PAIRS; i++) {
        lac_compliance_slip(c, domain->pressure, x);
    }
    double taken = cpu_seconds() - begin;
    free(x);
    lac_compliance_free(c);
    return taken / PAIRS;
}

// The calibration of a cascade with several seeds: its cost, and the scatter of each level.
static void calibration(size_t side)
{
    enum { SEEDS = 6, MOST_LEVELS = 32 };
    lac_domain *domain = cascade_of(side, 1.7, 5);
    lac_hierarchy *h = hierarchy_of(domain);
    lac_transfer_scene from = {domain, h, 1, 0.25, false, false, NULL};
    size_t levels = lac_hierarchy_levels(h);
    double k[MOST_LEVELS], mean[MOST_LEVELS] = {0}, square[MOST_LEVELS] = {0};
    double pair = pair_seconds(domain), begin = cpu_seconds();
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        if (lac_calibrate_elastic(&from, false, seed, k, NULL) != LAC_OK) {
            abort();
        }
        for (size_t l = 0; l < levels; l++) {
            mean[l] += k[l] / SEEDS;
            square[l] += k[l] * k[l] / SEEDS;
        }
    }
    double taken = (cpu_seconds() - begin) / SEEDS;
    printf("calibration, %zu^2, %zu cells: %.3f s, %.0f pairs; sd (%%)", side, domain->n, taken,
           taken / pair);
    for (size_t l = 0; l < levels; l++) {
        double variance = (square[l] / (mean[l] * mean[l]) - 1) * SEEDS / (SEEDS - 1);
        printf(" %.1f", 100 * sqrt(fmax(0, variance)));
    }
    printf("\n");
    lac_hierarchy_free(h);
    lac_domain_free(domain);
}

int main(int argc, char **argv)
{
    size_t largest = argc > 1 ? (size_t)strtoul(argv[1], NULL, 10) : 1024;
    for (size_t side = 256; side <= largest; side *= 2) {
        calibration(side);
    }
    levels(1);
    levels(0.8);
    levels(0.2);
    bench("full", mask_of(2));
    bench("random 0.8", mask_of(0.8));
    bench("random 0.2", mask_of(0.2));
    bench("cascade 1.7", cascade_of(SIDE, 1.7, 5));
    return 0;
}
