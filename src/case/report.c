// SPDX-License-Identifier: GPL-3.0-or-later
// Errors and warnings about a case: each is one short line with its key, whatever the file holds.
#include <ctype.h>
#include <stdarg.h>

#include "case/sections.h"

enum { LONGEST_VALUE = 60, LONGEST_MESSAGE = 500 };

char *lac_reader_copy(lac_reader *reader, const char *text, size_t size)
{
    char *copy = strndup(text, size);
    reader->no_memory = reader->no_memory || copy == NULL;
    return copy;
}

void *lac_reader_array(lac_reader *reader, size_t count, size_t size)
{
    void *array = calloc(count + 1, size);
    reader->no_memory = reader->no_memory || array == NULL;
    return array;
}

// A message is one line: control characters become '?', and what is cut ends in "..." between
// two characters of UTF-8.
static char *one_line(lac_reader *reader, const char *text, size_t longest)
{
    size_t n = strlen(text);
    bool cut = n > longest;
    if (cut) {
        for (n = longest; n > 0 && ((unsigned char)text[n] & 0xc0u) == 0x80u; n--) {
        }
    }
    char *line = malloc(n + sizeof "...");
    if (line == NULL) {
        reader->no_memory = true;
        return NULL;
    }
    for (size_t i = 0; i < n; i++) {
        line[i] = iscntrl((unsigned char)text[i]) ? '?' : text[i];
    }
    memcpy(line + n, cut ? "..." : "", cut ? sizeof "..." : 1);
    return line;
}

// What an issue is said of.
typedef struct subject {
    size_t line; // 0: of --set
    const char *key, *value;
    bool warning;
} subject;

static void add_issue(lac_reader *reader, const subject *of, const char *format, va_list args)
    __attribute__((format(printf, 3, 0)));

static void add_issue(lac_reader *reader, const subject *of, const char *format, va_list args)
{
    char message[LONGEST_MESSAGE + 100];
    lac_case_issues *report = reader->report;
    if (report->issue == NULL) {
        report->issue = calloc(LAC_MOST_ISSUES + 1, sizeof *report->issue);
        reader->no_memory = reader->no_memory || report->issue == NULL;
    }
    if (report->issue == NULL || report->count > LAC_MOST_ISSUES) {
        return;
    }
    bool full = report->count == LAC_MOST_ISSUES;
    lac_case_issue *issue = &report->issue[report->count++];
    (void)vsnprintf(message, sizeof message, format, args);
    issue->line = of->line;
    issue->warning = of->warning && !full;
    report->errors += issue->warning ? 0 : 1;
    issue->file = one_line(reader, of->line == 0 ? "--set" : reader->name, 4096);
    issue->key = one_line(reader, full ? "" : of->key, LAC_KEY_LENGTH);
    issue->value = one_line(reader, full ? "" : of->value, LONGEST_VALUE);
    issue->message =
        one_line(reader, full ? "has more errors, which are not listed" : message, LONGEST_MESSAGE);
}

void lac_add_error(lac_reader *reader, const lac_node *node, const char *format, ...)
{
    char key[LAC_KEY_LENGTH];
    bool scalar = node->kind == LAC_NODE_SCALAR && node->text != NULL;
    subject of = {.line = node->line,
                  .key = lac_node_path(node, key, sizeof key),
                  .value = scalar ? node->text : ""};
    va_list args;
    va_start(args, format);
    if (!node->bad) {
        add_issue(reader, &of, format, args);
    }
    va_end(args);
}

// What is said of a dotted key: at its node, or the nearest one above it.
static subject of_key(const lac_reader *reader, const char *key, bool warning)
{
    char path[LAC_KEY_LENGTH];
    const lac_node *node = NULL;
    (void)snprintf(path, sizeof path, "%s", key);
    for (;;) {
        node = lac_node_at(reader->root, path);
        char *dot = strrchr(path, '.');
        if (node != NULL || path[0] == '\0') {
            break;
        }
        *(dot != NULL ? dot : path) = '\0';
    }
    bool exact = strcmp(lac_node_path(node, path, sizeof path), key) == 0;
    return (subject){.line = node->line,
                     .key = key,
                     .value = exact && node->kind == LAC_NODE_SCALAR ? node->text : "",
                     .warning = warning};
}

bool lac_refuse(lac_reader *reader, bool wrong, const char *key, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    if (wrong) {
        subject of = of_key(reader, key, false);
        add_issue(reader, &of, format, args);
    }
    va_end(args);
    return wrong;
}

void lac_warn(lac_reader *reader, const char *key, const char *format, ...)
{
    subject of = of_key(reader, key, true);
    va_list args;
    va_start(args, format);
    add_issue(reader, &of, format, args);
    va_end(args);
}

void lac_add_error_text(lac_reader *reader, size_t line, const char *place, const char *format, ...)
{
    subject of = {.line = line, .key = place != NULL ? place : "", .value = ""};
    va_list args;
    va_start(args, format);
    add_issue(reader, &of, format, args);
    va_end(args);
}

void lac_append_names(char *list, size_t size, const char *const *names, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        lac_append(list, size, "%s%s", i == 0 ? "" : ", ", names[i]);
    }
}

void lac_add_error_unknown(lac_reader *reader, const lac_node *node, const char *what,
                           const char *const *known, size_t count)
{
    char list[LONGEST_MESSAGE] = "";
    const char *near = lac_nearest(node->key, known, count);
    lac_node named = *node; // its key is to blame, not its value
    named.text = NULL;
    named.bad = false;
    if (near != NULL) {
        lac_add_error(reader, &named, "is no %s here; did you mean \"%s\"?", what, near);
        return;
    }
    lac_append_names(list, sizeof list, known, count);
    lac_add_error(reader, &named, "is no %s here; known:%s%s", what, count > 0 ? " " : "", list);
}

// Insertion keeps issues of one line in the order they were found; there are few.
void lac_case_issues_sort(lac_case_issues *report)
{
    for (size_t i = 1; i < report->count; i++) {
        lac_case_issue moving = report->issue[i];
        size_t line = moving.line - 1; // 0, --set, becomes the largest
        size_t j = i;
        for (; j > 0 && report->issue[j - 1].line - 1 > line; j--) {
            report->issue[j] = report->issue[j - 1];
        }
        report->issue[j] = moving;
    }
}

void lac_case_issues_clear(lac_case_issues *report)
{
    for (size_t i = 0; i < report->count; i++) {
        free(report->issue[i].file);
        free(report->issue[i].key);
        free(report->issue[i].value);
        free(report->issue[i].message);
    }
    free(report->issue);
    *report = (lac_case_issues){0};
}

static const char *or_empty(const char *text) { return text != NULL ? text : ""; }

const char *lac_case_issue_format(const lac_case_issue *issue, char *text, size_t size)
{
    char line[32] = "";
    if (issue == NULL || text == NULL || size == 0) {
        return NULL;
    }
    const char *key = or_empty(issue->key);
    const char *value = or_empty(issue->value);
    if (issue->line > 0) {
        (void)snprintf(line, sizeof line, ":%zu", issue->line);
    }
    (void)snprintf(text, size, "%s%s: %s%s%s%s%s%s", or_empty(issue->file), line, key,
                   key[0] == '\0' ? "" : ": ", value[0] == '\0' ? "" : "\"", value,
                   value[0] == '\0' ? "" : "\" ", or_empty(issue->message));
    return text;
}
