/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_RUN_RESUME_H
#define LACUNA_CLI_RUN_RESUME_H

#include "store/store_checkpoint.h"

/// Reads the checkpoint of a run's file and sees that this program and this case can go on from it.
/// What may differ: time.end, solver.max_steps, and the name of the file.
/// @param inputs     what cli_inputs_sums says now
/// @param libraries  of this program, with versions
/// @param out        to be cleared whatever the status
/// @return LAC_OK; LAC_EINPUT (complete, no checkpoint, another case or program); LAC_EIO (no such
///         file, foreign, damaged); LAC_ENOMEM
lac_status cli_resume_read(const char *path, const char *case_text, const char *inputs,
                           const char *libraries, lac_kept_checkpoint *out, lac_error *err);

#endif
