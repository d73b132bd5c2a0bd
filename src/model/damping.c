// SPDX-License-Identifier: GPL-3.0-or-later
// Radiation damping where cells touch on a part of the nominal area only; docs/theory/momentum.md,
// eqs. 1 and 2. What is common to all cells leaves as plane waves through all of the area.
#include <math.h>

#include "base/vsum.h"
#include "model/internal.h"

lac_damping lac_damping_over(const lac_domain *domain, double eta, bool massive)
{
    double cells = (double)lac_grid_cells(&domain->grid);
    double n = (double)domain->n;
    if (massive) {
        return domain->n == 1 ? (lac_damping){0} : (lac_damping){.cell = eta, .mean = -eta};
    }
    return (lac_damping){.cell = eta, .mean = eta * ((cells - n) / n)};
}

// In between, by digits where the two are of one sign.
static double middle(double low, double high)
{
    if (low > 0.0 && high > 4.0 * low) {
        return sqrt(low) * sqrt(high);
    }
    if (high < 0.0 && low < 4.0 * high) {
        return -sqrt(-low) * sqrt(-high);
    }
    return 0.5 * low + 0.5 * high;
}

// What is found falls as what is taken rises, so the root lies between the two. Newton's method,
// kept there.
double lac_mean_search_on(lac_mean_search *search, double found, double slope)
{
    double from = search->mean;
    search->low = fmax(search->low, fmin(from, found));
    search->high = fmin(search->high, fmax(from, found));
    double next = from + (found - from) / (1.0 + slope);
    if (!(next >= search->low && next <= search->high)) {
        next = middle(search->low, search->high);
    }
    search->mean = next;
    return next - from;
}

void lac_block_ease(const lac_problem *problem, double share, const lac_friction_cells *cells,
                    double *ease)
{
    lac_block s;
    const lac_friction_values values = lac_block_values(&s);
    lac_friction_evaluate(problem->friction, cells, &values, NULL);
    for (size_t i = 0; i < cells->n; i++) {
        double held = problem->pressure[cells->first + i] * share * s.f_u[i];
        ease[i] = cells->v[i] / (held + problem->damping * cells->v[i]);
    }
}

// By Sherman and Morrison: with M = D + K + k_mean P,
//   x = M^-1 b - M^-1 1 (lean M^-1 b)/(n + lean M^-1 1)
// What leans so little that Newton's method does not feel it is left out: M is no less than the
// least D.
bool lac_problem_solve_leaning(const lac_problem *problem, double k_mean, const double *diagonal,
                               double *lean, double *b, double *scratch)
{
    const double felt = 1e-9;
    size_t n = problem->n;
    const lac_transfer *transfer = &problem->transfer;
    double least = INFINITY;
    double along = 0.0;
    double self = 0.0;
    for (size_t i = 0; i < n; i++) {
        least = fmin(least, diagonal[i]);
    }
    if (!transfer->kind->solve(transfer->state, k_mean, diagonal, b, b, scratch)) {
        return false;
    }
    if (lac_vmost(n, lean) <= felt * least && k_mean >= 0.0) {
        return true;
    }
    double *ones = lean + n;
    for (size_t i = 0; i < n; i++) {
        ones[i] = 1.0;
    }
    if (!transfer->kind->solve(transfer->state, k_mean, diagonal, ones, ones, scratch)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        along += lean[i] * b[i];
        self += lean[i] * ones[i];
    }
    double pivot = (double)n + self;
    if (!(pivot > 0.0) || !isfinite(pivot)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        b[i] -= ones[i] * (along / pivot);
    }
    return true;
}
