// SPDX-License-Identifier: GPL-3.0-or-later
// Synthesised surfaces on grids that do not resolve them, and on free boundaries: point samples,
// and block means against finer grids of the same surface.
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <omp.h>

#include "support/height_files.h"
#include "support/test.h"
#include "surface/surface.h"

enum { LOW_PASS, POINT, BLOCK_MEAN, MOST = 96 * 80 };

static const double rms = 0.3;

// A face of a 24 x 20 m interface whose shortest wave is 1.6 m.
static lac_self_affine face(int sampling)
{
    return (lac_self_affine){.hurst = 0.7,
                             .rms_height = rms,
                             .rms_slope = NAN,
                             .rolloff = 9.0,
                             .shortest = 1.6,
                             .seed = 5,
                             .anisotropy = 1.0,
                             .sampling = sampling};
}

static lac_joint joint(int sampling)
{
    return (lac_joint){.hurst = 0.7,
                       .rms_height = rms,
                       .rolloff = 9.0,
                       .shortest = 1.6,
                       .seed = 5,
                       .mating = 4.0,
                       .offset = 0.37,
                       .sampling = sampling};
}

static lac_grid grid_of(size_t nx, size_t ny)
{
    return (lac_grid){nx, ny, 24.0 / (double)nx, ny > 1 ? 20.0 / (double)ny : 1.0, true};
}

static void make(const char *name, void *params, lac_grid grid, double *h)
{
    lac_error err = {""};
    lac_model model = {&surface_source(name)->info, params};
    if (lac_surface_generate(&model, &grid, h, NULL, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
}

// Heights at shared nodes differ by one constant: each grid takes off its own mean.
static void shares_nodes(const double *coarse, lac_grid c, const double *fine, lac_grid f)
{
    double apart = coarse[0] - fine[0];
    for (size_t i = 0; i < lac_grid_cells(&c); i++) {
        size_t at = i / c.nx * (f.ny / c.ny) * f.nx + i % c.nx * (f.nx / c.nx);
        assert_true(fabs(coarse[i] - fine[at] - apart) < 1e-12 * rms);
    }
}

// The mean of the fine cells in each coarse one.
static void is_block_mean(const double *coarse, lac_grid c, const double *fine, lac_grid f)
{
    size_t mx = f.nx / c.nx;
    size_t my = f.ny / c.ny;
    for (size_t i = 0; i < lac_grid_cells(&c); i++) {
        double sum = 0.0;
        for (size_t k = 0; k < mx * my; k++) {
            sum += fine[(i / c.nx * my + k / mx) * f.nx + i % c.nx * mx + k % mx];
        }
        assert_true(fabs(coarse[i] - sum / (double)(mx * my)) < 1e-12 * rms);
    }
}

static const size_t sizes[][2] = {{24, 20}, {12, 40}, {8, 5}, {1, 1}};

static void point_samples_are_heights_at_nodes(void **state)
{
    (void)state;
    static double fine[MOST];
    static double coarse[MOST];
    const lac_grid f = grid_of(96, 80);
    for (int k = 0; k < 3; k++) {
        lac_self_affine p = face(LOW_PASS);
        lac_joint q = joint(LOW_PASS);
        p.anisotropy = k == 1 ? 1.5 : 1.0;
        p.direction = 0.6;
        p.skewness = k == 1 ? 0.8 : 0.0;
        make(k == 2 ? "joint" : "self-affine", k == 2 ? (void *)&q : (void *)&p, f, fine);
        p.sampling = POINT;
        q.sampling = POINT;
        for (size_t s = 0; s < 3; s++) {
            lac_grid c = grid_of(sizes[s][0], sizes[s][1]);
            make(k == 2 ? "joint" : "self-affine", k == 2 ? (void *)&q : (void *)&p, c, coarse);
            shares_nodes(coarse, c, fine, f);
        }
    }
}

static void block_means_nest(void **state)
{
    (void)state;
    static double fine[MOST];
    static double coarse[MOST];
    for (int k = 0; k < 2; k++) {
        lac_self_affine p = face(BLOCK_MEAN);
        lac_joint q = joint(BLOCK_MEAN);
        void *params = k == 0 ? (void *)&p : (void *)&q;
        const char *name = k == 0 ? "self-affine" : "joint";
        const lac_grid f = grid_of(48, 40);
        make(name, params, f, fine);
        for (size_t s = 0; s < 3; s++) {
            lac_grid c = grid_of(sizes[s][0], sizes[s][1]);
            make(name, params, c, coarse);
            is_block_mean(coarse, c, fine, f);
        }
    }
}

// Against the mean of heights at points by Simpson's rule, 12 x 16 a cell.
static void block_means_are_means(void **state)
{
    (void)state;
    static double fine[MOST];
    double mean[8 * 5];
    const lac_grid f = grid_of(96, 80);
    const lac_grid c = grid_of(8, 5);
    lac_self_affine p = face(LOW_PASS);
    make("self-affine", &p, f, fine);
    p.sampling = BLOCK_MEAN;
    make("self-affine", &p, c, mean);
    double off = 0.0;
    double size = 0.0;
    for (size_t i = 0; i < 40; i++) {
        double sum = 0.0;
        for (size_t k = 0; k < 13 * 17; k++) {
            size_t x = k % 13;
            size_t y = k / 13;
            double weight_x = x % 12 == 0 ? 1.0 : (x % 2 == 1 ? 4.0 : 2.0);
            double weight_y = y % 16 == 0 ? 1.0 : (y % 2 == 1 ? 4.0 : 2.0);
            sum += weight_x * weight_y * fine[(i / 8 * 16 + y) % 80 * 96 + (i % 8 * 12 + x) % 96];
        }
        off += pow(mean[i] - sum / (9.0 * 192.0), 2.0);
        size += mean[i] * mean[i];
    }
    assert_true(off < 1e-8 * size);
}

// On a line, and where the grid resolves the band, point samples are what they are without.
static void lines_and_fine_grids(void **state)
{
    (void)state;
    static double fine[MOST];
    static double coarse[MOST];
    lac_self_affine p = face(LOW_PASS);
    make("self-affine", &p, grid_of(96, 1), fine);
    p.sampling = POINT;
    make("self-affine", &p, grid_of(12, 1), coarse);
    shares_nodes(coarse, grid_of(12, 1), fine, grid_of(96, 1));
    p.sampling = LOW_PASS;
    make("self-affine", &p, grid_of(48, 40), fine);
    p.sampling = POINT;
    make("self-affine", &p, grid_of(48, 40), coarse);
    shares_nodes(coarse, grid_of(48, 40), fine, grid_of(48, 40));
}

static void same_bytes_for_any_threads(void **state)
{
    (void)state;
    static double one[MOST];
    static double several[MOST];
    int threads = omp_get_max_threads();
    for (int sampling = POINT; sampling <= BLOCK_MEAN; sampling++) {
        lac_self_affine p = face(sampling);
        omp_set_num_threads(1);
        make("self-affine", &p, grid_of(24, 20), one);
        omp_set_num_threads(3);
        make("self-affine", &p, grid_of(24, 20), several);
        assert_memory_equal(one, several, 24 * 20 * sizeof *one);
    }
    omp_set_num_threads(threads);
}

static void refuse(const char *name, void *params, lac_grid grid, const char *word)
{
    static double h[MOST];
    lac_error err = {""};
    lac_model model = {&surface_source(name)->info, params};
    assert_int_equal(lac_surface_generate(&model, &grid, h, NULL, &err), LAC_EINPUT);
    if (strstr(err.message, word) == NULL) {
        fail_msg("\"%s\" does not speak of \"%s\"", err.message, word);
    }
}

static void what_cannot_be_sampled(void **state)
{
    (void)state;
    lac_self_affine p = face(POINT);
    p.shortest = NAN;
    refuse("self-affine", &p, grid_of(24, 20), "sampling needs shortest");
    p.shortest = 1e-5;
    refuse("self-affine", &p, grid_of(24, 20), "at most 1e+09");
    p = face(BLOCK_MEAN);
    p.skewness = 0.5;
    refuse("self-affine", &p, grid_of(24, 20), "must not be block-mean");
    lac_joint q = joint(POINT);
    q.shortest = NAN;
    refuse("joint", &q, grid_of(24, 20), "sampling needs shortest");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(point_samples_are_heights_at_nodes),
        cmocka_unit_test(block_means_nest),
        cmocka_unit_test(block_means_are_means),
        cmocka_unit_test(lines_and_fine_grids),
        cmocka_unit_test(same_bytes_for_any_threads),
        cmocka_unit_test(what_cannot_be_sampled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
