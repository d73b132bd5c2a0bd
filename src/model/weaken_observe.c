// SPDX-License-Identifier: GPL-3.0-or-later
// What a case's weakening is told by: what errors of its unknowns are worth, what is put out of it,
// and what it cannot go with; docs/theory/weakening.md.
#include "model/internal.h"
#include "model/weaken.h"

lac_status lac_weaken_check(const lac_problem *problem, lac_error *err)
{
    const lac_weakening_set *weak = problem->weak;
    if (weak == NULL) {
        return LAC_OK;
    }
    LAC_FAIL_IF(weak->bridges && !(problem->bond > 0.0), err, LAC_EINPUT,
                "weakening: bridges break the cohesion of the friction law, which has none");
    LAC_FAIL_IF(weak->pore && problem->friction->response.value != NULL, err, LAC_EINPUT,
                "weakening: a pore pressure that follows slip does not go with alpha of the "
                "friction law, by which the state answers to it at once");
    return LAC_OK;
}

// What of z is worth an e-fold of v: a sigma/f of a pore pressure, a sigma/C of what is broken.
static double worth(const lac_problem *problem, const lac_weakening *item, size_t cell,
                    double excess)
{
    const lac_friction *friction = problem->friction;
    double a = lac_cellwise_of(&friction->column[LAC_A], cell);
    double b = lac_cellwise_of(&friction->column[LAC_B], cell);
    double f0 = lac_cellwise_of(&friction->column[LAC_F0], cell);
    double normal = problem->mean_pressure;
    double effect = a > 0.0 ? a : b > 0.0 ? b : 1.0;
    if (!item->kind->pore) {
        return fmin(effect * normal / friction->cohesion, 1.0);
    }
    return effect / fmax(f0, effect) * fmax(normal - excess, 1e-3 * normal);
}

void lac_weaken_weigh(const lac_problem *problem, const double *y, double rtol, double *weight)
{
    const lac_weakening_set *weak = problem->weak;
    const size_t n = problem->n, place = lac_weaken_place(problem);
    // Norms are means over all unknowns: what these add must not make the others count less.
    const double more =
        sqrt((double)(problem->kind->unknowns + weak->modes) / (double)problem->kind->unknowns);
    for (size_t i = 0; i < place; i++) {
        weight[i] *= more;
    }
    for (size_t i = 0; i < n; i++) {
        double excess = 0.0;
        for (size_t k = 0; k < weak->count; k++) {
            for (size_t j = 0; weak->item[k].kind->pore && j < weak->item[k].modes.n; j++) {
                excess += y[place + (weak->item[k].first + j) * n + i];
            }
        }
        for (size_t k = 0; k < weak->count; k++) {
            double scale = worth(problem, &weak->item[k], i, excess);
            for (size_t j = 0; j < weak->item[k].modes.n; j++) {
                const size_t at = place + (weak->item[k].first + j) * n + i;
                double size = fabs(y[at]);
                double error = rtol * scale * (weak->item[k].kind->pore ? 1.0 : fmax(1.0, size));
                weight[at] = more / fmax(error, 8.0 * DBL_EPSILON * size);
            }
        }
    }
}

double lac_weaken_fastest(const lac_problem *problem)
{
    double most = 0.0;
    for (size_t k = 0; problem->weak != NULL && k < problem->weak->count; k++) {
        const lac_weakening_modes *modes = &problem->weak->item[k].modes;
        for (size_t j = 0; j < modes->n; j++) {
            most = fmax(most, modes->decay[j]);
        }
    }
    return most;
}

const lac_weakening_set *lac_problem_weakening(const lac_problem *problem) { return problem->weak; }

void lac_problem_weakened(const lac_problem *problem, const double *y, double *pore,
                          double *temperature, double *broken)
{
    const lac_weakening_set *weak = problem->weak;
    const double *x = y + lac_weaken_place(problem);
    for (size_t i = 0; i < problem->n; i++) {
        pore[i] = temperature[i] = broken[i] = 0.0;
    }
    for (size_t k = 0; weak != NULL && k < weak->count; k++) {
        for (size_t j = 0; j < weak->item[k].modes.n; j++, x += problem->n) {
            double *to = weak->item[k].kind->pore ? pore : broken;
            for (size_t i = 0; i < problem->n; i++) {
                to[i] += x[i];
                temperature[i] += weak->item[k].modes.heat[j] * x[i];
            }
        }
    }
    for (size_t i = 0; i < problem->n; i++) {
        broken[i] = fmin(broken[i], 1.0);
    }
}
