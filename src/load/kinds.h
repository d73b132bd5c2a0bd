/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/rows.h"
#include "load/load.h"

#define LAC_PI 3.14159265358979323846

/// Parameters of a load that is one number.
typedef struct lac_load_value {
    double value;
} lac_load_value;

/// The row of the number of a load whose first member it is.
#define LAC_VALUE_ROW(si, low, high, bits, text) \
    LAC_REAL("value", si, offsetof(lac_load_value, value), NAN, low, high, bits, text)

/// Steepest slope that a load takes [rad]: almost vertical, where tan and 1/cos are still finite.
#define LAC_STEEPEST 1.57

/// Where what normal stresses on top of the normal load do is derived.
#define LAC_PRESSING_SOURCE "docs/theory/loads.md, \"Normal stress that changes\""

/// What lac_share is called in a case: the choices of a force's key `share`.
extern const char *const lac_share_names[];

/// The row of that key, for an int of the load's parameters. lac_load_set_create reads it.
#define LAC_SHARE_ROW(holder, member)                                                             \
    LAC_CHOICE("share", offsetof(holder, member), LAC_SHARE_PRESSURE, lac_share_names, 0,         \
               "of each cell: in proportion to its pressure, the same stress on all (equal), or " \
               "as elastic rock puts it on them when all slip alike (elastic; needs a material)")

/// The row of the key `azimuth` of a shear load, for a double of its parameters of that name.
/// lac_load_set_create reads it.
#define LAC_AZIMUTH "azimuth"
#define LAC_AZIMUTH_ROW(holder)                                                                  \
    LAC_REAL(LAC_AZIMUTH, "rad", offsetof(holder, azimuth), NAN, -2 * LAC_PI, 2 * LAC_PI,        \
             LAC_OPTIONAL,                                                                       \
             "direction of the shear from x towards y, with interface.slip: vector; along x if " \
             "absent")

/// Rows of keys that several loads have, by the member of the same name.
#define LAC_ANGLE_ROW(holder)                                                  \
    LAC_REAL("angle", "rad", offsetof(holder, angle), NAN, 0, LAC_STEEPEST, 0, \
             "dip of the interface")
#define LAC_START_ROW(holder)                                                  \
    LAC_REAL("start", "s", offsetof(holder, start), 0, -INFINITY, INFINITY, 0, \
             "when it begins, since the start of the run")
#define LAC_TIME_COLUMN_ROW(holder)             \
    LAC_TEXT("time", offsetof(holder, time), 0, \
             "name of the time column: dates, or seconds since the start of the run")
#define LAC_OFFSET_ROW(holder, text) \
    LAC_REAL("offset", "s", offsetof(holder, offset), 0, -INFINITY, INFINITY, 0, text)

/// LAC_ROWS of a pore pressure or a normal stress that a table shares with a force, whose azimuth
/// and share come last: it has no direction, and all cells feel it alike.
#define LAC_PORE_ROWS(rows, holder)                                      \
    .params = (rows), .param_count = sizeof(rows) / sizeof(rows)[0] - 2, \
    .params_size = sizeof(holder)

// The loads that a case can name: a new one is one more line here.
// clang-format off
#define LAC_NORMAL_LOADS(_)  \
    _(lac_normal_pressure),  \
    _(lac_normal_depth),     \
    _(lac_normal_slope),     \
    _(lac_normal_approach),  \
    _(lac_normal_dimension)

#define LAC_SHEAR_LOADS(_)  \
    _(lac_shear_ratio),     \
    _(lac_shear_slope),     \
    _(lac_shear_ramp),      \
    _(lac_shear_spring),    \
    _(lac_shear_machine),   \
    _(lac_shear_step),      \
    _(lac_shear_sine),      \
    _(lac_shear_shaking),   \
    _(lac_shear_series),    \
    _(lac_shear_back_slip)

#define LAC_PORE_LOADS(_)       \
    _(lac_pore_constant),       \
    _(lac_pore_ramp),           \
    _(lac_pore_step),           \
    _(lac_pore_sine),           \
    _(lac_pore_series),         \
    _(lac_pore_reservoir),      \
    _(lac_pore_rain),           \
    _(lac_pore_field),          \
    _(lac_pore_injection),      \
    _(lac_pore_line_injection), \
    _(lac_pore_water_table),   \
    _(lac_pore_toe)

#define LAC_NORMAL_STRESSES(_)  \
    _(lac_pressing_ramp),       \
    _(lac_pressing_step),       \
    _(lac_pressing_sine),       \
    _(lac_pressing_series),     \
    _(lac_pressing_field)
// clang-format on

extern const lac_normal_load LAC_NORMAL_LOADS(LAC_ROW_ITSELF);
extern const lac_load_kind LAC_SHEAR_LOADS(LAC_ROW_ITSELF), LAC_PORE_LOADS(LAC_ROW_ITSELF),
    LAC_NORMAL_STRESSES(LAC_ROW_ITSELF);

struct lac_units;

/// A column of a monitoring file on the clock of a run; missing readings left out.
typedef struct lac_readings {
    size_t n;
    double *t;     ///< [n] since the start of the run [s], rising
    double *value; ///< [n] SI
} lac_readings;

/// What is read.
typedef struct lac_readings_def {
    const char *path, *time;
    const char *column; ///< "name" or "name:unit"
    const char *per;    ///< what one unit of the column makes, "9810 Pa/m"; NULL: 1
    const char *si;     ///< unit of the product
    double offset;      ///< laid on the run this much later [s]
} lac_readings_def;

/// Reads a column, or takes it from what the clock's `files` keep. One without a unit, and without
/// `per`, is asked about as that of a monitoring series is (lac_series_read): taken as SI, which
/// `files` keep as a doubt, or refused.
/// @param remedy  what the user may do, for the message, where they do not cover the run; NULL:
///                they need not
lac_status lac_readings_read(const lac_readings_def *def, const lac_load_clock *clock,
                             const char *remedy, lac_readings *out, lac_error *err);

/// The same without a look at what `files` keep.
lac_status lac_readings_load(const lac_readings_def *def, const lac_load_clock *clock,
                             lac_readings *out, lac_error *err);

/// Keeps a doubt about a file that was read: lac_load_files_doubt.
lac_status lac_load_files_note(lac_load_files *files, const char *path, const char *text,
                               lac_error *err);

/// Refuses readings of a file that do not cover the run, whose message ends with the remedy.
lac_status lac_readings_cover(const lac_readings *readings, const char *path,
                              const lac_load_clock *clock, const char *remedy, lac_error *err);

void lac_readings_clear(lac_readings *readings);

/// Along straight lines between readings, of which there are some; held before and after them.
lac_signal lac_readings_at(const lac_readings *readings, double t);

/// Index of the last reading at or before `at`, SIZE_MAX before the first; and the first time after
/// it, INFINITY beyond the last.
size_t lac_readings_before(const double *t, size_t n, double at);
double lac_readings_next(const double *t, size_t n, double at);
