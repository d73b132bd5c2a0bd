// SPDX-License-Identifier: GPL-3.0-or-later
#include <string.h>

#include "cli/completion.h"

// Inside single quotes in zsh, where what stands in brackets is the text.
static void put_zsh(FILE *out, const char *text)
{
    for (; *text != '\0'; text++) {
        if (*text == '\'') {
            (void)fprintf(out, "'\\''");
            continue;
        }
        (void)fprintf(out, strchr("[]:\\", *text) != NULL ? "\\%c" : "%c", *text);
    }
}

// What completes files of these endings.
static void put_zsh_files(FILE *out, const char *endings)
{
    if (strcmp(endings, "*") == 0) {
        (void)fprintf(out, "_files");
    } else if (endings[0] != '\0') {
        (void)fprintf(out, "_files -g \"*.(%s)(-.)\"", endings);
    }
}

static void put_zsh_option(FILE *out, const cli_option *o)
{
    const char *again = o->bit == CLI_OPT_SET ? "*" : "";
    for (int form = o->letter != '\0' ? 0 : 1; form < 2; form++) {
        (void)fprintf(out, " \\\n                '%s", again);
        if (form == 0) {
            (void)fprintf(out, "-%c%s[", o->letter, o->value != NULL ? "+" : "");
        } else {
            (void)fprintf(out, "--%s%s[", o->name, o->value != NULL ? "=" : "");
        }
        put_zsh(out, o->doc);
        (void)fprintf(out, "]");
        if (o->value != NULL) {
            (void)fprintf(out, ":");
            put_zsh(out, o->value);
            (void)fprintf(out, ":");
        }
        if (o->bit == CLI_OPT_KIND) {
            (void)fprintf(out, "(");
            cli_put_templates(out);
            (void)fprintf(out, ")");
        } else if (o->bit == CLI_OPT_SET) {
            (void)fprintf(out, "_lacuna_set");
        } else {
            put_zsh_files(out, cli_files_of_option(o));
        }
        (void)fprintf(out, "'");
    }
}

static void put_zsh_arguments(FILE *out, const cli_command *command)
{
    if (strcmp(command->name, "describe") == 0) {
        (void)fprintf(out, " \\\n                '1::kind:(");
        cli_put_kinds(out);
        (void)fprintf(out, ")' '2::name:_lacuna_models'");
    } else if (strcmp(command->name, "completion") == 0) {
        (void)fprintf(out, " \\\n                '1:shell:(bash zsh fish)'");
    } else if (cli_files_of_command(command)[0] != '\0') {
        (void)fprintf(out, " \\\n                '*:file:");
        put_zsh_files(out, cli_files_of_command(command));
        (void)fprintf(out, "'");
    } else {
        (void)fprintf(out, " \\\n                '*:name:'");
    }
}

static void put_zsh_key(FILE *out, const cli_key *key) { (void)fprintf(out, " %s", key->path); }

static void put_zsh_choices(FILE *out, const cli_key *key)
{
    if (key->param->type != LAC_CHOICE && key->param->type != LAC_PATH) {
        return;
    }
    (void)fprintf(out, "            ");
    cli_put_pattern(out, key);
    if (key->param->type == LAC_PATH) {
        (void)fprintf(out, ") _files ;;\n");
        return;
    }
    (void)fprintf(out, ") compadd -- ");
    cli_put_choices(out, key->param);
    (void)fprintf(out, " ;;\n");
}

// KEY=VALUE: the next part of the key, then the value.
static void print_zsh_set(FILE *out)
{
    (void)fprintf(out, "_lacuna_set() {\n    local key rest\n    local -a keys match mbegin mend\n"
                       "    local -aU offers\n    keys=(");
    cli_keys_each(put_zsh_key, out);
    (void)fprintf(out, ")\n    if compset -P '*='; then\n"
                       "        key=${${IPREFIX%%=}##*=}\n        case $key in\n");
    cli_keys_each(put_zsh_choices, out);
    (void)fprintf(out, "        esac\n        return\n    fi\n"
                       "    [[ $PREFIX =~ '\\.([0-9]+)\\.' ]] && keys=(${keys//.0./.$match[1].})\n"
                       "    for key in ${(M)keys:#${(b)PREFIX}*}; do\n"
                       "        rest=${key#$PREFIX}\n"
                       "        if [[ $rest == *.* ]]; then offers+=($PREFIX${rest%%%%.*}.)\n"
                       "        else offers+=($key=); fi\n"
                       "    done\n"
                       "    compadd -Q -S '' -a offers\n}\n\n");
}

static void print_zsh_models(FILE *out)
{
    const lac_kind *kind;
    (void)fprintf(out, "_lacuna_models() {\n    case ${words[(r)(");
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
        (void)fprintf(out, "%s%s", i > 0 ? "|" : "", kind->name);
    }
    (void)fprintf(out, ")]} in\n");
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
        (void)fprintf(out, "        %s) compadd -- ", kind->name);
        cli_put_models(out, kind);
        (void)fprintf(out, " ;;\n");
    }
    (void)fprintf(out, "    esac\n}\n\n");
}

void cli_completion_zsh(FILE *out)
{
    const cli_command *command;
    const cli_option *o;
    (void)fprintf(
        out, "#compdef lacuna\n# zsh completion of lacuna, written by `lacuna completion zsh`\n\n");
    print_zsh_models(out);
    print_zsh_set(out);
    (void)fprintf(out, "_lacuna() {\n    local state\n    local -a commands\n    commands=(");
    for (size_t i = 0; (command = cli_command_at(i)) != NULL; i++) {
        (void)fprintf(out, "\n        '%s:", command->name);
        put_zsh(out, command->summary);
        (void)fprintf(out, "'");
    }
    (void)fprintf(out, "\n    )\n    _arguments -C");
    for (size_t i = 0; (o = cli_option_at(i)) != NULL; i++) {
        if ((o->bit & CLI_OPT_COMMON) != 0) {
            put_zsh_option(out, o);
        }
    }
    (void)fprintf(out, " \\\n        '1:command:->command' '*::argument:->rest'\n"
                       "    case $state in\n"
                       "        command) _describe command commands ;;\n"
                       "        rest) case $words[1] in\n");
    for (size_t i = 0; (command = cli_command_at(i)) != NULL; i++) {
        (void)fprintf(out, "            %s) _arguments", command->name);
        for (size_t k = 0; (o = cli_option_at(k)) != NULL; k++) {
            if (cli_takes(command, o)) {
                put_zsh_option(out, o);
            }
        }
        put_zsh_arguments(out, command);
        (void)fprintf(out, " ;;\n");
    }
    // As a file that zsh loads by itself this is the body of _lacuna; else it is only sourced.
    (void)fprintf(
        out, "        esac ;;\n    esac\n}\n\n"
             "if [[ $funcstack[1] == _lacuna ]]; then _lacuna \"$@\"; else compdef _lacuna lacuna; "
             "fi\n");
}
