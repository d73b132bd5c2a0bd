// SPDX-License-Identifier: GPL-3.0-or-later
// A joint sheared step by step under Coulomb friction: each step starts from what the last left.
#include "contact/tangential.h"

#include "contact/solve.h"
#include "contact/tangential_solve.h"

// One step on the contact cells, in tractions of order one.
typedef struct step {
    lac_shear_problem p;
    double unit; // of tractions, a power of two [Pa]
    uint32_t *cell;
    double *work; // limit, before, tau, u
    uint8_t *limited;
} step;

// The pressures of a contact: how many press, their mean and the highest.
typedef struct pressure_sums {
    size_t n;
    double mean, most;
} pressure_sums;

lac_tangential_def lac_tangential_default(void)
{
    return (lac_tangential_def){.tolerance = 1e-8, .max_iterations = 2000};
}

// Displacements in the unit of lac_shear_space to metres [m/Pa].
static double softness_of(const lac_tangential_def *def)
{
    const lac_grid *grid = &def->grid;
    double length = fmax((double)grid->nx * grid->dx, (double)grid->ny * grid->dy);
    return length / (M_PI * (1.0 - def->poisson) * def->e_star);
}

// A modulus may vanish in the numbers.
static lac_status check(const lac_tangential_def *def, lac_error *err)
{
    const double softness = softness_of(def);
    LAC_FAIL_IF(!(softness > 0.0 && isfinite(softness)), err, LAC_EINPUT,
                "cells of %g x %g m of a modulus of %g Pa are beyond numbers", def->grid.dx,
                def->grid.dy, def->e_star);
    return LAC_OK;
}

lac_status lac_tangential_create(const lac_tangential_def *def, lac_tangential **out,
                                 lac_error *err)
{
    lac_status status;
    *out = NULL;
    LAC_TRY_RETURN(check(def, err));
    lac_tangential *t = *out = calloc(1, sizeof *t);
    LAC_FAIL_MEMORY_IF(t == NULL, err);
    const size_t cells = lac_grid_cells(&def->grid);
    t->def = *def;
    t->softness = softness_of(def);
    t->traction[0] = calloc(6 * cells, sizeof *t->traction[0]);
    t->state = calloc(cells, sizeof *t->state);
    LAC_TRY(t->traction[0] != NULL && t->state != NULL ? LAC_OK : lac_fail_memory(err));
    t->traction[1] = t->traction[0] + cells;
    for (size_t axis = 0; axis < 2; axis++) {
        t->slip[axis] = t->traction[axis] + 2 * cells;
        t->u[axis] = t->slip[axis] + 2 * cells;
    }
    LAC_TRY(lac_shear_space_create(&def->grid, def->poisson, &t->space, err));
out:
    LAC_MADE(status, out, lac_tangential_free);
}

void lac_tangential_free(lac_tangential *t)
{
    if (t == NULL) {
        return;
    }
    lac_shear_space_free(t->space);
    free(t->traction[0]);
    free(t->state);
    free(t);
}

static lac_status check_pressure(const lac_tangential_def *def, const double *pressure,
                                 pressure_sums *pressed, lac_error *err)
{
    const size_t cells = lac_grid_cells(&def->grid);
    *pressed = (pressure_sums){0};
    for (size_t i = 0; i < cells; i++) {
        pressed->n += pressure[i] > 0.0 ? 1 : 0;
        pressed->mean += pressure[i] / (double)cells;
        pressed->most = fmax(pressed->most, pressure[i]);
    }
    LAC_FAIL_IF(pressed->n == 0, err, LAC_EINPUT,
                "no cell is in contact: there is nothing to shear");
    double strength = def->friction * pressed->most;
    LAC_FAIL_IF(!(strength >= DBL_MIN && strength <= 1e-4 * DBL_MAX / (double)cells), err,
                LAC_EINPUT, "a friction of %g times %g Pa is beyond numbers", def->friction,
                pressed->most);
    return LAC_OK;
}

// Friction must hold the load: at |Q| = f P already all slide, any shift does.
static lac_status check_strength(const lac_tangential_def *def, const lac_tangential_target *target,
                                 double mean_pressure, lac_error *err)
{
    double load = 0.0;
    for (int axis = 0; axis < 2; axis++) {
        if (target->control[axis] == LAC_SHEAR_LOAD) {
            load = hypot(load, target->value[axis]);
        }
    }
    double strength = def->friction * mean_pressure;
    LAC_FAIL_IF(load > 0.0 && !(load < strength * (1.0 - 1e-12)), err, LAC_EINPUT,
                "a shear load of %.10g Pa is not below the friction f p = %g x %.10g = %.10g Pa: "
                "all cells slide, and only a given shift says how far",
                load, def->friction, mean_pressure, strength);
    return LAC_OK;
}

static void clear_step(step *s)
{
    free(s->cell);
    free(s->work);
    free(s->limited);
}

// Room for n cells, to be cleared whatever the status.
static lac_status create_step(step *s, size_t n, lac_error *err)
{
    s->p.n = n;
    s->cell = malloc((n + 1) * sizeof *s->cell); // an empty contact has no cells
    s->work = calloc(7 * n + 1, sizeof *s->work);
    s->limited = calloc(n + 1, sizeof *s->limited);
    LAC_FAIL_MEMORY_IF(s->cell == NULL || s->work == NULL || s->limited == NULL, err);
    s->p.cell = s->cell;
    s->p.limit = s->work;
    s->p.before = s->work + n;
    s->p.tau = s->work + 3 * n;
    s->p.u = s->work + 5 * n;
    s->p.limited = s->limited;
    return LAC_OK;
}

// Contact cells, their limits and what they remember, in units of s->unit
static void fill_step(const lac_tangential *t, const double *pressure, double most, step *s)
{
    const size_t cells = lac_grid_cells(&t->def.grid);
    const size_t n = s->p.n;
    int exponent;
    (void)frexp(t->def.friction * most, &exponent);
    s->unit = ldexp(1.0, exponent);
    double *limit = s->work, *before = limit + n;
    double *tau = before + 2 * n;
    size_t k = 0;
    for (size_t i = 0; i < cells; i++) {
        if (pressure[i] > 0.0) {
            s->cell[k] = (uint32_t)i;
            // so far below the rest that it makes no difference, but still to be divided by
            limit[k] = fmax(t->def.friction * (pressure[i] / s->unit), 1e-150);
            for (size_t axis = 0; axis < 2; axis++) {
                before[axis * n + k] = t->u[axis][i] / s->unit;
                tau[axis * n + k] = t->traction[axis][i] / s->unit;
            }
            k++;
        }
    }
}

static lac_status fill_target(lac_tangential *t, const lac_tangential_target *target, step *s,
                              lac_error *err)
{
    const double cells = (double)lac_grid_cells(&t->def.grid);
    s->p.space = t->space;
    s->p.tolerance = t->def.tolerance;
    s->p.max_iterations = t->def.max_iterations;
    for (int axis = 0; axis < 2; axis++) {
        bool held = target->control[axis] == LAC_SHEAR_LOAD;
        s->p.held[axis] = held;
        s->p.load[axis] = held ? target->value[axis] / s->unit * cells : 0.0;
        s->p.shift[axis] =
            held ? 0.0 : (target->value[axis] - t->shift[axis]) / t->softness / s->unit;
        LAC_FAIL_IF(!isfinite(s->p.shift[axis] * s->p.shift[axis]), err, LAC_EINPUT,
                    "a shift of %g m is beyond numbers", target->value[axis]);
    }
    return LAC_OK;
}

static void take_displacements(lac_tangential *t, double unit)
{
    const size_t nx = t->def.grid.nx, ny = t->def.grid.ny;
    for (size_t axis = 0; axis < 2; axis++) {
        const lac_fft *fft = t->space->fft[axis];
        for (size_t j = 0; j < ny; j++) {
            for (size_t i = 0; i < nx; i++) {
                t->u[axis][j * nx + i] = fft->real[j * fft->nx + i] * unit;
            }
        }
    }
}

// Slip of this step [m] and state of contact cell k. It slips where friction is at its limit and
// the slip along it is more than what no slip is held to.
static lac_cell_state slip_of(const lac_tangential *t, const step *s, size_t k, double slip[2])
{
    const lac_shear_problem *p = &s->p;
    double along = 0.0;
    for (size_t axis = 0; axis < 2; axis++) {
        size_t at = axis * p->n + k;
        slip[axis] = p->shift[axis] - (p->u[at] - p->before[at]);
        along += slip[axis] * (p->tau[at] / p->limit[k]);
        slip[axis] *= s->unit * t->softness;
    }
    return p->limited[k] && along > p->tolerance * p->scale ? LAC_CELL_SLIP : LAC_CELL_STICK;
}

// Counts a contact cell in a report whose highest_ratio was -1 before the first.
static void count_cell(lac_tangential_stats *report, lac_cell_state state, double ratio,
                       size_t cell)
{
    report->contact_cells++;
    report->slip_cells += state == LAC_CELL_SLIP ? 1 : 0;
    report->stick_cells += state == LAC_CELL_STICK ? 1 : 0;
    if (state == LAC_CELL_STICK && ratio > report->highest_ratio) {
        report->highest_ratio = ratio;
        report->highest_cell = cell;
    }
}

// Everything of a step that has converged into the memory
static void keep_step(lac_tangential *t, const step *s, lac_tangential_stats *report)
{
    const size_t cells = lac_grid_cells(&t->def.grid);
    const lac_shear_problem *p = &s->p;
    const double area = lac_grid_cell_area(&t->def.grid);
    size_t k = 0;
    for (size_t i = 0; i < cells; i++) {
        if (k == p->n || s->cell[k] != i) {
            t->state[i] = LAC_CELL_OPEN;
            t->traction[0][i] = t->traction[1][i] = 0.0;
            t->slip[0][i] = t->slip[1][i] = 0.0;
            continue;
        }
        double slip[2];
        lac_cell_state state = slip_of(t, s, k, slip);
        t->state[i] = (uint8_t)state;
        for (size_t axis = 0; axis < 2; axis++) {
            double tau = p->tau[axis * p->n + k] * s->unit;
            double moved = state == LAC_CELL_SLIP ? slip[axis] : 0.0;
            t->traction[axis][i] = tau;
            t->slip[axis][i] += moved;
            report->traction[axis] += tau / (double)cells;
            report->dissipation += area * tau * moved;
        }
        count_cell(report, state, hypot(p->tau[k], p->tau[p->n + k]) / p->limit[k], i);
        k++;
    }
}

static void keep_shift(lac_tangential *t, const step *s, const lac_tangential_target *target,
                       lac_tangential_stats *report)
{
    for (int axis = 0; axis < 2; axis++) {
        if (s->p.held[axis]) {
            t->shift[axis] += s->p.shift[axis] * s->unit * t->softness;
            report->traction[axis] = target->value[axis];
        } else {
            t->shift[axis] = target->value[axis];
        }
        report->shift[axis] = t->shift[axis];
    }
}

static lac_status check_converged(const lac_shear_problem *p, const char *what, lac_error *err)
{
    LAC_FAIL_IF(!(p->residual <= p->tolerance), err, LAC_ENUMERIC,
                "no convergence of the %s to %g after %lld iterations: %.3g of the displacements",
                what, p->tolerance, (long long)p->iterations, p->residual);
    return LAC_OK;
}

static lac_status solve_step(lac_tangential *t, const double *pressure,
                             const pressure_sums *pressed, const lac_tangential_target *target,
                             lac_tangential_stats *report, lac_error *err)
{
    lac_status status;
    step s = {0};
    LAC_TRY(check_strength(&t->def, target, pressed->mean, err));
    LAC_TRY(create_step(&s, pressed->n, err));
    fill_step(t, pressure, pressed->most, &s);
    LAC_TRY(fill_target(t, target, &s, err));
    LAC_TRY(lac_shear_solve(&s.p, err));
    report->residual = s.p.residual;
    report->iterations = s.p.iterations;
    report->products = s.p.products;
    LAC_TRY(check_converged(&s.p, "shear tractions", err));
    take_displacements(t, s.unit);
    keep_step(t, &s, report);
    keep_shift(t, &s, target, report);
out:
    clear_step(&s);
    return status;
}

lac_status lac_tangential_step(lac_tangential *t, const double *pressure,
                               const lac_tangential_target *target, lac_tangential_stats *report,
                               lac_error *err)
{
    lac_status status;
    pressure_sums pressed;
    lac_tangential_stats r = {.highest_ratio = -1.0, .highest_cell = SIZE_MAX};
    LAC_TRY(check_pressure(&t->def, pressure, &pressed, err));
    LAC_TRY(solve_step(t, pressure, &pressed, target, &r, err));
out:
    r.highest_ratio = fmax(r.highest_ratio, 0.0);
    if (report != NULL) {
        *report = r;
    }
    return status;
}

// The contact cells of one problem without limits
static lac_status gather_contact(const lac_tangential_def *def, const double *pressure, size_t n,
                                 step *b, lac_error *err)
{
    lac_status status = create_step(b, n, err);
    size_t k = 0;
    for (size_t i = 0; i < lac_grid_cells(&def->grid) && status == LAC_OK; i++) {
        if (pressure[i] > 0.0) {
            b->work[k] = INFINITY;
            b->cell[k++] = (uint32_t)i;
        }
    }
    b->p.held[0] = b->p.held[1] = true;
    b->p.tolerance = def->tolerance;
    b->p.max_iterations = def->max_iterations;
    return status;
}

// The smallest f p / |tau|: what the tractions have to be multiplied by
static double first_limit(const lac_tangential_def *def, const double *pressure, const step *b,
                          size_t *cell)
{
    double least = INFINITY;
    for (size_t k = 0; k < b->p.n; k++) {
        size_t i = b->p.cell[k];
        double tau = hypot(b->p.tau[k], b->p.tau[b->p.n + k]);
        double factor = def->friction * pressure[i] / tau;
        if (factor < least) {
            least = factor;
            *cell = i;
        }
    }
    return least;
}

static void fill_result(const lac_tangential_def *def, const double *pressure,
                        const pressure_sums *pressed, const step *b, lac_first_slip *result)
{
    const double cells = (double)lac_grid_cells(&def->grid);
    double scale = first_limit(def, pressure, b, &result->cell);
    result->load = scale * (double)b->p.n / cells;
    result->factor = result->load / (def->friction * pressed->mean);
    for (int axis = 0; axis < 2; axis++) {
        result->shift[axis] = b->p.shift[axis] * scale * softness_of(def);
    }
    result->residual = b->p.residual;
    result->iterations = b->p.iterations;
    result->products = b->p.products;
}

lac_status lac_tangential_first_slip(const lac_tangential_def *def, const double *pressure,
                                     const double direction[2], lac_first_slip *result,
                                     lac_error *err)
{
    lac_status status;
    pressure_sums pressed;
    lac_shear_space *space = NULL;
    step b = {0};
    *result = (lac_first_slip){0};
    LAC_TRY_RETURN(check(def, err));
    LAC_TRY_RETURN(check_pressure(def, pressure, &pressed, err));
    double length = hypot(direction[0], direction[1]);
    LAC_TRY(gather_contact(def, pressure, pressed.n, &b, err));
    LAC_TRY(lac_shear_space_create(&def->grid, def->poisson, &space, err));
    b.p.space = space;
    for (int axis = 0; axis < 2; axis++) {
        b.p.load[axis] = direction[axis] / length * (double)pressed.n;
    }
    LAC_TRY(lac_shear_solve(&b.p, err));
    fill_result(def, pressure, &pressed, &b, result);
    LAC_TRY(check_converged(&b.p, "tractions without slip", err));
out:
    lac_shear_space_free(space);
    clear_step(&b);
    return status;
}
