/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_STORE_INPUT_H
#define LACUNA_STORE_INPUT_H

#include <stddef.h>

#include "store/nc.h"
#include "store/store_events.h"

/// A file being read.
typedef struct lac_input {
    int id;
    bool open;
    const char *path;
    size_t size;         ///< of the file [bytes]
    size_t records;      ///< along `time`
    int time;            ///< dimension
    lac_store_loss loss; ///< of its journal
} lac_input;

/// Opens a file of Lacuna, its seal or heap checked first. To be closed whatever the status.
/// @return LAC_OK; LAC_EIO; LAC_ENOMEM
lac_status lac_input_open(lac_input *in, const char *path, lac_error *err);

void lac_input_close(lac_input *in);

/// `path: cannot read NAME: why`, from what netCDF returned. @return LAC_EIO
lac_status lac_input_fail(const lac_input *in, int code, lac_error *err, const char *name);

/// Whether a file of this size can hold that many doubles, deflated.
bool lac_input_may_hold(const lac_input *in, size_t values);

/// What a variable holds where nothing was written, as a double.
double lac_input_fill(const lac_input *in, int id, nc_type type);

/// An attribute of one number, of a variable or NC_GLOBAL. @return whether there is such a one
bool lac_input_number(const lac_input *in, int id, const char *name, double *value);

/// Whether the attribute `status` says so.
bool lac_input_has_status(const lac_input *in, const char *status);

/// Refuses a variable that does not say the unit that files of ours have it in.
/// @return LAC_OK, also where it is not there; LAC_EINPUT
lac_status lac_input_must_be(const lac_input *in, const char *name, const char *unit,
                             lac_error *err);

/// A global attribute as text.
/// @return LAC_OK; LAC_EIO
lac_status lac_input_attribute(const lac_input *in, const char *name, char *text, size_t size,
                               lac_error *err);

/// Numbers of a variable; nothing where there is none of that name.
/// @param row  one place along its first dimension, or all
/// @param out  empty; cleared by the caller
/// @return LAC_OK; LAC_EINPUT (no such row); LAC_EIO; LAC_ENOMEM
enum { LAC_INPUT_ALL = -1 };
lac_status lac_input_values(const lac_input *in, const char *name, ptrdiff_t row,
                            lac_stored_values *out, lac_error *err);

#endif
