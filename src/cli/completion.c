// SPDX-License-Identifier: GPL-3.0-or-later
// What shells complete: commands, options, kinds and models, each from the table that the program
// itself reads.
#include <string.h>

#include "cli/command.h"
#include "cli/templates.h"
#include "cli/words.h"

// Prints a text with a backslash before each of the characters `special`.
static void put_escaped(const char *text, const char *special)
{
    for (; *text != '\0'; text++) {
        if (strchr(special, *text) != NULL) {
            putchar('\\');
        }
        putchar(*text);
    }
}

// Inside single quotes in zsh, where what stands in brackets is the text.
static void put_zsh(const char *text)
{
    for (; *text != '\0'; text++) {
        if (*text == '\'') {
            printf("'\\''");
            continue;
        }
        printf(strchr("[]:\\", *text) != NULL ? "\\%c" : "%c", *text);
    }
}

static bool takes(const cli_command *command, const cli_option *o)
{
    return ((command->options | CLI_OPT_COMMON) & o->bit) != 0;
}

// Whether the word after it is its value, whatever it is.
static bool needs_value(const cli_option *o) { return o->value != NULL && o->value[0] != '['; }

static bool takes_files(const cli_command *command)
{
    return strstr(command->arguments, "CASE") != NULL || strstr(command->arguments, ".nc") != NULL;
}

static void put_commands(const char *between)
{
    const cli_command *command;
    for (size_t i = 0; (command = cli_command_at(i)) != NULL; i++) {
        printf("%s%s", i > 0 ? between : "", command->name);
    }
}

static void put_templates(void)
{
    for (size_t i = 0; cli_templates[i].kind != NULL; i++) {
        printf("%s%s", i > 0 ? " " : "", cli_templates[i].kind);
    }
}

// What `describe` knows at its first place.
static void put_kinds(void)
{
    const lac_kind *kind;
    const lac_section *section;
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
        printf("%s%s", i > 0 ? " " : "", kind->name);
    }
    for (size_t i = 0; (section = lac_section_at(i)) != NULL; i++) {
        printf(" %s", section->name);
    }
}

static void put_models(const lac_kind *kind)
{
    const lac_descriptor *model;
    for (size_t i = 0; (model = kind->at(i)) != NULL; i++) {
        printf("%s%s", i > 0 ? " " : "", model->name);
    }
}

// The options that `command` takes; of a NULL one the common ones.
static void put_option_names(const cli_command *command)
{
    const cli_option *o;
    for (size_t i = 0; (o = cli_option_at(i)) != NULL; i++) {
        if (command == NULL ? (o->bit & CLI_OPT_COMMON) != 0 : takes(command, o)) {
            printf(" --%s", o->name);
            if (o->letter != '\0') {
                printf(" -%c", o->letter);
            }
        }
    }
}

// Options whose value no list can give: the word after them is left alone.
static void put_free_values(void)
{
    const cli_option *o;
    const char *bar = "";
    for (size_t i = 0; (o = cli_option_at(i)) != NULL; i++) {
        if (needs_value(o) && o->bit != CLI_OPT_KIND && o->bit != CLI_OPT_OUTPUT) {
            printf("%s--%s", bar, o->name);
            bar = "|";
        }
    }
}

static void put_bash_arguments(const cli_command *command)
{
    const lac_kind *kind;
    if (strcmp(command->name, "describe") == 0) {
        printf("            case $before in\n");
        for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
            printf("                %s) words='", kind->name);
            put_models(kind);
            printf("' ;;\n");
        }
        printf("                describe) words='");
        put_kinds();
        printf("' ;;\n            esac ;;\n");
    } else if (strcmp(command->name, "completion") == 0) {
        printf("            words='bash zsh fish' ;;\n");
    } else {
        printf("            %s ;;\n", takes_files(command) ? "files=yes" : ":");
    }
}

static void print_bash(void)
{
    const cli_command *command;
    printf("# bash completion of lacuna, written by `lacuna completion bash`\n"
           "_lacuna() {\n"
           "    local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
           "    local command='' options='' words='' files='' word\n"
           "    for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
           "        case $word in\n            ");
    put_commands("|");
    printf(") command=$word; break ;;\n        esac\n    done\n"
           "    case $before in\n"
           "        -o|--output) mapfile -t COMPREPLY < <(compgen -f -- \"$current\"); return ;;\n"
           "        --kind) COMPREPLY=($(compgen -W '");
    put_templates();
    printf("' -- \"$current\")); return ;;\n        ");
    put_free_values();
    printf(") COMPREPLY=(); return ;;\n    esac\n    case $command in\n        '')\n"
           "            options='");
    put_option_names(NULL);
    printf("'\n            words='");
    put_commands(" ");
    printf("' ;;\n");
    for (size_t i = 0; (command = cli_command_at(i)) != NULL; i++) {
        printf("        %s)\n            options='", command->name);
        put_option_names(command);
        printf("'\n");
        put_bash_arguments(command);
    }
    printf("    esac\n"
           "    [[ $current == -* ]] && words=$options files=''\n"
           "    COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
           "    [[ $files ]] && mapfile -t COMPREPLY < <(compgen -f -- \"$current\")\n"
           "}\n"
           "complete -o filenames -F _lacuna lacuna\n");
}

static void put_zsh_option(const cli_option *o)
{
    const char *again = o->bit == CLI_OPT_SET ? "*" : "";
    for (int form = o->letter != '\0' ? 0 : 1; form < 2; form++) {
        printf(" \\\n                '%s", again);
        if (form == 0) {
            printf("-%c%s[", o->letter, needs_value(o) ? "+" : "");
        } else {
            printf("--%s%s[", o->name, needs_value(o) ? "=" : "");
        }
        put_zsh(o->doc);
        printf("]");
        if (needs_value(o)) {
            printf(":");
            put_zsh(o->value);
            printf(":");
        }
        if (o->bit == CLI_OPT_KIND) {
            printf("(");
            put_templates();
            printf(")");
        }
        printf("%s'", o->bit == CLI_OPT_OUTPUT ? "_files" : "");
    }
}

static void put_zsh_arguments(const cli_command *command)
{
    if (strcmp(command->name, "describe") == 0) {
        printf(" \\\n                '1::kind:(");
        put_kinds();
        printf(")' '2::name:_lacuna_models'");
    } else if (strcmp(command->name, "completion") == 0) {
        printf(" \\\n                '1:shell:(bash zsh fish)'");
    } else if (takes_files(command)) {
        printf(" \\\n                '*:file:_files'");
    } else {
        printf(" \\\n                '*:name:'");
    }
}

static void print_zsh_models(void)
{
    const lac_kind *kind;
    printf("_lacuna_models() {\n    case ${words[(r)(");
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
        printf("%s%s", i > 0 ? "|" : "", kind->name);
    }
    printf(")]} in\n");
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
        printf("        %s) compadd -- ", kind->name);
        put_models(kind);
        printf(" ;;\n");
    }
    printf("    esac\n}\n\n");
}

static void print_zsh(void)
{
    const cli_command *command;
    const cli_option *o;
    printf("#compdef lacuna\n# zsh completion of lacuna, written by `lacuna completion zsh`\n\n");
    print_zsh_models();
    printf("_lacuna() {\n    local state\n    local -a commands\n    commands=(");
    for (size_t i = 0; (command = cli_command_at(i)) != NULL; i++) {
        printf("\n        '%s:", command->name);
        put_zsh(command->summary);
        printf("'");
    }
    printf("\n    )\n    _arguments -C");
    for (size_t i = 0; (o = cli_option_at(i)) != NULL; i++) {
        if ((o->bit & CLI_OPT_COMMON) != 0) {
            put_zsh_option(o);
        }
    }
    printf(" \\\n        '1:command:->command' '*::argument:->rest'\n"
           "    case $state in\n"
           "        command) _describe command commands ;;\n"
           "        rest) case $words[1] in\n");
    for (size_t i = 0; (command = cli_command_at(i)) != NULL; i++) {
        printf("            %s) _arguments", command->name);
        for (size_t k = 0; (o = cli_option_at(k)) != NULL; k++) {
            if (takes(command, o)) {
                put_zsh_option(o);
            }
        }
        put_zsh_arguments(command);
        printf(" ;;\n");
    }
    // As a file that zsh loads by itself this is the body of _lacuna; else it is only sourced.
    printf("        esac ;;\n    esac\n}\n\n"
           "if [[ $funcstack[1] == _lacuna ]]; then _lacuna \"$@\"; else compdef _lacuna lacuna; "
           "fi\n");
}

// An option in fish: for the commands that take it.
static void put_fish_option(const cli_option *o)
{
    const cli_command *command;
    printf("complete -c lacuna");
    if ((o->bit & CLI_OPT_COMMON) == 0) {
        printf(" -n '__fish_seen_subcommand_from");
        for (size_t i = 0; (command = cli_command_at(i)) != NULL; i++) {
            if (takes(command, o)) {
                printf(" %s", command->name);
            }
        }
        printf("'");
    }
    if (o->letter != '\0') {
        printf(" -s %c", o->letter);
    }
    printf(" -l %s%s", o->name, !needs_value(o) ? "" : o->bit == CLI_OPT_OUTPUT ? " -r" : " -x");
    if (o->bit == CLI_OPT_KIND) {
        printf(" -a '");
        put_templates();
        printf("'");
    }
    printf(" -d '");
    put_escaped(o->doc, "'\\");
    printf("'\n");
}

static void print_fish(void)
{
    const cli_command *command;
    const cli_option *o;
    const lac_kind *kind;
    printf("# fish completion of lacuna, written by `lacuna completion fish`\n");
    for (size_t i = 0; (command = cli_command_at(i)) != NULL; i++) {
        printf("complete -c lacuna -f -n __fish_use_subcommand -a %s -d '", command->name);
        put_escaped(command->summary, "'\\");
        printf("'\n");
        if (!takes_files(command)) {
            printf("complete -c lacuna -f -n '__fish_seen_subcommand_from %s'\n", command->name);
        }
    }
    for (size_t i = 0; (o = cli_option_at(i)) != NULL; i++) {
        put_fish_option(o);
    }
    printf("complete -c lacuna -n '__fish_seen_subcommand_from completion' -a 'bash zsh fish'\n"
           "complete -c lacuna -n '__fish_seen_subcommand_from describe' -a '");
    put_kinds();
    printf("'\n");
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
        printf("complete -c lacuna -n '__fish_seen_subcommand_from describe; and "
               "__fish_seen_subcommand_from %s' -a '",
               kind->name);
        put_models(kind);
        printf("'\n");
    }
}

lac_status cli_completion(const cli_request *request, lac_error *err)
{
    static const struct {
        const char *name;
        void (*print)(void);
    } shells[] = {{"bash", print_bash}, {"zsh", print_zsh}, {"fish", print_fish}};
    enum { SHELLS = sizeof shells / sizeof *shells };
    const char *names[SHELLS];
    for (size_t i = 0; i < SHELLS; i++) {
        names[i] = shells[i].name;
        if (strcmp(names[i], request->argument[0]) == 0) {
            shells[i].print();
            return LAC_OK;
        }
    }
    return cli_unknown("completion: ", request->argument[0], "shell", names, SHELLS, err);
}
