/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_STORE_RECORDING_INTERNAL_H
#define LACUNA_STORE_RECORDING_INTERNAL_H

#include "store/recording.h"

/// The text under which a recording keeps the comment of a variable.
#define LAC_RECORDING_COMMENT "%s:comment"
enum { LAC_RECORDING_NAME = 128 };

/// Adds values to a variable. @return LAC_OK; LAC_ENOMEM
lac_status lac_recording_append(lac_recording *recording, size_t index, const double *values,
                                size_t n, lac_error *err);

/// Makes room for lac_recording_pour. @return LAC_OK; LAC_ENOMEM
lac_status lac_recording_reserve(lac_recording *recording, const lac_recording *from, size_t index,
                                 lac_error *err);

/// Moves a variable's values behind those of another recording; where that has none, the array.
void lac_recording_pour(lac_recording *recording, lac_recording *from, size_t index);

/// Says which record is the last one: the same instant again says nothing new.
void lac_recording_resume(lac_recording *recording, double origin, double local);

/// Shortens a variable. @param count  values that are left, not more than there are
void lac_recording_cut(lac_recording *recording, size_t index, size_t count);

/// A variable's values, to be changed in place.
double *lac_recording_values(lac_recording *recording, size_t index);

/// How many places a variable has along its first dimension; 1 where it runs over nothing.
size_t lac_recorded_places(const lac_recording *recording, const lac_recorded *seen);

#endif
