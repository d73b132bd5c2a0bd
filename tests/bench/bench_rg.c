// SPDX-License-Identifier: GPL-3.0-or-later
// The cascade on contacts of self-affine surfaces: time of the contact series and of a pass, and
// the critical force by each rule. bench_rg [side]
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "lacuna/rg.h"
#include "lacuna/surface.h"
#include "support/cost.h"

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
    lac_slot slot = {&lac_surface_source_at(0)->about, &params};
    double *heights = get(side * side * sizeof *heights);
    double *pressure = get(side * side * sizeof *pressure);
    must(lac_surface_generate(&slot, &grid, heights, err), err);
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
    double start = wall_seconds();
    must(lac_rg_series_solve(&def, j->domain, j->pressure, err), err);
    double part[LAC_RG_LOADS];
    lac_rg_loads(part);
    lac_rg_series series = {j->domain->n, LAC_RG_LOADS, part, j->pressure, 1.0};
    must(lac_rg_path_elastic(&series, &j->path, err), err);
    printf("p/E* %g: %zu cells, contact series %.2f s\n", load, j->domain->n,
           wall_seconds() - start);
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
        double start = wall_seconds();
        double critical = lac_rg_critical(tree, rule, j->path, j->work);
        double whole = wall_seconds() - start;
        double fastest = INFINITY;
        for (int i = 0; i < 20; i++) {
            lac_rg_path_at(j->path, 0.5 + 0.02 * i, j->work, j->work + n);
            start = wall_seconds();
            (void)lac_rg_pass(tree, rule, j->work, j->work + n);
            fastest = fmin(fastest, wall_seconds() - start);
        }
        printf("  %s %.4f (%.0f ms; %.1f ns a node)", names[rule], critical, 1e3 * whole,
               1e9 * fastest / (double)nodes);
    }
    printf("\n");
    lac_rg_tree_free(tree);
}

int main(int argc, char **argv)
{
    size_t side = argc > 1 ? (size_t)atoi(argv[1]) : 256;
    const double loads[] = {0.01, 0.033, 0.105};
    lac_error err = {""};
    for (size_t i = 0; i < sizeof loads / sizeof *loads; i++) {
        joint j = {0};
        press(side, loads[i], &j, &err);
        for (int beta = 8; beta >= 6; beta--) {
            cascade(&j, 0.1 * beta, &err);
        }
        lac_rg_path_free(j.path);
        lac_hierarchy_free(j.h);
        lac_domain_free(j.domain);
        free(j.pressure), free(j.drop), free(j.work);
    }
    return 0;
}
