/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "data/describe.h"
#include "store/store_file.h"
#include "sweep/ensemble.h"

// What the tables of an ensemble and the reader of its file share.

/// The rows of a member: what is held in a lac_member.
extern const lac_variable lac_ensemble_of_member[];
extern const size_t lac_ensemble_rows;

/// The axis of the series, by lac_series_axis.
typedef struct lac_ensemble_axis {
    const char *place, *place_unit, *place_doc; ///< its coordinate
    const char *value, *unit, *doc;             ///< the series
} lac_ensemble_axis;
extern const lac_ensemble_axis lac_ensemble_axes[];

/// The variable of a key: "friction.aging.dc" is friction_aging_dc.
void lac_ensemble_name(const char *key, char name[LAC_STORED_NAME]);

/// Texts of a parameter, one behind the other, and which of those that differ each is.
/// @param text  [n] copied
lac_status lac_ensemble_words(lac_ensemble_param *param, size_t n, const char *const *text,
                              lac_error *err);
