// SPDX-License-Identifier: GPL-3.0-or-later
// What shells complete: commands, options, kinds, models and keys of a case, each from the table
// that the program itself reads.
#include <stdlib.h>
#include <string.h>

#include "cli/completion.h"
#include "cli/json.h"
#include "cli/templates.h"
#include "cli/words.h"

bool cli_takes(const cli_command *command, const cli_option *o)
{
    return ((command->options | CLI_OPT_COMMON) & o->bit) != 0;
}

const char *cli_files_of_command(const cli_command *command)
{
    if (strstr(command->arguments, "SERIES") != NULL) {
        return "*"; // monitoring data come under any name
    }
    const bool run = strstr(command->arguments, ".nc") != NULL;
    if (strstr(command->arguments, "CASE") != NULL) {
        return run ? "yaml|nc" : "yaml";
    }
    return run ? "nc" : "";
}

const char *cli_files_of_option(const cli_option *o)
{
    if (o->bit == CLI_OPT_OUTPUT || o->bit == CLI_OPT_COMPARE) {
        return "*";
    }
    return strcmp(o->name, "case") == 0 ? "yaml" : "";
}

void cli_put_commands(FILE *out, const char *between)
{
    const cli_command *command;
    for (size_t i = 0; (command = cli_command_at(i)) != NULL; i++) {
        (void)fprintf(out, "%s%s", i > 0 ? between : "", command->name);
    }
}

void cli_put_templates(FILE *out)
{
    for (size_t i = 0; cli_templates[i].kind != NULL; i++) {
        (void)fprintf(out, "%s%s", i > 0 ? " " : "", cli_templates[i].kind);
    }
}

void cli_put_kinds(FILE *out)
{
    const lac_kind *kind;
    const lac_section *section;
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
        (void)fprintf(out, "%s%s", i > 0 ? " " : "", kind->name);
    }
    for (size_t i = 0; (section = lac_section_at(i)) != NULL; i++) {
        (void)fprintf(out, " %s", section->name);
    }
}

void cli_put_models(FILE *out, const lac_kind *kind)
{
    const lac_descriptor *model;
    for (size_t i = 0; (model = kind->at(i)) != NULL; i++) {
        (void)fprintf(out, "%s%s", i > 0 ? " " : "", model->name);
    }
}

void cli_put_pattern(FILE *out, const cli_key *key)
{
    for (const char *c = key->path; *c != '\0'; c++) {
        (void)fputc(*c == '0' && c > key->path && c[-1] == '.' ? '*' : *c, out);
    }
}

void cli_put_choices(FILE *out, const lac_param *param)
{
    for (const char *const *choice = param->choices; *choice != NULL; choice++) {
        (void)fprintf(out, "%s%s", choice > param->choices ? " " : "", *choice);
    }
}

// The script as a text; NULL without memory. The caller frees it.
static char *script_of(void (*print)(FILE *out))
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (out == NULL) {
        return NULL;
    }
    print(out);
    if (fclose(out) != 0) {
        free(text);
        return NULL;
    }
    return text;
}

static lac_status print_json(const char *shell, void (*print)(FILE *out), lac_error *err)
{
    cli_json json = {.out = stdout};
    char *script = script_of(print);
    if (script == NULL) {
        return lac_fail_memory(err);
    }
    cli_json_open(&json, NULL, '{');
    cli_json_text(&json, "shell", shell);
    cli_json_text(&json, "script", script);
    cli_json_close(&json, '}');
    free(script);
    return LAC_OK;
}

lac_status cli_completion(const cli_request *request, lac_error *err)
{
    static const struct {
        const char *name;
        void (*print)(FILE *out);
    } shells[] = {
        {"bash", cli_completion_bash}, {"zsh", cli_completion_zsh}, {"fish", cli_completion_fish}};
    enum { SHELLS = sizeof shells / sizeof *shells };
    const char *names[SHELLS];
    for (size_t i = 0; i < SHELLS; i++) {
        names[i] = shells[i].name;
        if (strcmp(names[i], request->argument[0]) != 0) {
            continue;
        }
        if (cli_given(request, CLI_OPT_JSON)) {
            return print_json(names[i], shells[i].print, err);
        }
        shells[i].print(stdout);
        return LAC_OK;
    }
    return cli_unknown("completion: ", request->argument[0], "shell", names, SHELLS, err);
}
