// SPDX-License-Identifier: GPL-3.0-or-later
// The stations as Prometheus reads a text file: a family of numbers after the other.
#include "base/temp_file.h"
#include "watch/internal.h"

typedef struct family {
    const char *name, *type, *help;
    double (*value)(const lac_station *s); // NULL: how many readings came to be `taken`
    lac_taken taken;
} family;

static double last_time(const lac_station *s) { return s->n > 0 ? s->time[s->n - 1] : NAN; }
static double rate(const lac_station *s) { return s->rate; }
static double accelerating(const lac_station *s) { return s->accelerating ? 1.0 : 0.0; }
static double issued(const lac_station *s) { return s->issued; }
static double alarms(const lac_station *s) { return s->alarms; }
static double level(const lac_station *s) { return s->level; }
static double chance(const lac_station *s) { return s->chance; }

static const family families[] = {
    {"last_reading_seconds", "gauge", "Time of the last reading, of dates since 1970.", last_time,
     0},
    {"rate_meters_per_second", "gauge", "Last velocity.", rate, 0},
    {"accelerating", "gauge", "1 where the slope accelerates.", accelerating, 0},
    {"forecasts", "gauge", "Methods that issue a time of failure.", issued, 0},
    {"alarms", "gauge", "Methods whose median lies within the horizon.", alarms, 0},
    {"level", "gauge", "0 quiet, 1 watch, 2 warning, 3 alarm.", level, 0},
    {"chance_within_horizon", "gauge", "Chance of failure within the horizon, of all methods.",
     chance, 0},
    {"readings_total", "counter", "Readings taken.", NULL, LAC_TAKEN},
    {"late_total", "counter", "Of which came behind a later one.", NULL, LAC_TAKEN_LATE},
    {"doubled_total", "counter", "Dropped: there was one of that time.", NULL, LAC_TAKEN_DOUBLED},
    {"old_total", "counter", "Dropped: older than the window.", NULL, LAC_TAKEN_OLD},
    {"ahead_total", "counter", "Dropped: too far ahead of the clock.", NULL, LAC_TAKEN_AHEAD},
};

static void put_label(FILE *out, const char *text)
{
    for (; *text != '\0'; text++) {
        if (*text == '"' || *text == '\\') {
            (void)fputc('\\', out);
        }
        (void)fputc(*text, out);
    }
}

static void put_number(FILE *out, double value)
{
    char text[40];
    (void)fprintf(out, "%s\n",
                  isnan(value) ? "NaN" : lac_number_exact(value, 1, text, sizeof text));
}

static void put_family(FILE *out, const family *f, const lac_stations *s)
{
    (void)fprintf(out, "# HELP lacuna_%s %s\n# TYPE lacuna_%s %s\n", f->name, f->help, f->name,
                  f->type);
    for (size_t i = 0; i < s->n; i++) {
        (void)fprintf(out, "lacuna_%s{station=\"", f->name);
        put_label(out, s->at[i]->name);
        (void)fputs("\"} ", out);
        put_number(out, f->value != NULL ? f->value(s->at[i]) : (double)s->at[i]->taken[f->taken]);
    }
}

static void put_all(FILE *out, const lac_watch *w)
{
    for (size_t i = 0; i < sizeof families / sizeof *families; i++) {
        put_family(out, &families[i], &w->stations);
    }
    (void)fprintf(out,
                  "# HELP lacuna_bad_lines_total Lines that could not be read.\n"
                  "# TYPE lacuna_bad_lines_total counter\nlacuna_bad_lines_total %" PRIu64 "\n",
                  w->counts.bad);
}

lac_status lac_watch_tell(lac_watch *w, lac_error *err)
{
    char *text = NULL;
    size_t size = 0;
    if (w->def.fleet->prometheus == NULL || w->told) {
        return LAC_OK;
    }
    FILE *out = open_memstream(&text, &size);
    LAC_FAIL_MEMORY_IF(out == NULL, err);
    put_all(out, w);
    lac_status status = lac_text_made(out, &text) == NULL
                            ? lac_fail_memory(err)
                            : lac_write_text(w->def.fleet->prometheus, text, true, err);
    w->told = status == LAC_OK;
    free(text);
    return status;
}
