/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "store/store.h"

typedef struct lac_stored_file lac_stored_file;

/// What a file of a run keeps of its past for another run to go on from.
typedef struct lac_stored_past {
    lac_stored_file *file;
    char *case_text;     ///< attribute `case`
    char created[32];    ///< attribute `date_created`
    double first, last;  ///< times of its records [s]
    size_t snapshots;    ///< that are whole, with what a run goes on from; 0: see `lacks`
    double *time;        ///< [snapshots] [s]
    char lacks[200];     ///< what its snapshots lack, in words; "": nothing
    bool has_checkpoint; ///< of this program, and of this file
    lac_checkpoint_file checkpoint;
} lac_stored_past;

/// Reads all but the cells. @param out  to be cleared whatever the status
/// @return LAC_OK; LAC_EINPUT (not a run, or one without a record); LAC_EIO; LAC_ENOMEM
lac_status lac_stored_past_open(const char *path, lac_stored_past *out, lac_error *err);

/// The field over the cells that is all that a mechanism of weakening comes to, as its key of
/// output.fields; NULL: it is more than one field, as waves of pressure and heat are.
const char *lac_stored_past_field(const lac_weakening *of);

/// Whether snapshots have a field of the cells, by that key.
bool lac_stored_past_has(const lac_stored_past *past, const char *field);

/// The state of the cells at a snapshot, which has what lac_stored_past_field says.
/// @param state  of the problem of the file's case
/// @return LAC_OK; LAC_EIO where it is damaged; LAC_ENOMEM
lac_status lac_stored_past_state(const lac_stored_past *past, size_t snapshot,
                                 const lac_problem *problem, lac_problem_state *state,
                                 lac_error *err);

void lac_stored_past_clear(lac_stored_past *past);
