// SPDX-License-Identifier: GPL-3.0-or-later
// What may stand at the cursor of a command line, for all shells: commands, options, kinds, models
// and keys of a case, each from the table that the program itself reads. The scripts that shells
// read ask for it, and complete names of files themselves. Bash cuts words at = and :, so what it
// is told begins behind those.
#include "case/levels.h"
#include "cli/common/describe.h"
#include "cli/common/words.h"

enum { LINE_SIZE = 256 };

typedef struct offers {
    const char *word;  // at the cursor
    size_t lead;       // letters of it that stay as they are: "--set=", "solver.method="
    const char *key;   // of --set; its "=" stands before the value
    size_t key_length; // as far as it is typed
    bool again;        // the keys were gone through before
    FILE *out;         // a newline, then a line of each candidate
    char *text;        // what went there
    size_t size;
} offers;

// Whether a candidate begins as what is typed and was not offered yet; `line` is set to its line.
static bool is_new(const offers *all, const char *candidate, char line[LINE_SIZE])
{
    const char *typed = all->word + all->lead;
    const int n = snprintf(line, LINE_SIZE, "\n%.*s%s\t", (int)all->lead, all->word, candidate);
    return n < LINE_SIZE && strncmp(candidate, typed, strlen(typed)) == 0 &&
           fflush(all->out) == 0 && strstr(all->text, line) == NULL;
}

static void offer(const offers *all, const char *candidate, const char *meaning)
{
    char line[LINE_SIZE];
    if (is_new(all, candidate, line)) {
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

// What a key has behind its part that is typed, a place in a list being any number; NULL: the key
// is another one.
static const char *rest_of(const char *path, const char *typed, size_t n)
{
    for (const char *end = typed + n; typed < end; path++) {
        const bool place = *path == '0' && path[-1] == '.';
        const size_t letters = place ? strspn(typed, "0123456789") : *path == *typed;
        if (letters == 0) {
            return NULL;
        }
        typed += letters;
    }
    return path;
}

static void offer_key(const offers *all, const char *path, const lac_param *param)
{
    char name[LINE_SIZE], line[LINE_SIZE];
    const char *rest = rest_of(path, all->key, all->key_length);
    if (rest == NULL) {
        return;
    }
    if (all->key[all->key_length] == '=') { // its value, where the tables name it
        const bool choice = *rest == '\0' && param->type == LAC_CHOICE;
        if (*rest == '\0' && param->type == LAC_PATH) {
            offer_files(all, "");
        }
        for (size_t i = 0; choice && param->choices[i] != NULL; i++) {
            offer(all, param->choices[i], "");
        }
        return;
    }
    const size_t part = strcspn(rest, ".");
    const int n = snprintf(name, sizeof name, "%s%.*s.", all->key, (int)part, rest);
    if (rest[part] == '.') {
        offer(all, name, "");
    } else if (n < LINE_SIZE && all->again &&
               (is_new(all, name, line) || strncmp(path, "output.", 7) == 0)) {
        name[n - 1] = '='; // no keys stand below it; or they do, and it may be a time as well
        offer(all, name, param->doc);
    }
}

static void offer_rows(const offers *all, const char *folder, const lac_param *params, size_t count)
{
    char path[LINE_SIZE];
    for (size_t i = 0; i < count; i++) {
        const char *point = folder[0] == '\0' ? "" : ".";
        (void)snprintf(path, sizeof path, "%s%s%s", folder, point, params[i].key);
        offer_key(all, path, &params[i]);
    }
}

static void offer_models(const offers *all, const char *folder, const lac_kind *kind)
{
    char path[LINE_SIZE];
    const lac_model_info *model;
    for (size_t i = 0; (model = kind->at(i)) != NULL; i++) {
        (void)snprintf(path, sizeof path, "%s.%s", folder, model->name);
        offer_rows(all, path, model->params, model->param_count);
    }
}

// What may differ from cell to cell in friction is whatever a law has for it.
static void offer_spreads(const offers *all, const lac_kind *spread)
{
    char path[LINE_SIZE];
    const lac_friction_law *law;
    for (size_t i = 0; (law = lac_friction_law_get(i)) != NULL; i++) {
        for (size_t k = 0; k < law->info.param_count; k++) {
            if ((law->info.params[k].flags & LAC_CELLWISE) != 0) {
                (void)snprintf(path, sizeof path, "friction.spread.%s", law->info.params[k].key);
                offer_models(all, path, spread);
            }
        }
    }
}

// Where the rows of a section or the models of a kind stand, if not where its name says. An item of
// a list is its first one.
enum { MOST_PLACES = 3 };
static const struct {
    const char *name, *folder[MOST_PLACES + 1];
} places[] = {
    {"case", {""}},
    {"output.every", {"output.every", "output.fields_every", "output.checkpoint"}},
    {"compare", {"compare.0"}},
    {"load.history.steps", {"load.history.steps.0"}},
    {"load.shear", {"load.shear.0"}},
    {"load.normal_stress", {"load.normal_stress.0"}},
    {"load.pore_pressure", {"load.pore_pressure.0"}},
    {"weakening", {"weakening.0"}},
    {"friction.spread",
     {"interface.spread.pressure", "initial.spread.slip_rate", "initial.spread.state"}},
};

// The index-th folder of a section or a kind, NULL past the end.
static const char *folder_of(const char *name, size_t index)
{
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        if (strcmp(places[i].name, name) == 0) {
            return places[i].folder[index];
        }
    }
    return index == 0 ? name : NULL;
}

static void offer_every_key(const offers *all)
{
    const lac_section *section;
    const lac_kind *kind;
    const char *folder;
    for (size_t i = 0; (section = lac_section_get(i)) != NULL; i++) {
        for (size_t k = 0; (folder = folder_of(section->name, k)) != NULL; k++) {
            offer_rows(all, folder, section->params, section->param_count);
        }
    }
    for (size_t i = 0; (kind = lac_kind_get(i)) != NULL; i++) {
        const bool chosen = !kind->option && kind->command == NULL;
        for (size_t k = 0; chosen && (folder = folder_of(kind->section, k)) != NULL; k++) {
            offer_models(all, folder, kind);
        }
        if (strcmp(kind->name, "spread") == 0) {
            offer_spreads(all, kind);
        }
    }
}

// KEY=VALUE: first the parts that hold others, so that none of these is offered as a whole key.
static void offer_keys(offers *all)
{
    all->key = all->word + all->lead;
    all->key_length = strcspn(all->key, "=");
    if (all->key[all->key_length] == '=') {
        all->lead += all->key_length + 1;
    }
    offer_every_key(all);
    all->again = true;
    offer_every_key(all);
}

static void offer_values(offers *all, const cli_option *o)
{
    if (o->bit == CLI_OPT_SET) {
        offer_keys(all);
    } else if (o->bit == CLI_OPT_KIND) {
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
