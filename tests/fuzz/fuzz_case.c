// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a case: read into a case whose text reads back to itself, or refused with clear
// lines. What follows a byte 1 is a --set.
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "case/sections.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool sound)
{
    if (!sound) {
        abort();
    }
}

static void check_report(const lac_case_issues *report)
{
    size_t errors = 0;
    for (size_t i = 0; i < report->count; i++) {
        const lac_case_issue *issue = &report->issue[i];
        char line[2000];
        lac_case_issue_format(issue, line, sizeof line);
        require(issue->message[0] != '\0' && strlen(line) < sizeof line - 1);
        for (const char *c = line; *c != '\0'; c++) {
            require((unsigned char)*c >= 0x20);
        }
        errors += issue->warning ? 0 : 1;
    }
    require(errors == report->errors);
}

static const char name[] = "folder/fuzz.yaml";

// The text of a case reads back to a case with the same text.
static void check_text(const lac_units *units, const lac_case *c, lac_case_purpose purpose)
{
    char *text = lac_case_text(c);
    lac_case *again = NULL;
    lac_case_issues report;
    require(text != NULL);
    const lac_case_request how = {.purpose = purpose};
    require(lac_case_build(units, name, text, strlen(text), &how, &again, &report, NULL) == LAC_OK);
    char *second = lac_case_text(again);
    require(second != NULL && strcmp(text, second) == 0);
    lac_case_issues_clear(&report);
    lac_case_free(again);
    free(second);
    free(text);
}

static void read_bytes(const lac_units *units, const char *text, size_t size,
                       const lac_case_request *how)
{
    lac_case *c = NULL;
    lac_case_issues report;
    lac_error err = {""};
    lac_status status = lac_case_build(units, name, text, size, how, &c, &report, &err);
    check_report(&report);
    if (status == LAC_OK) {
        require(report.errors == 0);
        check_text(units, c, how->purpose);
    } else {
        require(status == LAC_EINPUT && c == NULL && report.errors > 0 && err.message[0] != '\0');
    }
    lac_case_issues_clear(&report);
    lac_case_free(c);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static lac_units *units; // reading the database takes longer than all the rest
    if (units == NULL) {
        require(lac_units_create(&units, NULL) == LAC_OK);
    }
    char *text = malloc(size + 1);
    require(text != NULL);
    memcpy(text, data, size);
    text[size] = '\0';
    char *set = memchr(text, 1, size);
    char *value = set != NULL ? strchr(set, '=') : NULL;
    lac_override override = {.key = set != NULL ? set + 1 : "",
                             .value = value != NULL ? value + 1 : ""};
    if (value != NULL) {
        *value = '\0';
    }
    lac_case_request how = {.overrides = &override, .count = set != NULL ? 1 : 0};
    const size_t until = set != NULL ? (size_t)(set - text) : size;
    read_bytes(units, text, until, &how);
    how.purpose = LAC_FOR_CONTACT;
    read_bytes(units, text, until, &how);
    free(text);
    return 0;
}
