/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_FREE_SLIP_H
#define LACUNA_TESTS_FREE_SLIP_H

/// Slip along x at (x, y) from the centre of a cell of dx by dy under unit traction along x, two
/// half-spaces, nothing else: the integral of r/(x^2 + y^2/(1 - nu))/(pi G) by Gauss's rule, and in
/// polar coordinates where the point is the centre itself.
double free_slip(double g, double nu, double dx, double dy, double x, double y);

/// Slip at distance a from the centre of a traction exp(-r^2/(2 s^2)), at an angle phi with x: from
/// the stiffness of plane waves, without any Green's function.
double gaussian_slip(double g, double nu, double s, double a, double phi);

#endif
