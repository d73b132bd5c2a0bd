// SPDX-License-Identifier: GPL-3.0-or-later
// The page of a run: HTML in which marks are replaced by the run's title and data; what was run,
// from what, and how it ended.
#include "report/report.h"

#include "base/date.h"
#include "base/hidden.h"
#include "base/temp_file.h"
#include "report/run.h"

enum { LONGEST_TEXT = 1 << 18 }; // a case; the history of a run that was resumed often is long too

// Attributes of the file.
static const char numbers[] =
    "seed grid_nx grid_ny grid_dx_m grid_dy_m failed failure_time_s time_reached_s mean_slip_m "
    "max_slip_rate_m_s steps rhs_evaluations restarts newton_iterations linear_solves "
    "error_test_fails nonlinear_fails balance_residual_max wall_time_s factor_of_safety_least "
    "factor_of_safety_below_1_time_s factor_of_safety_reference_rate_m_s ";
static const char texts[] =
    "title institution references source history status libraries date_created date_modified "
    "time_zone failure_date ended_by arrest boundary fidelity fidelity_why resumed case ";

static void write_attributes(lac_page *page, const char *names, char *text)
{
    char name[32];
    for (size_t length; (length = strcspn(names, " ")) > 0; names += length + 1) {
        (void)snprintf(name, sizeof name, "%.*s", (int)length, names);
        const double value = lac_stored_file_number(page->file, NULL, name);
        if (text == NULL && value == value) {
            lac_json_digits(&page->json, name, value, 12);
        } else if (text != NULL &&
                   lac_stored_file_text(page->file, NULL, name, text, LONGEST_TEXT)) {
            lac_json_text(&page->json, name, text);
        }
    }
}

static void write_about(lac_page *page, const char *key)
{
    lac_json *json = &page->json;
    char date[32], *text = lac_page_room(page, LONGEST_TEXT);
    if (text == NULL) {
        return;
    }
    lac_json_open(json, key, '{');
    const lac_page_def *def = page->def;
    lac_json_text(json, "file", lac_path_last(def->name != NULL ? def->name : def->run));
    lac_json_text(json, "made_by", page->def->made_by);
    lac_json_text(json, "made", lac_date_format(page->def->now, date, sizeof date));
    lac_json_boolean(json, "dated", page->dated);
    lac_json_digits(json, "start", page->start, 17);
    lac_json_integer(json, "records", (int64_t)page->n);
    write_attributes(page, numbers, NULL);
    write_attributes(page, texts, text);
    if (page->readings) { // on the clock of the readings, as the time of a run's failure is on its
                          // own
        const double failed = lac_stored_file_number(page->file, NULL, "failed_at_s") - page->start;
        lac_json_boolean(json, "failed", isfinite(failed));
        lac_json_digits(json, "failure_time_s", failed, 14);
    }
    lac_json_close(json, '}');
}

typedef struct section {
    const char *key;
    void (*write)(lac_page *page, const char *key);
} section;

static void write_data(lac_page *page)
{
    static const section of_run[] = {
        {"about", write_about},
        {"motion", lac_page_course},
        {"direction", lac_page_course},
        {"safety", lac_page_course},
        {"forces", lac_page_course},
        {"solver", lac_page_course},
        {"series", lac_page_series},
        {"fit", lac_page_fit},
        {"points", lac_page_points_section},
        {"cells", lac_page_cells},
        {"levels", lac_page_levels},
        {"forecasts", lac_page_forecasts},
        {"events", lac_page_events},
        {0},
    };
    static const section of_readings[] = {
        {"about", write_about},
        {"verdict", lac_page_verdict},
        {"readings", lac_page_readings},
        {"alarm", lac_page_alarm},
        {"forecasts", lac_page_stored_forecasts},
        {0},
    };
    static const section of_ensemble[] = {
        {"about", write_about}, {"sweep", lac_page_of_ensemble}, {0}};
    const section *first = page->def->ensemble != NULL ? of_ensemble
                           : page->readings            ? of_readings
                                                       : of_run;
    lac_json_open(&page->json, NULL, '{');
    for (const section *s = first; s->key != NULL && page->status == LAC_OK; s++) {
        s->write(page, s->key);
    }
    lac_json_close(&page->json, '}');
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

// Goes past a mark that stands here.
static bool begins(const char **at, const char *mark)
{
    const bool found = strncmp(*at, mark, strlen(mark)) == 0;
    *at += found ? strlen(mark) : 0;
    return found;
}

// The page with what its marks stand for. @param nonce  of its scripts and styles, an attribute
// @param page  whose data it holds; NULL: it asks for them
static void put_html(lac_json *json, const char *title, const char *nonce, lac_page *page)
{
    for (const char *at = (const char *)lac_page_html; *at != '\0';) {
        const char one[] = {*at, '\0'};
        if (begins(&at, "@TITLE@")) {
            put_escaped(json, title);
        } else if (begins(&at, "@NONCE@")) {
            put(json, nonce);
        } else if (!begins(&at, "@DATA@")) {
            put(json, one);
            at++;
        } else if (page != NULL) {
            write_data(page);
        } else {
            put(json, "{\"live\":true}");
        }
    }
}

// @param nonce  NULL: the data alone. @param live  a page that asks for its data
static lac_status make(const lac_page_def *def, const char *nonce, bool live, char **out,
                       lac_error *err)
{
    size_t size = 0;
    char title[512];
    *out = NULL;
    lac_page page = {
        .def = def, .err = err, .json = {.page = true, .out = open_memstream(out, &size)}};
    if (page.json.out != NULL && !live) {
        lac_page_begin(&page);
    }
    if (live && page.json.out != NULL) {
        put_html(&page.json, def->run, nonce, NULL);
    } else if (page.file != NULL && page.status == LAC_OK && nonce != NULL) {
        const bool titled = lac_stored_file_text(page.file, NULL, "title", title, sizeof title);
        put_html(&page.json,
                 !titled         ? def->run
                 : page.readings ? lac_path_last(title)
                                 : title,
                 nonce, &page);
    } else if (page.file != NULL && page.status == LAC_OK) {
        write_data(&page);
    }
    lac_page_clear(&page);
    const bool whole = page.json.out != NULL && fclose(page.json.out) == 0 && !page.json.broken;
    if (page.status != LAC_OK || !whole) {
        free(*out);
        *out = NULL;
    }
    return page.status == LAC_OK && !whole ? lac_fail_memory(err) : page.status;
}

lac_status lac_page_data(const lac_page_def *def, char **json, lac_error *err)
{
    return make(def, NULL, false, json, err);
}

lac_status lac_page_write(const lac_page_def *def, const char *path, bool force, lac_error *err)
{
    char *html = NULL;
    lac_status status = make(def, "", false, &html, err);
    if (status == LAC_OK) {
        status = lac_write_text(path, html, force, err);
    }
    free(html);
    return status;
}

lac_status lac_page_live_page(const char *nonce, char **html, lac_error *err)
{
    const lac_page_def def = {.run = "Lacuna"};
    char attribute[80];
    (void)snprintf(attribute, sizeof attribute, " nonce=\"%s\"", nonce);
    return make(&def, attribute, true, html, err);
}
