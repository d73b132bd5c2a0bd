/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_PRESSED_H
#define LACUNA_TESTS_PRESSED_H

#include <stdint.h>

#include "contact/contact.h"

enum { MOST = 96 * 96 };

/// A contact problem of at most MOST cells and its solution; flat, 8 x 8 to begin with.
typedef struct fixture {
    double h[MOST], p[MOST], gap[MOST];
    lac_contact_def def;
    lac_contact_stats report;
    lac_error err;
} fixture;

/// cmocka set-up and tear-down: *state is the fixture.
int set_up(void **state);
int tear_down(void **state);

/// Solves; the second fails the test where that does.
lac_status solve(fixture *f);
void must_solve(fixture *f);

/// Fails the test unless the problem is refused with a message that has this word.
void refuse(fixture *f, const char *word);

/// p >= 0, g >= 0 where p = 0, p g = 0, and the load: each to the tolerance it was solved to.
void check_solution(const fixture *f);
void check_solution_at(const fixture *f, double load);

double mean(const double *x, size_t n);

/// Uncorrelated heights from 0 to 1e-3 m.
void fill_random(fixture *f, uint64_t seed);

#endif
