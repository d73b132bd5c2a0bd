/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_RUN_EVENTS_H
#define LACUNA_RUN_EVENTS_H

#include "run/engine.h"

typedef enum lac_crossing_kind {
    LAC_CROSSING_NONE = 0,
    LAC_CROSSING_FAILURE, // mean slip rate, lac_problem_past_failure
    LAC_CROSSING_RATE,    // largest slip rate
    LAC_CROSSING_SLIP,    // mean slip
    LAC_CROSSING_GONE,    // mean slip, of failure
} lac_crossing_kind;

// Looks for the first limit crossed upwards within the step just made; where one was, the
// engine's time, state and slip are taken back to the crossing.
lac_status lac_crossing_find(lac_engine *engine, const lac_run_def *def, lac_crossing_kind *found,
                             lac_error *err);

#endif
