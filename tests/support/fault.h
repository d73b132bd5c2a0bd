/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_FAULT_H
#define LACUNA_TESTS_FAULT_H

#include "analysis/slip_events.h"
#include "support/tree.h"

/// A fault in elastic rock that a plate loads: full contact, aging law, regularised, 30 GPa,
/// shear waves of 3 km/s.
typedef struct fault_def {
    lac_grid grid;
    bool line, antiplane, creeping;
    double thickness;  ///< of slabs; NaN: half-spaces
    double plate_rate; ///< [m/s]
    double pressure, b, dc;
    const double *a;         ///< [n]
    const double *log_rate;  ///< [n]
    const double *log_state; ///< [n]
    double newton_tolerance;
    lac_formulation formulation; ///< AUTO: rate
} fault_def;

/// A tree's parts with another domain and transfer, and the plate's load.
typedef struct fault {
    tree parts;
    lac_model load;
    lac_load_set loads;
} fault;

/// Stops the program where it cannot. @param f  must stay where it is until it is freed
void fault_create(const fault_def *def, fault *f);
void fault_free(fault *f);

enum { MOST_EVENTS = 8 };

/// Upward crossings of 1 mm/s by the fastest cell; the peaks after them, at the steps' ends as
/// other codes give them, and the crests between these [m/s].
typedef struct fault_events {
    size_t count;
    double time[MOST_EVENTS], peak[MOST_EVENTS], crest[MOST_EVENTS];
    lac_slip_events all; ///< while the run goes on
} fault_events;

/// Runs to `end`; stops the program where it cannot.
lac_run_result fault_run(const fault *f, lac_method method, double end, double rtol,
                         fault_events *observation);

/// B1, a periodic line of 1024 cells in slabs, and C1, 128 x 128 cells in the full space: problems
/// of other earthquake-cycle codes.
void fault_b1(lac_formulation formulation, fault *f);
void fault_c1(lac_formulation formulation, fault *f);

/// Their events [s], to all digits that several codes agree on.
extern const double fault_b1_events[4], fault_c1_events[3];
/// The largest rate of each [m/s], to the digits given.
extern const double fault_b1_peaks[4], fault_c1_peaks[3];

#endif
