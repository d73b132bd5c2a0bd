/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "store/store.h"

/// A run kept in memory: the variables of a run's file (docs/format.md) as arrays.
typedef struct lac_recording lac_recording;

/// What it keeps. Only lac_recording_create looks at what this points to.
typedef lac_run_output lac_recording_def;
lac_status lac_recording_create(const lac_recording_def *def, lac_recording **out, lac_error *err);

/// Frees a recording; NULL is fine.
void lac_recording_free(lac_recording *recording);

/// The sink that fills it; it makes no checkpoints.
lac_sink lac_recording_sink(lac_recording *recording);

/// Sets a text that a file has among its global attributes; one of that name is replaced.
lac_status lac_recording_text(lac_recording *recording, const char *name, const char *text,
                              lac_error *err);

/// Sets all that a file has of where it comes from.
lac_status lac_recording_sign(lac_recording *recording, const lac_provenance *provenance,
                              lac_error *err);

/// Such a text; NULL where there is none.
const char *lac_recording_text_of(const lac_recording *recording, const char *name);

/// Keeps what a file of it would say: all else may be gone when somebody asks. Once, at the end.
/// @param status, result  as lac_store_finish has them
/// @param single  LAC_ROUGH ones are floats there
lac_status lac_recording_conclude(lac_recording *recording, const lac_provenance *provenance,
                                  const char *status, const lac_run_result *result, bool single,
                                  lac_error *err);

/// Moves all records, snapshots and events behind those of another recording. The one that is left
/// empty goes on as it would have: the instant of its last record again says nothing new.
/// @param recording  of the same def, but for `passing`; nothing else fills it
/// @return LAC_OK; LAC_ENOMEM: what was to be moved is dropped
/// @cost   where `recording` has none yet that of some pointers, and it cannot fail; else a copy
lac_status lac_recording_move(lac_recording *recording, lac_recording *from, lac_error *err);

/// Keeps some places along a dimension, and drops the others for good.
/// @param dimension  "time" (records), "snapshot" or "event"
/// @param keep       a byte a place, 0: drop it
void lac_recording_thin(lac_recording *recording, const char *dimension, const uint8_t *keep);

/// Puts what the file of a run holds up to its checkpoint before all that comes, of the snapshots
/// about 40: for a run that goes on, without a record yet.
lac_status lac_recording_load(lac_recording *recording, const char *path,
                              const lac_checkpoint_file *checkpoint, lac_error *err);

/// Its variables, named as in a file; times are seconds since the start. What is read of them holds
/// until the recording is written to or freed.
const lac_dataset *lac_recording_dataset(const lac_recording *recording);

/// The same for good: the dataset frees the recording with itself.
lac_dataset *lac_recording_hand_out(lac_recording *recording);
