// SPDX-License-Identifier: GPL-3.0-or-later
// The page of a run: HTML in which two marks are replaced by the run's title and data.
#include "report/report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hidden.h"
#include "base/temp_file.h"
#include "report/assets.h"
#include "report/run.h"

const char *lac_page_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

static lac_status write_data(const lac_page *page, lac_error *err)
{
    static const struct {
        const char *key;
        lac_status (*write)(const lac_page *page, const char *key, lac_error *err);
    } sections[] = {
        {"about", lac_page_about},   {"motion", lac_page_course}, {"forces", lac_page_course},
        {"solver", lac_page_course}, {"series", lac_page_series}, {"fit", lac_page_fit},
        {"cells", lac_page_cells},   {"levels", lac_page_levels}, {"forecasts", lac_page_forecasts},
        {"events", lac_page_events},
    };
    lac_status status = LAC_OK;
    lac_json_open(page->json, NULL, '{');
    for (size_t i = 0; i < sizeof sections / sizeof *sections; i++) {
        LAC_TRY(sections[i].write(page, sections[i].key, err));
    }
    lac_json_close(page->json, '}');
out:
    return status;
}

static void put(lac_json *json, const char *text)
{
    json->broken = fputs(text, json->out) < 0 || json->broken;
}

// A text as it may stand in HTML.
static void put_escaped(lac_json *json, const char *plain)
{
    const char *end = plain + strlen(plain);
    for (const char *c = plain; c < end; c++) {
        const size_t hidden = lac_hidden_length(c, (size_t)(end - c));
        const char one[] = {*c, '\0'};
        c += hidden > 0 ? hidden - 1 : 0;
        put(json, hidden > 0 ? "?" : *one == '<' ? "&lt;" : *one == '&' ? "&amp;" : one);
    }
}

static bool begins(const char *text, const char *with)
{
    return strncmp(text, with, strlen(with)) == 0;
}

// The page up to its data, or from there on. @param nonce  of its scripts and styles; NULL: none
// @return what comes after
static const char *put_html(lac_json *json, const char *html, const char *title, const char *nonce)
{
    const char *at = html;
    for (; *at != '\0' && !begins(at, "@DATA@"); at++) {
        const char one[] = {*at, '\0'};
        if (begins(at, "@TITLE@")) {
            put_escaped(json, title);
            at += strlen("@TITLE@") - 1;
            continue;
        }
        if (nonce != NULL && *at == '>' &&
            (begins(at - strlen("<script"), "<script") ||
             begins(at - strlen("<style"), "<style"))) {
            put(json, " nonce=\"");
            put(json, nonce);
            put(json, "\"");
        }
        put(json, one);
    }
    return *at != '\0' ? at + strlen("@DATA@") : at;
}

// What was written, or that memory ran out.
static lac_status finish(const lac_json *json, char **text, lac_status status, lac_error *err)
{
    const bool whole = fclose(json->out) == 0 && !json->broken;
    status = status == LAC_OK && !whole ? lac_fail_memory(err) : status;
    if (status != LAC_OK) {
        free(*text);
        *text = NULL;
    }
    return status;
}

static lac_status make(const lac_page_def *def, bool html, char **out, lac_error *err)
{
    size_t size = 0;
    lac_page_run run = {0};
    lac_json json = {.page = true};
    const lac_page page = {.def = def, .run = &run, .json = &json};
    const char *rest = (const char *)lac_page_html;
    char title[512];
    lac_status status;
    *out = NULL;
    LAC_TRY(lac_page_run_read(def, &run, err));
    json.out = open_memstream(out, &size);
    LAC_TRY(json.out != NULL ? LAC_OK : lac_fail_memory(err));
    if (html) {
        const bool titled = lac_stored_file_text(run.file, NULL, "title", title, sizeof title);
        rest = put_html(&json, rest, titled ? title : run.path, NULL);
    }
    LAC_TRY(write_data(&page, err));
    put(&json, html ? rest : "");
out:
    lac_page_run_clear(&run);
    return json.out != NULL ? finish(&json, out, status, err) : status;
}

lac_status lac_page_data(const lac_page_def *def, char **json, lac_error *err)
{
    return make(def, false, json, err);
}

lac_status lac_page_write(const lac_page_def *def, const char *path, bool force, lac_error *err)
{
    char *html = NULL;
    lac_status status = make(def, true, &html, err);
    if (status == LAC_OK) {
        status = lac_write_text(path, html, force, err);
    }
    free(html);
    return status;
}

lac_status lac_page_live_page(const char *nonce, char **html, lac_error *err)
{
    size_t size = 0;
    lac_json json = {.out = open_memstream(html, &size)};
    *html = NULL;
    LAC_FAIL_MEMORY_IF(json.out == NULL, err);
    const char *rest = put_html(&json, (const char *)lac_page_html, "Lacuna", nonce);
    put(&json, "{\"live\":true}");
    (void)put_html(&json, rest, "", nonce);
    return finish(&json, html, LAC_OK, err);
}
