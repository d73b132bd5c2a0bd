/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

/// Units by the UDUNITS-2 database, which is read when first a unit is met that is not among the
/// usual ones (base/units_usual.c). Not for several threads at a time: parse at the start.
typedef struct lac_units lac_units;

/// Finds the database.
lac_status lac_units_create(lac_units **out, lac_error *err);
void lac_units_free(lac_units *units);

/// Reads "0.1 mm" (or a bare number, which is SI) as a quantity of the dimension of `unit`.
/// Refuses: anything unread at the end, another dimension, fractional exponents, months, `a`
/// (are), "dday" and the like.
/// @param text   as the user wrote it
/// @param unit   SI unit of the result; "1" where dimensionless
/// @param value  the quantity in `unit`; set only on success
lac_status lac_units_parse(const lac_units *units, const char *text, const char *unit,
                           double *value, lac_error *err);

/// Factor and offset that take a number in unit `from` to unit `to`: y = scale x + offset.
lac_status lac_units_convert(const lac_units *units, const char *from, const char *to,
                             double *scale, double *offset, lac_error *err);

/// Factor and offset that take times in a file's unit to seconds: y = scale x + offset.
/// @param text   "day" or, as CF has it, "days since 2015-06-07 12:00"
/// @param dated  set where it counts from a date: seconds are then since 1970-01-01 UTC
lac_status lac_units_time(const lac_units *units, const char *text, double *scale, double *offset,
                          bool *dated, lac_error *err);

/// Writes a value of an SI unit with the unit that reads best ("3 MPa", "1 cm/week", "12.5 day")
/// into `text`, which it returns; so do the next two.
const char *lac_units_format(double value, const char *unit, char *text, size_t size);

/// Writes a number with as many digits as read back to the same, `fewest` at least.
const char *lac_number_exact(double value, int fewest, char *text, size_t size);

/// The same with its SI unit ("0.0001 m"; the number alone where the unit is "1").
const char *lac_units_exact(double value, const char *unit, char *text, size_t size);

/// When a usual unit is written: never, where it suits, where that makes a short number.
enum { LAC_READ, LAC_SHOWN, LAC_IF_ROUND };

/// A unit that most cases are written in, and what takes it to SI: the factor that UDUNITS-2
/// gives, to the last bit. It is there because reading UDUNITS' database costs as much as a small
/// run.
typedef struct lac_usual_unit {
    const char *from, *to;
    double scale;
    int show; ///< LAC_READ ...
} lac_usual_unit;

/// All of them. @param count  how many
const lac_usual_unit *lac_units_usual(size_t *count);

/// That of a pair, spelt exactly so; NULL where it is not among them.
const lac_usual_unit *lac_units_usual_find(const char *from, const char *to);
