/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_COMMON_COMPLETION_H
#define LACUNA_CLI_COMMON_COMPLETION_H

#include "cli/common/command.h"

/// Prints what may stand in the place of the last word, one candidate a line: "WORD<Tab>MEANING". A
/// line ":BEFORE<Tab>ENDINGS" says that a name of a file may, behind what is before it in the word:
/// one of these endings ("yaml|nc"), or any where none is named. Says nothing else, whatever the
/// words are.
/// @param word  [count] the words after the program's name, up to the cursor; also as bash cuts
///              them at = and :, and with the quotes that were typed
void cli_complete(int count, char **word);

#endif
