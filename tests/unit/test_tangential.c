// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "contact/tangential.h"
#include "contact/tangential_solve.h"
#include "support/test.h"

enum { SIDE = 8, CELLS = SIDE * SIDE };

// A small joint whose pressures are made up, and its history
typedef struct joint {
    double p[CELLS];
    lac_tangential_def def;
    lac_tangential *t;
    lac_tangential_stats report;
    lac_first_slip first;
    lac_error err;
} joint;

static double random_of(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) / 9007199254740992.0;
}

static void begin(joint *j)
{
    lac_tangential_free(j->t);
    if (lac_tangential_create(&j->def, &j->t, &j->err) != LAC_OK) {
        fail_msg("%s", j->err.message);
    }
}

static int set_up(void **state)
{
    joint *j = calloc(1, sizeof *j);
    j->def = lac_tangential_default();
    j->def.grid = (lac_grid){SIDE, SIDE, 0.1, 0.1, true};
    j->def.e_star = 1e9;
    j->def.poisson = 0.25;
    j->def.friction = 0.6;
    uint64_t seed = 3;
    for (size_t i = 0; i < CELLS; i++) {
        double x = random_of(&seed);
        j->p[i] = x > 0.5 ? 1e6 * x : 0.0;
    }
    begin(j);
    *state = j;
    return 0;
}

static int tear_down(void **state)
{
    joint *j = *state;
    lac_tangential_free(j->t);
    free(j);
    return 0;
}

static double mean_pressure(const joint *j)
{
    double sum = 0.0;
    for (size_t i = 0; i < CELLS; i++) {
        sum += j->p[i] / CELLS;
    }
    return sum;
}

static lac_status load(joint *j, double qx, double qy)
{
    lac_tangential_target target = {{LAC_SHEAR_LOAD, LAC_SHEAR_LOAD}, {qx, qy}};
    return lac_tangential_step(j->t, j->p, &target, &j->report, &j->err);
}

static lac_status drag(joint *j, double ux, double uy)
{
    lac_tangential_target target = {{LAC_SHEAR_SHIFT, LAC_SHEAR_SHIFT}, {ux, uy}};
    return lac_tangential_step(j->t, j->p, &target, &j->report, &j->err);
}

static void must(const joint *j, lac_status status)
{
    if (status != LAC_OK) {
        fail_msg("%s", j->err.message);
    }
}

static void refused(const joint *j, lac_status status, const char *word)
{
    assert_int_equal(status, LAC_EINPUT);
    if (strstr(j->err.message, word) == NULL) {
        fail_msg("no \"%s\" in: %s", word, j->err.message);
    }
}

static void a_modulus_beyond_numbers_is_refused(void **state)
{
    joint *j = *state;
    lac_tangential *t = NULL;
    j->def.e_star = 1e-310;
    refused(j, lac_tangential_create(&j->def, &t, &j->err), "modulus");
    assert_null(t);
    refused(j, lac_tangential_first_slip(&j->def, j->p, (double[]){1.0, 0.0}, &j->first, &j->err),
            "modulus");
}

static void wrong_steps_are_refused(void **state)
{
    joint *j = *state;
    double strength = 0.6 * mean_pressure(j);
    refused(j, load(j, strength, 0.0), "all cells slide");
    refused(j, load(j, 0.8 * strength, 0.7 * strength), "friction f p = 0.6 x");
    refused(j, drag(j, 1e300, 0.0), "beyond numbers");
    memset(j->p, 0, sizeof j->p);
    refused(j, load(j, 0.0, 0.0), "no cell is in contact");
    j->p[0] = 1e308;
    refused(j, load(j, 0.0, 0.0), "beyond numbers");
}

// The conditions that a step must meet, from its tractions and slip alone
static void check_coulomb(const joint *j)
{
    double sum[2] = {0.0, 0.0};
    double scale = hypot(j->report.shift[0], j->report.shift[1]);
    for (size_t i = 0; i < CELLS; i++) {
        scale = fmax(scale, hypot(j->t->slip[0][i], j->t->slip[1][i]));
    }
    for (size_t i = 0; i < CELLS; i++) {
        double qx = j->t->traction[0][i];
        double qy = j->t->traction[1][i];
        double sx = j->t->slip[0][i];
        double sy = j->t->slip[1][i];
        double limit = j->def.friction * j->p[i];
        sum[0] += qx / CELLS;
        sum[1] += qy / CELLS;
        assert_true(hypot(qx, qy) <= limit * (1.0 + 1e-12));
        switch (j->t->state[i]) {
        case LAC_CELL_OPEN:
            assert_true(j->p[i] == 0.0 && qx == 0.0 && qy == 0.0 && sx == 0.0 && sy == 0.0);
            break;
        case LAC_CELL_STICK:
            assert_true(j->p[i] > 0.0 && sx == 0.0 && sy == 0.0);
            break;
        default:
            assert_true(hypot(qx, qy) >= limit * (1.0 - 1e-12));
            assert_true(sx * (qx / limit) + sy * (qy / limit) > 0.0);
            assert_true(fabs(sx * (qy / limit) - sy * (qx / limit)) < 1e-7 * scale);
        }
    }
    assert_true(fabs(sum[0] - j->report.traction[0]) < 1e-11 * mean_pressure(j));
    assert_true(fabs(sum[1] - j->report.traction[1]) < 1e-11 * mean_pressure(j));
}

static void every_kind_of_joint(void **state)
{
    joint *j = *state;
    const double strength = 0.6 * mean_pressure(j);
    for (int k = 0; k < 4; k++) {
        j->def.grid.periodic = k % 2 == 0;
        j->def.poisson = k < 2 ? 0.0 : 0.4;
        begin(j);
        must(j, load(j, 0.5 * strength, -0.3 * strength));
        check_coulomb(j);
        assert_true(j->report.traction[0] == 0.5 * strength);
        assert_true(j->report.stick_cells > 0 && j->report.slip_cells > 0);
        assert_true(j->report.dissipation > 0.0);
        begin(j);
        must(j, drag(j, -1e-5, 2e-5));
        check_coulomb(j);
        assert_true(j->report.shift[0] == -1e-5 && j->report.shift[1] == 2e-5);
        begin(j);
        lac_tangential_target mixed = {{LAC_SHEAR_LOAD, LAC_SHEAR_SHIFT}, {0.4 * strength, 1e-4}};
        must(j, lac_tangential_step(j->t, j->p, &mixed, &j->report, &j->err));
        check_coulomb(j);
        assert_true(j->report.traction[0] == 0.4 * strength && j->report.shift[1] == 1e-4);
    }
}

static void nothing_happens_without_a_load(void **state)
{
    joint *j = *state;
    for (int k = 0; k < 2; k++) {
        must(j, load(j, 0.0, 0.0));
        assert_int_equal(j->report.slip_cells, 0);
        assert_true(j->report.shift[0] == 0.0 && j->report.shift[1] == 0.0);
        assert_true(j->report.dissipation == 0.0 && j->report.highest_ratio == 0.0);
        must(j, drag(j, 0.0, 0.0));
        assert_true(j->report.traction[0] == 0.0 && j->report.traction[1] == 0.0);
        check_coulomb(j);
        j->def.poisson = 0.0;
        begin(j);
    }
    // and a load that stays does nothing more, though cells are at their limit
    must(j, load(j, 2e5, 0.0));
    assert_true(j->report.slip_cells > 0);
    must(j, load(j, 2e5, 0.0));
    assert_int_equal(j->report.slip_cells, 0);
    assert_true(j->report.dissipation == 0.0);
    assert_true(j->report.highest_ratio > 0.999999);
}

// Full periodic contact meets no elastic resistance on the whole: any shift slides all of it.
static void complete_contact(void **state)
{
    joint *j = *state;
    uint64_t seed = 11;
    for (size_t i = 0; i < CELLS; i++) {
        j->p[i] = 1e6 * (1.0 + 0.1 * random_of(&seed));
    }
    must(j, load(j, 1e5, 0.0)); // no cell near its limit
    assert_int_equal(j->report.stick_cells, CELLS);
    assert_true(fabs(j->report.shift[0]) < 1e-18);
    begin(j);
    must(j, drag(j, 1e-2, 0.0));
    assert_int_equal(j->report.slip_cells, CELLS);
    assert_true(fabs(j->report.traction[0] / (0.6 * mean_pressure(j)) - 1.0) < 1e-6);
    check_coulomb(j);
    j->def.grid.nx = j->def.grid.ny = 1; // and a single cell never resists
    begin(j);
    must(j, load(j, 1e5, 0.0));
    assert_true(j->report.shift[0] == 0.0);
    must(j, drag(j, 1.0, 0.0));
    assert_int_equal(j->report.slip_cells, 1);
    assert_true(fabs(j->report.traction[0] / (0.6 * j->p[0]) - 1.0) < 1e-12);
}

static void one_cell(void **state)
{
    joint *j = *state;
    j->def.grid = (lac_grid){1, 1, 0.1, 0.1, false};
    j->p[0] = 1e6;
    begin(j);
    must(j, load(j, 0.3 * j->p[0], 0.0));
    // its own compliance, with the unit side of both: 4 asinh(1) (1 - nu/2) / (pi (1-nu) E*)
    double softness = 0.1 / (3.14159265358979323846 * 0.75 * 1e9);
    double shift = 4.0 * asinh(1.0) * (1.0 - 0.125) * 0.3 * j->p[0] * softness;
    assert_true(fabs(j->report.shift[0] / shift - 1.0) < 1e-12);
    assert_true(fabs(j->report.highest_ratio - 0.5) < 1e-12);
    assert_int_equal(j->report.highest_cell, 0);
    must(j, drag(j, 0.0, -4.0 * shift));
    assert_int_equal(j->report.slip_cells, 1);
    assert_true(hypot(j->report.traction[0], j->report.traction[1]) >
                0.6 * j->p[0] * (1.0 - 1e-12));
}

static void lines(void **state)
{
    joint *j = *state;
    for (int k = 0; k < 4; k++) {
        j->def.grid =
            k < 2 ? (lac_grid){CELLS, 1, 0.1, 0.3, k == 0} : (lac_grid){1, CELLS, 0.1, 0.3, k == 2};
        begin(j);
        must(j, load(j, 1e5, 5e4));
        check_coulomb(j);
    }
}

// Pressures over 300 orders of magnitude, and friction of any size
static void extremes(void **state)
{
    joint *j = *state;
    const double scales[] = {1e-290, 1e-100, 1e100, 1e200};
    for (int k = 0; k < 4; k++) {
        double most = 0.0;
        uint64_t seed = 5;
        for (size_t i = 0; i < CELLS; i++) {
            j->p[i] = scales[k] * (random_of(&seed) + 0.1);
            most = fmax(most, j->p[i]);
        }
        begin(j);
        must(j, load(j, 0.5 * 0.6 * mean_pressure(j), 0.0));
        assert_true(j->report.slip_cells > 0);
        check_coulomb(j);
    }
    for (size_t i = 0; i < CELLS; i++) {
        j->p[i] = pow(10.0, -4.0 * (double)i);
    }
    begin(j);
    must(j, load(j, 0.5 * 0.6 * mean_pressure(j), 0.0));
    for (size_t i = 0; i < 20; i++) {
        assert_true(hypot(j->t->traction[0][i], j->t->traction[1][i]) <=
                    0.6 * j->p[i] * (1.0 + 1e-12));
    }
}

static void a_failed_step_changes_nothing(void **state)
{
    joint *j = *state;
    must(j, load(j, 1e5, 0.0));
    double q[CELLS];
    memcpy(q, j->t->traction[0], sizeof q);
    must(j, load(j, 2e5, 1e4));
    double expected = j->report.shift[0];
    begin(j);
    must(j, load(j, 1e5, 0.0));
    refused(j, load(j, 1e9, 0.0), "all cells slide");
    assert_memory_equal(q, j->t->traction[0], sizeof q);
    must(j, load(j, 2e5, 1e4));
    assert_true(j->report.shift[0] == expected);
    j->def.max_iterations = 2;
    begin(j);
    assert_int_equal(load(j, 2e5, 1e4), LAC_ENUMERIC);
    assert_non_null(strstr(j->err.message, "after 2 iterations"));
    assert_true(j->t->traction[0][1] == 0.0);
}

// The projection is the nearest point: what is left is normal to the discs, but for lambda
static void projection(void **state)
{
    (void)state;
    enum { N = 24 };
    double limit[N];
    double y[2 * N];
    double tau[2 * N];
    uint8_t limited[N];
    uint64_t seed = 17;
    for (int trial = 0; trial < 200; trial++) {
        double strength = 0.0;
        for (size_t i = 0; i < N; i++) {
            limit[i] = pow(10.0, -6.0 * random_of(&seed));
            strength += limit[i];
            y[i] = 3.0 * (random_of(&seed) - 0.5) * limit[i];
            y[N + i] = 1e2 * (random_of(&seed) - 0.5);
        }
        double part = trial < 100 ? random_of(&seed) : 1.0 - pow(10.0, -10.0 * random_of(&seed));
        double angle = 7.0 * random_of(&seed);
        lac_shear_problem p = {.n = N,
                               .limit = limit,
                               .held = {trial % 3 != 1, trial % 3 != 0},
                               .load = {part * strength * cos(angle), 0.0}};
        p.load[0] = p.held[0] ? p.load[0] : 0.0;
        p.load[1] = p.held[1] ? part * strength * sin(angle) : 0.0;
        double lambda[2] = {p.held[0] && trial % 5 == 0 ? 1e8 : 0.0, 0.0};
        lac_shear_project(&p, y, tau, limited, lambda);
        double sum[2] = {0.0, 0.0};
        for (size_t i = 0; i < N; i++) {
            double rx = y[i] + lambda[0] - tau[i];
            double ry = y[N + i] + lambda[1] - tau[N + i];
            double size = hypot(y[i] + lambda[0], y[N + i] + lambda[1]);
            sum[0] += tau[i];
            sum[1] += tau[N + i];
            assert_true(hypot(tau[i], tau[N + i]) <= limit[i] * (1.0 + 1e-15));
            assert_true(limited[i] || (fabs(rx) <= 1e-15 * size && fabs(ry) <= 1e-15 * size));
            assert_true(fabs(rx * tau[N + i] - ry * tau[i]) <= 1e-14 * size * limit[i]);
        }
        assert_true(!p.held[0] || fabs(sum[0] - p.load[0]) < 1e-13 * strength);
        assert_true(!p.held[1] || fabs(sum[1] - p.load[1]) < 1e-13 * strength);
    }
}

// Two cells far from equal: they pull alike, so that the one pressed less slips first.
static void first_of_two_slips(void **state)
{
    joint *j = *state;
    j->def.grid.periodic = false;
    memset(j->p, 0, sizeof j->p);
    j->p[9] = 3e5;
    j->p[50] = 1e5;
    must(j, lac_tangential_first_slip(&j->def, j->p, (double[]){0.0, -2.0}, &j->first, &j->err));
    assert_int_equal(j->first.cell, 50);
    assert_true(fabs(j->first.factor - 0.5) < 1e-8); // both carry 0.6e5 of 0.6 (3e5 + 1e5)
    assert_true(j->first.shift[1] < 0.0);
    // just below nothing slips, just above that cell does
    must(j, load(j, 0.0, -0.999999 * j->first.load));
    assert_int_equal(j->report.slip_cells, 0);
    assert_int_equal(j->report.highest_cell, 50);
    must(j, load(j, 0.0, -1.001 * j->first.load));
    assert_int_equal(j->report.slip_cells, 1);
    assert_int_equal(j->t->state[50], LAC_CELL_SLIP);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_modulus_beyond_numbers_is_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(wrong_steps_are_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(every_kind_of_joint, set_up, tear_down),
        cmocka_unit_test_setup_teardown(nothing_happens_without_a_load, set_up, tear_down),
        cmocka_unit_test_setup_teardown(complete_contact, set_up, tear_down),
        cmocka_unit_test_setup_teardown(one_cell, set_up, tear_down),
        cmocka_unit_test_setup_teardown(lines, set_up, tear_down),
        cmocka_unit_test_setup_teardown(extremes, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_failed_step_changes_nothing, set_up, tear_down),
        cmocka_unit_test_setup_teardown(projection, set_up, tear_down),
        cmocka_unit_test_setup_teardown(first_of_two_slips, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
