// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna describe WORD: where a word of the user's own, "water" or "angle", stands in the tables.
#include "cli/common/describe.h"
#include "cli/common/words.h"
#include <ctype.h>

enum { LEAST_LETTERS = 3 }; // fewer stand in everything

// Letters of either case, and what parts words, are alike.
static int letter(char c)
{
    return c == ' ' || c == '_' || c == '-' ? ' ' : tolower((unsigned char)c);
}

// Whether a word of the text begins with this one; " ", "_" and "-" part words alike.
static bool has_word(const char *text, const char *word)
{
    const size_t n = strlen(word);
    for (const char *at = text; *at != '\0'; at++) {
        const bool starts = at == text || !isalnum((unsigned char)at[-1]);
        size_t same = 0;
        while (starts && same < n && letter(at[same]) == letter(word[same])) {
            same++;
        }
        if (same == n) {
            return true;
        }
    }
    return false;
}

typedef struct search {
    const char *word;
    lac_json *json; // NULL: as text
    bool tells;     // false: is counting
    size_t found;
} search;

static void tell(search *s, const char *kind, const char *name, const char *key, const char *text)
{
    s->found++;
    if (s->tells && s->json != NULL) {
        LAC_JSON_TEXTS(s->json, "kind", kind, "name", name, "key", key, "text", text);
    } else if (s->tells) {
        printf("  %s%s%s%s%s\n", kind, name[0] != '\0' ? " " : "", name, key[0] != '\0' ? ": " : "",
               key);
        cli_wrap("      ", text);
    }
}

static void search_model(search *s, const char *kind, const lac_model_info *model)
{
    const bool section = strcmp(kind, model->name) == 0;
    const char *name = section ? "" : model->name;
    if (has_word(model->name, s->word) || has_word(model->summary, s->word)) {
        tell(s, kind, name, "", model->summary);
    }
    for (size_t i = 0; i < model->param_count; i++) {
        const lac_param *param = &model->params[i];
        if (has_word(param->key, s->word) || has_word(param->doc, s->word)) {
            tell(s, kind, name, param->key, param->doc);
        }
    }
}

static void search_all(search *s)
{
    const lac_kind *kind;
    const lac_model_info *model;
    const lac_rock *rock;
    for (size_t i = 0; (kind = lac_kind_get(i)) != NULL; i++) {
        for (size_t k = 0; (model = kind->at(k)) != NULL; k++) {
            search_model(s, kind->name, model);
        }
    }
    for (size_t i = 0; (model = lac_section_get(i)) != NULL; i++) {
        search_model(s, model->name, model);
    }
    for (size_t i = 0; (rock = lac_rock_get(i)) != NULL; i++) {
        if (has_word(rock->name, s->word) || has_word(rock->summary, s->word)) {
            tell(s, CLI_ROCK, rock->name, "", rock->summary);
        }
    }
}

bool cli_describe_word(const cli_request *request)
{
    lac_json json = {.out = stdout};
    search s = {.word = request->argument[0]};
    if (request->count != 1 || request->pipe != 0 || strlen(s.word) < LEAST_LETTERS ||
        !isalnum((unsigned char)s.word[0])) {
        return false;
    }
    search_all(&s);
    if (s.found == 0) {
        return false;
    }
    s.tells = true;
    if (cli_given(request, CLI_OPT_JSON)) {
        s.json = &json;
        lac_json_open(&json, NULL, '{');
        lac_json_text(&json, "word", s.word);
        lac_json_open(&json, "found", '[');
        search_all(&s);
        lac_json_close(&json, ']');
        lac_json_close(&json, '}');
        return true;
    }
    printf("\"%s\" stands in these (lacuna describe KIND NAME has all of each):\n", s.word);
    search_all(&s);
    return true;
}
