/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "store/nc.h"

/// A file being read, or a run in memory.
struct lac_stored_file {
    int id;
    bool open;
    char *path;                     ///< owned
    size_t size;                    ///< of the file [bytes]
    lac_store_loss loss;            ///< of its journal
    const lac_recording *recording; ///< read instead of a file; NULL: a file
};

/// Opens any netCDF file, its seal or heap checked first.
lac_status lac_stored_file_open_any(const char *path, lac_stored_file **out, lac_error *err);

/// `path: cannot read NAME: why`, from what netCDF returned. @return LAC_EIO
lac_status lac_input_fail(const lac_stored_file *in, int code, lac_error *err, const char *name);

/// Whether a file of this size can hold that many doubles, deflated.
bool lac_input_may_hold(const lac_stored_file *in, size_t values);

/// Whether a global attribute is this text, of at most 15 bytes.
bool lac_input_says(const lac_stored_file *in, const char *name, const char *expected);

/// As the row of lac_stored_file_row: all of them.
enum { LAC_INPUT_ALL = -1 };
