// SPDX-License-Identifier: GPL-3.0-or-later
// Whether --resume can go on: same program, same case but for its end, max_steps and file name.
#include "cli/run/resume.h"

#include <stdio.h>
#include <string.h>

#include "store/store.h"
#include "store/store_file.h"

enum { LINE = 200 };

// A resolved case, line by line, without what may differ.
typedef struct lines {
    const char *at;
    const char *rest;               // follows where `at` ends; NULL
    char section[LINE], line[LINE]; // as much of them as messages show
    size_t length;                  // of the whole line
    const char *start;
} lines;

static bool may_differ(const lines *l)
{
    static const char *const free_lines[][2] = {
        {"time:", "  end:"}, {"solver:", "  max_steps:"}, {"output:", "  file:"}};
    bool differs = false;
    for (size_t i = 0; i < sizeof free_lines / sizeof free_lines[0]; i++) {
        differs |= strcmp(l->section, free_lines[i][0]) == 0 &&
                   strncmp(l->line, free_lines[i][1], strlen(free_lines[i][1])) == 0;
    }
    return differs;
}

// The next line; "" at the end.
static void next(lines *l)
{
    do {
        if (*l->at == '\0' && l->rest != NULL) {
            l->at = l->rest;
            l->rest = NULL;
        }
        l->start = l->at;
        l->length = strcspn(l->at, "\n");
        (void)snprintf(l->line, sizeof l->line, "%.*s", (int)(l->length < LINE ? l->length : LINE),
                       l->at);
        l->at += l->length + (l->at[l->length] == '\n');
        if (l->line[0] != ' ') {
            memcpy(l->section, l->line, sizeof l->section);
        }
    } while (l->length > 0 && may_differ(l));
}

static bool is_same(const lines *a, const lines *b)
{
    return a->length == b->length && memcmp(a->start, b->start, a->length) == 0;
}

static const char *shown(const lines *l)
{
    return l->length == 0 ? "(nothing)" : l->line + strspn(l->line, " ");
}

static lac_status compare_cases(const char *path, const char *then, const char *now,
                                const char *inputs, lac_error *err)
{
    lines a = {.at = then};
    lines b = {.at = now, .rest = inputs};
    do {
        next(&a);
        next(&b);
        if (!is_same(&a, &b)) {
            return lac_fail(err, LAC_EINPUT,
                            "--resume: %s was begun with another case: it said %s %s, now %s %s",
                            path, a.section, shown(&a), b.section, shown(&b));
        }
    } while (a.length > 0);
    return LAC_OK;
}

static lac_status compare_programs(const char *path, const lac_kept_checkpoint *from,
                                   const char *libraries, lac_error *err)
{
    const char *program = lac_kept_checkpoint_program();
    if (strcmp(from->program, program) == 0 && strcmp(from->libraries, libraries) == 0) {
        return LAC_OK;
    }
    return lac_fail(err, LAC_EINPUT,
                    "--resume: the checkpoint of %s is of %s with %s; this is %s with %s", path,
                    from->program, from->libraries, program, libraries);
}

lac_status cli_resume_read(const char *path, const char *case_text, const char *inputs,
                           const char *libraries, lac_kept_checkpoint *out, lac_error *err)
{
    char status_word[32];
    lac_status status;
    *out = (lac_kept_checkpoint){.records = 0};
    LAC_TRY(lac_store_read_attribute(path, "status", status_word, sizeof status_word, err));
    if (strcmp(status_word, "complete") == 0) {
        LAC_TRY(lac_fail(err, LAC_EINPUT,
                         lac_store_is_cut(path)
                             ? "--resume: %s is complete but was not closed; lacuna mend %s"
                             : "--resume: %s is complete",
                         path, path));
    }
    LAC_TRY(lac_kept_checkpoint_read(path, out, err));
    LAC_TRY(compare_programs(path, out, libraries, err));
    LAC_TRY(compare_cases(path, out->case_text, case_text, inputs, err));
out:
    return status;
}
