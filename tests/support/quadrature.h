/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_QUADRATURE_H
#define LACUNA_TESTS_QUADRATURE_H

// Time, in units of theta_ss, in which x = theta/theta_ss goes from `from` to `to` under constant
// load: T = integral of dx/(1 - x^(1-m)), by adaptive quadrature (GSL), independent of any ODE.
double aging_time(double m, double from, double to);

#endif
