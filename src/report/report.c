// SPDX-License-Identifier: GPL-3.0-or-later
// The page of a run: HTML in which two marks are replaced by the run's title and data.
#include "report/report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hidden.h"
#include "base/part.h"
#include "report/assets.h"
#include "report/run.h"

static lac_status write_data(const lac_page *page, lac_error *err)
{
    lac_status (*const sections[])(const lac_page *, lac_error *) = {
        lac_page_about, lac_page_motion, lac_page_forces, lac_page_solver,    lac_page_series,
        lac_page_fit,   lac_page_cells,  lac_page_levels, lac_page_forecasts, lac_page_events};
    lac_status status = LAC_OK;
    lac_page_open(page->text, NULL, '{');
    for (size_t i = 0; i < sizeof sections / sizeof *sections; i++) {
        LAC_TRY(sections[i](page, err));
    }
    lac_page_close(page->text, '}');
    LAC_TRY(page->text->broken ? lac_fail_memory(err) : LAC_OK);
out:
    return status;
}

// A text as it may stand in HTML.
static void put_escaped(lac_page_text *text, const char *plain)
{
    const char *end = plain + strlen(plain);
    for (const char *c = plain; c < end; c++) {
        const size_t hidden = lac_hidden_length(c, (size_t)(end - c));
        if (hidden > 0) {
            lac_page_puts(text, "?");
            c += hidden - 1;
        } else if (*c == '<') {
            lac_page_puts(text, "&lt;");
        } else if (*c == '&') {
            lac_page_puts(text, "&amp;");
        } else {
            lac_page_raw(text, c, 1);
        }
    }
}

// The page with what its two marks stand for: its title and its data.
static lac_status write_page(const lac_page *page, lac_error *err)
{
    static const char title_mark[] = "@TITLE@", data_mark[] = "@DATA@";
    const char *html = (const char *)lac_page_html;
    const char *title_at = strstr(html, title_mark);
    const char *data_at = strstr(html, data_mark);
    char title[512];
    if (!lac_page_attribute_text(page->run->file, "title", title, sizeof title)) {
        (void)snprintf(title, sizeof title, "%s", page->run->path);
    }
    lac_page_raw(page->text, html, (size_t)(title_at - html));
    put_escaped(page->text, title);
    title_at += sizeof title_mark - 1;
    lac_page_raw(page->text, title_at, (size_t)(data_at - title_at));
    const lac_status status = write_data(page, err);
    lac_page_puts(page->text, data_at + sizeof data_mark - 1);
    return status == LAC_OK && page->text->broken ? lac_fail_memory(err) : status;
}

typedef lac_status (*writer)(const lac_page *page, lac_error *err);

static lac_status make(const lac_report_def *def, writer write, char **out, lac_error *err)
{
    lac_page_text text = {0};
    lac_page_run run = {0};
    const lac_page page = {.def = def, .run = &run, .text = &text};
    lac_status status;
    *out = NULL;
    LAC_TRY(lac_page_run_read(def, &run, err));
    LAC_TRY(write(&page, err));
    *out = text.at;
    text.at = NULL;
out:
    lac_page_run_clear(&run);
    lac_page_text_clear(&text);
    return status;
}

lac_status lac_report_data(const lac_report_def *def, char **json, lac_error *err)
{
    return make(def, write_data, json, err);
}

lac_status lac_report_page(const lac_report_def *def, char **html, lac_error *err)
{
    return make(def, write_page, html, err);
}

lac_status lac_report_write(const lac_report_def *def, const char *path, bool force, lac_error *err)
{
    char *html = NULL;
    lac_status status = lac_report_page(def, &html, err);
    if (status == LAC_OK) {
        status = lac_write_text(path, html, force, err);
    }
    free(html);
    return status;
}
