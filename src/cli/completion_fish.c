// SPDX-License-Identifier: GPL-3.0-or-later
#include <string.h>

#include "cli/completion.h"

// Prints a text with a backslash before each of the characters `special`.
static void put_escaped(FILE *out, const char *text, const char *special)
{
    for (; *text != '\0'; text++) {
        if (strchr(special, *text) != NULL) {
            (void)fputc('\\', out);
        }
        (void)fputc(*text, out);
    }
}

static void put_fish_key(FILE *out, const cli_key *key) { (void)fprintf(out, " %s", key->path); }

static void put_fish_choices(FILE *out, const cli_key *key)
{
    if (key->param->type == LAC_CHOICE) {
        (void)fprintf(out, "        case '");
        cli_put_pattern(out, key);
        (void)fprintf(out, "=*'\n            set values ");
        cli_put_choices(out, key->param);
        (void)fprintf(out, "\n");
    }
}

// KEY=VALUE: keys, then the values of one.
static void put_fish_set(FILE *out)
{
    (void)fprintf(out, "function __lacuna_set\n"
                       "    set -l typed (string replace -r '^--set=' '' -- (commandline -ct))\n"
                       "    set -l place (string match -r '\\.([0-9]+)\\.' -- $typed)\n"
                       "    set -q place[2]; or set place . 0\n"
                       "    set -l values\n    switch $typed\n");
    cli_keys_each(put_fish_choices, out);
    (void)fprintf(out, "        case '*=*'\n        case '*'\n"
                       "            string replace .0. .$place[2]. --");
    cli_keys_each(put_fish_key, out);
    (void)fprintf(out, " | string replace -r '$' =\n    end\n"
                       "    set -q values[1]; and printf '%%s\\n' "
                       "(string replace -r '=.*' = -- $typed)$values\nend\n");
}

// An option in fish: for the commands that take it.
static void put_fish_option(FILE *out, const cli_option *o)
{
    const cli_command *command;
    (void)fprintf(out, "complete -c lacuna");
    if ((o->bit & CLI_OPT_COMMON) == 0) {
        (void)fprintf(out, " -n '__fish_seen_subcommand_from");
        for (size_t i = 0; (command = cli_command_at(i)) != NULL; i++) {
            if (cli_takes(command, o)) {
                (void)fprintf(out, " %s", command->name);
            }
        }
        (void)fprintf(out, "'");
    }
    if (o->letter != '\0') {
        (void)fprintf(out, " -s %c", o->letter);
    }
    (void)fprintf(out, " -l %s%s", o->name,
                  o->value == NULL                    ? ""
                  : cli_files_of_option(o)[0] != '\0' ? " -r"
                                                      : " -x");
    if (o->bit == CLI_OPT_KIND) {
        (void)fprintf(out, " -a '");
        cli_put_templates(out);
        (void)fprintf(out, "'");
    } else if (o->bit == CLI_OPT_SET) {
        (void)fprintf(out, " -a '(__lacuna_set)'");
    }
    (void)fprintf(out, " -d '");
    put_escaped(out, o->doc, "'\\");
    (void)fprintf(out, "'\n");
}

void cli_completion_fish(FILE *out)
{
    const cli_command *command;
    const cli_option *o;
    const lac_kind *kind;
    (void)fprintf(out, "# fish completion of lacuna, written by `lacuna completion fish`\n");
    put_fish_set(out);
    for (size_t i = 0; (command = cli_command_at(i)) != NULL; i++) {
        (void)fprintf(out, "complete -c lacuna -f -n __fish_use_subcommand -a %s -d '",
                      command->name);
        put_escaped(out, command->summary, "'\\");
        (void)fprintf(out, "'\n");
        if (cli_files_of_command(command)[0] == '\0') {
            (void)fprintf(out, "complete -c lacuna -f -n '__fish_seen_subcommand_from %s'\n",
                          command->name);
        }
    }
    for (size_t i = 0; (o = cli_option_at(i)) != NULL; i++) {
        put_fish_option(out, o);
    }
    (void)fprintf(
        out, "complete -c lacuna -n '__fish_seen_subcommand_from completion' -a 'bash zsh fish'\n"
             "complete -c lacuna -n '__fish_seen_subcommand_from describe' -a '");
    cli_put_kinds(out);
    (void)fprintf(out, "'\n");
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
        (void)fprintf(out,
                      "complete -c lacuna -n '__fish_seen_subcommand_from describe; and "
                      "__fish_seen_subcommand_from %s' -a '",
                      kind->name);
        cli_put_models(out, kind);
        (void)fprintf(out, "'\n");
    }
}
