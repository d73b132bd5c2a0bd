/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_COMPLETION_H
#define LACUNA_CLI_COMPLETION_H

#include "cli/command.h"

/// The script that a shell reads.
void cli_completion_bash(FILE *out);
void cli_completion_zsh(FILE *out);
void cli_completion_fish(FILE *out);

/// Whether a command takes an option.
bool cli_takes(const cli_command *command, const cli_option *o);

/// What files a command or an option takes: "" none, "*" any, else endings with bars between them.
const char *cli_files_of_command(const cli_command *command);
const char *cli_files_of_option(const cli_option *o);

/// Words, blanks between them: commands, kinds of case that `new` writes, what `describe` knows at
/// its first place, the models of a kind.
void cli_put_commands(FILE *out, const char *between);
void cli_put_templates(FILE *out);
void cli_put_kinds(FILE *out);
void cli_put_models(FILE *out, const lac_kind *kind);

enum { CLI_KEY_SIZE = 128 };

/// A key of a case as `--set` takes it, items of lists as the first one:
/// `load.shear.0.ratio.value`.
typedef struct cli_key {
    char path[CLI_KEY_SIZE];
    const lac_param *param;
} cli_key;

/// Calls `visit` for every key that a case can have, in the order of the tables.
void cli_keys_each(void (*visit)(FILE *out, const cli_key *key), FILE *out);

/// Writes a key with a star for its place in a list, and what its value can be.
void cli_put_pattern(FILE *out, const cli_key *key);
void cli_put_choices(FILE *out, const lac_param *param);

#endif
