/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <sys/stat.h>

#include "case/case.h"
#include "cli/common/options.h"

/// Whether a command reads a file: one that its words name, the case, or one that the case names.
/// @param c  NULL: the command reads no case
bool cli_inputs_has(const cli_request *request, const lac_case *c, const struct stat *file);

/// What the files that a case names hold: a section `files:` with a line `NAME: CHECKSUM` for each,
/// "" where it names none. To be freed; NULL where memory is short.
char *cli_inputs_sums(const lac_case *c);
