// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/driven.h"

#include <math.h>

#include "base/rng.h"
#include "support/test.h"

static const double day = 86400.0, remembers = 5.0;

static double normal(uint64_t seed, size_t which, size_t i)
{
    double pair[2];
    lac_random_normal(seed, LAC_STREAM_TEST, i, which, pair);
    return pair[0];
}

static double red(double before, double drawn)
{
    const double a = exp(-1.0 / remembers);
    return a * before + sqrt(1.0 - a * a) * drawn;
}

static double weather(const driven_def *def, size_t i, double before)
{
    const double drawn = normal(def->seed, 1, i);
    if (def->weather == DRIVEN_WHITE || def->weather == DRIVEN_RED) {
        return def->weather == DRIVEN_WHITE ? drawn : red(before, drawn);
    }
    const double more = def->weather == DRIVEN_WET && 3 * i > 2 * def->days ? 5.0 : 1.0;
    const bool dry = lac_random_uniform(def->seed, LAC_STREAM_TEST, i, 2) > 0.25;
    return dry ? 0.0 : -more * log(lac_random_uniform(def->seed, LAC_STREAM_TEST, i, 3));
}

// Mean of the reservoir over a day of constant rain, and its level after it.
static double fill(double memory, double fell, double *level)
{
    const double a = exp(-1.0 / memory), before = *level;
    *level = a * before + (1.0 - a) * fell;
    return fell + (before - fell) * memory * (1.0 - a);
}

void driven_make(const driven_def *def, driven *out)
{
    double level = 0.0, noise = 0.0, sum = 0.0;
    assert_true(def->days < DRIVEN_MOST);
    out->n = def->days + 1;
    out->time[0] = out->displacement[0] = out->value[0] = 0.0;
    for (size_t i = 1; i < out->n; i++) {
        const double drawn = normal(def->seed, 4, i);
        const double x = out->value[i] = weather(def, i, out->value[i - 1]);
        const double held = def->memory > 0.0 ? fill(def->memory, x, &level) : 0.0;
        noise = def->red ? red(noise, drawn) : drawn;
        double rate = 3.0 + def->noise * noise;
        rate += def->answer * (def->lag == 0  ? held
                               : i > def->lag ? out->value[i - def->lag]
                                              : 0.0);
        rate += def->change * (x - out->value[i - 1]);
        rate += def->rise / (21.0 - 20.0 * (double)i / (double)def->days);
        sum += 1e-3 * rate;
        out->time[i] = day * (double)i;
        out->displacement[i] = sum;
    }
    out->readings =
        (lac_readings){.n = out->n, .time = out->time, .displacement = out->displacement};
    out->driver = (lac_driver){
        .name = "rain", .unit = "mm", .n = out->n, .time = out->time, .value = out->value};
}

void driven_explain(const driven *of, lac_driver_effect *effect)
{
    const lac_motion_def raw = {.raw = true};
    lac_motion *motion = NULL;
    assert_int_equal(lac_motion_create(&raw, &of->readings, &motion, NULL), LAC_OK);
    assert_int_equal(lac_driver_explain(motion, &of->driver, 0.05, effect, NULL), LAC_OK);
    lac_motion_free(motion);
}
