// SPDX-License-Identifier: GPL-3.0-or-later
// The page of readings: what a file of lacuna precursors holds of their motion, of what drives it,
// of the forecasts from them, of the level at each time of issue, and what it says in words.
#include "base/date.h"
#include "base/temp_file.h"
#include "forecast/forecast.h"
#include "report/run.h"

enum { BUCKETS = 700, TEXT = 2000 };

static const char reading_time[] = "reading_time", issue_time[] = "issue_time";

bool lac_page_holds_readings(const lac_stored_file *file)
{
    lac_stored_shape shape;
    return lac_stored_file_shape(file, reading_time, &shape, NULL) == LAC_OK &&
           lac_stored_file_shape(file, issue_time, &shape, NULL) == LAC_OK;
}

lac_status lac_page_open_readings(lac_page *page)
{
    const lac_stored_values time = lac_page_values(page, page->file, reading_time);
    const lac_page_def *def = page->def;
    char unit[64];
    double zero = 0.0;
    LAC_TRY_RETURN(page->status);
    LAC_FAIL_IF(time.n == 0 || time.width != 1, page->err, LAC_EINPUT, "%s: holds no reading",
                def->run);
    (void)lac_stored_file_text(page->file, reading_time, "units", unit, sizeof unit);
    page->dated = strncmp(unit, "seconds since ", 14) == 0 && lac_date_parse(unit + 14, &zero);
    page->time = time.value;
    page->n = time.n;
    page->start = page->dated ? zero : 0.0;
    page->before = lac_page_room(page, page->n * sizeof *page->before);
    for (size_t i = 0; page->before != NULL && i < page->n; i++) {
        page->before[i] = page->time[page->n - 1] - page->time[i];
    }
    return page->status;
}

// A column over some times, thinned as that of a run is.
static void write_over(lac_page *page, const char *key, const lac_stored_values *time,
                       const lac_stored_values *value)
{
    const size_t n = value->n == time->n && value->width == 1 ? time->n : 0;
    uint8_t *keep = lac_page_room(page, n);
    double *before = lac_page_room(page, n * sizeof *before);
    lac_json *json = &page->json;
    if (keep == NULL || before == NULL) {
        return;
    }
    for (size_t i = 0; i < n; i++) {
        before[i] = time->value[n - 1] - time->value[i];
    }
    (void)lac_page_thin(n, time->value, before, BUCKETS, 1, (const double *const[]){value->value},
                        keep);
    lac_json_open(json, key, '{');
    lac_json_integer(json, "all", (int64_t)n);
    lac_page_column(page, "time", n, time->value, keep, 14);
    lac_page_column(page, "value", n, value->value, keep, 8);
    lac_json_close(json, '}');
}

static bool ends_in_time(const char *name)
{
    const size_t length = strlen(name);
    return length >= 4 && strcmp(name + length - 4, "time") == 0;
}

// The times of a variable: the first variable of times over its only dimension.
static bool find_times(lac_page *page, const lac_stored_shape *shape, char *name)
{
    lac_stored_shape other;
    for (size_t i = 0; lac_stored_file_variable(page->file, i, name, LAC_STORED_NAME); i++) {
        if (ends_in_time(name) && lac_stored_file_shape(page->file, name, &other, NULL) == LAC_OK &&
            other.rank == 1 && strcmp(other.dim[0].name, shape->dim[0].name) == 0) {
            return true;
        }
    }
    return false;
}

static void write_driver(lac_page *page, const char *name)
{
    lac_stored_shape shape;
    char over[LAC_STORED_NAME], text[TEXT];
    if (lac_stored_file_shape(page->file, name, &shape, NULL) != LAC_OK || shape.rank != 1 ||
        shape.text || ends_in_time(name) || !find_times(page, &shape, over)) {
        return;
    }
    lac_stored_values time = {0}, value = {0};
    if (lac_page_good(page, lac_stored_file_values(page->file, over, &time, page->err)) &&
        lac_page_good(page, lac_stored_file_values(page->file, name, &value, page->err))) {
        lac_json_open(&page->json, NULL, '{');
        lac_json_text(&page->json, "name", name + strlen("driver_"));
        (void)lac_stored_file_text(page->file, name, "units", text, sizeof text);
        lac_json_text(&page->json, "unit", text);
        (void)lac_stored_file_text(page->file, name, "long_name", text, sizeof text);
        lac_json_text(&page->json, "long_name", text);
        (void)lac_stored_file_text(page->file, name, "comment", text, sizeof text);
        lac_json_text(&page->json, "comment", text);
        write_over(page, "series", &time, &value);
        lac_json_close(&page->json, '}');
    }
    lac_stored_values_clear(&time);
    lac_stored_values_clear(&value);
}

static void write_drivers(lac_page *page)
{
    char name[LAC_STORED_NAME];
    lac_json_open(&page->json, "drivers", '[');
    for (size_t i = 0; lac_stored_file_variable(page->file, i, name, sizeof name); i++) {
        if (strncmp(name, "driver_", 7) == 0) {
            write_driver(page, name);
        }
    }
    lac_json_close(&page->json, ']');
}

void lac_page_readings(lac_page *page, const char *key)
{
    const lac_stored_values time = lac_page_values(page, page->file, reading_time);
    const lac_stored_values moved = lac_page_values(page, page->file, "displacement");
    const lac_stored_values then = lac_page_values(page, page->file, "velocity_time");
    const lac_stored_values rate = lac_page_values(page, page->file, "velocity");
    lac_json *json = &page->json;
    char text[TEXT];
    lac_json_open(json, key, '{');
    (void)lac_stored_file_text(page->file, NULL, "source_file", text, sizeof text);
    lac_json_text(json, "name", text[0] != '\0' ? lac_path_last(text) : page->def->run);
    (void)lac_stored_file_text(page->file, NULL, "source_attribution", text, sizeof text);
    lac_json_text(json, "attribution", text);
    lac_json_boolean(json, "falling", lac_stored_file_number(page->file, NULL, "falling") > 0.0);
    lac_json_digits(json, "noise", lac_stored_file_number(page->file, NULL, "noise_m"), 3);
    write_over(page, "moved", &time, &moved);
    if (rate.value != NULL) {
        write_over(page, "rate", &then, &rate);
    }
    write_drivers(page);
    lac_json_close(json, '}');
}

// An attribute that is shown as it is: a text, or a number with the unit that its name may end in.
static void write_said(lac_page *page, const char *variable, const char *name)
{
    char text[TEXT];
    if (!lac_stored_file_text(page->file, variable, name, text, sizeof text)) {
        const double value = lac_stored_file_number(page->file, variable, name);
        if (isnan(value)) {
            return;
        }
        (void)snprintf(text, sizeof text, "%.6g", value);
    }
    lac_json_open(&page->json, NULL, '[');
    lac_json_text(&page->json, NULL, name);
    lac_json_text(&page->json, NULL, text);
    lac_json_close(&page->json, ']');
}

// Whatever the file says under this name: attributes of the file that begin with it, and those of a
// variable of that name.
void lac_page_verdict(lac_page *page, const char *key)
{
    static const char *const about_itself[] = {"units", "long_name", "_FillValue", "coordinates"};
    const size_t length = strlen(key);
    char name[2 * LAC_STORED_NAME];
    lac_json_open(&page->json, key, '[');
    for (size_t i = 0; lac_stored_file_attribute(page->file, NULL, i, name, sizeof name); i++) {
        if (strncmp(name, key, length) == 0) {
            write_said(page, NULL, name);
        }
    }
    for (size_t i = 0; lac_stored_file_attribute(page->file, key, i, name, sizeof name); i++) {
        bool own = false;
        for (size_t k = 0; k < sizeof about_itself / sizeof *about_itself; k++) {
            own = own || strcmp(name, about_itself[k]) == 0;
        }
        if (!own) {
            write_said(page, key, name);
        }
    }
    lac_json_close(&page->json, ']');
}

void lac_page_alarm(lac_page *page, const char *key)
{
    const lac_stored_values issue = lac_page_values(page, page->file, issue_time);
    const lac_stored_values level = lac_page_values(page, page->file, "alarm_level");
    char text[TEXT];
    if (level.value == NULL || level.width != 1 || level.n != issue.n || issue.n == 0) {
        return; // a file of an earlier version
    }
    lac_json_open(&page->json, key, '{');
    lac_page_column(page, "time", issue.n, issue.value, NULL, 14);
    lac_page_column(page, "level", level.n, level.value, NULL, 3);
    (void)lac_stored_file_text(page->file, "alarm_level", "flag_meanings", text, sizeof text);
    lac_json_text(&page->json, "meanings", text);
    (void)lac_stored_file_text(page->file, "alarm_level", "comment", text, sizeof text);
    lac_json_text(&page->json, "comment", text);
    lac_json_close(&page->json, '}');
}

static bool same_word(const char *own, const char *name, size_t length)
{
    return strlen(own) == length && strncmp(own, name, length) == 0;
}

// What stands in the registry about a method that the file names; NULL: nothing.
static const lac_forecast_kind *find_kind(const char *name, size_t length)
{
    const lac_forecast_kind *kind = &lac_forecast_case;
    for (size_t i = 0; kind != NULL && !same_word(kind->info.name, name, length); i++) {
        kind = lac_forecast_kind_get(i);
    }
    return kind;
}

void lac_page_method(lac_page *page, const char *name, const lac_forecast_kind *kind)
{
    lac_json_open(&page->json, NULL, '{');
    lac_json_text(&page->json, "name", name);
    lac_json_text(&page->json, "summary", kind != NULL ? kind->info.summary : "");
    lac_json_text(&page->json, "reference", kind != NULL ? kind->info.reference : "");
    lac_json_boolean(&page->json, "baseline", kind != NULL && kind->baseline);
    lac_json_close(&page->json, '}');
}

static void write_methods(lac_page *page)
{
    char names[TEXT], name[LAC_STORED_NAME];
    (void)lac_stored_file_text(page->file, "method", "flag_meanings", names, sizeof names);
    lac_json_open(&page->json, "methods", '[');
    for (const char *at = names; *at != '\0'; at += strspn(at, " ")) {
        const size_t length = strcspn(at, " ");
        const lac_forecast_kind *kind = find_kind(at, length);
        (void)snprintf(name, sizeof name, "%.*s", (int)length, at);
        lac_page_method(page, name, kind);
        at += length;
    }
    lac_json_close(&page->json, ']');
}

// As those that are made for a page: times of failure count from the time of issue.
static void write_issues(lac_page *page, const lac_stored_values *issue, char **reason,
                         size_t methods)
{
    static const char *const names[] = {"failure_time", "failure_time_low90", "failure_time_low50",
                                        "failure_time_high50", "failure_time_high90"};
    const lac_stored_values issued = lac_page_values(page, page->file, "issued");
    const lac_stored_values raw = lac_page_values(page, page->file, "failure_time_raw");
    lac_stored_values time[sizeof names / sizeof *names];
    lac_json *json = &page->json;
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        time[k] = lac_page_values(page, page->file, names[k]);
    }
    for (size_t i = 0; i < issue->n; i++) {
        lac_json_open(json, NULL, '[');
        for (size_t m = 0; m < methods; m++) {
            const size_t at = i * methods + m;
            lac_json_open(json, NULL, '[');
            lac_json_boolean(json, NULL, issued.value[at] > 0.0);
            for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
                lac_json_digits(json, NULL,
                                time[k].value != NULL ? time[k].value[at] - issue->value[i] : NAN,
                                6);
            }
            lac_json_text(json, NULL, reason[at]);
            lac_json_open(json, NULL, '[');
            lac_json_close(json, ']');
            if (raw.n == issue->n && raw.width == methods) {
                lac_json_digits(json, NULL, raw.value[at] - issue->value[i], 6);
            }
            lac_json_close(json, ']');
        }
        lac_json_close(json, ']');
    }
}

// When it fails by all methods together, from the time of issue.
static void write_pooled(lac_page *page, const lac_stored_values *issue)
{
    const lac_stored_values pooled = lac_page_values(page, page->file, "pooled_time");
    if (pooled.value == NULL || pooled.n != issue->n || pooled.width != LAC_FORECAST_LEVELS) {
        return; // a file of an earlier version
    }
    lac_json_open(&page->json, "pooled", '[');
    for (size_t i = 0; i < issue->n; i++) {
        lac_json_open(&page->json, NULL, '[');
        for (size_t k = 0; k < pooled.width; k++) {
            lac_json_digits(&page->json, NULL, pooled.value[i * pooled.width + k] - issue->value[i],
                            6);
        }
        lac_json_close(&page->json, ']');
    }
    lac_json_close(&page->json, ']');
}

void lac_page_stored_forecasts(lac_page *page, const char *key)
{
    const lac_stored_values issue = lac_page_values(page, page->file, issue_time);
    const lac_stored_values issued = lac_page_values(page, page->file, "issued");
    const lac_stored_values failure = lac_page_values(page, page->file, "failure_time");
    lac_stored_shape shape;
    char **reason = NULL;
    if (page->status != LAC_OK ||
        !lac_page_good(page, lac_stored_file_shape(page->file, "reason", &shape, page->err)) ||
        !lac_page_good(page,
                       lac_stored_file_texts(page->file, "reason", &shape, &reason, page->err))) {
        return;
    }
    if (issued.n != issue.n || failure.n != issue.n || failure.width != issued.width ||
        shape.count != issued.n * issued.width) {
        (void)lac_page_good(
            page,
            lac_fail(page->err, LAC_EIO, "%s: its forecasts do not fit together", page->def->run));
    } else {
        lac_json_open(&page->json, key, '{');
        lac_json_boolean(&page->json, "measured", true);
        lac_json_integer(&page->json, "readings", (int64_t)page->n);
        write_methods(page);
        lac_page_column(page, "issue", issue.n, issue.value, NULL, 17);
        lac_json_open(&page->json, "forecast", '[');
        write_issues(page, &issue, reason, issued.width);
        lac_json_close(&page->json, ']');
        write_pooled(page, &issue);
        lac_json_close(&page->json, '}');
    }
    free((void *)reason);
}
