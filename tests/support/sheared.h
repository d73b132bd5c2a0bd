/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_SHEARED_H
#define LACUNA_TESTS_SHEARED_H

#include "contact/tangential.h"

/// A joint on the unit square, E* = 1, in normal contact, and the history of its shear.
typedef struct sheared {
    size_t n;
    double *h, *p; ///< [n * n]
    lac_contact_def normal;
    lac_contact_stats contact;
    lac_tangential_def def;
    lac_tangential *t;
    lac_error err;
} sheared;

/// Each fails the test that it is called in where anything goes wrong.

/// A sphere of radius 1 pressed on a free half-space until its contact has radius a.
sheared sphere_of(size_t n, double a, double poisson, double friction);

/// The benchmark surface A08_n under a mean pressure of 4.9e-3.
sheared rough_of(size_t n, bool periodic, double poisson, double friction);

/// Solves the normal contact anew for another load, the surface as it is.
void press(sheared *s, double mean_pressure);

/// The next step, load given along both axes.
lac_tangential_stats shear(sheared *s, double qx, double qy);

/// The next step, shift given along both axes.
lac_tangential_stats drag(sheared *s, double ux, double uy);

/// Forgets the history.
void start_again(sheared *s);

void release(sheared *s);

#endif
