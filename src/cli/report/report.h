/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/options.h"
#include "data/json.h"
#include "series/series.h"

/// Prints the errors of a case on stderr, one line each, and unless --quiet its warnings of keys
/// that begin with `section`.
void cli_report_print_of(const lac_case_issues *report, const cli_request *request,
                         const char *section);

/// Adds an error, or a warning, that was found beyond the text of the case. LAC_ENOMEM
lac_status cli_report_add(lac_case_issues *report, const lac_case *c, const char *key,
                          const char *message, bool warning, lac_error *err);

/// Reads the request's case and prints what is wrong with it, and what the files of its loads leave
/// open (a column without a unit) as warnings.
/// @param purpose  what the command does with it
/// @param report  kept for the caller, who clears it; NULL where only errors are to be printed
/// @return what lac_case_read returns
lac_status cli_case_read(const cli_request *request, lac_case_purpose purpose, lac_case **c,
                         lac_case_issues *report, lac_error *err);

/// Reads a quantity in a unit. @return LAC_OK; LAC_EINPUT, with what is allowed; LAC_EIO,
/// LAC_ENOMEM
lac_status cli_parse_quantity(const char *text, const char *unit, double *value, lac_error *err);

/// Reads a time of a run of the case, a date where it has one, since its start [s].
/// @return LAC_OK; LAC_EINPUT, with what is allowed; LAC_EIO, LAC_ENOMEM
lac_status cli_parse_time(const char *text, const lac_case *c, double *time, lac_error *err);

/// Where a run of the case ends by --until [s]; as it is without. @return as cli_parse_time
lac_status cli_until(const cli_request *request, const lac_case *c, double *end, lac_error *err);

/// Puts the case's name before the message of what went wrong with its scene.
/// @param c  NULL: the case could not be read, and the message says so already
/// @return status, unchanged
lac_status cli_blame(const lac_case *c, lac_status status, lac_error *err);

/// The monitoring series that a case lays beside its run.
typedef struct cli_compare {
    const lac_case *source;
    size_t count;
    lac_series **series; ///< [count] on the run's clock
} cli_compare;

/// Reads the case's series, before anything is computed, and warns of doubts.
/// @return LAC_OK; LAC_EIO; LAC_EINPUT (a wrong file; dates beside a run without a date);
///         LAC_ENOMEM
lac_status cli_compare_read(const cli_request *request, const lac_case *c, cli_compare *compare,
                            lac_error *err);
void cli_compare_clear(cli_compare *compare);

/// What is kept of the records of a run.
typedef struct cli_kept {
    size_t n, points, room;
    double *values; ///< [3 + 2 points][room] time on the clock of dates where the case has one;
                    ///< slip and rate of the joint and of each of output.points
} cli_kept;

/// Prints one table per series: observed and modelled where there are few readings, and misfits.
void cli_compare_print(const cli_compare *compare, const cli_kept *kept);

/// The same as a list under `compare`.
void cli_compare_json(lac_json *json, const cli_compare *compare, const cli_kept *kept);
