// SPDX-License-Identifier: GPL-3.0-or-later
// Slip in two directions: that along x alone, whichever way the axes lie; and under loads that
// turn, against closed forms; docs/theory/vector.md.
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/fail.h"
#include "lacuna/case.h"
#include "lacuna/simulation.h"
#include "support/test.h"

static double failed_at; // of the last run [s]; NaN: it did not fail

// A case with some keys set otherwise, run into memory.
static lac_dataset *run(const char *text, const lac_override *set, size_t count)
{
    lac_case *c = NULL;
    lac_simulation *simulation = NULL;
    lac_dataset *out = NULL;
    lac_error err = {""};
    lac_status status;
    lac_case_options how = lac_case_options_default();
    how.overrides = set;
    how.count = count;
    LAC_TRY(lac_case_parse("two-directions", text, strlen(text), &how, &c, &err));
    LAC_TRY(lac_simulation_create(c, NULL, &simulation, &err));
    status = lac_simulation_record(simulation, &out, &err);
    failed_at = lac_simulation_result(simulation)->failure_origin +
                lac_simulation_result(simulation)->failure_local;
out:
    if (status != LAC_OK) {
        fail_msg("%s", err.message);
    }
    lac_simulation_free(simulation);
    lac_case_free(c);
    return out;
}

static const double *values(const lac_dataset *of, const char *name)
{
    const double *array = lac_dataset_array(of, name);
    if (array == NULL) {
        fail_msg("no variable %s", name);
    }
    return array;
}

static void is_near(const char *what, double value, double expected, double scale, double error)
{
    if (!(fabs(value - expected) <= error * scale)) {
        fail_msg("%s: %.17g is not %.17g", what, value, expected);
    }
}

// A lacunar joint, damped, with a spread of dc, creeping to failure from 1e-12 m/s.
static const char joint[] =
    "{lacuna: 1, interface: {size: 1 m, levels: 4, domain: {cascade: {dimension: 1.6, seed: 3}}, "
    "spread: {pressure: {lognormal: {sigma: 0.5, seed: 4}}}}, "
    "material: {shear_modulus: 10 GPa, shear_speed: 3 km/s}, "
    "load: {normal: {pressure: 3 MPa}, shear: [{ramp: {rate: 1 Pa/s}}]}, "
    "friction: {aging: {f0: 0.6, a: 0.01, b: 0.015, dc: 10 um, v0: 1 um/s, form: regularised}}, "
    "initial: {slip_rate: 1e-12 m/s, state: {ratio_to_steady: 1}}, "
    "transfer: {hierarchy: {k0: 10 GPa/m}}, time: {end: 100 day}, "
    "solver: {formulation: slip}, output: {every: {time: 6 hour, steps: 1}, fields: [slip, "
    "slip_rate, traction, state], points: "
    "[{name: A, x: 30 cm, y: 20 cm, radius: 25 cm}]}}";

// All that a run along x has, a run in two directions has too: with loads along x the same steps,
// and the same numbers but for rounding. Cells that weaken magnify that as they magnify all that
// they differ by: the times of all steps, and the first half, keep ten digits, the last e-folds
// six.
static void loads_along_x_make_slip_along_x(void **state)
{
    static const char *const names[] = {"time",           "slip",          "slip_rate",
                                        "max_slip_rate",  "shear_force",   "cell_slip",
                                        "cell_slip_rate", "cell_traction", "cell_state"};
    const lac_override vector[] = {{"interface.slip", "vector"}, {"solver.formulation", "auto"}};
    (void)state;
    lac_dataset *one = run(joint, NULL, 0);
    assert_true(isfinite(failed_at));
    lac_dataset *two = run(joint, vector, 2);
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        const size_t n = lac_dataset_count(one, names[k]);
        const double *a = values(one, names[k]), *b = values(two, names[k]);
        assert_int_equal(n, lac_dataset_count(two, names[k]));
        for (size_t i = 0; i < n; i++) {
            is_near(names[k], b[i], a[i], fabs(a[i]), k == 0 || 2 * i < n ? 1e-10 : 1e-6);
        }
    }
    const double *across = values(two, "slip_y");
    for (size_t i = 0; i < lac_dataset_count(two, "slip_y"); i++) {
        assert_true(across[i] == 0.0);
    }
    lac_dataset_free(one);
    lac_dataset_free(two);
}

// What is told of a point has components too.
static void points_turn_too(const lac_dataset *of, double way)
{
    static const char *const names[][3] = {
        {"point_slip", "point_slip_x", "point_slip_y"},
        {"point_slip_rate", "point_slip_rate_x", "point_slip_rate_y"},
        {"point_traction", "point_traction_x", "point_traction_y"}};
    for (size_t k = 0; k < 3; k++) {
        const double *size = values(of, names[k][0]);
        const double *x = values(of, names[k][1]), *y = values(of, names[k][2]);
        for (size_t i = 0; i < lac_dataset_count(of, names[k][0]); i++) {
            is_near(names[k][1], x[i], size[i] * cos(way), size[i], 1e-9);
            is_near(names[k][2], y[i], size[i] * sin(way), size[i], 1e-9);
        }
    }
}

// Loads that pull another way move the same joint that way, over some thirty decades of rate too,
// where what ties the cells knows no direction.
static void the_axes_do_not_matter(void **state)
{
    static const char *const azimuths[] = {"30 degree", "90 degree", "-160 degree"};
    static const char *const rates[] = {"1e-12 m/s", "1e-30 m/s"};
    (void)state;
    for (size_t k = 0; k < 6; k++) {
        const double way = strtod(azimuths[k / 2], NULL) * M_PI / 180.0;
        const lac_override along[] = {{"initial.slip_rate", rates[k % 2]},
                                      {"load.shear.0.ramp.rate", "100 Pa/s"}};
        const lac_override turned[] = {along[0],
                                       along[1],
                                       {"interface.slip", "vector"},
                                       {"solver.formulation", "auto"},
                                       {"initial.azimuth", azimuths[k / 2]},
                                       {"load.shear.0.ramp.azimuth", azimuths[k / 2]}};
        lac_dataset *one = run(joint, along, 2);
        const double failure = failed_at;
        assert_true(isfinite(failure));
        lac_dataset *two = run(joint, turned, 6);
        is_near("time of failure", failed_at, failure, failure, 1e-8);
        const double *x = values(two, "cell_slip_rate_x"), *y = values(two, "cell_slip_rate_y");
        const double *v = values(two, "cell_slip_rate");
        for (size_t i = 0; i < lac_dataset_count(two, "cell_slip_rate"); i++) {
            is_near("along x", x[i], v[i] * cos(way), v[i], 1e-9);
            is_near("along y", y[i], v[i] * sin(way), v[i], 1e-9);
        }
        points_turn_too(two, way);
        lac_dataset_free(one);
        lac_dataset_free(two);
    }
}

// Friction that is steady at every rate under a stress of constant size that turns: the block
// slides at a constant rate along it, v e^{i w t}, so that its path is a circle:
// slip = v/(i w) (e^{i w t} - 1). At 1e-28 m/s and at 0.01. Slip far below dc counts for nothing:
// there its error is held to rtol dc.
static void a_stress_that_turns_leads_round_a_circle(void **state)
{
    static const char block[] =
        "{lacuna: 1, load: {normal: {pressure: 1 MPa}, shear: ["
        "{sine: {amplitude: 0.6 MPa, period: 1000 s, phase: 90 degree}}, "
        "{sine: {amplitude: 0.6 MPa, period: 1000 s, azimuth: 90 degree}}]}, "
        "interface: {slip: vector}, time: {end: 1500 s}, solver: {rtol: 1e-9}, "
        "friction: {aging: {f0: 0.6, a: 0.015, b: 0.01, dc: 10 um, v0: 1 um/s}}}";
    static const char *const rates[] = {"1e-28 m/s", "0.01 m/s"};
    (void)state;
    for (size_t k = 0; k < 4; k++) {
        const double v = strtod(rates[k / 2], NULL), w = 2.0 * M_PI / 1000.0;
        const lac_override set[] = {{"friction.aging.v0", rates[k / 2]},
                                    {"friction.aging.form", k % 2 == 0 ? "plain" : "regularised"}};
        lac_dataset *of = run(block, set, 2);
        const double *t = values(of, "time");
        const double *x = values(of, "slip_x"), *y = values(of, "slip_y");
        const double *vx = values(of, "slip_rate_x"), *vy = values(of, "slip_rate_y");
        const double *q = values(of, "shear_force_y");
        for (size_t i = 0; i < lac_dataset_count(of, "time"); i++) {
            const double complex turned = cexp(I * w * t[i]);
            const double complex slip = v / (I * w) * (turned - 1.0);
            is_near("slip along x", x[i], creal(slip), v / w + 1e-8, 1e-6);
            is_near("slip along y", y[i], cimag(slip), v / w + 1e-8, 1e-6);
            is_near("rate along x", vx[i], v * creal(turned), v, 1e-6);
            is_near("rate along y", vy[i], v * cimag(turned), v, 1e-6);
            is_near("Q along y", q[i], 0.6e6 * cimag(turned), 0.6e6, 1e-9);
        }
        lac_dataset_free(of);
    }
}

// At slip rates far below the regularisation friction is viscous, p a v/(2 v0) for f0 = 0. Held by
// a spring under a stress A e^{i w t}: eta dz/dt + k z = A e^{i w t}, so that
// z = A (e^{i w t} - e^{-k t/eta})/(k + i w eta).
static void viscous_friction_follows_a_stress_that_turns(void **state)
{
    static const char block[] =
        "{lacuna: 1, load: {normal: {pressure: 1 MPa}, shear: ["
        "{sine: {amplitude: 1 Pa, period: 1000 s, phase: 90 degree}}, "
        "{sine: {amplitude: 1 Pa, period: 1000 s, azimuth: 90 degree}}, "
        "{spring: {stiffness: 1 kPa/m, speed: 0 m/s}}]}, "
        "interface: {slip: vector}, time: {end: 3000 s}, solver: {rtol: 1e-9}, "
        "friction: {aging: {f0: 0, a: 0.4, b: 0, dc: 1 mm, v0: 1 m/s, form: regularised}}}";
    const double eta = 1e6 * 0.4 / 2.0, k = 1e3, stress = 1.0, w = 2.0 * M_PI / 1000.0;
    (void)state;
    lac_dataset *of = run(block, NULL, 0);
    const double *t = values(of, "time");
    const double *x = values(of, "slip_x"), *y = values(of, "slip_y");
    for (size_t i = 0; i < lac_dataset_count(of, "time"); i++) {
        const double complex z =
            stress * (cexp(I * w * t[i]) - exp(-k * t[i] / eta)) / (k + I * w * eta);
        is_near("slip along x", x[i], creal(z), stress / k, 1e-6);
        is_near("slip along y", y[i], cimag(z), stress / k, 1e-6);
    }
    lac_dataset_free(of);
}

// Friction of all but constant size (a = 1e-6): a block that a spring of stiffness k drags along y,
// stretched along x at first, stays f p/k behind the spring's far end and slides towards it: the
// curve of a dog on its lead (tractrix). The angle between the spring and y falls as
// tan(angle/2) = tan(45 degree) e^{-V t k/(f p)}, the far end at (f p/k, V t).
static void a_block_on_a_lead_follows_the_tractrix(void **state)
{
    static const char block[] =
        "{lacuna: 1, load: {normal: {pressure: 1 MPa}, shear: ["
        "{spring: {stiffness: 10 MPa/m, speed: 1 um/s, azimuth: 90 degree}}]}, "
        "interface: {slip: vector}, initial: {slip_rate: 1e-9 m/s, state: steady}, "
        "time: {end: 2 day}, solver: {rtol: 1e-8}, "
        "friction: {aging: {f0: 0.6, a: 1e-6, b: 0, dc: 1 mm, v0: 1 um/s, form: regularised}}}";
    const double lead = 0.6e6 / 1e7, speed = 1e-6;
    (void)state;
    lac_dataset *of = run(block, NULL, 0);
    const size_t n = lac_dataset_count(of, "time");
    const double *t = values(of, "time");
    const double *x = values(of, "slip_x"), *y = values(of, "slip_y");
    const double *q = values(of, "shear_force_x");
    for (size_t i = 0; i < n; i++) {
        const double angle = 2.0 * atan(exp(-speed * t[i] / lead));
        is_near("slip along x", x[i], lead * (1.0 - sin(angle)), lead, 1e-4);
        is_near("slip along y", y[i], speed * t[i] - lead * cos(angle), lead, 1e-4);
        is_near("Q along x", q[i], 0.6e6 * sin(angle), 0.6e6, 1e-4);
    }
    assert_true(speed * t[n - 1] > 2.0 * lead && y[n - 1] > lead);
    lac_dataset_free(of);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loads_along_x_make_slip_along_x),
        cmocka_unit_test(the_axes_do_not_matter),
        cmocka_unit_test(a_stress_that_turns_leads_round_a_circle),
        cmocka_unit_test(viscous_friction_follows_a_stress_that_turns),
        cmocka_unit_test(a_block_on_a_lead_follows_the_tractrix),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
