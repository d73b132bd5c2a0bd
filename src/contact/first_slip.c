// SPDX-License-Identifier: GPL-3.0-or-later
// The shear load at which some cell first reaches its friction limit, while none has slipped yet.
#include <math.h>

#include "contact/tangential_solve.h"

// The contact cells of one problem without limits
static lac_status gather_contact(const lac_tangential_def *def, const double *pressure, size_t n,
                                 lac_shear_step *b, lac_error *err)
{
    lac_status status = lac_shear_step_create(b, n, err);
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
static double first_limit(const lac_tangential_def *def, const double *pressure,
                          const lac_shear_step *b, size_t *cell)
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
                        const lac_pressed *pressed, const lac_shear_step *b, lac_first_slip *result)
{
    const double cells = (double)lac_grid_cells(&def->grid);
    double scale = first_limit(def, pressure, b, &result->cell);
    result->load = scale * (double)b->p.n / cells;
    result->factor = result->load / (def->friction * pressed->mean);
    for (int axis = 0; axis < 2; axis++) {
        result->shift[axis] = b->p.shift[axis] * scale * lac_tangential_softness(def);
    }
    result->residual = b->p.residual;
    result->iterations = b->p.iterations;
    result->products = b->p.products;
}

static void fill_traction(const lac_tangential_def *def, const lac_shear_step *b, double load,
                          double *traction)
{
    const size_t cells = lac_grid_cells(&def->grid);
    const double scale = load * (double)cells / (double)b->p.n;
    for (size_t i = 0; i < 2 * cells; i++) {
        traction[i] = 0.0;
    }
    for (size_t k = 0; k < b->p.n; k++) {
        traction[b->p.cell[k]] = b->p.tau[k] * scale;
        traction[cells + b->p.cell[k]] = b->p.tau[b->p.n + k] * scale;
    }
}

lac_status lac_tangential_first_slip(const lac_tangential_def *def, const double *pressure,
                                     const double direction[2], double *traction,
                                     lac_first_slip *result, lac_error *err)
{
    lac_status status;
    lac_pressed pressed;
    lac_shear_space *space = NULL;
    lac_shear_step b = {0};
    *result = (lac_first_slip){0};
    LAC_TRY(lac_tangential_check(def, err));
    LAC_TRY(lac_tangential_check_pressure(def, pressure, &pressed, err));
    double length = hypot(direction[0], direction[1]);
    if (!(length > 0.0 && isfinite(length))) {
        status = lac_fail(err, LAC_EINPUT, "a shear along (%g, %g) has no direction", direction[0],
                          direction[1]);
        goto out;
    }
    LAC_TRY(gather_contact(def, pressure, pressed.n, &b, err));
    LAC_TRY(lac_shear_space_create(&def->grid, def->poisson, &space, err));
    b.p.space = space;
    for (int axis = 0; axis < 2; axis++) {
        b.p.load[axis] = direction[axis] / length * (double)pressed.n;
    }
    LAC_TRY(lac_shear_solve(&b.p, err));
    fill_result(def, pressure, &pressed, &b, result);
    if (!(b.p.residual <= def->tolerance)) {
        status = lac_fail(err, LAC_ENUMERIC,
                          "no convergence of the tractions without slip to %g after %lld "
                          "iterations: %.3g of the displacements",
                          def->tolerance, (long long)b.p.iterations, b.p.residual);
        goto out;
    }
    if (traction != NULL) {
        fill_traction(def, &b, result->load, traction);
    }
out:
    lac_shear_space_free(space);
    lac_shear_step_clear(&b);
    return status;
}
