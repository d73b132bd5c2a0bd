/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "analysis/analysis.h"

/// Which cells slip, from one record to the next.
typedef struct lac_slipping {
    const lac_friction *friction;
    size_t n;
    bool begun, by_rate;
    double strength;    ///< part of the strength at the start at or below which a cell slips [1]
    double rate;        ///< least slip rate of a slipping cell [m/s]; NaN until the start is seen
    double ratio;       ///< of the mean rate at the start [1]; NaN: the rate is given
    double *most_state; ///< [n] ln theta at which the strength has come down; NaN: never; NULL by
                        ///< rate
    uint8_t *slips;     ///< [n]
    uint32_t *changed;  ///< [n] cells that began or ceased at the last look, in their order
    size_t changes;
} lac_slipping;

/// @param strength  part where slip is told by the strength; NaN: not
/// @param rate, ratio  where by the rate, one of them; NaN: not
lac_status lac_slipping_create(const lac_friction *friction, double strength, double rate,
                               double ratio, lac_slipping *out, lac_error *err);
void lac_slipping_clear(lac_slipping *s);

/// Looks at the cells; at the first look it takes their strength at the start, a friction
/// coefficient at v0: f(v0, theta).
void lac_slipping_evaluate(lac_slipping *s, const lac_record *record);

/// Passes what has been seen.
void lac_slipping_serialize(lac_slipping *s, lac_archive *archive);

/// The definition in words.
const char *lac_slipping_describe(const lac_slipping *s, char *text, size_t size);
