/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stddef.h>

#include "store/nc.h"
#include "store/store_file.h"

/// A file being read.
typedef struct lac_input {
    int id;
    bool open;
    const char *path;
    size_t size;         ///< of the file [bytes]
    lac_store_loss loss; ///< of its journal
} lac_input;

/// Opens a file of Lacuna, its seal or heap checked first. To be closed whatever the status.
/// @return LAC_OK; LAC_EIO; LAC_ENOMEM
lac_status lac_input_open(lac_input *in, const char *path, lac_error *err);

/// The same of any netCDF file.
lac_status lac_input_open_any(lac_input *in, const char *path, lac_error *err);

void lac_input_close(lac_input *in);

/// `path: cannot read NAME: why`, from what netCDF returned. @return LAC_EIO
lac_status lac_input_fail(const lac_input *in, int code, lac_error *err, const char *name);

/// Whether a file of this size can hold that many doubles, deflated.
bool lac_input_may_hold(const lac_input *in, size_t values);

/// What a variable holds where nothing was written, as a double.
double lac_input_fill(const lac_input *in, int id, nc_type type);

/// Whether a global attribute is this text, of at most 15 bytes.
bool lac_input_says(const lac_input *in, const char *name, const char *expected);

/// Numbers of a variable; nothing where there is none of that name.
/// @param row  one place along its first dimension, or all
/// @param out  empty; cleared by the caller
/// @return LAC_OK; LAC_EINPUT (no such row); LAC_EIO; LAC_ENOMEM
enum { LAC_INPUT_ALL = -1 };
lac_status lac_input_values(const lac_input *in, const char *name, ptrdiff_t row,
                            lac_stored_values *out, lac_error *err);

/// The same of a variable over time, of the records that are whole.
lac_status lac_input_series(const lac_input *in, const char *name, lac_stored_values *out,
                            lac_error *err);
