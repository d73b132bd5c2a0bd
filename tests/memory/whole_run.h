/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_MEMORY_WHOLE_RUN_H
#define LACUNA_MEMORY_WHOLE_RUN_H

#include "lacuna/error.h"

/// All that `lacuna run` and `lacuna contact` do, into a file or into some that begin like it.
/// @return LAC_OK; LAC_ENOMEM, LAC_EIO ... where an allocation failed
lac_status whole_run(const char *path, lac_error *err);
lac_status whole_recording(const char *path, lac_error *err);
lac_status whole_contact(const char *path, lac_error *err);
lac_status whole_resumed(const char *path, lac_error *err);

/// One that goes on from another, which is prepared before and removed after.
void branch_prepare(void);
void branch_remove(void);
lac_status whole_branch(const char *path, lac_error *err);

#endif
