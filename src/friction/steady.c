// SPDX-License-Identifier: GPL-3.0-or-later
// Steady states, and states told by how far they are from one.
#include "base/roots.h"
#include "friction/cutoff.h"
#include "friction/law.h"

double lac_law_steady_renewal(const lac_friction *friction, size_t cell, double u)
{
    return lac_cellwise_of(&friction->ln_dc, cell) - u;
}

double lac_friction_steady_state(const lac_friction *friction, size_t cell, double u)
{
    return friction->law->steady_state(friction, cell, u);
}

double lac_friction_state_after(const lac_friction *friction, size_t cell, double w,
                                double pressure_ratio)
{
    return friction->response.value == NULL
               ? w
               : w - lac_cellwise_of(&friction->response, cell) * log(pressure_ratio);
}

// A cell that slides at u in the state ln x above the one that is steady at `steady` (ln v).
typedef struct aged {
    const lac_friction *friction;
    size_t cell;
    double u, ln_x;
} aged;

// F of steady sliding at `steady` less F of the cell.
static double excess(const aged *c, double steady)
{
    double w = lac_friction_steady_state(c->friction, c->cell, steady);
    return lac_friction_plain(c->friction, c->cell, steady, w) -
           lac_friction_plain(c->friction, c->cell, c->u, w + c->ln_x);
}

// The rate nearest to `near` at which steady sliding takes the same F. NaN where there is none.
static double steady_rate(const aged *c, double near)
{
    const double farthest = 200.0;
    for (double reach = 0.25; reach <= farthest; reach *= 2) {
        double low = near - reach, high = near + reach;
        double at_low = excess(c, low), at_high = excess(c, high);
        if (!(at_low * at_high <= 0)) {
            continue;
        }
        for (int i = 0; i < 100; i++) {
            double middle = 0.5 * (low + high);
            lac_halve(&low, &high, (excess(c, middle) > 0) == (at_low > 0));
        }
        return 0.5 * (low + high);
    }
    return (double)NAN;
}

// F(u_s, w_s) = F(u, w_s + ln x), w_s steady at u_s: without cut-offs u_s = u + (b/a) ln x.
double lac_friction_state_at_ratio(const lac_friction *friction, size_t cell, double u, double x)
{
    if (x == 1) {
        return lac_friction_steady_state(friction, cell, u);
    }
    double a = lac_cellwise_of(&friction->column[LAC_A], cell);
    double b = lac_cellwise_of(&friction->column[LAC_B], cell);
    aged c = {.friction = friction, .cell = cell, .u = u, .ln_x = log(x)};
    double steady = u + b / a * c.ln_x;
    if (lac_cutoff_any(friction)) {
        steady = steady_rate(&c, steady);
    }
    return lac_friction_steady_state(friction, cell, steady) + c.ln_x;
}
