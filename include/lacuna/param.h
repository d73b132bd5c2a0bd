/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_PARAM_H
#define LACUNA_PARAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "lacuna/error.h"
#include "lacuna/linkage.h"

LAC_BEGIN_C

/// How a parameter is held in its struct.
typedef enum lac_param_type {
    LAC_REAL = 0, ///< double, SI
    LAC_INTEGER,  ///< int64_t
    LAC_CHOICE,   ///< int, index into `choices`
    LAC_TEXT,     ///< char *, owned by the struct
    LAC_PATH,     ///< char *, owned; a relative path is taken from the case file's folder
} lac_param_type;

enum {
    LAC_OPTIONAL = 1,  ///< may be absent without a default: NaN, INT64_MIN, -1 or NULL then
    LAC_ABOVE_MIN = 2, ///< `min` itself is excluded (a strictly positive quantity)
    LAC_CELLWISE = 4,  ///< may vary from cell to cell (`spread`)
};

/// One parameter of a model: schema, unit, default, range and documentation in one row.
typedef struct lac_param {
    const char *key;            ///< its name in a case file
    const char *unit;           ///< SI unit as UDUNITS reads it; "1" where dimensionless
    double fallback;            ///< default, SI; NAN means it must be given (unless LAC_OPTIONAL)
    double min, max;            ///< allowed range, SI
    size_t offset;              ///< of the field in the parameter struct
    const char *doc;            ///< one line
    lac_param_type type;        ///< LAC_REAL unless said
    unsigned flags;             ///< LAC_OPTIONAL | ...
    const char *const *choices; ///< NULL-terminated, for LAC_CHOICE
} lac_param;

/// What every model says of itself; the first member of every model's const row.
typedef struct lac_descriptor {
    const char *name;        ///< its key in a case file
    const char *summary;     ///< one line
    const char *reference;   ///< what to cite; "" where there is nothing
    const lac_param *params; ///< [param_count]
    size_t param_count;
    size_t params_size; ///< size of the struct that the offsets refer to [bytes]
    /// What is wrong with the parameters taken together; NULL where nothing is. NULL: no such check
    const char *(*fault)(const void *params);
} lac_descriptor;

/// A model chosen in a case, with its parameters.
typedef struct lac_slot {
    const lac_descriptor *about; ///< first member of the model's row; NULL: nothing chosen
    void *params;                ///< owned; about->params_size bytes
} lac_slot;

/// Fills `params` with the defaults of the table; absent and required ones with the absent mark.
/// @param params  params_size bytes; overwritten
/// @return LAC_OK, LAC_ENOMEM (a default text)
lac_status lac_params_default(const lac_descriptor *about, void *params, lac_error *err);

/// Sets one parameter to its default, or to the absent mark. A text it held is not freed.
void lac_param_reset(const lac_param *param, void *params);

/// Checks a parameter's value against its row.
/// @param value  SI
/// @param why    [size] set to what is allowed ("must be > 0 m") where the value is refused
/// @return true where the value is allowed; NaN and infinities never are
bool lac_param_allows(const lac_param *param, double value, char *why, size_t size);

/// Whether an optional parameter was given.
bool lac_param_given(const lac_param *param, const void *params);

/// A slot holding the defaults of a model.
/// @return LAC_OK, LAC_ENOMEM
lac_status lac_slot_create(const lac_descriptor *about, lac_slot *slot, lac_error *err);

/// Frees what a slot owns; an empty slot is fine. The slot is empty afterwards.
void lac_slot_clear(lac_slot *slot);

LAC_END_C

#endif
