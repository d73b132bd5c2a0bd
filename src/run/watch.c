// SPDX-License-Identifier: GPL-3.0-or-later
// Every step shown to a sink that asks for it, and not only what is recorded.
#include "run/watch.h"

lac_status lac_watch_step(const lac_engine *engine, const lac_sink *sink, double step,
                          double max_rate, lac_error *err)
{
    if (sink == NULL || sink->step == NULL) {
        return LAC_OK;
    }
    const lac_step seen = {.time_origin = engine->origin,
                           .time_local = engine->base + engine->t,
                           .step = step,
                           .max_rate = max_rate,
                           .n = engine->n,
                           .slip_rate = engine->work,
                           .slip = engine->slip};
    return sink->step(sink->context, &seen, err);
}
