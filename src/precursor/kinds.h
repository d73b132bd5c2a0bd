/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/fft.h"
#include "base/rows.h"
#include "precursor/precursor.h"

extern const lac_precursor_kind lac_precursor_slowing, lac_precursor_log_periodicity,
    lac_precursor_b_value, lac_precursor_b_positive, lac_precursor_event_rate, lac_precursor_moment,
    lac_precursor_slip_fraction, lac_precursor_length;

/// The values of a row, for its descriptor.
#define LAC_PRECURSOR_VALUES(list) .value_count = sizeof(list) / sizeof *(list), .value = (list)

/// Moment magnitudes (Hanks & Kanamori 1979) of the events that have a moment; the caller frees.
lac_status lac_precursor_magnitudes(const lac_event_list *events, double **magnitude, size_t *n,
                                    lac_error *err);

/// From which magnitude on a catalogue is complete: 0.2 above the fullest bin of 0.1 (Woessner &
/// Wiemer 2005), and on from there until b is stable within its error over half a magnitude (Cao &
/// Gao 2002); where it never is, the first.
/// @param n  at least 1
double lac_precursor_complete_from(size_t n, const double *magnitude);

/// A stationary first-order autoregression with coefficient phi and innovations of variance 1.
void lac_surrogate_red(size_t n, double phi, uint64_t seed, size_t index, double *x);

/// A series' Fourier amplitudes, of which surrogates with other phases are made.
typedef struct lac_phases {
    size_t n;
    lac_fft *fft;
    double *amplitude; ///< [n/2 + 1]
} lac_phases;

/// @return LAC_OK; LAC_ENOMEM; phases are to be cleared in any case
lac_status lac_phases_create(size_t n, const double *x, lac_phases *out, lac_error *err);
void lac_phases_clear(lac_phases *phases);

/// A series with the same amplitudes and phases at random.
void lac_phases_draw(const lac_phases *phases, uint64_t seed, size_t index, double *x);
