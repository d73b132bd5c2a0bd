/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_RUN_WATCH_H
#define LACUNA_RUN_WATCH_H

#include "run/engine.h"

// Shows a sink that asks for every step the state reached; its rates are those in engine->work.
// @param step      length of the step that ended here; 0 at the start and beyond a jump [s]
// @param max_rate  largest |v| [m/s]
lac_status lac_watch_step(const lac_engine *engine, const lac_sink *sink, double step,
                          double max_rate, lac_error *err);

#endif
