// SPDX-License-Identifier: GPL-3.0-or-later
// What every law of the registry must do in every form, with and without cut-off slip rates.

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "support/laws.h"
#include "support/test.h"

enum { TRIALS = 1000 };

static const double ln_slowest = -69.07755278982137, ln_fastest = 6.907755278982137;
static const double ln_youngest = -27.631021115928547, ln_oldest = 46.051701859880914;

// A rate and a state of any size for a cell. Half of the states make f of the order of a, where
// the regularised strength bends.
static void draw(const lac_friction *friction, uint64_t trial, size_t cell, double *u, double *w)
{
    *u = laws_biased(trial, 10, ln_slowest, ln_fastest);
    *w = laws_biased(trial, 11, ln_youngest, ln_oldest);
    double a = lac_cellwise_of(&friction->column[LAC_A], cell);
    double b = lac_cellwise_of(&friction->column[LAC_B], cell);
    if (trial % 2 == 0) {
        double plain = a * laws_uniform(trial, 12, -4, 4);
        *w = (plain - lac_friction_plain(friction, cell, *u, 0)) / b;
        *w = fmin(fmax(*w, ln_youngest), ln_oldest);
    }
}

typedef void check(const variant *kind);

static void on_every_law_and_form(check *run)
{
    variant kind = {0};
    for (; lac_friction_law_get(kind.law) != NULL; kind.law++) {
        for (int i = 0; i < 8; i++) {
            kind.form = i % 2 == 0 ? LAC_FORM_PLAIN : LAC_FORM_REGULARISED;
            kind.v1 = i / 2 % 2 == 1;
            kind.v2 = i / 4 == 1;
            run(&kind);
        }
    }
    assert_true(kind.law >= 3);
}

static void check_steady(const variant *kind)
{
    lac_friction *friction = laws_make_varied(kind);
    for (size_t i = 0; i < LAWS_CELLS; i++) {
        evaluation e;
        e.u[0] = laws_biased(i, 1, ln_slowest, ln_fastest);
        e.w[0] = lac_friction_steady_state(friction, i, e.u[0]);
        laws_evaluate(friction, i, 1, &e);
        double renewal = e.v[0] / lac_cellwise_of(&friction->column[LAC_DC], i); // [1/s]
        double change = fmax(renewal, exp(-e.w[0])); // a state that saturates is below dc/v
        laws_must(fabs(e.out[G][0]) <= 1e-12 * change, friction, i, (double[]){e.u[0], e.w[0]},
                  "the state changes in its steady state");
        e.w[0] += 0.1;
        laws_evaluate(friction, i, 1, &e);
        laws_must(e.out[G][0] < -0.01 * change, friction, i, (double[]){e.u[0], e.w[0]},
                  "a state above the steady one does not fall");
    }
    lac_friction_free(friction);
}

static void steady_at_its_steady_state(void **state)
{
    (void)state;
    on_every_law_and_form(check_steady);
}

static void assert_finite_everywhere(const lac_friction *friction)
{
    for (double u = ln_slowest; u <= ln_fastest + 1e-9; u += (ln_fastest - ln_slowest) / 9) {
        for (double w = ln_youngest; w <= ln_oldest + 1e-9; w += (ln_oldest - ln_youngest) / 10) {
            evaluation e = {.u = {u}, .w = {w}};
            laws_evaluate(friction, 0, 1, &e);
            bool finite = true;
            for (size_t k = 0; k < OUTPUTS; k++) {
                finite = finite && isfinite(e.out[k][0]);
            }
            laws_must(finite, friction, 0, (double[]){u, w}, "strength or evolution not finite");
            assert_true(e.out[F_U][0] >= 0 && e.out[F_W][0] >= 0);
            assert_true(friction->form == LAC_FORM_PLAIN || e.out[F][0] >= 0);
        }
    }
}

static void check_finite(const variant *kind)
{
    static const double effect[] = {0, 1e-300, 1e-12, 1e-4, 0.01, 1, 1e3};
    enum { EFFECTS = sizeof effect / sizeof effect[0] };
    for (size_t i = 0; i < EFFECTS; i++) {
        for (size_t j = 0; j < EFFECTS; j++) {
            for (double dc = 1e-12; dc < 1e7; dc *= test_few() ? 1e18 : 1e6) {
                lac_friction *friction = laws_make(kind, 1, effect[i], effect[j], dc);
                assert_finite_everywhere(friction);
                lac_friction_free(friction);
            }
        }
    }
}

static void finite_over_the_whole_range(void **state)
{
    (void)state;
    on_every_law_and_form(check_finite);
}

// (out_k(x + h) - out_k(x - h))/2h in the direction of u or w.
static void difference(const lac_friction *friction, size_t cell, const evaluation *at,
                       bool along_u, double h, double slope[OUTPUTS])
{
    evaluation up = {.u = {at->u[0]}, .w = {at->w[0]}}, down = up;
    (along_u ? up.u : up.w)[0] += h;
    (along_u ? down.u : down.w)[0] -= h;
    double width = along_u ? up.u[0] - down.u[0] : up.w[0] - down.w[0];
    laws_evaluate(friction, cell, 1, &up);
    laws_evaluate(friction, cell, 1, &down);
    for (size_t k = 0; k < OUTPUTS; k++) {
        slope[k] = (up.out[k][0] - down.out[k][0]) / width;
    }
}

// Where derivatives are looked at.
typedef struct place {
    const lac_friction *friction;
    size_t cell;
    const evaluation *e;
} place;

static void assert_slope(const place *at, const char *name, double analytic, double numeric,
                         double tolerance)
{
    char text[200];
    (void)snprintf(text, sizeof text, "%s = %.12g, by differences %.12g (tolerance %g)", name,
                   analytic, numeric, tolerance);
    laws_must(fabs(analytic - numeric) <= tolerance, at->friction, at->cell,
              (double[]){at->e->u[0], at->e->w[0]}, text);
}

static void check_slopes_at(const lac_friction *friction, size_t cell, const evaluation *e)
{
    const place at = {friction, cell, e};
    double a = lac_cellwise_of(&friction->column[LAC_A], cell);
    double b = lac_cellwise_of(&friction->column[LAC_B], cell);
    double by_u[OUTPUTS], by_w[OUTPUTS];
    // along w the regularised strength bends over a/b
    difference(friction, cell, e, true, 1e-4, by_u);
    difference(friction, cell, e, false, 1e-4 * fmin(1, a / b), by_w);
    assert_slope(&at, "f_u", e->out[F_U][0], by_u[F], 1e-6 * a);
    assert_slope(&at, "f_w", e->out[F_W][0], by_w[F], 1e-6 * b);
    assert_slope(&at, "f_uu", e->out[F_UU][0], by_u[F_U], 1e-6 * a);
    assert_slope(&at, "f_uw", e->out[F_UW][0], by_u[F_W], 1e-6 * b);
    assert_slope(&at, "f_uw", e->out[F_UW][0], by_w[F_U], 1e-6 * b);
    assert_slope(&at, "f_ww", e->out[F_WW][0], by_w[F_W], 1e-6 * b * b / a);

    // the composite law's healing ends within vc/v of an e-fold
    difference(friction, cell, e, true, 1e-5, by_u);
    difference(friction, cell, e, false, 1e-4, by_w);
    double g_u = e->out[G_U][0], g_w = e->out[G_W][0];
    double rounding = 1e-9 * (fabs(e->out[G][0]) + fabs(g_u) + fabs(g_w));
    assert_slope(&at, "g_u", g_u, by_u[G], 1e-6 * fabs(g_u) + rounding);
    assert_slope(&at, "g_w", g_w, by_w[G], 1e-6 * fabs(g_w) + rounding);
}

static void check_derivatives(const variant *kind)
{
    lac_friction *friction = laws_make_varied(kind);
    for (uint64_t trial = 0; trial < test_some(TRIALS); trial++) {
        size_t cell = trial % LAWS_CELLS;
        evaluation e;
        draw(friction, trial, cell, &e.u[0], &e.w[0]);
        laws_evaluate(friction, cell, 1, &e);
        check_slopes_at(friction, cell, &e);
    }
    lac_friction_free(friction);
}

static void derivatives_equal_differences(void **state)
{
    (void)state;
    on_every_law_and_form(check_derivatives);
}

static void assert_equals_single_cells(const lac_friction *friction, size_t first, size_t n)
{
    evaluation all, one;
    for (size_t i = 0; i < n; i++) {
        draw(friction, first + i, first + i, &all.u[i], &all.w[i]);
    }
    laws_evaluate(friction, first, n, &all);
    for (size_t i = 0; i < n; i++) {
        one.u[0] = all.u[i];
        one.w[0] = all.w[i];
        laws_evaluate(friction, first + i, 1, &one);
        for (size_t k = 0; k < OUTPUTS; k++) {
            laws_must(memcmp(&one.out[k][0], &all.out[k][i], sizeof(double)) == 0, friction,
                      first + i, (double[]){one.u[0], one.w[0]}, "not the same alone");
        }
        double f = lac_friction_coefficient(friction, first + i, one.u[0], one.w[0]);
        assert_memory_equal(&f, &one.out[F][0], sizeof f);
    }
}

static void check_blocks(const variant *kind)
{
    lac_friction *friction = laws_make_varied(kind);
    assert_equals_single_cells(friction, 0, LAC_FRICTION_BLOCK);
    assert_equals_single_cells(friction, LAWS_CELLS - LAC_FRICTION_BLOCK, LAC_FRICTION_BLOCK);
    for (size_t n = 0; n < 20; n++) {
        assert_equals_single_cells(friction, 3 * n, n);
    }
    evaluation e, bare; // without slopes the rest is the same
    draw(friction, 5, 5, &e.u[0], &e.w[0]);
    laws_evaluate(friction, 5, 1, &e);
    lac_friction_evaluate(
        friction, &(lac_friction_cells){5, 1, e.u, e.w, e.v, 0, NULL},
        &(lac_friction_values){
            .f = bare.out[F], .f_u = bare.out[F_U], .f_w = bare.out[F_W], .g = bare.out[G]},
        NULL);
    for (size_t k = F; k <= G; k++) {
        assert_memory_equal(&e.out[k][0], &bare.out[k][0], sizeof(double));
    }
    lac_friction_free(friction);
}

static void block_equals_single_cells(void **state)
{
    (void)state;
    on_every_law_and_form(check_blocks);
}

static void check_state_for(const variant *kind)
{
    lac_friction *friction = laws_make_varied(kind);
    for (uint64_t trial = 0; trial < test_some(TRIALS); trial++) {
        size_t cell = trial % LAWS_CELLS;
        double u, w;
        draw(friction, trial, cell, &u, &w);
        double f = lac_friction_coefficient(friction, cell, u, w);
        if (kind->form == LAC_FORM_REGULARISED && f < 1e-300) {
            continue; // underflow: any younger state does as well
        }
        double found = lac_friction_state_for(friction, cell, u, f);
        if (isnan(found)) {
            // younger than dc/v2 by far, f does not tell how young
            assert_true(kind->v2 && w < lac_cellwise_of(&friction->ln_cut, cell) - 20);
            continue;
        }
        double again = lac_friction_coefficient(friction, cell, u, found);
        // f in terms of ln theta is good to the rounding of its terms
        assert_true(fabs(again - f) <= 1e-10 * fabs(f) + 1e-12);
        assert_true(kind->form == LAC_FORM_PLAIN || fabs(again / f - 1) <= 1e-9);
    }
    lac_friction_free(friction);
}

static void check_rate_for(const variant *kind)
{
    static const double damping[] = {0, 1e-6, 1, 4.5e6, 1e12};
    lac_friction *friction = laws_make_varied(kind);
    for (uint64_t trial = 0; trial < test_some(TRIALS); trial++) {
        size_t cell = trial % LAWS_CELLS;
        double u, w, eta = damping[trial / 2 % 5];
        double pressure = pow(10, laws_biased(trial, 20, 0, 9));
        draw(friction, trial, cell, &u, &w);
        double friction_part = pressure * lac_friction_coefficient(friction, cell, u, w);
        double tau = friction_part + eta * exp(u);
        if (kind->form == LAC_FORM_REGULARISED && tau < 1e-290) {
            continue;
        }
        double found = lac_friction_rate_for(friction, cell, w, tau, pressure, eta);
        if (isnan(found)) {
            // faster than v1 by far, f does not tell how fast
            assert_true(kind->v1 && eta == 0 && u > lac_cellwise_of(&friction->ln_v1, cell) + 20);
            continue;
        }
        double viscous = eta * exp(found);
        double residual =
            pressure * lac_friction_coefficient(friction, cell, found, w) + viscous - tau;
        assert_true(fabs(residual) <= 1e-11 * (fabs(friction_part) + viscous) + 1e-13 * pressure);
        assert_true(kind->form == LAC_FORM_PLAIN || fabs(residual) <= 1e-9 * tau);
    }
    lac_friction_free(friction);
}

static void state_and_rate_invert_the_coefficient(void **state)
{
    (void)state;
    on_every_law_and_form(check_state_for);
    on_every_law_and_form(check_rate_for);
}

enum { HOSTILE = 14 };

// Every 25th combination of hostile arguments, from `k` on: the effects are the k-th pair.
static void check_hostile_cells(const lac_friction *friction, size_t k)
{
    static const double values[HOSTILE] = {0,      -0.0, 1,    -1,  1e-300, 1e300,    -1e300,
                                           5e-324, 1e6,  -700, 700, NAN,    INFINITY, -INFINITY};
    for (size_t i = k; i < HOSTILE * HOSTILE * HOSTILE * HOSTILE; i += 25) {
        double w = values[i % HOSTILE], tau = values[i / HOSTILE % HOSTILE];
        double pressure = values[i / HOSTILE / HOSTILE % HOSTILE];
        double eta = values[i / HOSTILE / HOSTILE / HOSTILE];
        if (i % 97 != 0 && (fabs(w) > 1e3 || isnan(w))) {
            continue; // a sample of those is enough
        }
        double u = lac_friction_rate_for(friction, 0, w, tau, pressure, eta);
        bool bad =
            isnan(w) || isnan(tau) || isnan(pressure) || isnan(eta) || pressure < 0 || eta < 0;
        assert_true(!bad || isnan(u));
    }
}

static void check_hostile(const variant *kind)
{
    static const double effects[] = {0, 5e-324, 1e-290, 0.01, 1e3};
    for (size_t k = 0; k < 25; k++) {
        lac_friction *friction = laws_make(kind, 1, effects[k % 5], effects[k / 5], 1e-4);
        check_hostile_cells(friction, k);
        lac_friction_free(friction);
    }
}

// Normal stress takes (alpha/b) d ln p/dt off dw/dt, a jump the integral of that; and no more.
static void check_normal_stress(const variant *kind)
{
    lac_friction *friction = laws_make_varied(kind);
    double alpha[LAWS_CELLS];
    for (int with = 0; with < 2; with++) {
        for (size_t cell = 0; cell < LAWS_CELLS; cell++) {
            evaluation still, moving;
            double f, f_u, f_w, rate = pow(10, laws_uniform(cell, 30, -9, 3));
            draw(friction, cell, cell, &still.u[0], &still.w[0]);
            laws_evaluate(friction, cell, 1, &still);
            lac_friction_evaluate(
                friction, &(lac_friction_cells){cell, 1, still.u, still.w, still.v, rate, NULL},
                &(lac_friction_values){&f, &f_u, &f_w, moving.out[G]}, NULL);
            double response = with ? alpha[cell] / friction->column[LAC_B].value[cell] : 0;
            double want = still.out[G][0] - response * rate;
            assert_true(fabs(moving.out[G][0] - want) <= 1e-15 * (fabs(want) + response * rate));
            assert_true(f == still.out[F][0] && f_w == still.out[F_W][0]);
            double after = lac_friction_state_after(friction, cell, still.w[0], 3);
            assert_true(fabs(still.w[0] - after - response * log(3)) <= 1e-13 * (100 + response));
        }
        for (size_t cell = 0; cell < LAWS_CELLS; cell++) {
            alpha[cell] = laws_biased(cell, 31, 0, 1);
        }
        assert_int_equal(lac_friction_set(friction, "alpha", alpha, NULL), LAC_OK);
        assert_int_equal(lac_friction_check(friction, NULL), LAC_OK);
    }
    lac_friction_free(friction);
}

static void state_responds_to_normal_stress(void **state)
{
    (void)state;
    on_every_law_and_form(check_normal_stress);
}

static void rate_for_takes_anything(void **state)
{
    (void)state;
    on_every_law_and_form(check_hostile);
}

static void check_table(const variant *kind)
{
    static const char *const common[] = {"f0", "a", "b", "dc", "v0", "form", "v1", "v2", "alpha"};
    const size_t all = sizeof common / sizeof common[0];
    const lac_model_info *info = &lac_friction_law_get(kind->law)->info;
    assert_true(info->param_count >= all && info->params_size >= sizeof(lac_friction_params));
    assert_true(strlen(info->summary) > 0 && strlen(info->reference) > 0);
    assert_non_null(info->validate);
    for (size_t i = 0; i < info->param_count; i++) {
        assert_true(strlen(info->params[i].doc) > 0);
        assert_true(info->params[i].offset < info->params_size);
    }
    for (size_t i = 0; i < all; i++) {
        assert_string_equal(info->params[i].key, common[i]);
        assert_true(((info->params[i].flags & LAC_CELLWISE) != 0) ==
                    (strcmp(common[i], "form") != 0));
        assert_true(((info->params[i].flags & LAC_OPTIONAL) != 0) == (i > 5));
    }
}

static void tables_start_with_the_common_parameters(void **state)
{
    (void)state;
    on_every_law_and_form(check_table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_start_with_the_common_parameters),
        cmocka_unit_test(steady_at_its_steady_state),
        cmocka_unit_test(finite_over_the_whole_range),
        cmocka_unit_test(derivatives_equal_differences),
        cmocka_unit_test(block_equals_single_cells),
        cmocka_unit_test(state_and_rate_invert_the_coefficient),
        cmocka_unit_test(state_responds_to_normal_stress),
        cmocka_unit_test(rate_for_takes_anything),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
