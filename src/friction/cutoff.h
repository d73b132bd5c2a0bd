/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "friction/friction.h"

/// Whether any cell has a cut-off slip rate.
static inline bool lac_cutoff_any(const lac_friction *friction)
{
    return friction->ln_v1.value != NULL || friction->ln_cut.value != NULL;
}

/// U and W of one cell.
double lac_cutoff_rate(const lac_friction *friction, size_t cell, double u);
double lac_cutoff_state(const lac_friction *friction, size_t cell, double w);

/// u with U(u) = `softened`; NaN where that is v1 or faster.
double lac_cutoff_rate_of(const lac_friction *friction, size_t cell, double softened);

/// w with W(w) = `softened`; NaN where that is dc/v2 or younger.
double lac_cutoff_state_of(const lac_friction *friction, size_t cell, double softened);

/// Strength over cells first ... first + n - 1; docs/theory/friction.md eqs. 1 to 4.
/// @param values  f, f_u and f_w are set; g is left alone
/// @param slopes  f_uu, f_uw and f_ww are set, g_u and g_w left alone; NULL where not wanted
void lac_form_evaluate(const lac_friction *friction, size_t first, size_t n, const double *u,
                       const double *w, const lac_friction_values *values,
                       const lac_friction_slopes *slopes);

/// The plain coefficient that goes with coefficient f of the form in use.
/// @return a ln(2 sinh(f/a)) where regularised, NaN if f <= 0; f itself where plain
double lac_form_plain_of(const lac_friction *friction, size_t cell, double f);

/// Flash heating of what the form gives: f becomes f_w + (f - f_w)/(1 + v/v_w), its derivatives
/// with it; docs/theory/friction.md eq. 11. There must be one.
void lac_flash_weaken(const lac_friction *friction, const lac_friction_cells *cells,
                      const lac_friction_values *values, const lac_friction_slopes *slopes);

/// The same of one coefficient, and back.
double lac_flash_of(const lac_friction *friction, size_t cell, double u, double f);
double lac_flash_before(const lac_friction *friction, size_t cell, double u, double f);

/// Rates of all cells of a balance at once, where no cell has a cut-off; lac_friction_rates.
void lac_friction_solve_rates(const lac_friction *friction, const lac_friction_balance *eq,
                              double *u, double *v);

/// Gives those u a value that are no place to begin: 0, beyond the bounds, NaN.
void lac_friction_warm(const lac_friction *friction, const lac_friction_balance *eq, double *u);

/// Rates of those of the cells that are not 0 in `open`, one by one.
void lac_friction_search_rest(const lac_friction *friction, const lac_friction_balance *eq,
                              const double *open, double *u, double *v);

/// The balance of the cells from i on.
static inline lac_friction_balance lac_friction_balance_from(const lac_friction_balance *eq,
                                                             size_t i)
{
    lac_friction_balance rest = *eq;
    rest.first += i;
    rest.n -= i;
    rest.w += i;
    rest.traction += i;
    rest.pressure += i;
    return rest;
}
