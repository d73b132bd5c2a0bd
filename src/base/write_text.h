/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_BASE_WRITE_TEXT_H
#define LACUNA_BASE_WRITE_TEXT_H

#include <stdbool.h>

#include "lacuna/error.h"

/// Writes a text as a file that is never half there: under another name first, as a netCDF file.
/// Where `path` is a symbolic link, what it leads to is replaced; a device or a pipe never is.
/// @param force  replaces a file that is there
/// @return LAC_OK; LAC_EINPUT: there is one; LAC_EIO: it cannot be written; LAC_ENOMEM
lac_status lac_write_text(const char *path, const char *text, bool force, lac_error *err);

#endif
