// SPDX-License-Identifier: GPL-3.0-or-later
// Answers of ensembles whose indices, shares and quantiles are known in closed form, and of poor
// ones: broken members, one member, ties, nothing that varies.
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "base/rng.h"
#include "support/test.h"
#include "sweep/answers.h"

static const double pi = 3.14159265358979323846;

typedef double (*function)(const double *u);

// A sample of our own.
typedef struct sample {
    lac_sample of;
    double *drawn, *result;
} sample;

static double uniform(uint64_t seed, size_t i, size_t p)
{
    return lac_random_uniform(seed, LAC_STREAM_TEST, i, p);
}

static sample sample_create(lac_sample_design design, size_t d, size_t n, uint64_t seed, function f)
{
    sample s = {.drawn = malloc(d * n * sizeof(double)), .result = malloc(n * sizeof(double))};
    assert_true(s.drawn != NULL && s.result != NULL);
    for (size_t i = 0; i < n; i++) {
        double u[8];
        const size_t row = i / (d + 2), k = i % (d + 2);
        for (size_t p = 0; p < d; p++) {
            const bool b = k == 1 || k == 2 + p;
            u[p] = design == LAC_SAMPLE_SALTELLI ? uniform(seed, row, p + (b ? d : 0))
                                                 : uniform(seed, i, p);
            s.drawn[p * n + i] = u[p];
        }
        s.result[i] = f(u);
    }
    s.of = (lac_sample){.params = d,
                        .members = n,
                        .drawn = s.drawn,
                        .result = s.result,
                        .design = design,
                        .by = NAN,
                        .seed = seed};
    return s;
}

static void sample_clear(sample *s)
{
    free(s->drawn);
    free(s->result);
}

static lac_answers *answer(const lac_sample *s)
{
    lac_answers *a = NULL;
    lac_error err = {""};
    if (lac_answers_create(s, &a, &err) != LAC_OK) {
        fail_msg("answers: %s", err.message);
    }
    return a;
}

static const lac_influence *influence_of(const lac_answers *a, size_t param)
{
    const lac_influence *found = NULL;
    for (size_t p = 0; p < a->params; p++) {
        found = a->influence[p].param == param ? &a->influence[p] : found;
    }
    assert_non_null(found);
    return found;
}

// Ishigami & Homma (1990): sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1, x in (-pi, pi).
static double ishigami(const double *u)
{
    const double x1 = pi * (2 * u[0] - 1), x2 = pi * (2 * u[1] - 1), x3 = pi * (2 * u[2] - 1);
    return sin(x1) + 7 * sin(x2) * sin(x2) + 0.1 * pow(x3, 4) * sin(x1);
}

static void ishigami_indices(double first[3], double total[3])
{
    const double a = 7, b = 0.1, p4 = pow(pi, 4), p8 = p4 * p4;
    const double v1 = 0.5 * pow(1 + b * p4 / 5, 2), v2 = a * a / 8, v13 = b * b * p8 * 8 / 225;
    const double v = v1 + v2 + v13;
    first[0] = v1 / v, first[1] = v2 / v, first[2] = 0;
    total[0] = (v1 + v13) / v, total[1] = v2 / v, total[2] = v13 / v;
}

// How often the 95 % intervals hold, of seeds and 3 parameters.
static void intervals_hold_ishigamis_indices(void **state)
{
    (void)state;
    double first[3], total[3];
    size_t first_in = 0, total_in = 0;
    const size_t seeds = test_some(100);
    double off = 0.0;
    ishigami_indices(first, total);
    for (size_t seed = 1; seed <= seeds; seed++) {
        sample s = sample_create(LAC_SAMPLE_SALTELLI, 3, (size_t)5 * 400, seed, ishigami);
        lac_answers *a = answer(&s.of);
        for (size_t p = 0; p < 3; p++) {
            const lac_influence *one = influence_of(a, p);
            first_in += one->first_low <= first[p] && first[p] <= one->first_high ? 1 : 0;
            total_in += one->total_low <= total[p] && total[p] <= one->total_high ? 1 : 0;
            off = fmax(off, fabs(one->first - first[p]) / one->first_error);
            off = fmax(off, fabs(one->total - total[p]) / one->total_error);
        }
        lac_answers_free(a);
        sample_clear(&s);
    }
    print_message("95 %% intervals hold: first %zu, total %zu of %zu; worst %.2f sd\n", first_in,
                  total_in, 3 * seeds, off);
    assert_in_range(first_in, 3 * seeds * 90 / 100, 3 * seeds - seeds / 30);
    assert_in_range(total_in, 3 * seeds * 90 / 100, 3 * seeds - seeds / 30);
    assert_true(off < 5.0);
}

// Of members that are drawn freely: by groups of neighbours.
static void drawn_members_tell_first_indices(void **state)
{
    (void)state;
    double first[3], total[3];
    size_t in = 0;
    const size_t seeds = test_some(40);
    ishigami_indices(first, total);
    for (size_t seed = 1; seed <= seeds; seed++) {
        sample s = sample_create(LAC_SAMPLE_DRAWN, 3, 2000, seed, ishigami);
        lac_answers *a = answer(&s.of);
        for (size_t p = 0; p < 3; p++) {
            const lac_influence *one = influence_of(a, p);
            in += one->first_low <= first[p] && first[p] <= one->first_high ? 1 : 0;
            assert_true(isnan(one->total));
        }
        lac_answers_free(a);
        sample_clear(&s);
    }
    print_message("of drawn members: first %zu of %zu\n", in, 3 * seeds);
    assert_in_range(in, 3 * seeds * 90 / 100, 3 * seeds);
}

// Of one member a value, or of one value, nothing tells the values from chance.
static void too_few_members_tell_nothing(void **state)
{
    (void)state;
    const double drawn[] = {1, 2, 3, 4, 1, 1, 1, 1}, result[] = {7, 8, 11, 10};
    for (size_t n = 2; n <= 4; n++) {
        lac_sample s = {.params = 2, .members = n, .drawn = drawn, .result = result, .by = NAN};
        double own[8];
        memcpy(own, drawn, n * sizeof *own);
        memcpy(own + n, drawn + 4, n * sizeof *own);
        s.drawn = own;
        lac_answers *a = answer(&s);
        assert_int_equal(!isnan(influence_of(a, 0)->first), n == 4); // two groups of two
        assert_true(isnan(influence_of(a, 1)->first) && !a->alike);
        lac_answers_free(a);
    }
    for (size_t rows = 1; rows <= 2; rows++) {
        sample s = sample_create(LAC_SAMPLE_SALTELLI, 3, 5 * rows, 7, ishigami);
        lac_answers *a = answer(&s.of);
        assert_int_equal(isnan(influence_of(a, 0)->total), rows == 1);
        lac_answers_free(a);
        sample_clear(&s);
    }
}

static double linear(const double *u) { return 3 * u[0] - 2 * u[1] + u[2]; }

// Time to failure of a block under constant load from the same x = theta/theta_ss: dc/v* F(m, x),
// docs/theory/creep.md: dc in (1, 3) cm, 1/v* in (2, 3) s/m.
static double block(const double *u) { return (0.01 + 0.02 * u[0]) * (2 + u[1]) * 0.856272305814; }

static void close_to(double got, double want, double error, const char *what)
{
    if (!(fabs(got - want) <= 4 * error + 1e-12)) {
        fail_msg("%s: %g, expected %g +- %g", what, got, want, error);
    }
}

static void linear_and_products(void **state)
{
    (void)state;
    sample s = sample_create(LAC_SAMPLE_SALTELLI, 3, (size_t)5 * 2000, 7, linear);
    lac_answers *a = answer(&s.of);
    const double of_linear[] = {9.0 / 14, 4.0 / 14, 1.0 / 14};
    for (size_t p = 0; p < 3; p++) {
        const lac_influence *one = influence_of(a, p);
        close_to(one->first, of_linear[p], one->first_error, "first of a sum");
        close_to(one->total, of_linear[p], one->total_error, "total of a sum");
        assert_int_equal(a->influence[p].param, p); // the strongest first
    }
    assert_int_equal(a->counted, 2 * 2000); // of A and B, which alone are drawn
    assert_int_equal(a->rows, 2000);
    assert_true(influence_of(a, 0)->rank > 0.5 && influence_of(a, 1)->rank < -0.3);
    lac_answers_free(a);
    sample_clear(&s);

    // c: variance over squared mean; of a product first c1/all, total c1 (1 + c2)/all
    const double c1 = 1.0 / 12, c2 = 1.0 / 75, all = (1 + c1) * (1 + c2) - 1;
    s = sample_create(LAC_SAMPLE_SALTELLI, 2, (size_t)4 * 3000, 8, block);
    a = answer(&s.of);
    const lac_influence *dc = influence_of(a, 0), *v = influence_of(a, 1);
    close_to(dc->first, c1 / all, dc->first_error, "first of dc");
    close_to(dc->total, c1 * (1 + c2) / all, dc->total_error, "total of dc");
    close_to(v->first, c2 / all, v->first_error, "first of v");
    close_to(v->total, c2 * (1 + c1) / all, v->total_error, "total of v");
    assert_true(dc->total_error < 0.05 && v->total_error < 0.05);
    lac_answers_free(a);
    sample_clear(&s);
}

// Fails at 10 u0 where u1 < 0.6; never else. Broken where u0 < 0.1.
static double some_never(const double *u)
{
    return u[0] < 0.1 ? (double)NAN : u[1] < 0.6 ? 10 * u[0] : (double)INFINITY;
}

static void never_is_no_number(void **state)
{
    (void)state;
    sample s = sample_create(LAC_SAMPLE_DRAWN, 2, 4000, 3, some_never);
    lac_answers *a = answer(&s.of);
    assert_int_equal(a->members, 4000);
    assert_int_equal(a->broken + a->counted, 4000);
    assert_in_range(a->broken, 340, 460);
    assert_true(a->of_chance);
    assert_true(a->chance.low < 0.6 && 0.6 < a->chance.high);
    assert_true(a->chance.high - a->chance.low < 0.04);
    assert_true(fabs(a->quantile[2].value - (1 + 9 * 0.5 / 0.6)) < 0.3);
    assert_true(isinf(a->quantile[3].value) && isinf(a->quantile[4].value));
    assert_int_equal(a->influence[0].param, 1);
    assert_true(a->influence[0].first > 0.95);
    lac_answers_free(a);
    s.of.by = 5.5; // half of those that fail, one product of two independent events
    a = answer(&s.of);
    assert_true(a->chance.low < 0.3 && 0.3 < a->chance.high);
    close_to(influence_of(a, 0)->first, 0.09 / 0.21, influence_of(a, 0)->first_error, "u0");
    close_to(influence_of(a, 1)->first, 0.06 / 0.21, influence_of(a, 1)->first_error, "u1");
    lac_answers_free(a);
    sample_clear(&s);
}

// Members that were not followed so long are neither; the interval holds both of what they may do.
static void not_followed_is_not_known(void **state)
{
    (void)state;
    const double result[] = {1, 2, INFINITY, INFINITY}, until[] = {1, 2, 3, 10};
    const lac_sample s = {.members = 4, .result = result, .followed = until, .by = NAN};
    const lac_chance c = lac_answers_chance(&s, 5);
    assert_int_equal(c.failed, 2);
    assert_int_equal(c.unknown, 1);
    assert_float_equal(c.share, 2.0 / 3, 1e-15);
    const lac_chance all = lac_answers_chance(&s, 3);
    assert_int_equal(all.unknown, 0);
    assert_true(c.low == all.low && c.high > all.high);
}

// Wilson's interval of 0, 1 and 37 of 100: its ends are roots of (p - k/n)^2 = z^2 p (1 - p)/n.
static void shares_have_wilsons_interval(void **state)
{
    (void)state;
    const double z2 = 1.959963984540054 * 1.959963984540054;
    double result[100];
    for (size_t k = 0; k <= 100; k += 37) {
        for (size_t i = 0; i < 100; i++) {
            result[i] = i < k ? 1.0 : (double)INFINITY;
        }
        const lac_sample s = {.members = 100, .result = result, .by = NAN};
        const lac_chance c = lac_answers_chance(&s, 2);
        const double p = (double)k / 100, ends[] = {c.low, c.high};
        for (size_t e = 0; e < 2; e++) {
            const double q = ends[e], off = (q - p) * (q - p) - z2 * q * (1 - q) / 100;
            assert_true(fabs(off) < 1e-14);
        }
        assert_true(c.low <= p && p <= c.high && c.low >= 0 && c.high <= 1);
    }
}

// The median of 10 and of 6 lies between their 2nd and 9th, 1st and 6th value (binomial tables).
static void quantiles_lie_between_order_statistics(void **state)
{
    (void)state;
    const double result[] = {7, 3, 1, 9, 5, 2, 8, 10, 4, 6};
    lac_sample s = {.members = 10, .result = result, .by = NAN};
    lac_answers *a = answer(&s);
    assert_float_equal(a->quantile[2].value, 5.5, 1e-15);
    assert_float_equal(a->quantile[2].low, 2, 0);
    assert_float_equal(a->quantile[2].high, 9, 0);
    assert_true(isnan(a->quantile[0].low) && isnan(a->quantile[4].high));
    lac_answers_free(a);
    s.members = 5;
    a = answer(&s);
    assert_true(isnan(a->quantile[2].low) && isnan(a->quantile[2].high));
    lac_answers_free(a);
}

static void a_tornado_is_of_one_at_a_time(void **state)
{
    (void)state;
    // base; p0 low, high; p1: never at its low; p2: broken; p3 changes nothing
    const double drawn[] = {5, 1, 9, 5, 5, 5, 5, 5, 5, 2, 2, 2, 1, 3, 2, 2, 2, 2,
                            7, 7, 7, 7, 7, 6, 8, 7, 7, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    const double result[] = {10, 8, 13, INFINITY, 9, NAN, 10, 10, 10};
    lac_sample s = {.params = 4,
                    .members = 9,
                    .drawn = drawn,
                    .result = result,
                    .design = LAC_SAMPLE_TORNADO,
                    .by = NAN};
    lac_answers *a = answer(&s);
    const size_t order[] = {1, 0, 3, 2};
    for (size_t k = 0; k < 4; k++) {
        assert_int_equal(a->swing[k].param, order[k]);
    }
    assert_true(isinf(a->swing[0].swing) && isnan(a->swing[3].swing));
    assert_float_equal(a->swing[1].swing, 5, 0);
    assert_float_equal(a->swing[1].low, 1, 0);
    assert_float_equal(a->swing[1].result_high, 13, 0);
    assert_float_equal(a->swing[2].swing, 0, 0);
    assert_float_equal(a->base, 10, 0);
    assert_int_equal(a->broken, 1);
    assert_int_equal(a->counted, 0);
    lac_answers_free(a);
    lac_error err = {""};
    s.members = 8;
    assert_int_equal(lac_answers_create(&s, &a, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "no whole design tornado"));
    s.design = LAC_SAMPLE_SALTELLI;
    assert_int_equal(lac_answers_create(&s, &a, &err), LAC_EINPUT);
}

// Two members of each of 20 values, which decide all: 6 groups of neighbours would leave a rest.
static void equal_values_are_a_group(void **state)
{
    (void)state;
    double drawn[40], result[40];
    for (size_t i = 0; i < 40; i++) {
        drawn[i] = (double)(i / 2);
        result[i] = fmod(7.0 * drawn[i], 20.0);
    }
    const lac_sample s = {
        .params = 1, .members = 40, .drawn = drawn, .result = result, .by = NAN, .seed = 1};
    lac_answers *a = answer(&s);
    assert_float_equal(a->influence[0].first, 1.0, 1e-12);
    lac_answers_free(a);
}

static double constant(const double *u)
{
    (void)u;
    return 4;
}

static double broken(const double *u)
{
    (void)u;
    return (double)NAN;
}

static double stays(const double *u)
{
    (void)u;
    return (double)INFINITY;
}

// A pair of values and 3 times of failure: ties everywhere.
static double steps(const double *u) { return 1 + floor(2 * u[0]) + floor(2 * u[1]); }

static void poor_ensembles_get_sound_answers(void **state)
{
    (void)state;
    const function functions[] = {constant, broken, stays, steps};
    const lac_sample_design designs[] = {LAC_SAMPLE_DRAWN, LAC_SAMPLE_SALTELLI};
    for (size_t k = 0; k < 16; k++) {
        const size_t of = k % 4, n = k < 8 ? 4 : 400, d = designs[k / 4 % 2];
        sample s = sample_create((lac_sample_design)d, 2, n, 5, functions[of]);
        lac_answers *a = answer(&s.of);
        assert_int_equal(a->broken, of == 1 ? n : 0);
        assert_int_equal(a->never, of == 2 ? n : 0);
        const lac_influence *one = influence_of(a, 0);
        if (of < 3) {
            assert_true(isnan(one->first) && isnan(one->first_error) && isnan(one->total));
        } else if (n > 4) {
            close_to(one->first, 0.5, one->first_error, "first of steps");
        }
        assert_true(of == 1 ? isnan(a->chance.share) : a->chance.share == (of == 2 ? 0.0 : 1.0));
        lac_answers_free(a);
        sample_clear(&s);
    }
}

static void one_member_and_no_parameter(void **state)
{
    (void)state;
    const double result = 3;
    const lac_sample s = {.members = 1, .result = &result, .by = NAN};
    lac_answers *a = answer(&s);
    assert_float_equal(a->quantile[2].value, 3, 0);
    assert_true(isnan(a->quantile[2].low));
    assert_true(a->chance.low > 0.2 && a->chance.low < 0.21 && a->chance.high == 1.0);
    lac_answers_free(a);
    const lac_sample none = {.by = NAN};
    a = answer(&none);
    assert_true(isnan(a->quantile[2].value) && isnan(a->chance.share));
    lac_answers_free(a);
}

static void a_fan_counts_the_failed_as_fastest(void **state)
{
    (void)state;
    const float nan = (float)NAN, inf = (float)INFINITY;
    const float series[] = {1, 2, nan, 2, 4, nan, 3, inf, nan};
    double fan[LAC_ANSWERS_QUANTILES * 3];
    lac_error err = {""};
    assert_int_equal(lac_answers_fan(3, 3, series, NULL, fan, &err), LAC_OK);
    assert_float_equal(fan[2 * 3], 2, 0);
    assert_float_equal(fan[2 * 3 + 1], 4, 0);
    assert_true(isinf(fan[4 * 3 + 1]) && isnan(fan[2]));
    const bool use[] = {true, true, false};
    assert_int_equal(lac_answers_fan(3, 3, series, use, fan, &err), LAC_OK);
    assert_float_equal(fan[2 * 3 + 1], 3, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(intervals_hold_ishigamis_indices),
        cmocka_unit_test(drawn_members_tell_first_indices),
        cmocka_unit_test(too_few_members_tell_nothing),
        cmocka_unit_test(linear_and_products),
        cmocka_unit_test(never_is_no_number),
        cmocka_unit_test(not_followed_is_not_known),
        cmocka_unit_test(shares_have_wilsons_interval),
        cmocka_unit_test(quantiles_lie_between_order_statistics),
        cmocka_unit_test(a_tornado_is_of_one_at_a_time),
        cmocka_unit_test(equal_values_are_a_group),
        cmocka_unit_test(poor_ensembles_get_sound_answers),
        cmocka_unit_test(one_member_and_no_parameter),
        cmocka_unit_test(a_fan_counts_the_failed_as_fastest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
