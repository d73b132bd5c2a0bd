// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/free_slip.h"
#include "support/half_space.h"
#include "support/test.h"
#include "support/trees.h"
#include "transfer/calibrate.h"
#include "transfer/compliance.h"

static const double tau = 6.283185307179586476925286766559;

// Signed angular wavenumber of mode j of n cells of side d.
static double wavenumber(size_t j, size_t n, double d)
{
    double signed_j = 2 * j <= n ? (double)j : (double)j - (double)n;
    return tau * signed_j / ((double)n * d);
}

// Stiffness of a mode of slip along x on two half-spaces [Pa/m].
static double mode_stiffness(const lac_grid *grid, double g, double nu, size_t i, size_t j)
{
    double kx = wavenumber(i, grid->nx, grid->dx), ky = wavenumber(j, grid->ny, grid->dy);
    double k = sqrt(kx * kx + ky * ky);
    return k > 0 ? g / 2 * (ky * ky + kx * kx / (1 - nu)) / k : 0;
}

static lac_domain *domain_on(lac_grid grid, const double *pressure)
{
    lac_domain *domain = NULL;
    assert_int_equal(lac_domain_create(&grid, pressure, &domain, NULL), LAC_OK);
    return domain;
}

static lac_domain *random_mask(lac_grid grid, double fraction, uint64_t seed)
{
    double *pressure = new_doubles(lac_grid_cells(&grid));
    for (size_t i = 0; i < lac_grid_cells(&grid); i++) {
        pressure[i] = draw_uniform(seed, i, 0, 1) < fraction ? 1 : 0;
    }
    lac_domain *domain = domain_on(grid, pressure);
    free(pressure);
    return domain;
}

static void calibrate_rock(const lac_domain *domain, double g, double nu, bool line, uint64_t seed,
                           double *k)
{
    lac_hierarchy *h = hierarchy_of(domain);
    lac_transfer_scene scene = {domain, h, g, nu, line, false, NULL};
    lac_error err = {""};
    if (lac_calibrate_elastic(&scene, false, seed, k, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    lac_hierarchy_free(h);
}

static void calibrate(const lac_domain *domain, double g, double nu, uint64_t seed, double *k)
{
    calibrate_rock(domain, g, nu, false, seed, k);
}

// |mean of exp(i theta x) over 2^l cells|^2 = (sin(2^l theta/2)/(2^l sin(theta/2)))^2
static double box(double theta, size_t level)
{
    double side = ldexp(1, (int)level);
    double s = sin(theta / 2);
    return fabs(s) < 1e-12 ? 1 : pow(sin(side * theta / 2) / (side * s), 2);
}

// On full contact K is diagonal in Fourier space: trace(P_l K) = sum over modes of S times the
// square of the block mean of the mode.
static double full_trace(const lac_grid *grid, double g, double nu, size_t level)
{
    double trace = 0;
    for (size_t j = 0; j < grid->ny; j++) {
        for (size_t i = 0; i < grid->nx; i++) {
            double s = mode_stiffness(grid, g, nu, i, j);
            double bx = box(tau * (double)i / (double)grid->nx, level);
            double by = grid->ny > 1 ? box(tau * (double)j / (double)grid->ny, level) : 1;
            trace += s * bx * by;
        }
    }
    return trace;
}

static void check_full(lac_grid grid, size_t levels, double nu)
{
    lac_domain *domain = random_mask(grid, 2, 1);
    lac_hierarchy *h = hierarchy_of(domain);
    double found[33];
    calibrate(domain, 3, nu, 1, found);
    for (size_t l = 0; l < levels; l++) {
        double exact = (full_trace(&grid, 3, nu, l) - full_trace(&grid, 3, nu, l + 1)) /
                       (double)lac_hierarchy_rank(h, l);
        double error = found[l] / exact - 1;
        bool whole = lac_grid_cells(&grid) <= 4096 && lac_hierarchy_rank(h, l) <= 32;
        print_message("full %zu x %zu, level %zu: k %.5f exact %.5f, off by %+.2e\n", grid.nx,
                      grid.ny, l, found[l], exact, error);
        assert_true(fabs(error) <= (whole ? 1e-9 : l == 0 ? 0.005 : l <= 2 ? 0.016 : 0.018));
    }
    lac_hierarchy_free(h);
    lac_domain_free(domain);
}

static void full_contact_has_a_closed_form(void **state)
{
    (void)state;
    check_full((lac_grid){64, 64, 1, 1, true}, 6, 0);
    check_full((lac_grid){64, 64, 0.5, 2, true}, 6, 0.25);
    check_full((lac_grid){256, 1, 1, 1, true}, 8, 0.25);
    check_full((lac_grid){128, 128, 0.5, 2, true}, 7, 0.25);
    check_full((lac_grid){256, 256, 1, 1, true}, 8, 0);
    check_full((lac_grid){8192, 1, 1, 1, true}, 13, 0.25);
}

static void check_dense(lac_grid grid, uint64_t seed, bool line)
{
    lac_domain *domain = random_mask(grid, 0.25, seed);
    lac_hierarchy *h = hierarchy_of(domain);
    size_t n = domain->n;
    double *dense = new_doubles(n * n), *slip = new_doubles(n), *traction = new_doubles(n);
    double *expected = new_doubles(n), energy, exact_energy = 0;
    dense_elastic(&(rock_def){2, 0.25, INFINITY, line}, domain, dense);

    lac_compliance *c = NULL;
    lac_rock rock = {.shear_modulus = 2, .poisson = 0.25, .thickness = INFINITY, .line = line};
    assert_int_equal(lac_compliance_create(domain, &rock, &c, NULL), LAC_OK);
    for (size_t i = 0; i < n; i++) {
        slip[i] = draw_uniform(seed, 5000 + i, -1, 1);
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            expected[i] += dense[i * n + j] * slip[j];
        }
        exact_energy += slip[i] * expected[i];
    }
    assert_int_equal(lac_compliance_invert(c, slip, 1e-15, traction, &energy, NULL), LAC_OK);
    assert_true(relative_error(n, traction, expected) < 1e-6);
    // free: as good as the quadrature of the reference
    assert_true(fabs(energy / exact_energy - 1) < (grid.periodic ? 1e-12 : 1e-6));
    lac_compliance_free(c);

    double found[33];
    calibrate_rock(domain, 2, 0.25, line, 1, found);
    long double *band = calloc(n * n, sizeof *band);
    assert_non_null(band);
    for (size_t l = 0; l < lac_hierarchy_levels(h); l++) {
        double k[33] = {0}, trace = 0;
        k[l] = 1;
        dense_hierarchy(domain, lac_hierarchy_levels(h), k, band);
        for (size_t i = 0; i < n * n; i++) {
            trace += (double)band[i] * dense[i];
        }
        double exact = trace / (double)lac_hierarchy_rank(h, l);
        print_message("%zu cells of %zu x %zu, level %zu: k %.5f dense %.5f, off by %+.1e\n", n,
                      grid.nx, grid.ny, l, found[l], exact, found[l] / exact - 1);
        assert_true(fabs(found[l] - exact) <= 2e-3 * exact);
    }
    free(band);
    free(dense);
    free(slip);
    free(traction);
    free(expected);
    lac_hierarchy_free(h);
    lac_domain_free(domain);
}

static void small_domains_agree_with_dense_matrices(void **state)
{
    (void)state;
    check_dense((lac_grid){16, 16, 1, 1, true}, 1, false);
    check_dense((lac_grid){16, 12, 2, 0.7, true}, 2, false);
    check_dense((lac_grid){64, 1, 1, 1, true}, 3, false);
}

static void free_grids_agree_with_dense_matrices(void **state)
{
    (void)state;
    check_dense((lac_grid){16, 16, 1, 1, false}, 1, false);
    check_dense((lac_grid){16, 12, 2, 0.7, false}, 2, false);
    check_dense((lac_grid){15, 20, 1, 1, false}, 3, false);
    check_dense((lac_grid){64, 1, 1, 3, false}, 4, false); // a strip
    check_dense((lac_grid){1, 40, 2, 1, false}, 5, false);
    check_dense((lac_grid){96, 1, 0.5, 1, false}, 6, true);
}

// The dense reference itself: cells under a smooth traction add up to what plane waves give.
static void free_cells_add_up_to_plane_waves(void **state)
{
    (void)state;
    const double s = 3, g = 2;
    for (int k = 0; k < 12; k++) {
        double nu = k < 4 ? 0 : k < 8 ? 0.25 : 0.45;
        int ax = k % 4 == 1 ? 4 : k % 4 == 2 ? 0 : k % 4 * 2;
        int ay = k % 4 == 1 ? 0 : k % 4 == 2 ? 5 : k % 4;
        double sum = 0;
        for (int i = -18; i <= 18; i++) {
            for (int j = -18; j <= 18; j++) {
                double traction = exp(-0.5 * (i * i + j * j) / (s * s));
                sum += traction * free_slip(g, nu, 1, 1, ax - i, ay - j);
            }
        }
        double exact = gaussian_slip(g, nu, s, hypot(ax, ay), atan2(ay, ax));
        assert_true(fabs(sum / exact - 1) < 0.006); // cells of s/3: (1/s)^2/24
    }
}

// trace(P_l K) block by block, from the tractions under a unit slip of each.
static double block_trace(lac_compliance *c, const lac_hierarchy *h, size_t level)
{
    const uint32_t *first = lac_hierarchy_offsets(h, level);
    size_t n = lac_hierarchy_cells(h);
    double *slip = new_doubles(n), *traction = new_doubles(n), trace = 0;
    for (size_t b = 0; b < lac_hierarchy_blocks(h, level); b++) {
        double energy;
        for (size_t i = 0; i < n; i++) {
            slip[i] = i >= first[b] && i < first[b + 1] ? 1 : 0;
        }
        assert_int_equal(lac_compliance_invert(c, slip, 1e-5, traction, &energy, NULL), LAC_OK);
        trace += energy / (double)(first[b + 1] - first[b]);
    }
    free(slip);
    free(traction);
    return trace;
}

// The levels of a large grid that tie few blocks, against those traces.
static void check_coarse(lac_grid grid, bool line, bool across)
{
    lac_domain *domain = random_mask(grid, 0.2, 1);
    lac_hierarchy *h = hierarchy_of(domain);
    size_t levels = lac_hierarchy_levels(h);
    lac_transfer_scene scene = {domain, h, 2, 0.25, line, false, NULL};
    lac_rock rock = {
        .shear_modulus = 2, .poisson = 0.25, .thickness = INFINITY, .line = line, .across = across};
    lac_compliance *c = NULL;
    double k[33], finer = 0;
    assert_int_equal(lac_compliance_create(domain, &rock, &c, NULL), LAC_OK);
    assert_int_equal(lac_calibrate_elastic(&scene, across, 1, k, NULL), LAC_OK);
    for (size_t l = levels - 4; l <= levels; l++) {
        double trace = block_trace(c, h, l);
        if (l > levels - 4) {
            double exact = (finer - trace) / (double)lac_hierarchy_rank(h, l - 1);
            double off = k[l - 1] / exact - 1;
            print_message("%zu x %zu, level %zu: k %.5f exact %.5f, off by %+.2e\n", grid.nx,
                          grid.ny, l - 1, k[l - 1], exact, off);
            assert_true(fabs(off) < 0.02);
        }
        finer = trace;
    }
    lac_compliance_free(c);
    lac_hierarchy_free(h);
    lac_domain_free(domain);
}

static void coarse_levels_of_large_grids_agree_with_traces(void **state)
{
    (void)state;
    check_coarse((lac_grid){128, 128, 1, 1, true}, false, false);
    check_coarse((lac_grid){128, 128, 1, 2, true}, false, true);
    check_coarse((lac_grid){90, 100, 1, 1, false}, false, false);
    check_coarse((lac_grid){6000, 1, 1, 1, true}, true, false);
    check_coarse((lac_grid){8192, 2, 1, 1, true}, false, false);
}

// Figures of an earlier, independent prototype (antiplane, contact 0.2), mean of some masks.
static void random_masks_agree_with_an_earlier_prototype(void **state)
{
    (void)state;
    const double earlier[] = {1.27, 1.03, 0.85, 0.63, 0.46, 0.33};
    const int masks = 12;
    double mean[6] = {0};
    for (int i = 0; i < masks; i++) {
        lac_domain *domain = random_mask((lac_grid){64, 64, 1, 1, true}, 0.2, (uint64_t)i);
        double found[33];
        calibrate(domain, 1, 0, 1, found);
        for (size_t l = 0; l < 6; l++) {
            mean[l] += found[l] / masks;
        }
        lac_domain_free(domain);
    }
    for (size_t l = 0; l < 6; l++) {
        print_message("level %zu: k %.3f G/r, earlier %.2f\n", l, mean[l], earlier[l]);
        assert_true(fabs(mean[l] / earlier[l] - 1) < (l < 4 ? 0.03 : 0.08));
    }
}

static double worst_error(size_t side, size_t level, int seeds)
{
    lac_grid grid = {side, side, 1, 1, true};
    lac_domain *domain = random_mask(grid, 2, 1);
    lac_hierarchy *h = hierarchy_of(domain);
    double exact = (full_trace(&grid, 1, 0, level) - full_trace(&grid, 1, 0, level + 1)) /
                   (double)lac_hierarchy_rank(h, level);
    double worst = 0;
    for (int seed = 0; seed < seeds; seed++) {
        double found[33];
        calibrate(domain, 1, 0, (uint64_t)seed, found);
        worst = fmax(worst, fabs(found[level] / exact - 1));
    }
    print_message("%zu^2, level %zu: worst error %.1f %%\n", side, level, 100 * worst);
    lac_hierarchy_free(h);
    lac_domain_free(domain);
    return worst;
}

static void seeds_scatter_as_stated(void **state)
{
    (void)state;
    assert_true(worst_error(32, 1, 60) < 0.03);
    assert_true(worst_error(128, 0, 20) < 0.01);
    assert_true(worst_error(128, 2, 20) < 0.02);
    assert_true(worst_error(128, 5, 20) < 0.03);
}

static void stiffness_scales_with_modulus_and_size(void **state)
{
    (void)state;
    lac_domain *a = random_mask((lac_grid){32, 32, 1, 1, true}, 0.3, 4);
    lac_domain *b = random_mask((lac_grid){32, 32, 5, 5, true}, 0.3, 4);
    double ka[33], kb[33];
    calibrate(a, 1, 0.2, 1, ka);
    calibrate(b, 30e9, 0.2, 1, kb);
    for (size_t l = 0; l < 5; l++) {
        assert_true(fabs(kb[l] / ka[l] / 6e9 - 1) < 1e-9);
    }
    lac_domain_free(a);
    lac_domain_free(b);
}

// A small patch in a wide gap does not see its images: repeating or not, it is as stiff, but for
// what waves cut off at the cell differ from uniform tractions on cells.
static void isolated_patches_do_not_feel_the_boundary(void **state)
{
    (void)state;
    lac_grid grid = {64, 64, 1, 1, true};
    double *pressure = new_doubles(64 * 64);
    for (size_t i = 0; i < 64; i++) {
        pressure[(i / 8 + 24) * 64 + i % 8 + 24] = 1;
    }
    lac_domain *periodic = domain_on(grid, pressure);
    grid.periodic = false;
    lac_domain *alone = domain_on(grid, pressure);
    double a[33], b[33];
    calibrate(periodic, 1, 0.25, 1, a);
    calibrate(alone, 1, 0.25, 1, b);
    for (size_t l = 0; l < 3; l++) {
        print_message("level %zu: periodic %.4f, alone %.4f\n", l, a[l], b[l]);
        assert_true(fabs(a[l] / b[l] - 1) < 0.05);
    }
    assert_true(a[3] == 0 && b[5] == 0); // one block: nothing to tie
    lac_domain_free(periodic);
    lac_domain_free(alone);
    free(pressure);
}

static void one_cell_has_no_stiffness(void **state)
{
    (void)state;
    double pressure[16] = {0};
    pressure[9] = 1;
    lac_domain *domain = domain_on((lac_grid){4, 4, 1, 1, true}, pressure);
    double found[33];
    calibrate(domain, 1, 0.25, 1, found);
    assert_true(found[0] == 0 && found[1] == 0);
    lac_domain_free(domain);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(full_contact_has_a_closed_form),
        cmocka_unit_test(small_domains_agree_with_dense_matrices),
        cmocka_unit_test(free_grids_agree_with_dense_matrices),
        cmocka_unit_test(free_cells_add_up_to_plane_waves),
        cmocka_unit_test(coarse_levels_of_large_grids_agree_with_traces),
        cmocka_unit_test(random_masks_agree_with_an_earlier_prototype),
        cmocka_unit_test(seeds_scatter_as_stated),
        cmocka_unit_test(stiffness_scales_with_modulus_and_size),
        cmocka_unit_test(isolated_patches_do_not_feel_the_boundary),
        cmocka_unit_test(one_cell_has_no_stiffness),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
