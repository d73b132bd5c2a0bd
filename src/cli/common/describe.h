/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/command.h"
#include "data/json.h"

// Parts of `lacuna describe`: rocks, words, and all models as a dataset.

#define CLI_ROCK "rock"
#define CLI_ROCK_SUMMARY \
    "rocks and gouges that a friction law can take f0, a, b and dc from, by its key rock"

/// lacuna describe rock [NAME]: the list, or one of them.
lac_status cli_describe_rock(const cli_request *request, lac_error *err);

/// lacuna describe WORD: models, keys and rocks whose names or texts have the word.
/// @return false: nothing was printed, as none has it, or --pipe asks
bool cli_describe_word(const cli_request *request);

// What is told of a parameter.
bool cli_param_is_number(const lac_param *param);
/// Whether a limit of its range is one: beyond what anything measures it is not.
bool cli_param_is_bounded(const lac_param *param, double limit);
const char *cli_param_type(const lac_param *param);

typedef struct cli_described_param {
    const char *kind, *model;
    lac_param param;
} cli_described_param;

/// A model, or a section of plain parameters.
typedef struct cli_described_model {
    const char *kind, *section;
    const lac_model_info *info;
} cli_described_model;

/// Those that are told as a dataset.
typedef struct cli_described {
    size_t models, model_room, params, param_room;
    cli_described_model *model; ///< [models] owned
    cli_described_param *param; ///< [params] owned
} cli_described;

/// Adds one; the parameters as they are now. LAC_ENOMEM
lac_status cli_described_add(cli_described *table, const char *kind, const char *section,
                             const lac_model_info *info, lac_error *err);

/// Hands them over: --pipe.
lac_status cli_described_put(const cli_request *request, const cli_described *table,
                             lac_error *err);
