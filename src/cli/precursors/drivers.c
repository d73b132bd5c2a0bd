// SPDX-License-Identifier: GPL-3.0-or-later
// What drives a slope, as --driver names it: columns beside the readings, or files with a clock of
// their own; and what it explains, in words.
#include "cli/precursors/precursors.h"

#include <sys/stat.h>

static const double day = 86400.0;
static const double uneven = 1.5; // median intervals

// "rain.csv/rain_mm:mm:sum", in parts that point into one copy.
typedef struct parts {
    const char *path; ///< NULL: the readings' own
    const char *column, *unit;
    bool sum;
} parts;

// The file is what comes before the first slash up to which there is one: columns may have slashes.
static char *find_slash(char *text)
{
    struct stat is;
    for (char *slash = strchr(text, '/'); slash != NULL; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        const bool file = stat(text, &is) == 0 && S_ISREG(is.st_mode);
        *slash = '/';
        if (file) {
            return slash;
        }
    }
    return NULL;
}

static lac_status split(const char *given, char *text, parts *out, lac_error *err)
{
    static const char must[] = "must be COLUMN:UNIT or FILE/COLUMN:UNIT, for amounts with \":sum\" "
                               "behind it, such as \"lake_m:m\" or \"rain.csv/rain_mm:mm:sum\"";
    char *colon = strrchr(text, ':');
    *out = (parts){.sum = colon != NULL && strcmp(colon, ":sum") == 0};
    if (out->sum) {
        *colon = '\0';
        colon = strrchr(text, ':');
    }
    LAC_FAIL_IF(colon == NULL || colon == text || colon[1] == '\0', err, LAC_EINPUT,
                "--driver: \"%s\" %s", given, must);
    *colon = '\0';
    out->unit = colon + 1;
    out->column = text;
    if (strchr(text, '/') != NULL) {
        char *slash = find_slash(text), *last = strrchr(text, '/');
        if (slash == NULL) {
            *last = '\0';
            return lac_fail(err, LAC_EIO, "--driver: %s: %s", text, strerror(ENOENT));
        }
        *slash = '\0';
        out->path = text;
        out->column = slash + 1;
    }
    LAC_FAIL_IF(out->column[0] == '\0', err, LAC_EINPUT, "--driver: \"%s\" %s", given, must);
    return LAC_OK;
}

// Values that look like amounts, at uneven times.
static bool asks_for_sum(const lac_series *s)
{
    double least = INFINITY, most = 0.0;
    size_t zeros = 0;
    for (size_t i = 0; i < s->n; i++) {
        zeros += s->value[i] == 0.0 ? 1 : 0;
        if (s->value[i] < 0.0) {
            return false;
        }
        const double step = i > 0 ? s->time[i] - s->time[i - 1] : NAN;
        least = fmin(least, step);
        most = fmax(most, step);
    }
    return zeros > 0 && most > uneven * least;
}

static lac_status check_times(const cli_watched *w, const char *given, const lac_series *s,
                              lac_error *err)
{
    const lac_readings *in = &w->readings;
    LAC_FAIL_IF(s->dated != w->of.dated, err, LAC_EINPUT,
                "--driver: \"%s\": its times are %s, those of %s are %s", given,
                s->dated ? "dates" : "no dates", w->of.source, w->of.dated ? "dates" : "no dates");
    LAC_FAIL_IF(s->time[0] >= in->time[in->n - 1] || s->time[s->n - 1] <= in->time[0], err,
                LAC_EINPUT,
                "--driver: \"%s\": its times, %s, have none in common with the readings', %s",
                given, cli_watched_span(&w->of, s->time[0], s->time[s->n - 1]).s,
                cli_watched_span(&w->of, in->time[0], in->time[in->n - 1]).s);
    return LAC_OK;
}

static bool is_called(const char *words, const char *column)
{
    const char *colon = words != NULL ? strrchr(words, ':') : NULL;
    const size_t n = words == NULL ? 0 : colon != NULL ? (size_t)(colon - words) : strlen(words);
    return words != NULL && strlen(column) == n && strncmp(words, column, n) == 0;
}

// Whether a column is what is to be explained.
static bool is_motion(const cli_request *request, const lac_case *known, const char *column)
{
    const cli_series_words *words = &request->series;
    const bool named = words->displacement != NULL || words->velocity != NULL;
    return is_called(words->displacement, column) || is_called(words->velocity, column) ||
           (!named && known != NULL &&
            (is_called(known->fit.columns.displacement, column) ||
             is_called(known->fit.columns.velocity, column)));
}

static lac_status read_one(const cli_request *request, const lac_case *known, const char *given,
                           const cli_watched *w, const lac_units *units, cli_drivers *out,
                           lac_error *err)
{
    lac_series_def def = {.time_format = request->series.time_format};
    const size_t k = out->n;
    parts p;
    out->text[k] = strdup(given);
    LAC_FAIL_MEMORY_IF(out->text[k] == NULL, err);
    LAC_TRY_RETURN(split(given, out->text[k], &p, err));
    for (size_t i = 0; i < k; i++) { // columns of two files may have one name; variables may not
        LAC_FAIL_IF(strcmp(out->driver[i].name, p.column) == 0, err, LAC_EINPUT,
                    "--driver: \"%s\" is the second driver named %s: rename a column", given,
                    p.column);
    }
    if (p.path == NULL) {
        def.time = request->series.time != NULL ? request->series.time
                   : known != NULL              ? known->fit.columns.time
                                                : NULL;
    }
    if (def.time_format == NULL && known != NULL) {
        def.time_format = known->fit.columns.time_format;
    }
    LAC_FAIL_IF(p.path == NULL && is_motion(request, known, p.column), err, LAC_EINPUT,
                "--driver: \"%s\" is the motion itself, and would explain it whatever drives the "
                "slope",
                given);
    def.path = p.path != NULL ? p.path : w->of.source;
    def.value = p.column;
    def.value_unit = def.value_si = p.unit; // of any dimension: kept as it is
    LAC_TRY_RETURN(lac_series_read(&def, units, &out->series[k], err));
    const lac_series *s = out->series[k];
    bool days = p.path != NULL && s->dated; // all at 00:00: values of days
    for (size_t i = 0; days && i < s->n; i++) {
        days = fmod(s->time[i], day) == 0.0;
    }
    out->driver[out->n++] = (lac_driver){.name = p.column,
                                         .unit = p.unit,
                                         .sum = p.sum,
                                         .days = days,
                                         .n = s->n,
                                         .time = s->time,
                                         .value = s->value};
    if (p.path != NULL) {
        cli_series_warn(request, p.path, s);
    }
    if (!p.sum && asks_for_sum(s) && !cli_given(request, CLI_OPT_QUIET)) {
        cli_note("warning: --driver: \"%s\": taken as means since the value before; \"%s:sum\" "
                 "where they are amounts",
                 given, given);
    }
    return check_times(w, given, s, err);
}

lac_status cli_drivers_read(const cli_request *request, const lac_case *known,
                            const cli_watched *watched, const lac_units *units, cli_drivers *out,
                            lac_error *err)
{
    LAC_FAIL_IF(request->drivers.n > LAC_DRIVERS_MAX, err, LAC_EINPUT,
                "--driver: %zu drivers, at most %d", request->drivers.n, (int)LAC_DRIVERS_MAX);
    LAC_FAIL_IF(request->drivers.n > 0 && watched->run, err, LAC_EINPUT,
                "--driver: is of monitoring files: %s is a run, and what drives it stands in its "
                "case",
                watched->of.source);
    for (size_t k = 0; k < request->drivers.n; k++) {
        LAC_TRY_RETURN(
            read_one(request, known, request->drivers.word[k], watched, units, out, err));
    }
    return LAC_OK;
}

void cli_drivers_clear(cli_drivers *drivers)
{
    for (size_t k = 0; k < LAC_DRIVERS_MAX; k++) {
        lac_series_free(drivers->series[k]);
        free(drivers->text[k]);
    }
}

// To two digits or so: it is not known better.
static cli_text length_of(double seconds)
{
    const cli_time_unit *u = cli_time_unit_of(seconds, 1.0);
    const double count = seconds / u->seconds, enough = 9.95;
    return cli_format(count < enough ? "%.1f %s" : "%.0f %s", count, u->name);
}

static cli_text answer_of(const lac_driver_effect *e)
{
    static const char *const words[] = {
        [LAC_RESPONSE_LAG] = "lag %s",
        [LAC_RESPONSE_MEMORY] = "memory %s",
        [LAC_RESPONSE_CHANGE] = "of its change, memory %s",
    };
    const cli_text length = e->scale > 0.0 ? length_of(e->scale) : cli_format("none");
    return cli_format(words[e->response], length.s);
}

void cli_drivers_print(const lac_forecast_set *forecasts)
{
    static const char *const remains[] = {
        [LAC_REMAINS_UNKNOWN] = "whether what remains accelerates cannot be told",
        [LAC_REMAINS_RISING] = "what remains accelerates",
        [LAC_REMAINS_LEVEL] = "what remains does not accelerate",
    };
    for (size_t k = 0; k < forecasts->effects; k++) {
        const lac_driver_effect *e = &forecasts->effect[k];
        printf("%s  %s: ", k == 0 ? "\n" : "", e->driver->name);
        if (e->verdict == LAC_EXPLAINS_UNKNOWN) {
            printf("cannot tell: %s\n", e->reason);
        } else if (e->verdict == LAC_EXPLAINS_NOT) {
            printf("does not explain the rate (p %.2g, %zu intervals)\n", e->p, e->intervals);
        } else {
            printf("explains %.0f %% of the rate (p %.2g), %s%s; %s\n", 100.0 * e->share, e->p,
                   e->slope < 0.0 ? "slower with more of it, " : "", answer_of(e).s,
                   remains[e->remains]);
        }
    }
}
