/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_LIBRARIES_H
#define LACUNA_CLI_LIBRARIES_H

#include <stddef.h>

/// The libraries that the program runs with and their versions, on one line.
/// @return text, which also stands in `text`
const char *cli_libraries(char *text, size_t size);

#endif
