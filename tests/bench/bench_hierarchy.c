// SPDX-License-Identifier: GPL-3.0-or-later
// Time per cell of the hierarchy's apply and solve on random cascades, beside the time that a
// triad takes to move the same bytes. bench_hierarchy [repetitions]
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "hierarchy/hierarchy.h"
#include "support/cost.h"

typedef struct arrays {
    const lac_hierarchy *h;
    double *k, *d, *x, *y, *work;
} arrays;

static bool apply(const arrays *a)
{
    lac_hierarchy_apply(a->h, a->k, a->x, a->y, a->work);
    return true;
}

static bool solve(const arrays *a)
{
    return lac_hierarchy_solve(a->h, a->k, 0, a->d, a->y, a->x, a->work);
}

// 24 bytes a cell
static bool triad(const arrays *a)
{
    for (size_t i = 0; i < lac_hierarchy_cells(a->h); i++) {
        a->y[i] = a->x[i] + 1e-9 * a->d[i];
    }
    return true;
}

// The shortest time of one call over the repetitions [ns a cell]
static double fastest(bool (*call)(const arrays *), const arrays *a, int repetitions)
{
    double best = INFINITY;
    for (int i = 0; i < repetitions; i++) {
        double start = wall_seconds();
        if (!call(a)) {
            (void)fprintf(stderr, "the solve failed\n");
            exit(1);
        }
        best = fmin(best, wall_seconds() - start);
    }
    return 1e9 * best / (double)lac_hierarchy_cells(a->h);
}

static void report(const lac_domain *domain, int repetitions, lac_error *err)
{
    lac_hierarchy *h = NULL;
    double start = wall_seconds();
    if (lac_hierarchy_create(domain, &h, err) != LAC_OK) {
        (void)fprintf(stderr, "%s\n", err->message);
        exit(1);
    }
    double build = 1e9 * (wall_seconds() - start) / (double)domain->n;
    size_t n = domain->n;
    arrays a = {.h = h,
                .k = calloc(33, sizeof(double)),
                .d = malloc(n * sizeof(double)),
                .x = malloc(n * sizeof(double)),
                .y = malloc(n * sizeof(double)),
                .work = malloc(lac_hierarchy_work(h) * sizeof(double))};
    if (a.k == NULL || a.d == NULL || a.x == NULL || a.y == NULL || a.work == NULL) {
        exit(1);
    }
    for (int l = 0; l < 33; l++) {
        a.k[l] = ldexp(1, -l);
    }
    for (size_t i = 0; i < n; i++) {
        a.d[i] = 0.1 + (double)(i * 7919 % 1000) * 1e-3;
        a.x[i] = a.y[i] = sin((double)i);
    }
    double t_apply = fastest(apply, &a, repetitions);
    double t_triad = fastest(triad, &a, repetitions);
    double t_solve = fastest(solve, &a, repetitions);
    printf("%9zu %8.2f %8.2f %8.2f %8.2f %10.2f\n", n, t_apply, t_solve, t_triad, build,
           24 / t_triad);
    free(a.k), free(a.d), free(a.x), free(a.y), free(a.work);
    lac_hierarchy_free(h);
}

int main(int argc, char **argv)
{
    int repetitions = argc > 1 ? atoi(argv[1]) : 20;
    static const struct {
        size_t side;
        double dimension;
    } cases[] = {{64, 2}, {256, 2}, {500, 2}, {1024, 2}, {1024, 1.723}, {2048, 1.723}};
    lac_error err = {""};
    printf("    cells    apply    solve    triad    build   triad GB/s     (ns a cell)\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        lac_grid grid = {cases[i].side, cases[i].side, 1, 1, true};
        lac_cascade cascade = {cases[i].dimension, 3};
        lac_model model = {&lac_domain_source_get(1)->info, &cascade};
        lac_domain *domain = NULL;
        if (lac_domain_from_source(&model, &grid, 1e6, &domain, &err) != LAC_OK) {
            (void)fprintf(stderr, "%s\n", err.message);
            return 1;
        }
        report(domain, repetitions, &err);
        lac_domain_free(domain);
    }
    return 0;
}
