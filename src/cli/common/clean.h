/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stddef.h>

/// Puts '?' in the place of control characters in UTF-8 (C0 but tab and newline, DEL) and of hidden
/// ones (lac_hidden_length): those of a title, a column or a file's name are no commands to a
/// terminal, and turn no line around.
/// @param text  [n] changed in place
/// @return characters that are left
size_t cli_clean(char *text, size_t n);

/// Lets all that is printed on stdout from here on go through cli_clean. Without memory nothing
/// changes.
void cli_clean_stdout(void);
