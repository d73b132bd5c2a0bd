// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/tangential_state.h"
#include "lacuna/contact.h"

// Ciavarella (1998), Jaeger (1998): under a load Q that grows along one direction while P is held,
//   q = f [p(P) - p(P - Q/f)],   stick where p(P - Q/f) > 0.
// With nu = 0 shear displaces as pressure does: u = f [S p(P) - S p(P')] with S p = h + g - a, a
// the approach, so that the shift is f (a(P') - a(P)) and a cell slips by f g(P'). Otherwise both
// times (1 - nu/2)/(1 - nu), the mean of the compliances along and across the load.

static double factor_of(const lac_tangential_def *def)
{
    return def->friction * (1.0 - 0.5 * def->poisson) / (1.0 - def->poisson);
}

// Pressures, gaps and approach under a load, from the pressures that are there
static lac_status press(const lac_tangential_def *def, double load, double *pressure, double *gap,
                        lac_contact_report *report, lac_error *err)
{
    lac_contact_def normal = lac_contact_default();
    normal.grid = def->grid;
    normal.heights = def->heights;
    normal.e_star = def->e_star;
    normal.mean_pressure = load;
    normal.start = pressure;
    normal.tolerance = def->tolerance;
    normal.max_iterations = def->max_iterations;
    lac_status status = lac_contact_solve(&normal, pressure, gap, report, err);
    return status == LAC_OK ? status : lac_fail_within(err, status, "superposed shear");
}

// No load at all: the bodies touch at the highest peak, undeformed.
static void just_touch(const lac_tangential_def *def, double *pressure, double *gap,
                       lac_contact_report *report)
{
    const size_t cells = lac_grid_cells(&def->grid);
    double mean = 0.0;
    double highest = -INFINITY;
    for (size_t i = 0; i < cells; i++) {
        mean += def->heights[i] / (double)cells;
        highest = fmax(highest, def->heights[i]);
    }
    for (size_t i = 0; i < cells; i++) {
        pressure[i] = 0.0;
        gap[i] = highest - def->heights[i];
    }
    *report = (lac_contact_report){.approach = highest - mean};
}

static lac_status check_def(const lac_tangential *t, lac_error *err)
{
    if (t->def.heights == NULL) {
        return lac_fail(err, LAC_EINPUT, "superposed shear needs the heights of the joint");
    }
    return LAC_OK;
}

// The first step: keeps its pressures, which must be those of the heights.
static lac_status begin(lac_tangential *t, const double *pressure, const lac_pressed *pressed,
                        lac_error *err)
{
    const size_t cells = lac_grid_cells(&t->def.grid);
    lac_superposed *s = &t->superposed;
    lac_contact_report report;
    lac_status status;
    double *kept = malloc(cells * sizeof *kept);
    s->reduced = s->reduced != NULL ? s->reduced : malloc(cells * sizeof *s->reduced);
    s->gap = s->gap != NULL ? s->gap : malloc(cells * sizeof *s->gap);
    status = kept != NULL && s->reduced != NULL && s->gap != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    memcpy(s->reduced, pressure, cells * sizeof *pressure);
    memcpy(kept, pressure, cells * sizeof *pressure);
    LAC_TRY(press(&t->def, pressed->mean, s->reduced, s->gap, &report, err));
    double most = 0.0;
    for (size_t i = 0; i < cells; i++) {
        most = fmax(most, fabs(s->reduced[i] - pressure[i]));
    }
    if (most > 1e-3 * pressed->most) {
        status = lac_fail(err, LAC_EINPUT,
                          "superposed shear needs the pressures of its own heights: they differ by "
                          "%g Pa under a mean of %g Pa",
                          most, pressed->mean);
        goto out;
    }
    s->approach = report.approach;
    s->pressure = kept;
    kept = NULL;
out:
    free(kept);
    return status;
}

static lac_status check_pressures(const lac_superposed *s, const double *pressure, size_t cells,
                                  double most, lac_error *err)
{
    for (size_t i = 0; i < cells; i++) {
        if (fabs(pressure[i] - s->pressure[i]) > 1e-9 * most) {
            return lac_fail(err, LAC_EINPUT,
                            "superposed shear holds under constant pressures only, and that of "
                            "cell %zu went from %g to %g Pa: take the direct method",
                            i, s->pressure[i], pressure[i]);
        }
    }
    return LAC_OK;
}

// The load may only grow, along one direction, up to f P.
static lac_status check_load(const lac_tangential *t, const lac_tangential_target *target,
                             double mean_pressure, double *load, lac_error *err)
{
    const lac_superposed *s = &t->superposed;
    if (target->control[0] != LAC_SHEAR_LOAD || target->control[1] != LAC_SHEAR_LOAD) {
        return lac_fail(err, LAC_EINPUT,
                        "superposed shear follows loads, not shifts: take the direct method");
    }
    const double *q = target->value;
    const double *d = s->direction;
    double strength = t->def.friction * mean_pressure;
    *load = hypot(q[0], q[1]);
    if (*load > strength * (1.0 + 1e-12)) {
        return lac_fail(err, LAC_EINPUT,
                        "a shear load of %.10g Pa is more than the friction f p = %g x %.10g = "
                        "%.10g Pa holds",
                        *load, t->def.friction, mean_pressure, strength);
    }
    double across = fabs(q[0] * d[1] - q[1] * d[0]);
    double along = d[0] == 0.0 && d[1] == 0.0 ? *load : q[0] * d[0] + q[1] * d[1];
    if (across > 1e-9 * strength || along < s->load - 1e-12 * strength) {
        return lac_fail(err, LAC_EINPUT,
                        "superposed shear follows a load that grows along one direction only, not "
                        "from %g to (%g, %g) Pa: take the direct method",
                        s->load, q[0], q[1]);
    }
    return LAC_OK;
}

static lac_status reduce(lac_tangential *t, double load, double mean_pressure,
                         lac_contact_report *report, lac_error *err)
{
    lac_superposed *s = &t->superposed;
    const size_t cells = lac_grid_cells(&t->def.grid);
    double left = mean_pressure - load / t->def.friction;
    if (!(left > 1e-12 * mean_pressure)) {
        just_touch(&t->def, s->reduced, s->gap, report);
        return LAC_OK;
    }
    memcpy(s->reduced, s->pressure, cells * sizeof *s->pressure);
    return press(&t->def, left, s->reduced, s->gap, report, err);
}

static void keep(lac_tangential *t, const double direction[2], lac_tangential_report *report)
{
    const lac_superposed *s = &t->superposed;
    const size_t cells = lac_grid_cells(&t->def.grid);
    const double area = lac_grid_cell_area(&t->def.grid);
    const double factor = factor_of(&t->def);
    for (size_t i = 0; i < cells; i++) {
        bool open = s->pressure[i] == 0.0;
        // rounding may leave a little more than there was
        double part = open ? 0.0 : fmax(0.0, 1.0 - s->reduced[i] / s->pressure[i]);
        bool sticks = s->reduced[i] > 0.0;
        lac_cell_state state = open ? LAC_CELL_OPEN : sticks ? LAC_CELL_STICK : LAC_CELL_SLIP;
        double slip = state == LAC_CELL_SLIP ? factor * fmax(0.0, s->gap[i]) : 0.0;
        t->state[i] = (uint8_t)state;
        for (size_t axis = 0; axis < 2; axis++) {
            double *was = &t->slip[axis * cells + i];
            double tau = t->def.friction * s->pressure[i] * part * direction[axis];
            t->tau[axis * cells + i] = tau;
            report->traction[axis] += tau / (double)cells;
            report->dissipation += area * tau * (slip * direction[axis] - *was);
            *was = slip * direction[axis];
        }
        if (!open) {
            lac_tangential_count(report, state, part, i);
        }
    }
}

lac_status lac_superposed_step(lac_tangential *t, const double *pressure,
                               const lac_pressed *pressed, const lac_tangential_target *target,
                               lac_tangential_report *report, lac_error *err)
{
    lac_superposed *s = &t->superposed;
    lac_contact_report normal;
    lac_status status;
    double load = 0.0;
    const bool first = s->pressure == NULL;
    LAC_TRY(check_def(t, err));
    LAC_TRY(check_load(t, target, pressed->mean, &load, err));
    if (first) {
        LAC_TRY(begin(t, pressure, pressed, err));
    }
    LAC_TRY(check_pressures(s, pressure, lac_grid_cells(&t->def.grid), pressed->most, err));
    LAC_TRY(reduce(t, load, pressed->mean, &normal, err));
    double direction[2] = {s->direction[0], s->direction[1]};
    if (load > 0.0) {
        direction[0] = target->value[0] / load;
        direction[1] = target->value[1] / load;
    }
    keep(t, direction, report);
    s->load = load;
    for (int axis = 0; axis < 2; axis++) {
        s->direction[axis] = direction[axis];
        double shift = factor_of(&t->def) * (normal.approach - s->approach);
        t->shift[axis] = shift * direction[axis];
        report->shift[axis] = t->shift[axis];
    }
    // Tractions are the difference of two solutions: the less the load, the more of it is error.
    double part = load / (t->def.friction * pressed->mean);
    double error = fmax(normal.complementarity_error, normal.load_error);
    report->residual = part > 0.0 ? error / part : 0.0;
    report->iterations = normal.iterations;
    report->products = normal.products;
out:
    if (status != LAC_OK && first) {
        free(s->pressure);
        s->pressure = NULL;
    }
    return status;
}
