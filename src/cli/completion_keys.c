// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a case, from the tables that its reader goes by.
#include <string.h>

#include "cli/completion.h"

typedef struct walk {
    void (*visit)(FILE *out, const cli_key *key);
    FILE *out;
} walk;

static void visit(const walk *w, const char *folder, const lac_param *param)
{
    cli_key key = {.param = param};
    const char *point = folder[0] == '\0' ? "" : ".";
    (void)snprintf(key.path, sizeof key.path, "%s%s%s", folder, point, param->key);
    w->visit(w->out, &key);
}

// Whether keys of their own stand below this one, and it cannot be a value itself.
static bool holds_keys(const char *folder, const char *name)
{
    char path[CLI_KEY_SIZE];
    const lac_kind *kind;
    const lac_section *section;
    (void)snprintf(path, sizeof path, "%s.%s", folder, name);
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
        if (!kind->option && strcmp(kind->section, path) == 0) {
            return true;
        }
    }
    for (size_t i = 0; (section = lac_section_at(i)) != NULL; i++) {
        if (strcmp(section->name, path) == 0) {
            return strcmp(name, "every") != 0; // which may be a time as well
        }
    }
    return strcmp(name, "spread") == 0;
}

// The rows of a section below `folder`.
static void visit_rows(const walk *w, const char *folder, const lac_section *section)
{
    for (size_t i = 0; i < section->param_count; i++) {
        if (!holds_keys(folder, section->params[i].key)) {
            visit(w, folder, &section->params[i]);
        }
    }
}

static void visit_section(const walk *w, const lac_section *section)
{
    static const char *const cadences[] = {"output.every", "output.fields_every",
                                           "output.checkpoint"};
    if (strcmp(section->name, "case") == 0) {
        visit_rows(w, "", section);
    } else if (strcmp(section->name, "output.every") == 0) {
        for (size_t i = 0; i < sizeof cadences / sizeof *cadences; i++) {
            visit_rows(w, cadences[i], section);
        }
    } else if (strcmp(section->name, "compare") == 0) {
        visit_rows(w, "compare.0", section);
    } else if (strcmp(section->name, "load.history.steps") == 0) {
        visit_rows(w, "load.history.steps.0", section);
    } else {
        visit_rows(w, section->name, section);
    }
}

static void visit_models(const walk *w, const lac_kind *kind, const char *folder)
{
    char path[CLI_KEY_SIZE];
    const lac_descriptor *model;
    for (size_t i = 0; (model = kind->at(i)) != NULL; i++) {
        (void)snprintf(path, sizeof path, "%s.%s", folder, model->name);
        for (size_t k = 0; k < model->param_count; k++) {
            visit(w, path, &model->params[k]);
        }
    }
}

// Whether a law before this one has the parameter.
static bool seen(const lac_kind *laws, size_t before, const char *key)
{
    for (size_t i = 0; i < before; i++) {
        const lac_descriptor *law = laws->at(i);
        for (size_t k = 0; k < law->param_count; k++) {
            if (strcmp(law->params[k].key, key) == 0) {
                return true;
            }
        }
    }
    return false;
}

// What may differ from cell to cell: in friction whatever a law has for it.
static void visit_spreads(const walk *w, const lac_kind *spread, const lac_kind *laws)
{
    char path[CLI_KEY_SIZE];
    const lac_descriptor *law;
    visit_models(w, spread, "interface.spread.pressure");
    visit_models(w, spread, "initial.spread.slip_rate");
    visit_models(w, spread, "initial.spread.state");
    for (size_t i = 0; (law = laws->at(i)) != NULL; i++) {
        for (size_t k = 0; k < law->param_count; k++) {
            const lac_param *param = &law->params[k];
            if ((param->flags & LAC_CELLWISE) != 0 && !seen(laws, i, param->key)) {
                (void)snprintf(path, sizeof path, "friction.spread.%s", param->key);
                visit_models(w, spread, path);
            }
        }
    }
}

static const lac_kind *kind_of(const char *name)
{
    const lac_kind *kind = NULL;
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL && strcmp(kind->name, name) != 0; i++) {
    }
    return kind;
}

void cli_keys_each(void (*visit_key)(FILE *out, const cli_key *key), FILE *out)
{
    const walk w = {.visit = visit_key, .out = out};
    const lac_section *section;
    const lac_kind *kind;
    for (size_t i = 0; (section = lac_section_at(i)) != NULL; i++) {
        visit_section(&w, section);
    }
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
        char path[CLI_KEY_SIZE];
        const bool list =
            strcmp(kind->name, "shear") == 0 || strcmp(kind->name, "pore_pressure") == 0;
        (void)snprintf(path, sizeof path, "%s%s", kind->section, list ? ".0" : "");
        if (strcmp(kind->name, "spread") == 0) {
            visit_spreads(&w, kind, kind_of("friction"));
        } else if (!kind->option && kind->command == NULL) {
            visit_models(&w, kind, path);
        }
    }
}
