/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_SLIDER_H
#define LACUNA_TESTS_SLIDER_H

#include "run/run.h"

// The spring slider of the earthquake-cycle codes, as cases/peers/spring-slider.yaml has it.
typedef struct slider {
    lac_domain *domain;
    lac_hierarchy *hierarchy;
    lac_transfer transfer;
    lac_friction *friction;
    lac_model spring;
    lac_load_set loads;
    double start[2];
    lac_problem_def problem_def; // of what is above; the formulation may be changed
} slider;

// Its five events by Dormand-Prince 8(7) at 1e-10 to 1e-13, confirmed by QDYN to 1e-9 [s].
extern const double slider_event_times[5];

void slider_create(lac_formulation formulation, slider *out);
void slider_clear(slider *s);

// Over five events, every step recorded.
lac_run_def slider_run(void);

// Upward crossings of a largest slip rate of 1e-3 m/s, by interpolation in ln v between records.
typedef struct slider_events {
    size_t n;        // crossings so far; the first ten are kept
    double time[10]; // [s]
    double last_time, last_log_rate;
    bool begun;
} slider_events;

lac_sink slider_events_sink(slider_events *events);

#endif
