// SPDX-License-Identifier: GPL-3.0-or-later

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/rng.h"
#include "base/vmath.h"
#include "support/test.h"
#include "support/vmath_copies.h"

enum { SAMPLES = 1 << 16 };

typedef struct function {
    const char *name;
    test_vfunction *vector;
    long double (*exact)(long double);
} function;

static const function exponential = {"exp", lac_vexp, expl};
static const function logarithm = {"log", lac_vlog, logl};
static const function arsinh = {"asinh", lac_vasinh, asinhl};

static double uniform(size_t i) { return lac_random_uniform(7, LAC_STREAM_TEST, i, 0); }

// Error of y in units of the last place of the exact value.
static double ulps(double y, long double exact)
{
    int exponent;
    (void)frexpl(exact, &exponent);
    exponent = exponent < DBL_MIN_EXP ? DBL_MIN_EXP : exponent;
    return (double)fabsl(ldexpl(y - exact, DBL_MANT_DIG - exponent));
}

// Worst error on x = transform(low ... high), the ends included.
static void assert_accurate(const function *f, double low, double high, double (*transform)(double))
{
    static double x[SAMPLES], y[SAMPLES];
    for (size_t i = 0; i < SAMPLES; i++) {
        double at = i == 0 ? 0 : i == 1 ? 1 : uniform(i);
        x[i] = transform(low + (high - low) * at);
    }
    f->vector(SAMPLES, x, y);
    double worst = 0, where = 0;
    for (size_t i = 0; i < SAMPLES; i++) {
        double error = ulps(y[i], f->exact(x[i]));
        if (!(error <= worst)) { // NaN too
            worst = error;
            where = x[i];
        }
    }
    printf("%-5s on [%.6g, %.6g]: %.3f ulp at %a\n", f->name, transform(low), transform(high),
           worst, where);
    assert_true(worst <= 1.5);
}

static double itself(double x) { return x; }
static double past_one(double x) { return 1 + x; }
static double power_of_ten(double x) { return pow(10, x); }
static double subnormal(double x) { return x * 0x1p-1022; }

// Valgrind computes long double in double.
static bool long_double_is_longer(void)
{
    volatile long double one = 1;
    return one + 0x1p-60L != one;
}

static void errors_are_below_1_5_ulp(void **state)
{
    (void)state;
    if (!long_double_is_longer()) {
        skip(); // no better reference here
    }
    assert_accurate(&exponential, -708, 709.78, itself);
    assert_accurate(&exponential, -745.1, -708, itself);
    assert_accurate(&exponential, -1, 1, itself);
    assert_accurate(&exponential, -20, -1, power_of_ten);
    assert_accurate(&logarithm, -307.6, 308.25, power_of_ten);
    assert_accurate(&logarithm, 0.5, 2, itself);
    assert_accurate(&logarithm, -1e-5, 1e-5, past_one);
    assert_accurate(&logarithm, 0x1p-52, 1, subnormal);
    assert_accurate(&arsinh, -307.6, 308.25, power_of_ten);
    assert_accurate(&arsinh, -3, 3, itself);
    assert_accurate(&arsinh, -20, 1, power_of_ten);
    assert_accurate(&arsinh, 0x1p-52, 1, subnormal);
}

// One point: x in, y out, compared bit for bit except that NaN is NaN.
static void assert_gives(const function *f, double x, double expected)
{
    double y = 42;
    f->vector(1, &x, &y);
    if (isnan(expected) ? !isnan(y) : memcmp(&y, &expected, sizeof y) != 0) {
        fail_msg("%s(%a) = %a, not %a", f->name, x, y, expected);
    }
}

static void special_values_are_those_of_ieee(void **state)
{
    (void)state;
    assert_gives(&exponential, 0.0, 1);
    assert_gives(&exponential, -0.0, 1);
    assert_gives(&exponential, 5e-324, 1);
    assert_gives(&exponential, INFINITY, INFINITY);
    assert_gives(&exponential, -INFINITY, 0);
    assert_gives(&exponential, NAN, NAN);
    assert_gives(&exponential, 0x1.62e42fefa39fp+9, INFINITY); // just above ln DBL_MAX
    assert_gives(&exponential, DBL_MAX, INFINITY);
    assert_gives(&exponential, -745.0, 4.9406564584124654e-324);
    assert_gives(&exponential, -745.2, 0);
    assert_gives(&exponential, -DBL_MAX, 0);

    assert_gives(&logarithm, 1, 0);
    assert_gives(&logarithm, 0.0, -INFINITY);
    assert_gives(&logarithm, -0.0, -INFINITY);
    assert_gives(&logarithm, -5e-324, NAN);
    assert_gives(&logarithm, -1, NAN);
    assert_gives(&logarithm, -INFINITY, NAN);
    assert_gives(&logarithm, INFINITY, INFINITY);
    assert_gives(&logarithm, NAN, NAN);

    assert_gives(&arsinh, 0.0, 0.0);
    assert_gives(&arsinh, -0.0, -0.0);
    assert_gives(&arsinh, 5e-324, 5e-324);
    assert_gives(&arsinh, -5e-324, -5e-324);
    assert_gives(&arsinh, 1e-20, 1e-20);
    assert_gives(&arsinh, INFINITY, INFINITY);
    assert_gives(&arsinh, -INFINITY, -INFINITY);
    assert_gives(&arsinh, NAN, NAN);
}

// Arguments that reach every branch of every function, among random ones of every exponent.
static void awkward(double *x, size_t n)
{
    static const double corners[] = {
        0,      -0.0,    1,       -1,        0.5,       2,     INFINITY, -INFINITY, NAN,
        5e-324, -5e-324, DBL_MIN, 0x1p28,    0x1p29,    1e300, 0x1.6p-1, 709.9,     -745.1,
        -746.5, 1e-10,   0.41421, 0x1.6ap-1, 0x1.6bp-1, 710,   -708.5,   -20.25,    3.75};
    size_t corner_count = sizeof corners / sizeof corners[0];
    memcpy(x, corners, sizeof corners);
    for (size_t i = corner_count; i < n; i++) {
        uint64_t bits[4];
        lac_random(3, LAC_STREAM_TEST, i, 1, bits);
        memcpy(&x[i], &bits[0], sizeof x[i]);
        if (i % 2 == 0 || isnan(x[i])) {
            x[i] = 100 * uniform(i) - 50;
        }
    }
}

enum { AWKWARD = 512 };

static void assert_same_bits(const char *what, const double *x, const double *y, const double *z,
                             size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (isnan(y[i]) && isnan(z[i])) {
            continue;
        }
        if (memcmp(&y[i], &z[i], sizeof y[i]) != 0) {
            fail_msg("%s(%a): %a and %a", what, x[i], y[i], z[i]);
        }
    }
}

static void assert_length_does_not_matter(const function *f)
{
    double x[AWKWARD], single[AWKWARD], y[AWKWARD + 1];
    awkward(x, AWKWARD);
    for (size_t i = 0; i < AWKWARD; i++) {
        f->vector(1, &x[i], &single[i]);
    }
    for (size_t first = 0; first < 9; first++) {
        for (size_t n = 0; n + first <= AWKWARD; n += n < 40 ? 1 : 47) {
            y[first + n] = 42;
            f->vector(n, x + first, y + first);
            assert_same_bits(f->name, x + first, y + first, single + first, n);
            assert_true(y[first + n] == 42); // nothing is written past the end
        }
    }
    memcpy(y, x, sizeof x);
    f->vector(AWKWARD, y, y);
    assert_same_bits(f->name, x, y, single, AWKWARD);
}

static void result_is_the_same_for_every_length_and_place(void **state)
{
    (void)state;
    assert_length_does_not_matter(&exponential);
    assert_length_does_not_matter(&logarithm);
    assert_length_does_not_matter(&arsinh);
}

static void every_instruction_set_gives_the_same_bits(void **state)
{
    (void)state;
    static double x[SAMPLES], y[SAMPLES], z[SAMPLES];
    awkward(x, SAMPLES);
    test_vmath_copy copies[3];
    size_t count = test_vmath_copies(copies);
    for (size_t i = 0; i < count; i++) {
        const test_vmath_copy *copy = &copies[i];
        printf("compared with %s\n", copy->name);
        lac_vexp(SAMPLES, x, y);
        copy->exp(SAMPLES, x, z);
        assert_same_bits("exp", x, y, z, SAMPLES);
        lac_vlog(SAMPLES, x, y);
        copy->log(SAMPLES, x, z);
        assert_same_bits("log", x, y, z, SAMPLES);
        lac_vasinh(SAMPLES, x, y);
        copy->asinh(SAMPLES, x, z);
        assert_same_bits("asinh", x, y, z, SAMPLES);
    }
}

static void asinh_is_odd(void **state)
{
    (void)state;
    double x[AWKWARD], minus_x[AWKWARD], y[AWKWARD], z[AWKWARD];
    awkward(x, AWKWARD);
    for (size_t i = 0; i < AWKWARD; i++) {
        minus_x[i] = -x[i];
    }
    lac_vasinh(AWKWARD, x, y);
    lac_vasinh(AWKWARD, minus_x, z);
    for (size_t i = 0; i < AWKWARD; i++) {
        z[i] = -z[i];
    }
    assert_same_bits("asinh", x, y, z, AWKWARD);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_are_below_1_5_ulp),
        cmocka_unit_test(special_values_are_those_of_ieee),
        cmocka_unit_test(result_is_the_same_for_every_length_and_place),
        cmocka_unit_test(every_instruction_set_gives_the_same_bits),
        cmocka_unit_test(asinh_is_odd),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
