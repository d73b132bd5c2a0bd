// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/sheared.h"

#include <stdlib.h>

#include "support/benchmark_surface.h"
#include "support/test.h"

void start_again(sheared *s)
{
    lac_tangential_free(s->t);
    if (lac_tangential_create(&s->def, &s->t, &s->err) != LAC_OK) {
        fail_msg("%s", s->err.message);
    }
}

void press(sheared *s, double mean_pressure)
{
    s->normal.mean_pressure = mean_pressure;
    if (lac_contact_solve(&s->normal, s->p, NULL, &s->contact, &s->err) != LAC_OK) {
        fail_msg("%s", s->err.message);
    }
}

static sheared make(size_t n, bool periodic, double poisson, double friction)
{
    sheared s = {.n = n, .normal = lac_contact_default(), .def = lac_tangential_default()};
    s.h = calloc(2 * n * n, sizeof *s.h);
    assert_non_null(s.h);
    s.p = s.h + n * n;
    s.normal.grid = (lac_grid){n, n, 1.0 / (double)n, 1.0 / (double)n, periodic};
    s.normal.heights = s.h;
    s.normal.e_star = 1.0;
    s.normal.tolerance = 1e-11;
    s.def.grid = s.normal.grid;
    s.def.e_star = 1.0;
    s.def.poisson = poisson;
    s.def.friction = friction;
    s.def.tolerance = 1e-9;
    start_again(&s);
    return s;
}

sheared sphere_of(size_t n, double a, double poisson, double friction)
{
    sheared s = make(n, false, poisson, friction);
    for (size_t i = 0; i < n * n; i++) {
        double x = ((double)(i % n) - 0.5 * (double)n) / (double)n;
        double y = ((double)(i / n) - 0.5 * (double)n) / (double)n;
        s.h[i] = -0.5 * (x * x + y * y);
    }
    press(&s, 4.0 / 3.0 * a * a * a);
    return s;
}

sheared rough_of(size_t n, bool periodic, double poisson, double friction)
{
    sheared s = make(n, periodic, poisson, friction);
    assert_int_equal(benchmark_surface(n, s.h), 0);
    press(&s, 4.9e-3);
    return s;
}

static lac_tangential_stats go(sheared *s, const lac_tangential_target *target)
{
    lac_tangential_stats report;
    if (lac_tangential_step(s->t, s->p, target, &report, &s->err) != LAC_OK) {
        fail_msg("%s", s->err.message);
    }
    return report;
}

lac_tangential_stats shear(sheared *s, double qx, double qy)
{
    return go(s, &(lac_tangential_target){{LAC_SHEAR_LOAD, LAC_SHEAR_LOAD}, {qx, qy}});
}

lac_tangential_stats drag(sheared *s, double ux, double uy)
{
    return go(s, &(lac_tangential_target){{LAC_SHEAR_SHIFT, LAC_SHEAR_SHIFT}, {ux, uy}});
}

void release(sheared *s)
{
    lac_tangential_free(s->t);
    free(s->h);
}
