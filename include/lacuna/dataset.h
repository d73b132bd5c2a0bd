/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_DATASET_H
#define LACUNA_DATASET_H

#include <stdbool.h>
#include <stddef.h>

#include "lacuna/error.h"
#include "lacuna/linkage.h"

LAC_BEGIN_C

/// Named variables with units and dimensions: what every result is read from, and written from as
/// netCDF or JSON. It does not change.
typedef struct lac_dataset lac_dataset;

/// Frees a dataset and the result that it is of; NULL is fine.
void lac_dataset_free(lac_dataset *dataset);

/// The name of the index-th variable; NULL past the end.
const char *lac_dataset_name(const lac_dataset *dataset, size_t index);

// What is told of a variable. NULL, and 0, where the dataset has none of that name.

/// Its unit, as UDUNITS reads it; "1" where it has none.
const char *lac_dataset_unit(const lac_dataset *dataset, const char *name);

/// What it is, in words.
const char *lac_dataset_long_name(const lac_dataset *dataset, const char *name);

/// Its index-th dimension, the last one fastest. @param length  places along it; NULL: not asked
/// @return its name; NULL past the last
const char *lac_dataset_dim(const lac_dataset *dataset, const char *name, size_t index,
                            size_t *length);

/// Whether its values are texts.
bool lac_dataset_is_text(const lac_dataset *dataset, const char *name);

/// How many values it has.
size_t lac_dataset_count(const lac_dataset *dataset, const char *name);

/// All its values where they lie in memory as they are, until the dataset is freed.
/// @return [lac_dataset_count] NaN: missing; NULL: they lie nowhere, ask lac_dataset_values
const double *lac_dataset_array(const lac_dataset *dataset, const char *name);

/// Copies all values of a variable.
/// @param n    room for so many; must be lac_dataset_count
/// @param out  [n] NaN or infinite: missing
/// @return LAC_OK; LAC_EINPUT: no such variable, it is a text, or of another number of values
lac_status lac_dataset_values(const lac_dataset *dataset, const char *name, size_t n, double *out,
                              lac_error *err);

/// One text of a variable.
/// @param place  of lac_dataset_count
/// @param text   [size] "" where it is missing
/// @return LAC_OK; LAC_EINPUT: no such text, or no room for it
lac_status lac_dataset_text(const lac_dataset *dataset, const char *name, size_t place, char *text,
                            size_t size, lac_error *err);

/// Told an attribute: a text or, with n > 0, numbers. @param whole  they are integers
typedef void (*lac_attribute_told)(void *context, const char *name, const char *text, size_t n,
                                   const double *number, bool whole);

/// Tells all that a file says of a variable: first, with no name, the type of its values there
/// (float64, float32, int64, int32, int8, str; attribute: it is one of the whole), then its
/// attributes. Of one that is in no file nothing is told. The texts hold as long as the call.
/// @param name  NULL: tells the attributes of the whole, but what a clock and a command line give
/// @return LAC_OK; LAC_EINPUT: there is no such variable; LAC_ENOMEM
lac_status lac_dataset_tell(const lac_dataset *dataset, const char *name, lac_attribute_told told,
                            void *context, lac_error *err);

/// The dataset as one JSON object, with the names that the program's --json has.
/// @param text  freed by free()
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_dataset_to_json(const lac_dataset *dataset, char **text, lac_error *err);

/// How a file is written; from lac_write_options_default.
typedef struct lac_write_options {
    size_t size;              ///< of this structure, as the default has it
    bool force;               ///< replace an existing file
    double now;               ///< seconds since 1970, UTC: the library reads no clock
    const char *command_line; ///< for its `history`; NULL: not said
    const char *libraries;    ///< names and versions; NULL: not said
} lac_write_options;

/// Replaces no file and says nothing of who writes.
static inline lac_write_options lac_write_options_default(void)
{
    lac_write_options options = LAC_ZEROS;
    options.size = sizeof options;
    return options;
}

/// Writes a dataset to a netCDF-4 file of its own, with the case that it is of; docs/format.md.
/// @param options  NULL: the default
/// @return LAC_OK; LAC_EINPUT where the file exists and `force` is not set; LAC_EIO; LAC_ENOMEM
lac_status lac_dataset_write(const lac_dataset *dataset, const char *path,
                             const lac_write_options *options, lac_error *err);

LAC_END_C

#endif
