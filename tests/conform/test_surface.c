// SPDX-License-Identifier: GPL-3.0-or-later
// What every synthesised surface source must do; run on each one registered.
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <omp.h>

#include "base/fft.h"
#include "support/test.h"
#include "surface/surface.h"

static const double size = 64.0; // of the interface [m]

// What the tests ask of a source, by the keys of its table.
typedef struct request {
    double hurst, rms_height, rolloff, shortest;
    int64_t seed;
} request;

static const request usual = {0.7, 0.3, 16.0, 2.0, 5};

static const lac_param *find(const lac_model_info *info, const char *key)
{
    for (size_t i = 0; i < info->param_count; i++) {
        if (strcmp(info->params[i].key, key) == 0) {
            return &info->params[i];
        }
    }
    return NULL;
}

// A source of another kind is asked for its defaults where it knows no such key.
static void put(lac_model *model, const char *key, double value)
{
    const lac_param *param = find(model->info, key);
    if (param == NULL) {
        assert_null(find(model->info, "shortest"));
        return;
    }
    char *at = (char *)model->params + param->offset;
    if (param->type == LAC_INTEGER) {
        memcpy(at, &(int64_t){(int64_t)value}, sizeof(int64_t));
    } else {
        memcpy(at, &value, sizeof value);
    }
}

static lac_status ask(const lac_surface_source *source, request r, const lac_grid *grid, double *h,
                      lac_error *err)
{
    lac_model model = {0};
    assert_int_equal(lac_model_create(&source->info, &model, err), LAC_OK);
    put(&model, "hurst", r.hurst);
    put(&model, "rms_height", r.rms_height);
    put(&model, "rolloff", r.rolloff);
    put(&model, "shortest", r.shortest);
    put(&model, "seed", (double)r.seed);
    lac_status status = lac_surface_generate(&model, grid, h, NULL, err);
    lac_model_clear(&model);
    return status;
}

static double *heights(const lac_surface_source *source, request r, const lac_grid *grid)
{
    lac_error err = {""};
    double *h = malloc(lac_grid_cells(grid) * sizeof *h);
    assert_non_null(h);
    if (ask(source, r, grid, h, &err) != LAC_OK) {
        fail_msg("%s: %s", source->info.name, err.message);
    }
    return h;
}

static lac_grid square(size_t n)
{
    return (lac_grid){n, n, size / (double)n, size / (double)n, true};
}

static lac_grid line(size_t n) { return (lac_grid){n, 1, size / (double)n, 1.0, true}; }

// The index-th source that has a parameter of this name, NULL past the end.
static const lac_surface_source *with(const char *key, size_t index)
{
    for (size_t i = 0; lac_surface_source_get(i) != NULL; i++) {
        const lac_surface_source *source = lac_surface_source_get(i);
        if (find(&source->info, key) != NULL && index-- == 0) {
            return source;
        }
    }
    return NULL;
}

#define EACH_WITH(key, source)                       \
    const lac_surface_source *source = with(key, 0); \
    for (size_t each = 0; (source = with(key, each)) != NULL; each++)

// Synthesised from a band of wavelengths stated in metres, the same on any grid.
#define EACH_SOURCE(source) EACH_WITH("shortest", source)

static void at_least_one_is_registered(void **state)
{
    (void)state;
    assert_non_null(with("seed", 0));
    assert_non_null(with("shortest", 0));
    for (size_t i = 0; lac_surface_source_get(i) != NULL; i++) {
        const lac_model_info *info = &lac_surface_source_get(i)->info;
        assert_true(strlen(info->name) > 0 && strlen(info->summary) > 0);
        assert_non_null(info->reference);
    }
}

static void same_seed_same_bytes(void **state)
{
    (void)state;
    const int threads = omp_get_max_threads();
    EACH_WITH("seed", source)
    {
        lac_grid grid = square(256);
        omp_set_num_threads(1);
        double *one = heights(source, usual, &grid);
        for (int n = 2; n < 2 + (int)test_some(4); n++) {
            omp_set_num_threads(n);
            double *many = heights(source, usual, &grid);
            assert_memory_equal(one, many, 256 * 256 * sizeof *one);
            free(many);
        }
        request other = usual;
        other.seed = 6;
        double *different = heights(source, other, &grid);
        assert_memory_not_equal(one, different, 256 * 256 * sizeof *one);
        free(different);
        free(one);
    }
    omp_set_num_threads(threads);
}

// A coarse grid holds the heights of the fine one at the nodes they share.
static void agrees(const lac_surface_source *source, const lac_grid *coarse, const lac_grid *fine)
{
    double *c = heights(source, usual, coarse);
    double *f = heights(source, usual, fine);
    size_t mx = fine->nx / coarse->nx;
    size_t my = fine->ny / coarse->ny;
    for (size_t j = 0; j < coarse->ny; j++) {
        for (size_t i = 0; i < coarse->nx; i++) {
            double there = f[j * my * fine->nx + i * mx];
            assert_true(fabs(c[j * coarse->nx + i] - there) < 1e-12 * usual.rms_height);
        }
    }
    free(c);
    free(f);
}

static void same_interface_at_every_resolution(void **state)
{
    (void)state;
    const size_t sides[][2] = {{128, 256}, {128, 512}, {96, 288}, {65, 195}, {75, 300}};
    EACH_SOURCE(source)
    {
        for (size_t k = 0; k < test_some(5); k++) {
            lac_grid coarse = square(sides[k][0]);
            lac_grid fine = square(sides[k][1]);
            agrees(source, &coarse, &fine);
            coarse = line(sides[k][0]);
            fine = line(sides[k][1]);
            agrees(source, &coarse, &fine);
            coarse = (lac_grid){sides[k][0], 72, size / (double)sides[k][0], 0.5, true};
            fine = (lac_grid){sides[k][1], 144, size / (double)sides[k][1], 0.25, true};
            agrees(source, &coarse, &fine);
        }
    }
}

static lac_fft *spectrum(const double *h, const lac_grid *grid)
{
    lac_fft *fft = NULL;
    assert_int_equal(lac_fft_create(grid->nx, grid->ny, &fft, NULL), LAC_OK);
    memcpy(fft->real, h, lac_grid_cells(grid) * sizeof *h);
    lac_fft_forward(fft);
    for (size_t k = 0; k < fft->nkx * fft->ny; k++) {
        fft->spectrum[k] /= (double)lac_grid_cells(grid);
    }
    return fft;
}

// A grid too coarse for the band keeps the modes below its Nyquist wavenumber, as they are.
static void coarse_grid_leaves_out_short_waves(void **state)
{
    (void)state;
    EACH_SOURCE(source)
    {
        lac_grid grids[] = {square(16), square(128)};
        double *h[] = {heights(source, usual, &grids[0]), heights(source, usual, &grids[1])};
        lac_fft *coarse = spectrum(h[0], &grids[0]);
        lac_fft *fine = spectrum(h[1], &grids[1]);
        for (size_t j = 0; j < 16; j++) {
            size_t row = j < 8 ? j : j + 112;
            for (size_t i = 0; i < 9; i++) {
                double _Complex expected = fine->spectrum[row * fine->nkx + i];
                if (i == 8 || j == 8) {
                    expected = 0.0;
                }
                assert_true(cabs(coarse->spectrum[j * coarse->nkx + i] - expected) < 1e-14);
            }
        }
        lac_fft_free(coarse);
        lac_fft_free(fine);
        free(h[0]);
        free(h[1]);
    }
}

static double mean_power(const double *h, size_t n, int power)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += power == 1 ? h[i] : h[i] * h[i];
    }
    return sum / (double)n;
}

// Independent faces whose variances add up
static double faces(const lac_surface_source *source)
{
    return find(&source->info, "mating") == NULL ? 1.0 : 2.0;
}

// Mean over seeds of h^2 is rms_height^2 within four standard errors, and these are small.
static void rms_is_stated(const lac_surface_source *source, const lac_grid *grid, double bound)
{
    enum { SEEDS = 200 };
    double sum = 0.0;
    double sum2 = 0.0;
    for (int64_t seed = 1; seed <= SEEDS; seed++) {
        request r = usual;
        r.seed = seed;
        double *h = heights(source, r, grid);
        size_t n = lac_grid_cells(grid);
        assert_true(fabs(mean_power(h, n, 1)) < 1e-13);
        double ratio = mean_power(h, n, 2) / (faces(source) * r.rms_height * r.rms_height);
        sum += ratio;
        sum2 += ratio * ratio;
        free(h);
    }
    double mean = sum / SEEDS;
    double error = sqrt((sum2 / SEEDS - mean * mean) / SEEDS);
    print_message("%s %zu x %zu: variance / stated %.4f +- %.4f\n", source->info.name, grid->nx,
                  grid->ny, mean, error);
    assert_true(error < bound);
    assert_true(fabs(mean - 1.0) < 4.0 * error);
}

static void mean_is_zero_and_rms_as_stated(void **state)
{
    (void)state;
    EACH_SOURCE(source)
    {
        lac_grid grids[] = {line(256), square(128), square(90), {100, 64, 0.64, 0.5, true}};
        for (size_t k = 0; k < test_some(4); k++) {
            rms_is_stated(source, &grids[k], grids[k].ny == 1 ? 0.05 : 0.02);
        }
    }
}

// Adds |h_k|^2 to the octaves of q: shell s holds 2^s <= |k| < 2^(s+1) in half steps.
enum { SHELLS = 12 };
typedef struct shells {
    double power[SHELLS], modes[SHELLS], log_k[SHELLS];
} shells;

static void add_shells(const lac_fft *fft, shells *sh)
{
    for (size_t j = 0; j < fft->ny; j++) {
        double ky = lac_fft_frequency(j, fft->ny);
        for (size_t i = 1; i < fft->nkx; i++) {
            double k = hypot((double)i, ky);
            int s = (int)floor(2.0 * log2(k));
            double a = cabs(fft->spectrum[j * fft->nkx + i]);
            if (s < SHELLS) {
                sh->power[s] += a * a;
                sh->modes[s] += 1.0;
                sh->log_k[s] += log(k);
            }
        }
    }
}

// Power density over seeds: level below the rolloff and slope beyond it.
static void spectrum_is(const lac_surface_source *source, const lac_grid *grid, double slope,
                        double tolerance)
{
    shells sh = {{0}, {0}, {0}};
    const size_t seeds = test_some(40); // of a tenth of them the spread is larger
    tolerance *= sqrt(40.0 / (double)seeds);
    for (int64_t seed = 1; seed <= (int64_t)seeds; seed++) {
        request r = {0.7, 1.0, size / 8.0, size / 64.0, seed};
        double *h = heights(source, r, grid);
        lac_fft *fft = spectrum(h, grid);
        add_shells(fft, &sh);
        lac_fft_free(fft);
        free(h);
    }
    double x[SHELLS];
    double y[SHELLS];
    for (size_t s = 0; s < SHELLS; s++) {
        x[s] = sh.log_k[s] / sh.modes[s];
        y[s] = log(sh.power[s] / sh.modes[s]);
    }
    // Beyond the rolloff |k| = 8 (shell 6) to the shortest wave |k| = 64 (shell 11)
    double measured = (y[11] - y[6]) / (x[11] - x[6]);
    double plateau = (y[5] - y[2]) / (x[5] - x[2]);
    print_message("%s %zu x %zu: slope %.3f (%.3f), plateau %.3f (0)\n", source->info.name,
                  grid->nx, grid->ny, measured, slope, plateau);
    assert_true(fabs(measured - slope) < tolerance);
    assert_true(fabs(plateau) < 4.0 * tolerance);
}

static void spectrum_is_as_stated(void **state)
{
    (void)state;
    EACH_SOURCE(source)
    {
        lac_grid plane = square(160);
        lac_grid stripe = line(160);
        spectrum_is(source, &plane, -2.0 * 1.7, 0.06);
        spectrum_is(source, &stripe, -2.4, 0.2);
    }
}

static void nothing_is_shorter_than_the_shortest_wave(void **state)
{
    (void)state;
    EACH_SOURCE(source)
    {
        lac_grid grid = square(128);
        double *h = heights(source, usual, &grid);
        lac_fft *fft = spectrum(h, &grid);
        size_t inside = 0;
        for (size_t j = 0; j < fft->ny; j++) {
            for (size_t i = 0; i < fft->nkx; i++) {
                double k = hypot((double)i, lac_fft_frequency(j, fft->ny));
                double a = cabs(fft->spectrum[j * fft->nkx + i]);
                assert_true(k <= 32.0 || a < 1e-15);
                inside += k <= 32.0 && a > 1e-15 ? 1 : 0;
            }
        }
        assert_true(inside > 1500); // half of the disk of 3217 modes
        lac_fft_free(fft);
        free(h);
    }
}

// Sum of |k|^-2(H+1) over the modes 0 < |k| <= most of a plane
static double plane_sum(double hurst, double most)
{
    double sum = 0.0;
    for (double ky = 0.0; ky <= most; ky += 1.0) {
        for (double kx = 1.0; kx * kx + ky * ky <= most * most; kx += 1.0) {
            sum += 4.0 * pow(kx * kx + ky * ky, -(hurst + 1.0)); // four quadrants, turned
        }
    }
    return sum;
}

// Sum of |k|^-(2H+1) over the modes 0 < |k| <= most of a line
static double line_sum(double hurst, double most)
{
    double sum = 0.0;
    for (double k = 1.0; k <= most; k += 1.0) {
        sum += 2.0 * pow(k, -(2.0 * hurst + 1.0));
    }
    return sum;
}

// Variance on a grid of a band of `near` modes over that of one of `far` modes, both full of
// waves that the grid leaves out, so that only the normalisation differs.
static double variance_ratio(const lac_surface_source *source, const lac_grid *grid, double near,
                             double far)
{
    size_t n = lac_grid_cells(grid);
    double *a = heights(source, (request){0.05, 1.0, NAN, size / near, 1}, grid);
    double *b = heights(source, (request){0.05, 1.0, NAN, size / far, 1}, grid);
    double ratio = mean_power(a, n, 2) / mean_power(b, n, 2);
    free(a);
    free(b);
    return ratio;
}

// A band far beyond the grid: the variance is that of all its modes, here counted one by one.
static void short_waves_far_below_the_grid_count(void **state)
{
    (void)state;
    if (test_few()) {
        skip();
    }
    EACH_SOURCE(source)
    {
        lac_grid plane = square(64);
        double expected = plane_sum(0.05, 2000.0) / plane_sum(0.05, 100.0);
        double ratio = variance_ratio(source, &plane, 100.0, 2000.0);
        assert_true(fabs(ratio / expected - 1.0) < 2e-5);
        lac_grid stripe = line(64);
        expected = line_sum(0.05, 4e6) / line_sum(0.05, 100.0);
        ratio = variance_ratio(source, &stripe, 100.0, 4e6);
        assert_true(fabs(ratio / expected - 1.0) < 1e-8);
    }
}

static void refuse(const lac_surface_source *source, request r, lac_grid grid, const char *word)
{
    lac_error err = {""};
    double h[64 * 64];
    assert_int_equal(ask(source, r, &grid, h, &err), LAC_EINPUT);
    if (strstr(err.message, word) == NULL) {
        fail_msg("\"%s\" does not speak of \"%s\"", err.message, word);
    }
}

static void wrong_parameters_are_refused(void **state)
{
    (void)state;
    EACH_SOURCE(source)
    {
        lac_grid grid = square(64);
        refuse(source, (request){0.7, 1.0, 2.0, 16.0, 1}, grid, "rolloff");
        refuse(source, (request){0.7, 1.0, 0.5, NAN, 1}, grid, "two cells");
        refuse(source, (request){0.7, 1.0, 200.0, 100.0, 1}, grid, "shortest");
    }
}

static void smallest_grids(void **state)
{
    (void)state;
    EACH_SOURCE(source)
    {
        request r = {0.8, 1.0, NAN, NAN, 1};
        const lac_grid grids[] = {{1, 1, 1.0, 1.0, true}, {2, 2, 1.0, 1.0, true},
                                  {3, 1, 1.0, 1.0, true}, {1, 5, 1.0, 1.0, true},
                                  {4, 3, 1.0, 9.0, true}, {1000, 2, 1.0, 1.0, true}};
        for (size_t k = 0; k < 6; k++) {
            double *h = heights(source, r, &grids[k]);
            for (size_t i = 0; i < lac_grid_cells(&grids[k]); i++) {
                assert_true(isfinite(h[i]));
            }
            assert_true(grids[k].nx != 1 || grids[k].ny != 1 || h[0] == 0.0);
            free(h);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(at_least_one_is_registered),
        cmocka_unit_test(same_seed_same_bytes),
        cmocka_unit_test(same_interface_at_every_resolution),
        cmocka_unit_test(coarse_grid_leaves_out_short_waves),
        cmocka_unit_test(mean_is_zero_and_rms_as_stated),
        cmocka_unit_test(spectrum_is_as_stated),
        cmocka_unit_test(nothing_is_shorter_than_the_shortest_wave),
        cmocka_unit_test(short_waves_far_below_the_grid_count),
        cmocka_unit_test(wrong_parameters_are_refused),
        cmocka_unit_test(smallest_grids),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
