// SPDX-License-Identifier: GPL-3.0-or-later
// Kato and Tullis' law: contacts heal with time only while they slip slowly.
#include "base/vmath.h"
#include "friction/law.h"

enum { LAC_VC = LAC_COMMON_COLUMNS };

// Stands in for a larger v/vc, so that it times exp(-v/vc) = 0 is 0.
#define LARGEST_RATIO 1e300

typedef struct composite_params {
    lac_friction_params common;
    double vc;
} composite_params;

static double over(double v, double vc)
{
    double ratio = v / vc;
    return ratio < LARGEST_RATIO ? ratio : LARGEST_RATIO;
}

// dtheta/dt = exp(-v/vc) - (v theta/dc) ln(v theta/dc), for w = ln theta:
// g = exp(-v/vc - w) - (v/dc) (u + w - ln dc)
static void evolve(const lac_friction *friction, const lac_friction_cells *cells, double *g,
                   double *g_u, double *g_w)
{
    size_t n = cells->n;
    const double *u = cells->u, *w = cells->w, *v = cells->v;
    const double *vc = lac_cellwise_from(&friction->column[LAC_VC], cells->first);
    const double *inv_dc = lac_cellwise_from(&friction->inv_dc, cells->first);
    const double *ln_dc = lac_cellwise_from(&friction->ln_dc, cells->first);
    for (size_t i = 0; i < n; i++) {
        g[i] = -over(v[i], vc[i]) - w[i];
    }
    lac_vexp(n, g, g);
    if (g_u != NULL) {
        for (size_t i = 0; i < n; i++) {
            double renewal = v[i] * inv_dc[i];
            g_w[i] = -g[i] - renewal;
            g_u[i] = -over(v[i], vc[i]) * g[i] - renewal * (u[i] + w[i] - ln_dc[i] + 1);
        }
    }
    for (size_t i = 0; i < n; i++) {
        g[i] -= v[i] * inv_dc[i] * (u[i] + w[i] - ln_dc[i]);
    }
}

// v theta/dc = z with z ln z = exp(-v/vc), so y = ln z solves y e^y = exp(-v/vc) <= 1: y is
// Lambert's W. The left side is convex and exp(-v/vc) lies right of the root, where Newton's
// steps fall onto it.
static double steady_state(const lac_friction *friction, size_t cell, double u)
{
    double healing = exp(-over(exp(u), lac_cellwise_of(&friction->column[LAC_VC], cell)));
    double y = healing;
    for (int i = 0; i < 20; i++) {
        double next = y - (y - healing * exp(-y)) / (1 + y);
        if (!(next < y)) {
            break;
        }
        y = next;
    }
    return y + lac_cellwise_of(&friction->ln_dc, cell) - u;
}

static const lac_param params[] = {
    LAC_FRICTION_COMMON_ROWS,
    LAC_REAL("vc", "m/s", offsetof(composite_params, vc), 1e-8, 0, INFINITY,
             LAC_CELLWISE | LAC_ABOVE_MIN,
             "slip rate above which contacts no longer heal with time"),
};

const lac_friction_law lac_friction_composite = {
    .info = LAC_ABOUT("composite",
                      "heals with time below vc, else only with slip: dtheta/dt = exp(-v/vc) - (v "
                      "theta/dc) ln(v theta/dc)",
                      "Kato & Tullis (2001) Geophys. Res. Lett. 28, 1103, doi "
                      "10.1029/2000GL012060; regularised: " LAC_RICE_BEN_ZION,
                      LAC_ROWS(params, composite_params), .validate = lac_law_validate,
                      .complete = lac_law_complete),
    .evolve = evolve,
    .steady_state = steady_state,
};
