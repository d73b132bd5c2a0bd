/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_OUTPUT_H
#define LACUNA_CLI_OUTPUT_H

#include "cli/options.h"
#include "lacuna/store.h"

/// The file a command writes: -o, else `configured`, else the case's name with `ending` in place
/// of its extension, in the working folder. Checks, before anything is computed, that it can be
/// written and is not there already.
/// @param configured  output.file of the case; NULL: none
/// @param path        the caller frees
/// @return LAC_OK; LAC_EINPUT (exists and no --force, is one of the run's own inputs); LAC_EIO
///         (no such folder, not writable); LAC_ENOMEM
lac_status cli_output_path(const cli_request *request, const lac_case *c, const char *configured,
                           const char *ending, char **path, lac_error *err);

/// What a file says of who made it.
/// @param case_text, libraries  borrowed
lac_provenance cli_provenance(const cli_request *request, const lac_case *c, const char *case_text,
                              const char *libraries);

#endif
