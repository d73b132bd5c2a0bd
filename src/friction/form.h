/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_FRICTION_FORM_H
#define LACUNA_FRICTION_FORM_H

#include "friction/friction.h"

/// Strength over cells first ... first + n - 1; docs/theory/friction.md eqs. 1 to 4.
/// @param values  f, f_u and f_w are set; g is left alone
/// @param slopes  f_uu, f_uw and f_ww are set, g_u and g_w left alone; NULL where not wanted
void lac_form_evaluate(const lac_friction *friction, size_t first, size_t n, const double *u,
                       const double *w, const lac_friction_values *values,
                       const lac_friction_slopes *slopes);

/// The plain coefficient that goes with coefficient f of the form in use.
/// @return a ln(2 sinh(f/a)) where regularised, NaN if f <= 0; f itself where plain
double lac_form_plain_of(const lac_friction *friction, size_t cell, double f);

#endif
