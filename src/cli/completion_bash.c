// SPDX-License-Identifier: GPL-3.0-or-later
#include <string.h>

#include "cli/completion.h"

// The options that `command` takes; of a NULL one the common ones.
static void put_option_names(FILE *out, const cli_command *command)
{
    const cli_option *o;
    for (size_t i = 0; (o = cli_option_at(i)) != NULL; i++) {
        if (command == NULL ? (o->bit & CLI_OPT_COMMON) != 0 : cli_takes(command, o)) {
            (void)fprintf(out, " --%s", o->name);
            if (o->letter != '\0') {
                (void)fprintf(out, " -%c", o->letter);
            }
        }
    }
}

// What follows an option that takes a value: files, words, or nothing that a list could give.
static void put_values(FILE *out)
{
    const cli_option *o;
    for (size_t i = 0; (o = cli_option_at(i)) != NULL; i++) {
        if (o->value == NULL) {
            continue;
        }
        (void)fprintf(out, "        --%s", o->name);
        if (o->letter != '\0') {
            (void)fprintf(out, "|-%c", o->letter);
        }
        if (o->bit == CLI_OPT_SET) {
            (void)fputs(") _lacuna_set; return ;;\n", out);
        } else if (o->bit == CLI_OPT_KIND) {
            (void)fputs(") COMPREPLY=($(compgen -W '", out);
            cli_put_templates(out);
            (void)fputs("' -- \"$current\")); return ;;\n", out);
        } else {
            const char *files = cli_files_of_option(o);
            (void)fprintf(out, ") %s%s%s return ;;\n", files[0] != '\0' ? "_lacuna_files '" : "",
                          files, files[0] != '\0' ? "';" : "");
        }
    }
}

static void put_arguments(FILE *out, const cli_command *command)
{
    const lac_kind *kind;
    const char *files = cli_files_of_command(command);
    if (strcmp(command->name, "describe") == 0) {
        (void)fputs("            case $before in\n", out);
        for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
            (void)fprintf(out, "                %s) words='", kind->name);
            cli_put_models(out, kind);
            (void)fputs("' ;;\n", out);
        }
        (void)fputs("                describe) words='", out);
        cli_put_kinds(out);
        (void)fputs("' ;;\n            esac ;;\n", out);
    } else if (strcmp(command->name, "completion") == 0) {
        (void)fputs("            words='bash zsh fish' ;;\n", out);
    } else if (files[0] != '\0') {
        (void)fprintf(out, "            files='%s' ;;\n", files);
    } else {
        (void)fputs("            ;;\n", out);
    }
}

static void put_key(FILE *out, const cli_key *key) { (void)fprintf(out, " %s", key->path); }

// The values of a key, where the tables name them.
static void put_choices(FILE *out, const cli_key *key)
{
    if (key->param->type != LAC_CHOICE && key->param->type != LAC_PATH) {
        return;
    }
    (void)fputs("        ", out);
    cli_put_pattern(out, key);
    if (key->param->type == LAC_PATH) {
        (void)fputs(") files='*' ;;\n", out);
        return;
    }
    (void)fputs(") words='", out);
    cli_put_choices(out, key->param);
    (void)fputs("' ;;\n", out);
}

// KEY=VALUE: the next part of the key, then the value. Bash ends words at `=`, but not in quotes.
static void put_set(FILE *out)
{
    (void)fputs("_lacuna_keys='", out);
    cli_keys_each(put_key, out);
    (void)fputs("'\n\n_lacuna_values() {\n    words='' files=''\n    case $1 in\n", out);
    cli_keys_each(put_choices, out);
    (void)fputs(
        "    esac\n}\n\n"
        "_lacuna_set() {\n"
        "    local line=${COMP_LINE:0:COMP_POINT} typed quote='' keys=$_lacuna_keys key words "
        "files\n"
        "    local -A offers=()\n"
        "    typed=${line##*[[:space:]]} typed=${typed#--set=}\n"
        "    [[ $typed == [\\'\\\"]* ]] && quote=yes typed=${typed:1}\n"
        "    compopt +o filenames 2>/dev/null\n"
        "    if [[ $typed == *=* ]]; then\n"
        "        key=${typed%%=*}\n"
        "        _lacuna_values \"$key\"\n"
        "        COMPREPLY=($(compgen -W \"$words\" -- \"${typed#*=}\"))\n"
        "        [[ $files ]] && mapfile -t COMPREPLY < <(compgen -f -- \"${typed#*=}\")\n"
        "        [[ $quote ]] && COMPREPLY=(\"${COMPREPLY[@]/#/$key=}\")\n"
        "        return\n"
        "    fi\n"
        "    [[ $typed =~ \\.([0-9]+)\\. ]] && keys=${keys//.0./.${BASH_REMATCH[1]}.}\n"
        "    for key in $keys; do\n"
        "        [[ $key == \"$typed\"* ]] || continue\n"
        "        key=${key#\"$typed\"}\n"
        "        if [[ $key == *.* ]]; then offers[$typed${key%%.*}.]=1; else "
        "offers[$typed$key=]=1; fi\n"
        "    done\n"
        "    compopt -o nospace 2>/dev/null\n"
        "    COMPREPLY=(\"${!offers[@]}\")\n"
        "}\n\n",
        out);
}

static void put_files(FILE *out)
{
    (void)fputs(
        "_lacuna_files() {\n"
        "    local ending\n"
        "    if [[ $1 == '*' ]]; then\n"
        "        mapfile -t COMPREPLY < <(compgen -f -- \"$current\")\n"
        "        return\n"
        "    fi\n"
        "    mapfile -t COMPREPLY < <(compgen -d -- \"$current\"\n"
        "        for ending in ${1//|/ }; do compgen -f -X \"!*.$ending\" -- \"$current\"; done)\n"
        "}\n\n",
        out);
}

void cli_completion_bash(FILE *out)
{
    const cli_command *command;
    (void)fputs("# bash completion of lacuna, written by `lacuna completion bash`\n", out);
    put_set(out);
    put_files(out);
    (void)fputs(
        "_lacuna() {\n"
        "    local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
        "    local command='' options='' words='' files='' word\n"
        "    if [[ $current == = ]]; then\n"
        "        current=''\n"
        "    elif [[ $before == = ]]; then\n"
        "        before=${COMP_WORDS[COMP_CWORD-2]}\n"
        "    fi\n"
        "    [[ ${COMP_LINE:0:COMP_POINT} =~ --set[=[:space:]]+[^[:space:]]*$ ]] && before=--set\n"
        "    for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
        "        case $word in\n            ",
        out);
    cli_put_commands(out, "|");
    (void)fputs(") command=$word; break ;;\n        esac\n    done\n    case $before in\n", out);
    put_values(out);
    (void)fputs("    esac\n    case $command in\n        '')\n            options='", out);
    put_option_names(out, NULL);
    (void)fputs("'\n            words='", out);
    cli_put_commands(out, " ");
    (void)fputs("' ;;\n", out);
    for (size_t i = 0; (command = cli_command_at(i)) != NULL; i++) {
        (void)fprintf(out, "        %s)\n            options='", command->name);
        put_option_names(out, command);
        (void)fputs("'\n", out);
        put_arguments(out, command);
    }
    (void)fputs("    esac\n"
                "    [[ $current == -* ]] && words=$options files=''\n"
                "    COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
                "    [[ $files ]] && _lacuna_files \"$files\"\n"
                "}\n"
                "complete -o filenames -F _lacuna lacuna\n",
                out);
}
