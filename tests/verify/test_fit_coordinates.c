// SPDX-License-Identifier: GPL-3.0-or-later
// The coordinates that walkers live in: their map there and back, and its Jacobian by differences.
#include <stdio.h>

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "fit/internal.h"
#include "support/test.h"

enum { READINGS = 12 };

// A fit of a block whose `fit.parameters` are given, never run.
static lac_fit *make(const char *parameters, const char *tail, lac_case **c)
{
    char text[2048];
    double time[READINGS], displacement[READINGS];
    size_t line[READINGS];
    lac_case_issues report;
    lac_error err = {""};
    lac_fit *fit = NULL;
    const lac_case_request how = {LAC_FOR_FIT, NULL, 0};
    (void)snprintf(text, sizeof text,
                   "lacuna: 1\n"
                   "load: {normal: {pressure: \"1 MPa\"}}\n"
                   "friction: {aging: {a: 0.010, b: 0.015, dc: \"0.1 m\"}}\n"
                   "initial: {slip_rate: \"2 mm/day\", state: {ratio_to_steady: 0.8}}\n"
                   "time: {end: \"400 day\"}\n"
                   "fit: {time: t, displacement: d%s, parameters: {%s}}\n",
                   tail, parameters);
    for (size_t i = 0; i < READINGS; i++) {
        time[i] = 86400.0 * (double)i;
        displacement[i] = 2e-3 * (double)i;
        line[i] = i + 2;
    }
    const lac_series series = {
        .n = READINGS, .time = time, .displacement = displacement, .line = line};
    if (lac_case_read_text("case.yaml", text, strlen(text), &how, c, &report, &err) != LAC_OK ||
        lac_fit_create(*c, &series, 1, &fit, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    lac_case_issues_clear(&report);
    fit->straight = lac_fit_straighten(fit);
    return fit;
}

// ln |det du/dz| by central differences.
static double difference(const lac_fit *fit, const double *z)
{
    const double h = 1e-5;
    size_t n = fit->unknowns;
    double moved[LAC_FIT_UNKNOWNS], more[LAC_FIT_UNKNOWNS], less[LAC_FIT_UNKNOWNS];
    gsl_matrix *j = gsl_matrix_alloc(n, n);
    gsl_permutation *p = gsl_permutation_alloc(n);
    int sign;
    for (size_t k = 0; k < n; k++) {
        memcpy(moved, z, n * sizeof *moved);
        moved[k] = z[k] + h;
        (void)lac_fit_from_line(fit, moved, more);
        moved[k] = z[k] - h;
        (void)lac_fit_from_line(fit, moved, less);
        for (size_t i = 0; i < n; i++) {
            gsl_matrix_set(j, i, k, (more[i] - less[i]) / (2.0 * h));
        }
    }
    assert_int_equal(gsl_linalg_LU_decomp(j, p, &sign), 0);
    double found = gsl_linalg_LU_lndet(j);
    gsl_permutation_free(p);
    gsl_matrix_free(j);
    return found;
}

static void check(const char *parameters, const char *tail, bool straight)
{
    lac_case *c = NULL;
    lac_fit *fit = make(parameters, tail, &c);
    assert_int_equal(fit->straight.used, straight);
    for (uint64_t draw = 0; draw < 20; draw++) {
        double u[LAC_FIT_UNKNOWNS], z[LAC_FIT_UNKNOWNS], back[LAC_FIT_UNKNOWNS];
        lac_fit_draw_prior(fit, draw, u);
        lac_fit_to_line(fit, u, z);
        double slope = lac_fit_from_line(fit, z, back);
        for (size_t k = 0; k < fit->unknowns; k++) {
            if (!(fabs(back[k] - u[k]) < 1e-9 * (1.0 + fabs(u[k])))) {
                fail_msg("%s: coordinate %zu: %.17g comes back as %.17g", parameters, k, u[k],
                         back[k]);
            }
        }
        if (!(fabs(slope - difference(fit, z)) < 1e-6)) {
            fail_msg("%s: ln of the Jacobian %.12g, by differences %.12g", parameters, slope,
                     difference(fit, z));
        }
    }
    lac_fit_free(fit);
    lac_case_free(c);
}

#define DC "friction.aging.dc: {range: [\"1 cm\", \"1 m\"]}, "
#define X "initial.state.ratio_to_steady: {range: [0.3, 0.99]"
#define RATE "initial.slip_rate: {range: [\"0.1 mm/day\", \"9 mm/day\"]}"

static void there_and_back(void **state)
{
    (void)state;
    check(RATE, "", false);
    check(DC RATE, ", errors: ar1", false);
    check(DC X "}, " RATE, "", true);
    check(DC X ", prior: {uniform: {}}}, " RATE, ", errors: ar1", true);
    check("friction.aging.dc: {range: [\"1 cm\", \"1 m\"], prior: {uniform: {}}}, " X
          ", prior: {uniform: {}}}, friction.aging.b: {range: [0.011, 0.03]}",
          "", true);
    check("friction.aging.a: {range: [0.005, 0.012], prior: {uniform: {}}}, " DC X "}", "", true);
    check("friction.aging.dc: {prior: {lognormal: {median: \"0.1 m\", sigma: 1}}}, " X "}", "",
          true);
}

// Where m - 1 or 1 - x may change its sign, S would.
static void not_where_signs_change(void **state)
{
    (void)state;
    check(DC "initial.state.ratio_to_steady: {range: [0.3, 1.5]}", "", false);
    check(DC X "}, friction.aging.b: {range: [0.009, 0.03]}", "", false);
}

// Chains whose places, on the line, are normal but for a coordinate that bends with another one.
static lac_fit *make_chain(double bend, size_t pivot, lac_case **c)
{
    enum { WALKERS = 40, STEPS = 60 };
    lac_fit *fit = make(DC RATE ", friction.aging.b: {range: [0.011, 0.03]}", "", c);
    const size_t d = fit->unknowns, bent = (pivot + 1) % d;
    lac_chain *chain = calloc(1, sizeof *chain + WALKERS * STEPS * d * sizeof(double));
    assert_non_null(chain);
    *chain =
        (lac_chain){.dimension = d, .walkers = WALKERS, .steps = STEPS, .x = (double *)(chain + 1)};
    fit->chain = chain;
    for (uint64_t i = 0; i < WALKERS * STEPS; i++) {
        double z[LAC_FIT_UNKNOWNS], normal[2];
        for (size_t k = 0; k < d; k++) {
            lac_random_normal(8, LAC_STREAM_TEST, i, k, normal);
            z[k] = normal[0] * (k == bent && bend != 0.0 ? 0.01 : 0.6);
        }
        const double t = z[pivot];
        z[bent] += bend * (0.3 + 0.7 * t + 0.8 * t * t - 0.5 * t * t * t);
        (void)lac_fit_from_line(fit, z, chain->x + i * d);
    }
    return fit;
}

// Behind the shear what is bent is a straight line again, and narrow; the volume is the same.
static void a_bent_valley_becomes_straight(void **state)
{
    (void)state;
    for (size_t pivot = 0; pivot < 3; pivot++) {
        lac_case *c = NULL;
        lac_fit *fit = make_chain(1.0, pivot, &c);
        const lac_chain *chain = fit->chain;
        const size_t d = chain->dimension, bent = (pivot + 1) % d,
                     n = chain->walkers * chain->steps;
        double sum[5] = {0};
        lac_error err;
        assert_int_equal(lac_fit_find_shear(fit, &err), LAC_OK);
        assert_true(fit->shear.used && fit->shear.pivot == pivot);
        for (size_t i = 0; i < n; i++) {
            double z[LAC_FIT_UNKNOWNS], u[LAC_FIT_UNKNOWNS];
            lac_fit_to_line(fit, chain->x + i * d, z);
            const double x = z[pivot], y = z[bent];
            const double terms[] = {x, y, x * x, x * y, y * y};
            for (size_t k = 0; k < 5; k++) {
                sum[k] += terms[k] / (double)n;
            }
            const double slope = lac_fit_from_line(fit, z, u);
            for (size_t k = 0; k < d; k++) {
                assert_true(fabs(u[k] - chain->x[i * d + k]) < 1e-9 * (1.0 + fabs(u[k])));
            }
            if (i % 500 == 0 && !(fabs(slope - difference(fit, z)) < 1e-6)) {
                fail_msg("ln of the Jacobian %.12g, by differences %.12g", slope,
                         difference(fit, z));
            }
        }
        const double xx = sum[2] - sum[0] * sum[0], xy = sum[3] - sum[0] * sum[1],
                     yy = sum[4] - sum[1] * sum[1];
        const double width = sqrt(yy - xy * xy / xx);
        if (!(fabs(width / 0.01 - 1.0) < 0.05)) {
            fail_msg("pivot %zu: as wide as %g about a line, made as 0.01", pivot, width);
        }
        lac_fit_free(fit);
        lac_case_free(c);
    }
}

// Where nothing bends the coordinates stay what they are.
static void a_straight_one_stays(void **state)
{
    (void)state;
    lac_case *c = NULL;
    lac_fit *fit = make_chain(0.0, 0, &c);
    lac_error err;
    assert_int_equal(lac_fit_find_shear(fit, &err), LAC_OK);
    assert_false(fit->shear.used);
    lac_fit_free(fit);
    lac_case_free(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(there_and_back),
        cmocka_unit_test(not_where_signs_change),
        cmocka_unit_test(a_bent_valley_becomes_straight),
        cmocka_unit_test(a_straight_one_stays),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
