/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CASE_H
#define LACUNA_CASE_H

#include <stdbool.h>
#include <stddef.h>

#include "lacuna/error.h"
#include "lacuna/linkage.h"

LAC_BEGIN_C

/// A case: a joint, its loads and what is to be done with it, read and checked; all in SI.
typedef struct lac_case lac_case;

/// What a case is read for. What it holds must be right for any purpose; what it must hold differs.
typedef enum lac_case_purpose {
    LAC_FOR_RUN = 0, ///< also what only a run needs: friction, a shear load, time.end
    LAC_FOR_CONTACT, ///< statics: none of those
    LAC_FOR_RG,      ///< statics, and what the cascade needs
    LAC_FOR_FIT,     ///< what a run needs, and `fit`
    LAC_FOR_CELLS,   ///< the cascade on cells that are known: statics, its beta and its friction
    LAC_FOR_CHECK,   ///< as for a run, but for a case that is static by what it names
} lac_case_purpose;

/// One thing that is wrong with a case. Only the library makes it: it may grow at its end.
typedef struct lac_case_issue {
    char *file, *key, *value, *message; ///< message: what is allowed; value "" where none
    size_t line;                        ///< 1-based; 0 where it comes from an override
    bool warning;                       ///< said by `lacuna check`, but the case runs
} lac_case_issue;

/// Writes `FILE:LINE: KEY: "VALUE" MESSAGE` (parts that are empty left out).
/// @return text; NULL where there is no issue or no room
const char *lac_case_issue_format(const lac_case_issue *issue, char *text, size_t size);

/// One change of a case, as `--set key.path=value`. It does not grow.
typedef struct lac_override {
    const char *key;   ///< dotted, list items by index: "friction.aging.dc"
    const char *value; ///< YAML: "4 um"
} lac_override;

/// How a case is to be read; from lac_case_options_default.
typedef struct lac_case_options {
    size_t size;                   ///< of this structure, as the default has it
    lac_case_purpose purpose;      ///< LAC_FOR_RUN unless said
    const lac_override *overrides; ///< [count] applied in order
    size_t count;
    /// Told all errors and warnings, in the order of the file; NULL: nobody is.
    void (*issue)(void *context, const lac_case_issue *issue);
    void *context;
} lac_case_options;

/// For a run, nothing overridden, nobody told.
static inline lac_case_options lac_case_options_default(void)
{
    lac_case_options options = LAC_ZEROS;
    options.size = sizeof options;
    return options;
}

/// Reads a case file, applies the overrides, checks everything.
/// @param options  NULL: the default
/// @param out      the case; NULL where it has errors
/// @return LAC_OK; LAC_EINPUT (the first error stands in `err`); LAC_EIO (cannot be read);
///         LAC_ENOMEM
lac_status lac_case_load(const char *path, const lac_case_options *options, lac_case **out,
                         lac_error *err);

/// The same of a case that is in memory.
/// @param name  stands for the path in messages; what the case names relatively is looked for
///              beside it
/// @param text  [size] YAML, as in a case file
/// @return as lac_case_load
lac_status lac_case_parse(const char *name, const char *text, size_t size,
                          const lac_case_options *options, lac_case **out, lac_error *err);

/// Frees a case; NULL is fine.
void lac_case_free(lac_case *c);

/// The resolved case as YAML that reads back to the same case: every value in SI with its unit,
/// defaults filled in.
/// @return text, freed by free(); NULL where memory is short or there is no case
char *lac_case_text(const lac_case *c);

/// A real number of a case by its dotted key: of the models it names (list items by index), of
/// interface and material, initial.slip_rate, initial.state (where a time) and
/// initial.state.ratio_to_steady. Other keys are set by an override.
/// @param value  SI
/// @return LAC_OK; LAC_EINPUT: the case has no such number
lac_status lac_case_get(const lac_case *c, const char *key, double *value, lac_error *err);

/// Sets one, if its range and the model that it is of allow the value; else it stays as it was.
/// @return LAC_OK; LAC_EINPUT: there is no such number, what is allowed, or a simulation of the
/// case
///         is not freed yet
lac_status lac_case_set(lac_case *c, const char *key, double value, lac_error *err);

LAC_END_C

#endif
