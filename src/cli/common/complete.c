// SPDX-License-Identifier: GPL-3.0-or-later
// What may stand at the cursor of a command line, for all shells: commands, options, kinds and
// models, each from the table that the program itself reads. The scripts that shells read ask for
// it, and complete names of files themselves. Bash cuts words at = and :, so what it is told begins
// behind those.
#include "case/levels.h"
#include "cli/common/describe.h"
#include "cli/common/words.h"

enum { LINE_SIZE = 256 };

typedef struct offers {
    const char *word; // at the cursor
    size_t lead;      // letters of it that stay as they are: "--output="
    FILE *out;        // a newline, then a line of each candidate
    char *text;       // what went there
    size_t size;
} offers;

// A candidate that begins as what is typed and was not offered yet.
static void offer(const offers *all, const char *candidate, const char *meaning)
{
    char line[LINE_SIZE];
    const char *typed = all->word + all->lead;
    const int n = snprintf(line, LINE_SIZE, "\n%.*s%s\t", (int)all->lead, all->word, candidate);
    if (n < LINE_SIZE && strncmp(candidate, typed, strlen(typed)) == 0 && fflush(all->out) == 0 &&
        strstr(all->text, line) == NULL) {
        (void)fprintf(all->out, "%s%s\n", line + 1, meaning);
    }
}

// Files of these endings, "" for any. Nothing else stands where files do.
static void offer_files(const offers *all, const char *endings)
{
    if (fflush(all->out) == 0 && all->size == 1) {
        (void)fprintf(all->out, ":%.*s\t%s\n", (int)all->lead, all->word, endings);
    }
}

// Files by what the help text calls the argument, or the value of an option.
static void offer_files_of(const offers *all, const char *name)
{
    const bool run = strstr(name, ".nc") != NULL;
    if (strncmp(name, "CASE", 4) == 0) {
        offer_files(all, run ? "yaml|nc" : "yaml");
    } else if (strstr(name, "SERIES") != NULL || strcmp(name, "FILE") == 0 ||
               strcmp(name, "FIT") == 0) {
        offer_files(all, ""); // monitoring data come under any name
    } else if (run) {
        offer_files(all, "nc");
    }
}

static void offer_names(const offers *all, const cli_named_text *texts)
{
    for (; texts->name != NULL; texts++) {
        offer(all, texts->name, "");
    }
}

static void offer_options(const offers *all, const cli_command *command)
{
    const unsigned taken = CLI_OPT_COMMON | (command != NULL ? command->options : 0);
    for (const cli_option *o = cli_options; o->name != NULL; o++) {
        const char letter[] = {'-', o->letter, '\0'};
        if ((o->bit & taken) != 0) {
            offer(all, o->name, o->doc);
            offer(all, o->letter != '\0' ? letter : o->name, o->doc);
        }
    }
}

// What `describe` knows at its first place; the models of a kind that stands there.
static void offer_kinds(const offers *all, const char *of)
{
    const lac_kind *kind;
    const lac_section *section;
    const lac_model_info *model;
    for (size_t i = 0; (kind = lac_kind_get(i)) != NULL; i++) {
        if (of == NULL) {
            offer(all, kind->name, kind->summary);
            continue;
        }
        for (size_t k = 0; strcmp(kind->name, of) == 0 && (model = kind->at(k)) != NULL; k++) {
            offer(all, model->name, model->summary);
        }
    }
    for (size_t i = 0; of == NULL && (section = lac_section_get(i)) != NULL; i++) {
        offer(all, section->name, section->summary);
    }
    if (of == NULL) {
        offer(all, CLI_ROCK, CLI_ROCK_SUMMARY);
        offer(all, lac_levels_table.name, lac_levels_table.summary);
    } else if (strcmp(of, CLI_ROCK) == 0) {
        const lac_rock *rock;
        for (size_t i = 0; (rock = lac_rock_get(i)) != NULL; i++) {
            offer(all, rock->name, rock->summary);
        }
    }
}

static void offer_values(const offers *all, const cli_option *o)
{
    if (o->bit == CLI_OPT_KIND) {
        offer_names(all, cli_templates);
    } else {
        offer_files_of(all, o->value);
    }
}

static void offer_arguments(const offers *all, const cli_request *request)
{
    const cli_command *command = request->command;
    const char *names = command->arguments;
    if (request->count == command->most) {
        return;
    }
    if (command->run == cli_describe) {
        offer_kinds(all, request->argument[0]);
    } else if (command->run == cli_completion) {
        offer_names(all, cli_shells);
    } else {
        offer_files_of(all, names + (request->count > 0 ? strcspn(names, " ") : 0));
    }
}

// The option whose value stands in the word itself, --output=FILE or -oFILE; NULL: there is none.
static const cli_option *option_in_word(offers *all)
{
    const char *word = all->word;
    const size_t length = strcspn(word, "=");
    const bool is_long = word[1] == '-';
    const cli_option *o = NULL;
    if (is_long ? word[length] == '=' : word[1] != '\0' && word[2] != '\0') {
        o = cli_option_find(word, length);
        all->lead = is_long ? length + 1 : 2;
    }
    if (o == NULL || o->value == NULL) {
        all->lead = 0;
        return NULL;
    }
    return o;
}

// @param request  what stands before the word
static void offer_all(offers *all, const cli_request *request)
{
    const bool dashed = all->word[0] == '-' && !request->only_arguments;
    const cli_option *o = request->open;
    if (o == NULL && dashed) {
        o = option_in_word(all);
    }
    if (o != NULL) {
        offer_values(all, o);
    } else if (dashed) {
        offer_options(all, request->command);
    } else if (request->command == NULL) {
        for (const cli_command *command = cli_commands; command->name != NULL; command++) {
            offer(all, command->name, command->summary);
        }
    } else {
        offer_arguments(all, request);
    }
}

// Bash cuts words at = and :, and leaves quotes where they were typed: words as the program gets
// them are put into `text`. The word of a cursor behind a blank is empty, and one of its own.
// @return how many they are
static int join(int count, char **word, char *text)
{
    int kept = 0;
    bool cut = false;
    for (int i = 0; i < count; i++) {
        const char *c = word[i];
        const bool mark = c[0] != '\0' && c[strspn(c, "=:")] == '\0';
        if (kept > 0 && (mark || (cut && c[0] != '\0'))) {
            text--;
        } else {
            word[kept++] = text;
        }
        for (; *c != '\0'; c++) {
            *text = *c;
            text += strchr("'\"\\", *c) == NULL;
        }
        *text++ = '\0';
        cut = mark;
    }
    return kept;
}

void cli_complete(int count, char **word)
{
    cli_request request = {0};
    offers all = {.word = ""};
    size_t letters = 1;
    for (int i = 0; i < count; i++) {
        letters += strlen(word[i]) + 1;
    }
    char *text = malloc(letters);
    all.out = open_memstream(&all.text, &all.size);
    if (text != NULL && all.out != NULL && fputc('\n', all.out) == '\n') {
        count = join(count, word, text);
        if (count > 0) {
            all.word = word[--count];
        }
        cli_request_begin(count, word, &request);
        offer_all(&all, &request);
    }
    if (all.out != NULL && fclose(all.out) == 0) {
        (void)fputs(all.text + 1, stdout);
    }
    cli_request_clear(&request);
    free(all.text);
    free(text);
}

lac_status cli_completion(const cli_request *request, lac_error *err)
{
    const cli_named_text *shell = cli_find("completion: ", request->argument[0], "shell",
                                           cli_shells, sizeof *cli_shells, err);
    if (shell == NULL) {
        return LAC_EINPUT;
    }
    if (cli_given(request, CLI_OPT_JSON)) {
        lac_json json = {.out = stdout};
        LAC_JSON_TEXTS(&json, "shell", shell->name, "script", shell->text);
    } else {
        (void)fputs(shell->text, stdout);
    }
    return LAC_OK;
}
