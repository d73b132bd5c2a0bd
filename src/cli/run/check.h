/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "data/dataset.h"
#include "scene/estimate.h"

/// What `check` found. Texts and what is pointed to are borrowed.
typedef struct cli_checked {
    const lac_case *source;
    const char *scene, *branch;                   ///< resolved case, what it goes on from; NULL
    const lac_estimate *estimate;                 ///< NULL: the case has errors
    size_t errors, warnings;                      ///< how many
    const lac_case_issue **error, **warning;      ///< [errors], [warnings]
    char regime[LAC_REGIME_ROOM];                 ///< words on it
} cli_checked;

/// Its variables, for JSON and --pipe. @param checked  must outlive the dataset
lac_status cli_check_describe(const cli_checked *checked, lac_dataset **out, lac_error *err);

/// How many steps a run takes, in words.
const char *cli_steps_class(const lac_estimate *estimate);
