// SPDX-License-Identifier: GPL-3.0-or-later
// Spectrum of the gap between two faces, against that of one face.
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "base/fft.h"
#include "support/test.h"
#include "surface/surface.h"

enum { N = 128 };
static const lac_grid grid = {N, N, 0.5, 0.5, true};
static const double two_pi = 6.283185307179586476925286766559;
static const double side = 64.0;

static const lac_model_info *info(const char *name)
{
    size_t i = 0;
    while (strcmp(lac_surface_source_get(i)->info.name, name) != 0) {
        i++;
    }
    return &lac_surface_source_get(i)->info;
}

// Modes of a surface; the caller frees.
static lac_fft *modes(const char *source, void *params)
{
    lac_error err = {""};
    lac_fft *fft = NULL;
    assert_int_equal(lac_fft_create(N, N, &fft, &err), LAC_OK);
    lac_model model = {info(source), params};
    if (lac_surface_generate(&model, &grid, fft->real, NULL, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    lac_fft_forward(fft);
    for (size_t k = 0; k < fft->nkx * N; k++) {
        fft->spectrum[k] /= (double)N * N;
    }
    return fft;
}

static lac_joint joint(int64_t seed, double mating, double offset)
{
    return (lac_joint){0.7, 0.3, 16.0, 2.0, seed, mating, offset, 0};
}

static lac_fft *one_face(int64_t seed)
{
    lac_self_affine face = {.hurst = 0.7,
                            .rms_height = 0.3,
                            .rms_slope = NAN,
                            .rolloff = 16.0,
                            .shortest = 2.0,
                            .seed = seed,
                            .anisotropy = 1.0};
    return modes("self-affine", &face);
}

// Mated waves: a (1 - exp(-i qx d)), of power 4 sin^2(qx d / 2) |a|^2, mode by mode.
static void mated_waves_are_left_by_the_offset_alone(void **state)
{
    (void)state;
    const double offsets[] = {0.0, 0.7, 3.0, -2.2};
    lac_fft *face = one_face(5);
    for (size_t o = 0; o < 4; o++) {
        lac_joint params = joint(5, 4.0, offsets[o]);
        lac_fft *gap = modes("joint", &params);
        for (size_t j = 0; j < N; j++) {
            for (size_t i = 0; i < gap->nkx; i++) {
                double k = hypot((double)i, lac_fft_frequency(j, N));
                if (k > 16.0) {
                    continue; // shorter than 4 m
                }
                double qd = two_pi * (double)i / side * offsets[o];
                double _Complex a = face->spectrum[j * face->nkx + i];
                double _Complex expected = a * (1.0 - (cos(qd) - sin(qd) * I));
                double _Complex found = gap->spectrum[j * gap->nkx + i];
                assert_true(cabs(found - expected) < 1e-14);
                assert_true(fabs(cabs(found) - 2.0 * fabs(sin(0.5 * qd)) * cabs(a)) < 1e-14);
            }
        }
        lac_fft_free(gap);
    }
    lac_fft_free(face);
}

// Waves that do not mate: the spectrum is twice that of a face, whatever the offset, and the gap
// correlates with the upper face as much as that with itself.
static void other_waves_are_independent(void **state)
{
    (void)state;
    enum { SEEDS = 30 };
    const double offsets[] = {0.0, 3.0};
    for (size_t o = 0; o < 2; o++) {
        double upper = 0.0;
        double both = 0.0;
        double common = 0.0;
        for (int64_t seed = 1; seed <= SEEDS; seed++) {
            lac_joint params = joint(seed, 4.0, offsets[o]);
            lac_fft *gap = modes("joint", &params);
            lac_fft *face = one_face(seed);
            for (size_t m = 0; m < gap->nkx * N; m++) {
                double k = hypot((double)(m % gap->nkx), lac_fft_frequency(m / gap->nkx, N));
                if (k > 16.0 && k <= 32.0) { // whitened, so that every mode counts the same
                    double weight = pow(k, 3.4);
                    double _Complex a = face->spectrum[m];
                    upper += weight * creal(a * conj(a));
                    common += weight * creal(gap->spectrum[m] * conj(a));
                    both += weight * creal(gap->spectrum[m] * conj(gap->spectrum[m]));
                }
            }
            lac_fft_free(gap);
            lac_fft_free(face);
        }
        print_message("offset %g: gap / face %.4f (2), common / face %.4f (1)\n", offsets[o],
                      both / upper, common / upper);
        assert_true(fabs(both / upper - 2.0) < 0.04);
        assert_true(fabs(common / upper - 1.0) < 0.02);
    }
}

static void unrelated_faces_have_nothing_in_common(void **state)
{
    (void)state;
    lac_joint params = joint(5, NAN, 0.0);
    lac_fft *gap = modes("joint", &params);
    for (size_t i = 1; i <= 4; i++) {
        assert_true(cabs(gap->spectrum[i]) > 1e-6); // a mated wave would leave nothing
    }
    lac_fft_free(gap);
}

static void faces_that_fit_exactly_are_refused(void **state)
{
    (void)state;
    static double h[N * N];
    lac_error err = {""};
    lac_joint params = joint(5, 2.0, 0.0);
    lac_model model = {info("joint"), &params};
    assert_int_equal(lac_surface_generate(&model, &grid, h, NULL, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "fit exactly"));
    params.offset = 0.5;
    assert_int_equal(lac_surface_generate(&model, &grid, h, NULL, &err), LAC_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mated_waves_are_left_by_the_offset_alone),
        cmocka_unit_test(other_waves_are_independent),
        cmocka_unit_test(unrelated_faces_have_nothing_in_common),
        cmocka_unit_test(faces_that_fit_exactly_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
