// SPDX-License-Identifier: GPL-3.0-or-later
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case/case.h"
#include "support/test.h"

#define WRONG LACUNA_SOURCE_DIR "/tests/case/wrong"

enum { LONGEST = 24000 };

static void append(char *text, const char *line)
{
    size_t used = strlen(text);
    assert_true(used + strlen(line) + 2 < LONGEST);
    (void)snprintf(text + used, LONGEST - used, "%s\n", line);
}

// The report as "LINE: KEY: "VALUE" MESSAGE" lines, warnings marked.
static void report_text(const lac_case_issues *report, const char *path, char *text)
{
    text[0] = '\0';
    for (size_t i = 0; i < report->count; i++) {
        char line[2000];
        char marked[2100];
        lac_case_issue_format(&report->issue[i], line, sizeof line);
        assert_memory_equal(line, path, strlen(path));
        assert_int_equal(line[strlen(path)], ':');
        assert_null(strchr(line, '\n'));
        (void)snprintf(marked, sizeof marked, "%s%s", report->issue[i].warning ? "warning: " : "",
                       line + strlen(path) + 1);
        append(text, marked);
    }
}

static void read_expected(const char *path, char *text)
{
    FILE *file = fopen(path, "r");
    if (file == NULL) {
        fail_msg("%s is missing", path);
        return;
    }
    size_t n = fread(text, 1, LONGEST - 1, file);
    text[n] = '\0';
    (void)fclose(file);
}

// Line by line; one that ends in "..." says how it begins: lists of models grow.
static bool as_expected(const char *found, const char *expected)
{
    while (*expected != '\0') {
        size_t n = strcspn(expected, "\n"), m = strcspn(found, "\n");
        bool open = n >= 3 && strncmp(expected + n - 3, "...", 3) == 0;
        size_t least = open ? n - 3 : n;
        if (m < least || (!open && m > n) || strncmp(found, expected, least) != 0) {
            return false;
        }
        expected += n + (expected[n] == '\n');
        found += m + (found[m] == '\n');
    }
    return *found == '\0';
}

static void check_one(const char *name)
{
    static char expected[LONGEST];
    static char found[LONGEST];
    char path[600];
    char text_path[600];
    lac_case *c = NULL;
    lac_case_issues report;
    lac_error err = {""};
    (void)snprintf(path, sizeof path, "%s/%s", WRONG, name);
    (void)snprintf(text_path, sizeof text_path, "%.*s.txt", (int)(strlen(path) - 5), path);
    lac_status status = lac_case_read(path, NULL, &c, &report, &err);
    if (status != LAC_EINPUT || c != NULL || err.message[0] == '\0') {
        fail_msg("%s: status %d, \"%s\"", name, status, err.message);
    }
    report_text(&report, path, found);
    read_expected(text_path, expected);
    if (!as_expected(found, expected)) {
        fail_msg("%s is said to be wrong in this way:\n%sand not:\n%s", name, found, expected);
    }
    lac_case_issues_clear(&report);
}

static void every_wrong_case_says_what_is_wrong(void **state)
{
    (void)state;
    DIR *folder = opendir(WRONG);
    assert_non_null(folder);
    size_t checked = 0;
    for (const struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        const char *dot = strrchr(entry->d_name, '.');
        if (dot != NULL && strcmp(dot, ".yaml") == 0) {
            check_one(entry->d_name);
            checked++;
        }
    }
    (void)closedir(folder);
    assert_true(checked >= 90);
}

static void expect_text(const char *text, size_t size, const char *message)
{
    lac_case *c = NULL;
    lac_case_issues report;
    char line[2000];
    assert_int_equal(lac_case_read_text("x.yaml", text, size, NULL, &c, &report, NULL), LAC_EINPUT);
    assert_null(c);
    assert_int_equal(report.count, 1);
    assert_int_equal(report.errors, 1);
    assert_string_equal(lac_case_issue_format(&report.issue[0], line, sizeof line), message);
    lac_case_issues_clear(&report);
}

static void monsters_get_one_line(void **state)
{
    (void)state;
    size_t size = 5u << 20;
    char *text = malloc(size);
    assert_non_null(text);
    memset(text, '#', size);
    expect_text(text, size, "x.yaml:1: is larger than 4 MiB, which no case is");
    expect_text(text, 1u << 20, "x.yaml:1: is empty; a case starts with lacuna: 1");
    memset(text, '[', 100000);
    expect_text(text, 100000, "x.yaml:1: is no case: it is nested more than 32 deep");
    memset(text, '-', 100000);
    for (size_t i = 1; i < 100000; i += 2) {
        text[i] = ' ';
    }
    expect_text(text, 100000, "x.yaml:1: is no case: it is nested more than 32 deep");
    size_t used = 0;
    for (int i = 0; i < 300; i++) {
        used += (size_t)snprintf(text + used, size - used, "k%d: 1\n", i);
    }
    expect_text(text, used, "x.yaml:257: is no case: a mapping has more than 256 keys");
    used = (size_t)snprintf(text, size, "lacuna: [");
    for (int i = 0; i < 30000; i++) {
        used += (size_t)snprintf(text + used, size - used, "1,");
    }
    expect_text(text, used, "x.yaml:1: is no case: it has more than 20000 values");
    free(text);
}

static void what_cannot_be_read_is_an_io_error(void **state)
{
    (void)state;
    static const char *const paths[] = {WRONG, WRONG "/absent.yaml", WRONG "/empty.yaml/x", ""};
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
        lac_case *c = NULL;
        lac_case_issues report;
        lac_error err = {""};
        assert_int_equal(lac_case_read(paths[i], NULL, &c, &report, &err), LAC_EIO);
        assert_null(c);
        assert_int_equal(report.count, 0);
        assert_non_null(strstr(err.message, "cannot be "));
        lac_case_issues_clear(&report);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_wrong_case_says_what_is_wrong),
        cmocka_unit_test(monsters_get_one_line),
        cmocka_unit_test(what_cannot_be_read_is_an_io_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
