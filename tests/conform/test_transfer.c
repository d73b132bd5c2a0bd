// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/test.h"
#include "support/trees.h"
#include "transfer/transfer.h"

enum { TREES = 60, MAX_CELLS = 400, SMALL = 60 };

// How a kind is tried. Iterated ones take long: few and small domains, and a tolerance of theirs.
typedef struct trial {
    const char *kind;
    lac_transfer_hierarchy hierarchy;
    lac_transfer_elastic elastic;
    bool large;    // cheap enough to make on a million cells
    bool iterated; // else its matrix is that of its level stiffnesses
    bool anchored; // uniform slip costs something
} trial;

#define TIGHT .tolerance = 1e-14, .newton_tolerance = 1e-14

// What a kind is tried with, beside its defaults. Kinds that are not listed run with those.
static const trial trials[] = {
    {"hierarchy", .hierarchy = {.stiffness = -1, .k0 = 3, .ratio = NAN}, .large = true},
    {"hierarchy", .hierarchy = {.stiffness = -1, .k0 = 0.2, .ratio = 1.7}},
    {"hierarchy", .hierarchy = {.stiffness = -1, .k0 = 2, .ratio = 0}},
    {"hierarchy", .hierarchy = {.stiffness = 0, .k0 = NAN, .ratio = NAN, .seed = 1}},
    {"elastic", .elastic = {.thickness = NAN, TIGHT}, .iterated = true},
    {"elastic", .elastic = {.mode = 1, .thickness = NAN, TIGHT}, .iterated = true},
    {"elastic", .elastic = {.thickness = 3, TIGHT}, .iterated = true, .anchored = true},
};

typedef struct scene {
    lac_domain *domain;
    lac_hierarchy *h;
    lac_transfer transfer;
    size_t n;
    double slack; // of results, relative
    double *d, *x, *y, *z, *work;
} scene;

static scene scene_of(const lac_model *model, lac_domain *domain, uint64_t seed)
{
    scene s = {.domain = domain, .h = hierarchy_of(domain), .n = domain->n, .slack = 1e-14};
    lac_transfer_scene made_from = {domain, s.h, 2.0, 0.25, false, false, NULL};
    lac_error err = {""};
    if (lac_transfer_create(model, &made_from, &s.transfer, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    s.d = new_doubles(s.n);
    s.x = new_doubles(s.n);
    s.y = new_doubles(s.n);
    s.z = new_doubles(s.n);
    s.work = new_doubles(s.transfer.kind->work(s.transfer.state));
    for (size_t i = 0; i < s.n; i++) {
        s.d[i] = draw_log(seed, 2000 + i, 0.1, 10);
        s.y[i] = draw_uniform(seed, 3000000 + i, -1, 1);
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
    free(s->z);
    free(s->work);
}

static void apply(const scene *s, const double *x, double *y)
{
    s->transfer.kind->apply(s->transfer.state, x, y, s->work);
}

static bool solve(const scene *s, double k_mean, const double *y, double *x)
{
    return s->transfer.kind->solve(s->transfer.state, k_mean, s->d, y, x, s->work);
}

static double stiffness(const scene *s, size_t level)
{
    return s->transfer.kind->stiffness(s->transfer.state, level);
}

static double largest(size_t n, const double *x)
{
    double size = 0;
    for (size_t i = 0; i < n; i++) {
        size = fmax(size, fabs(x[i]));
    }
    return size;
}

// K (2 x + 3 y) = 2 K x + 3 K y
static void is_linear(scene *s, uint64_t seed)
{
    double *sum = new_doubles(s->n);
    for (size_t i = 0; i < s->n; i++) {
        s->x[i] = draw_uniform(seed, 8000000 + i, -1, 1);
        sum[i] = 2 * s->x[i] + 3 * s->y[i];
    }
    apply(s, s->x, s->z);
    apply(s, s->y, s->x);
    for (size_t i = 0; i < s->n; i++) {
        s->z[i] = 2 * s->z[i] + 3 * s->x[i];
    }
    apply(s, sum, s->x);
    double scale = fmax(largest(s->n, s->x), 1e-12);
    for (size_t i = 0; i < s->n; i++) {
        assert_true(fabs(s->x[i] - s->z[i]) <= 10 * s->slack * scale);
    }
    free(sum);
}

static void uniform_slip_costs_nothing(scene *s)
{
    for (size_t i = 0; i < s->n; i++) {
        s->x[i] = 0.3;
    }
    apply(s, s->x, s->z);
    double k = 0;
    for (size_t l = 0; l < lac_hierarchy_levels(s->h); l++) {
        k += stiffness(s, l);
    }
    assert_true(largest(s->n, s->z) <= 0.1 * s->slack * k);
}

// The operator's columns, into dense; symmetric, positive semidefinite, and, where `levels`, the
// matrix that its level stiffnesses define.
static void is_its_dense_matrix(scene *s, bool levels, long double *dense, long double *reference)
{
    size_t n = s->n;
    double scale = 0;
    memset(s->x, 0, n * sizeof *s->x);
    for (size_t j = 0; j < n; j++) {
        s->x[j] = 1;
        apply(s, s->x, s->z);
        s->x[j] = 0;
        for (size_t i = 0; i < n; i++) {
            dense[i * n + j] = s->z[i];
        }
        scale = fmax(scale, largest(n, s->z));
    }
    double k[33] = {0};
    for (size_t l = 0; l < lac_hierarchy_levels(s->h); l++) {
        k[l] = stiffness(s, l);
        assert_true(isfinite(k[l]) && k[l] >= 0);
    }
    dense_hierarchy(s->domain, lac_hierarchy_levels(s->h), k, reference);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            assert_true(fabsl(dense[i * n + j] - dense[j * n + i]) <= s->slack * scale);
            long double off = fabsl(dense[i * n + j] - reference[i * n + j]);
            assert_true(!levels || off <= 1e-12 * scale);
        }
    }
    memcpy(reference, dense, n * n * sizeof *dense);
    for (size_t i = 0; i < n; i++) {
        reference[i * n + i] += 100 * s->slack * scale + 1e-300;
    }
    assert_true(dense_positive(n, reference));
}

// (D + K + k_mean P_m) x = y against the dense matrix, and in place.
static void solve_is_that_of_its_matrix(scene *s, double k_mean, const long double *dense,
                                        long double *matrix)
{
    size_t n = s->n;
    long double *x = calloc(n, sizeof *x);
    assert_non_null(x);
    memcpy(matrix, dense, n * n * sizeof *dense);
    for (size_t i = 0; i < n; i++) {
        matrix[i * n + i] += s->d[i];
        for (size_t j = 0; j < n; j++) {
            matrix[i * n + j] += (long double)k_mean / (long double)n;
        }
        x[i] = s->y[i];
    }
    dense_solve(n, matrix, x);
    for (size_t i = 0; i < n; i++) {
        s->z[i] = (double)x[i];
    }
    assert_true(solve(s, k_mean, s->y, s->x));
    assert_true(relative_error(n, s->x, s->z) < 100 * s->slack);
    memcpy(s->z, s->y, n * sizeof *s->z);
    assert_true(solve(s, k_mean, s->z, s->z));
    assert_memory_equal(s->x, s->z, n * sizeof *s->x);
    free(x);
}

// |sum D x + n k_mean mean x - sum y| / sum |y| with D and k_mean a tiny part of the stiffness.
// (A stiff k_mean on soft cells asks for sum x = 0 of huge x: no double could say that.)
static void forces_balance(scene *s, double k_mean)
{
    for (double scale = 1; scale > 1e-16; scale *= 1e-5) {
        double *kept = s->d;
        s->d = new_doubles(s->n);
        for (size_t i = 0; i < s->n; i++) {
            s->d[i] = scale * kept[i];
        }
        assert_true(solve(s, scale * k_mean, s->y, s->x));
        long double force = 0, size = 0;
        for (size_t i = 0; i < s->n; i++) {
            force += ((long double)s->d[i] + scale * k_mean) * s->x[i] - s->y[i];
            size += fabs(s->y[i]);
        }
        assert_true(fabsl(force) <= s->slack * size);
        free(s->d);
        s->d = kept;
    }
}

static void solve_inverts_apply(scene *s, double k_mean, double tolerance)
{
    assert_true(solve(s, k_mean, s->y, s->x));
    apply(s, s->x, s->z);
    long double mean = 0;
    for (size_t i = 0; i < s->n; i++) {
        mean += s->x[i] / (long double)s->n;
    }
    for (size_t i = 0; i < s->n; i++) {
        s->z[i] += s->d[i] * s->x[i] + k_mean * (double)mean;
    }
    double error = relative_error(s->n, s->z, s->y);
    if (!(error < tolerance)) {
        fail_msg("%s, %zu cells: solve inverts apply to %.1e only", s->transfer.kind->info.name,
                 s->n, error);
    }
}

static void bad_diagonals_are_refused(scene *s)
{
    const double bad[] = {NAN, INFINITY, -INFINITY, -1e300};
    double kept = s->d[s->n / 2];
    for (size_t i = 0; i < 4; i++) {
        s->d[s->n / 2] = bad[i];
        assert_false(solve(s, 0.1, s->y, s->x));
    }
    s->d[s->n / 2] = kept;
    assert_false(solve(s, NAN, s->y, s->x));
    assert_false(solve(s, -1e12, s->y, s->x));
}

static void run_kit(const lac_model *model, const trial *how)
{
    size_t most = how->iterated ? SMALL : MAX_CELLS;
    long double *dense = calloc(most * most, sizeof *dense);
    long double *scratch = calloc(most * most, sizeof *scratch);
    assert_true(dense != NULL && scratch != NULL);
    for (uint64_t seed = 0; seed < test_some(how->iterated ? TREES / 6 : TREES); seed++) {
        // Every fourth tree at full size, the others small: elimination is O(n^3).
        scene s = scene_of(model, random_domain(seed, seed % 4 == 0 ? most : SMALL), seed);
        s.slack = how->iterated ? 1e-11 : s.slack;
        is_linear(&s, seed);
        if (!how->anchored) {
            uniform_slip_costs_nothing(&s);
        }
        is_its_dense_matrix(&s, !how->iterated, dense, scratch);
        solve_is_that_of_its_matrix(&s, 0, dense, scratch);
        solve_is_that_of_its_matrix(&s, 4, dense, scratch);
        if (!how->anchored) {
            s.slack = 1e-14;
            forces_balance(&s, seed % 2 == 0 ? 0 : 0.4);
        }
        solve_inverts_apply(&s, 0.4, how->iterated ? 1e-9 : 1e-12);
        bad_diagonals_are_refused(&s);
        scene_free(&s);
    }
    free(dense);
    free(scratch);
}

static void run_large(const lac_model *model)
{
    const size_t side = test_few() ? 256 : 2048;
    lac_grid grid = {side, side, 1, 1, true};
    lac_cascade cascade = {1.84, 5};
    lac_model source = {&lac_domain_source_get(1)->info, &cascade};
    lac_domain *domain = NULL;
    assert_int_equal(lac_domain_from_source(&source, &grid, 1, &domain, NULL), LAC_OK);
    assert_true(domain->n > side * side / 4);
    scene s = scene_of(model, domain, 1);
    solve_inverts_apply(&s, 0.5, 1e-10);
    scene_free(&s);
}

static void describes_itself(const lac_model_info *info)
{
    assert_true(info->name[0] != '\0' && info->summary[0] != '\0' && info->reference != NULL);
    for (size_t i = 0; i < info->param_count; i++) {
        const lac_param *p = &info->params[i];
        assert_true(p->key[0] != '\0' && p->doc[0] != '\0' && p->offset < info->params_size);
        assert_true(p->type != LAC_CHOICE || p->choices != NULL);
        char why[100];
        bool optional = (p->flags & LAC_OPTIONAL) != 0 || p->type == LAC_CHOICE;
        assert_true(optional || lac_param_allows(p, p->fallback, why, sizeof why));
    }
}

static void every_kind_passes_the_kit(void **state)
{
    (void)state;
    for (size_t i = 0; lac_transfer_kind_get(i) != NULL; i++) {
        const lac_model_info *info = &lac_transfer_kind_get(i)->info;
        bool listed = false;
        describes_itself(info);
        for (size_t v = 0; v < sizeof trials / sizeof *trials; v++) {
            if (strcmp(trials[v].kind, info->name) == 0) {
                trial how = trials[v];
                void *params = how.iterated ? (void *)&how.elastic : (void *)&how.hierarchy;
                lac_model model = {info, params};
                listed = true;
                run_kit(&model, &how);
                if (how.large) {
                    run_large(&model);
                }
            }
        }
        if (!listed) {
            lac_model model;
            assert_int_equal(lac_model_create(info, &model, NULL), LAC_OK);
            run_kit(&model, &(trial){0});
            run_large(&model);
            lac_model_clear(&model);
        }
    }
}

static void an_empty_slot_is_none(void **state)
{
    (void)state;
    scene s = scene_of(&(lac_model){0}, domain_of(3, 3, NULL), 1);
    assert_string_equal(s.transfer.kind->info.name, "none");
    scene_free(&s);
    lac_transfer nothing = {0};
    lac_transfer_clear(&nothing);
}

static void one_cell_is_held_by_the_spring(void **state)
{
    (void)state;
    scene s = scene_of(&(lac_model){0}, domain_of(1, 1, NULL), 1);
    s.d[0] = -2;
    assert_true(solve(&s, 6, s.y, s.x));
    assert_true(s.x[0] == s.y[0] / 4);
    assert_false(solve(&s, 1, s.y, s.x));
    scene_free(&s);
}

static void stiffness_is_a_power_law(void **state)
{
    (void)state;
    const lac_model_info *info = &lac_transfer_kind_get(0)->info;
    lac_transfer_hierarchy params = {.stiffness = -1, .k0 = 8, .ratio = 0.25};
    scene s = scene_of(&(lac_model){info, &params}, domain_of(8, 8, NULL), 1);
    assert_true(stiffness(&s, 0) == 8 && stiffness(&s, 1) == 2 && stiffness(&s, 2) == 0.5);
    assert_true(stiffness(&s, 3) == 0);
    scene_free(&s);
    params.ratio = NAN;
    s = scene_of(&(lac_model){info, &params}, domain_of(8, 8, NULL), 1);
    assert_true(stiffness(&s, 2) == 2);
    scene_free(&s);
}

static void refuse(lac_transfer_hierarchy params, double shear_modulus, double poisson,
                   const char *says)
{
    lac_domain *domain = domain_of(4, 4, NULL);
    lac_hierarchy *h = hierarchy_of(domain);
    lac_transfer_scene made_from = {domain, h, shear_modulus, poisson, false, false, NULL};
    lac_model model = {&lac_transfer_kind_get(0)->info, &params};
    lac_transfer transfer;
    lac_error err = {""};
    assert_int_equal(lac_transfer_create(&model, &made_from, &transfer, &err), LAC_EINPUT);
    assert_null(transfer.state);
    if (strstr(err.message, says) == NULL) {
        fail_msg("\"%s\" does not say \"%s\"", err.message, says);
    }
    lac_transfer_clear(&transfer);
    lac_hierarchy_free(h);
    lac_domain_free(domain);
}

static void bad_parameters_are_refused(void **state)
{
    (void)state;
    const double none = NAN;
    refuse((lac_transfer_hierarchy){-1, none, none, 1}, 1, 0.2, "needs stiffness: elastic, or k0");
    refuse((lac_transfer_hierarchy){-1, none, 0.5, 1}, 1, 0.2, "needs stiffness: elastic, or k0");
    refuse((lac_transfer_hierarchy){0, 1, none, 1}, 1, 0.2, "not both");
    refuse((lac_transfer_hierarchy){0, none, 0.5, 1}, 1, 0.2, "ratio: goes with k0");
    refuse((lac_transfer_hierarchy){-1, -1, 0.5, 1}, 1, 0.2, "k0: -1");
    refuse((lac_transfer_hierarchy){-1, INFINITY, 0.5, 1}, 1, 0.2, "finite");
    refuse((lac_transfer_hierarchy){-1, 1, 1001, 1}, 1, 0.2, "ratio: 1001");
    refuse((lac_transfer_hierarchy){-1, 1, -0.1, 1}, 1, 0.2, "ratio: -0.1");
    refuse((lac_transfer_hierarchy){0, none, none, 1}, NAN, 0.2, "needs a material");
    refuse((lac_transfer_hierarchy){0, none, none, 1}, 1, NAN, "needs a material");
    refuse((lac_transfer_hierarchy){0, none, none, 1}, -1, 0.2, "> 0 Pa");
    refuse((lac_transfer_hierarchy){0, none, none, 1}, 1, 0.7, "Poisson");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_passes_the_kit),
        cmocka_unit_test(an_empty_slot_is_none),
        cmocka_unit_test(one_cell_is_held_by_the_spring),
        cmocka_unit_test(stiffness_is_a_power_law),
        cmocka_unit_test(bad_parameters_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
