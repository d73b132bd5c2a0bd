/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_INPUTS_H
#define LACUNA_CLI_INPUTS_H

#include <sys/stat.h>

#include "lacuna/case.h"

/// Whether a case reads a file: the case itself, or one that it names.
bool cli_inputs_has(const lac_case *c, const struct stat *file);

/// What the files that a case names hold: a section `files:` with a line `NAME: CHECKSUM` for each,
/// "" where it names none. To be freed; NULL where memory is short.
char *cli_inputs_sums(const lac_case *c);

#endif
