/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_BASE_UNITS_USUAL_H
#define LACUNA_BASE_UNITS_USUAL_H

#include <stddef.h>

/// A unit that most cases are written in, and what takes it to SI: the factor that UDUNITS-2
/// gives, to the last bit. It is there because reading UDUNITS' database costs as much as a small
/// run.
typedef struct lac_usual_unit {
    const char *from, *to;
    double scale;
} lac_usual_unit;

/// All of them. @param count  how many
const lac_usual_unit *lac_units_usual(size_t *count);

/// That of a pair, spelt exactly so; NULL where it is not among them.
const lac_usual_unit *lac_units_usual_find(const char *from, const char *to);

#endif
