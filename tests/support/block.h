/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_BLOCK_H
#define LACUNA_TESTS_BLOCK_H

#include "run/run.h"

// One sliding block: a problem of a single cell of 1 m2.
typedef struct block_def {
    const char *law;
    int form;
    double f0, a, b, dc, v0;
    double v1, v2, alpha, vc; // 0: none, or the default
    double pressure, damping;
    double mass, columns; // [kg/m2], [1]; 0: none
    double slip_rate;     // at the start
    double x;             // theta/theta_ss under the load that follows
    double theta;         // instead of x [s]; 0: x counts
    lac_formulation formulation;
    const lac_model *shear;
    size_t shear_count;
    const lac_model *pore;
    size_t pore_count;
} block_def;

typedef struct block {
    lac_domain *domain;
    lac_hierarchy *hierarchy;
    lac_transfer transfer;
    lac_friction *friction;
    lac_load_set loads;
    lac_problem *problem;
} block;

// A block whose times are of order one: dc = v0 = 1, sigma = 1 MPa, a = 0.01, b = m a.
block_def block_default(double m, double x);

void block_create(const block_def *def, block *out);
void block_clear(block *b);

// The formulations, and cmocka's entries of a test for each: *state points to the one it is to use.
extern lac_formulation block_formulations[3];
#define FOR_EACH_FORMULATION(test)                                      \
    {#test ": rate", test, NULL, NULL, &block_formulations[0]},         \
        {#test ": traction", test, NULL, NULL, &block_formulations[1]}, \
    {                                                                   \
#test ": slip", test, NULL, NULL, &block_formulations[2]        \
    }

// The one that a test is to use.
static inline lac_formulation chosen(void **state) { return *(const lac_formulation *)*state; }

// theta_ss and v* under the load that the start fixes.
double block_steady_state(const block_def *def);
double block_steady_rate(const block_def *def);

// A growing record of a run.
typedef struct history {
    size_t n, room;
    lac_record *line;
} history;

lac_sink history_sink(history *h);
void history_clear(history *h);
// Total time of a record [s].
double history_time(const history *h, size_t i);

#endif
