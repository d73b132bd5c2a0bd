// SPDX-License-Identifier: GPL-3.0-or-later
// The cascade on contacts of self-affine surfaces: time of the contact series, of a pass, and of a
// study of five betas at 1 and 16 places; the critical force by each rule. All CPU time, on one
// thread. Floors at 1024: series <= 12 s, pass <= 15 ns a node, study <= 2 s. bench_rg [side
// [loads]]
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>

#include "rg/rg_study.h"
#include "support/cost.h"
#include "surface/surface.h"

static void must(lac_status status, const lac_error *err)
{
    if (status != LAC_OK) {
        (void)fprintf(stderr, "%s\n", err->message);
        exit(1);
    }
}

static void *get(size_t size)
{
    void *p = malloc(size);
    if (p == NULL) {
        exit(1);
    }
    return p;
}

typedef struct joint {
    lac_domain *domain;
    lac_hierarchy *h;
    lac_rg_path *path;
    double *pressure, *drop, *work;
} joint;

static void press(size_t side, double load, joint *j, lac_error *err)
{
    lac_grid grid = {side, side, 1.0 / (double)side, 1.0 / (double)side, true};
    lac_self_affine params = {.hurst = 0.8,
                              .rms_height = NAN,
                              .rms_slope = 1.0,
                              .rolloff = NAN,
                              .shortest = NAN,
                              .seed = 1,
                              .anisotropy = 1.0};
    lac_model model = {&lac_surface_source_get(0)->info, &params};
    double *heights = get(side * side * sizeof *heights);
    double *pressure = get(side * side * sizeof *pressure);
    must(lac_surface_generate(&model, &grid, heights, NULL, err), err);
    lac_contact_def def = lac_contact_default();
    def.grid = grid;
    def.heights = heights;
    def.e_star = 1.0;
    def.mean_pressure = load;
    must(lac_contact_solve(&def, pressure, NULL, NULL, err), err);
    must(lac_domain_create(&grid, pressure, &j->domain, err), err);
    must(lac_hierarchy_create(j->domain, &j->h, err), err);
    j->pressure = get(LAC_RG_LOADS * j->domain->n * sizeof(double));
    j->drop = get(j->domain->n * sizeof(double));
    j->work = get(2 * j->domain->n * sizeof(double));
    double start = cpu_seconds();
    must(lac_rg_series_solve(&def, j->domain, LAC_RG_LOADS, j->pressure, err), err);
    double part[LAC_RG_LOADS];
    lac_rg_loads(LAC_RG_LOADS, part);
    lac_rg_series series = {j->domain->n, LAC_RG_LOADS, part, j->pressure, 1.0};
    must(lac_rg_path_elastic(&series, &j->path, err), err);
    printf("p/E* %g: %zu cells, contact series %.2f s\n", load, j->domain->n,
           cpu_seconds() - start);
    free(heights);
    free(pressure);
}

static void cascade(const joint *j, double beta, lac_error *err)
{
    static const char *const names[] = {"fix", "cons", "lump"};
    const size_t n = j->domain->n;
    for (size_t i = 0; i < n; i++) {
        j->drop[i] = (1.0 - beta) * j->domain->pressure[i];
    }
    lac_rg_tree *tree = NULL;
    must(lac_rg_tree_create(j->h, j->domain->pressure, j->drop, &tree, err), err);
    size_t nodes = 0;
    for (size_t level = 0; level <= lac_rg_levels(tree); level++) {
        nodes += lac_rg_blocks_at(tree, level);
    }
    printf("  beta %.1f:", beta);
    for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_LUMP; rule++) {
        double start = cpu_seconds();
        double critical = lac_rg_critical(tree, rule, j->path, j->work);
        double whole = cpu_seconds() - start;
        double fastest = INFINITY;
        for (int i = 0; i < 20; i++) {
            lac_rg_path_eval(j->path, 0.5 + 0.02 * i, j->work, j->work + n);
            start = cpu_seconds();
            (void)lac_rg_pass(tree, rule, j->work, j->work + n);
            fastest = fmin(fastest, cpu_seconds() - start);
        }
        printf("  %s %.4f (%.0f ms; %.1f ns a node)", names[rule], critical, 1e3 * whole,
               1e9 * fastest / (double)nodes);
    }
    printf("\n");
    lac_rg_tree_free(tree);
}

// Five betas by each rule, as lacuna rg studies them.
static void study(const joint *j, size_t places, lac_error *err)
{
    static const char *const names[] = {"fix", "cons", "lump"};
    printf("  five beta, %2zu places:", places);
    for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_LUMP; rule++) {
        lac_rg_study_def def = lac_rg_study_default();
        const lac_rg_result *result = NULL;
        def.rule = rule;
        def.places = places;
        double start = cpu_seconds();
        for (int beta = 9; beta >= 5; beta--) {
            lac_rg_study *s = NULL;
            for (size_t i = 0; i < j->domain->n; i++) {
                j->drop[i] = (1.0 - 0.1 * beta) * j->domain->pressure[i];
            }
            const lac_rg_joint one = {j->domain, j->domain->pressure, j->drop, j->path, NULL};
            must(lac_rg_study_create(&def, &s, err), err);
            must(lac_rg_study_add(s, &one, err), err);
            must(lac_rg_study_finish(s, &result, err), err);
            lac_rg_study_free(s);
        }
        printf("  %s %.2f s", names[rule], cpu_seconds() - start);
    }
    printf("\n");
}

int main(int argc, char **argv)
{
    size_t side = argc > 1 ? (size_t)atoi(argv[1]) : 256;
    const double loads[] = {0.033, 0.01, 0.105};
    size_t cases = argc > 2 ? (size_t)atoi(argv[2]) : sizeof loads / sizeof *loads;
    lac_error err = {""};
    omp_set_num_threads(1);
    (void)setvbuf(stdout, NULL, _IOLBF, 0);
    for (size_t i = 0; i < cases && i < sizeof loads / sizeof *loads; i++) {
        joint j = {0};
        press(side, loads[i], &j, &err);
        for (int beta = 8; beta >= 6; beta--) {
            cascade(&j, 0.1 * beta, &err);
        }
        study(&j, 1, &err);
        study(&j, 16, &err);
        lac_rg_path_free(j.path);
        lac_hierarchy_free(j.h);
        lac_domain_free(j.domain);
        free(j.pressure), free(j.drop), free(j.work);
    }
    return 0;
}
