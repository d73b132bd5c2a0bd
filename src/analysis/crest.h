/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "run/run.h"

/// Slip rates at the ends of the last three steps, from which the crests between steps are found:
/// docs/theory/events.md, eqs. 4 and 5.
typedef struct lac_crest {
    size_t n;
    double *block;   // [3 n], owned
    double *rate[3]; ///< [n] |v| of each cell, the latest first [m/s]
    double step[2];  ///< lengths of the steps between them, the latest first [s]
    int known;       ///< how many of the three there are
} lac_crest;

lac_status lac_crest_create(size_t n, lac_crest *out, lac_error *err);
void lac_crest_clear(lac_crest *c);

/// The crest of a cell's slip rate about the end of the last step, now that the step after it is
/// known; call it before lac_crest_take.
/// @param since  becomes when, from the end of the last step [s]; NULL: not asked
/// @return [m/s]; 0: there is none
double lac_crest_top(const lac_crest *c, const lac_step *step, size_t cell, double *since);

/// Takes the end of a step; beyond a jump of the loads it begins anew.
void lac_crest_take(lac_crest *c, const lac_step *step);

/// Passes the rates, of the same n; to one that was just made, where the archive is loading.
void lac_crest_serialize(lac_crest *c, lac_archive *archive);

/// Where in a step ln |v|, taken as linear there, comes to a limit: the share before it.
double lac_crest_share_at(double before, double after, double limit);
