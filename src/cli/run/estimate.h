/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_RUN_ESTIMATE_H
#define LACUNA_CLI_RUN_ESTIMATE_H

#include "case/case.h"
#include "data/json.h"
#include "model/problem.h"

/// What a case will cost, without solving its contact.
typedef struct cli_estimate {
    double grid_cells;
    double contact_cells;   ///< NaN: not estimated
    bool exact;             ///< contact_cells is a count, not an estimate
    double critical;        ///< k_crit = p (b - a)/dc [Pa/m]; NaN: nothing is integrated
    double stiffness_ratio; ///< k_0/k_crit of the finest level [1]; NaN: does not apply
    bool stable;        ///< one block, b <= a, or k_0 well above k_crit everywhere: no cell fails
                        ///< on its own
    bool integrated;    ///< else statics: no steps
    double unknowns;    ///< of a contact cell
    bool own_steps;     ///< cells take steps of their own (solver.fidelity: events), each counts
    const char *faster; ///< the other fidelity, where it is known to be the faster one; NULL
    bool changing;      ///< a load changes in time: how often cells slip is not known
    double steps_least, steps_most;       ///< most NaN: not estimated
    double memory;                        ///< peak [bytes]
    double cpu_time_least, cpu_time_most; ///< [s]; most NaN: not estimated
    double records, file_bytes; ///< at stated times up to the end: records; they and the fields
    double cascade_time;        ///< of `lacuna rg`, or of the cascade that a run follows, in
                                ///< the times above then [s]; NaN: none
    lac_failure failure;        ///< what counts as it; rate 0: not known before the run
} cli_estimate;

/// Estimates the cost; generates the surface (not its contact), so that it is a check too.
/// @return LAC_OK; what the surface or domain source returns; LAC_ENOMEM
lac_status cli_estimate_make(const lac_case *c, cli_estimate *estimate, lac_error *err);

/// As comment lines of YAML.
void cli_estimate_print(const cli_estimate *estimate);

/// As an object under `estimate`; NULL writes null.
void cli_estimate_json(lac_json *json, const cli_estimate *estimate);

#endif
