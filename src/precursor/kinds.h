/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_PRECURSOR_KINDS_H
#define LACUNA_PRECURSOR_KINDS_H

#include "precursor/precursor.h"

extern const lac_precursor_kind lac_precursor_slowing, lac_precursor_log_periodicity,
    lac_precursor_b_value, lac_precursor_b_positive, lac_precursor_event_rate, lac_precursor_moment,
    lac_precursor_slip_fraction, lac_precursor_length;

/// The values of a row, for its descriptor.
#define LAC_PRECURSOR_VALUES(list) .value_count = sizeof(list) / sizeof *(list), .value = (list)

/// Moment magnitudes (Hanks & Kanamori 1979) of the events that have a moment; the caller frees.
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_precursor_magnitudes(const lac_event_list *events, double **magnitude, size_t *n,
                                    lac_error *err);

/// From which magnitude on a catalogue is complete: 0.2 above the fullest bin of 0.1 (Woessner &
/// Wiemer 2005), and on from there until b is stable within its error over half a magnitude (Cao &
/// Gao 2002); where it never is, the first.
/// @param n  at least 1
double lac_precursor_complete_from(size_t n, const double *magnitude);

#endif
