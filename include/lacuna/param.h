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
    LAC_OPEN = 16,     ///< an optional whole number that the word auto leaves open too
    LAC_TELLS = 8,     ///< a choice that gives other parameters their values where a case does not
};

/// One parameter of a model: schema, unit, default, range and documentation in one row.
typedef struct lac_param {
    const char *key;            ///< its name in a case file
    const char *unit;           ///< SI unit as UDUNITS reads it; "1" where dimensionless
    double fallback;            ///< default, SI; NAN means it must be given (unless LAC_OPTIONAL)
    double min, max;            ///< allowed range, SI
    size_t offset;              ///< of the field in the library's own struct
    const char *doc;            ///< one line
    lac_param_type type;        ///< LAC_REAL unless said
    unsigned flags;             ///< LAC_OPTIONAL | ...
    const char *const *choices; ///< NULL-terminated, for LAC_CHOICE
} lac_param;

/// What every model says of itself; the first member of every model's const row. A section of a
/// case has a name, a summary and parameters, and no more.
typedef struct lac_model_info {
    const char *name;        ///< its key in a case file
    const char *summary;     ///< one line
    const char *reference;   ///< what to cite; "" where there is nothing
    const lac_param *params; ///< [param_count]; from outside by lac_model_param, as rows may grow
    size_t param_count;
    size_t params_size; ///< size of the struct that the offsets refer to [bytes]
    /// What is wrong with the parameters taken together; NULL where nothing is. NULL: no such check
    const char *(*validate)(const void *params);
    /// Gives parameters that a case does not name what follows from those that it does, bit i of
    /// `given` the i-th. @return what is wrong; NULL where nothing is. NULL: nothing follows
    const char *(*complete)(void *params, uint64_t given);
} lac_model_info;

/// A kind of model that a case can choose, or that a command has. Only the library makes it: it may
/// grow at its end, as may a model and a parameter.
typedef struct lac_kind {
    const char *name;    ///< "friction", "transfer", "surface" ...
    const char *section; ///< where in a case it stands: "friction", "load.shear"
    const char *summary;
    bool option; ///< chosen by the value of `section`, or by giving the parameters listed there,
                 ///< not as {MODEL: {...}}
    const char *command; ///< that has all of them, whatever the case; NULL: a case chooses
    const lac_model_info *(*at)(size_t index); ///< its models; NULL past the end
} lac_kind;

/// The index-th kind, NULL past the end.
const lac_kind *lac_kind_get(size_t index);

/// The index-th section of plain parameters (interface, material, time, solver ...), NULL past the
/// end.
const lac_model_info *lac_section_get(size_t index);

/// The model of a kind by its name: "friction", "aging". @return NULL: there is none
const lac_model_info *lac_model_find(const char *kind, const char *name);

/// The index-th parameter of a model or a section, NULL past the end.
const lac_param *lac_model_param(const lac_model_info *model, size_t index);

LAC_END_C

#endif
