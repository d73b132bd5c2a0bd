// SPDX-License-Identifier: GPL-3.0-or-later
// A watch from its beginning to its end; and a line of input to a line of output.
#define _GNU_SOURCE // newlocale
#include <unistd.h>

#include "data/dataset.h"
#include "precursor/precursor.h"
#include "watch/internal.h"

lac_status lac_watch_reader(const lac_watch *w, bool of_many, const char *where,
                            lac_line_reader **out, lac_error *err)
{
    const lac_fleet *f = w->def.fleet;
    const char *station = f->station != NULL ? f->station : "station";
    const lac_line_def def = {.path = where,
                              .station = of_many ? station : NULL,
                              .time = f->time != NULL ? f->time : "time",
                              .time_format = f->time_format,
                              .clock = f->clock,
                              .displacement = f->displacement,
                              .displacement_unit = f->displacement_unit,
                              .sigma = f->sigma,
                              .sigma_unit = f->sigma_unit,
                              .order = (const char *const *)f->column,
                              .columns = f->columns};
    return lac_line_reader_create(&def, w->def.units, out, err);
}

void lac_watch_blame(lac_watch *w, const char *where, uint64_t number, const char *station,
                     const char *why, const char *text)
{
    char shown[64];
    lac_json json = {.out = w->out, .line = true};
    w->counts.bad++;
    lac_json_open(&json, NULL, '{');
    lac_json_text(&json, "error", why);
    lac_json_text(&json, "source", where);
    lac_json_integer(&json, "line", (int64_t)number);
    if (station != NULL) {
        lac_json_text(&json, "station", station);
    }
    if (text != NULL) {
        (void)snprintf(shown, sizeof shown, "%.60s", text);
        lac_json_text(&json, "text", shown);
    }
    lac_json_integer(&json, "bad", (int64_t)w->counts.bad);
    lac_json_close(&json, '}');
}

static void open_line(lac_json *json, const lac_station *s, const lac_line *l)
{
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "station", s->name);
    lac_json_number(json, "time_s", l->time);
}

// A reading that changes nothing is said too.
static void say_dropped(lac_watch *w, const lac_station *s, const lac_line *l, lac_taken taken)
{
    const struct {
        const char *name;
        uint64_t *all;
    } row[] = {[LAC_TAKEN_DOUBLED] = {"doubled", &w->counts.doubled},
               [LAC_TAKEN_OLD] = {"old", &w->counts.old},
               [LAC_TAKEN_AHEAD] = {"ahead", &w->counts.ahead}};
    lac_json json = {.out = w->out, .line = true};
    (*row[taken].all)++;
    open_line(&json, s, l);
    lac_json_text(&json, "dropped", row[taken].name);
    lac_json_integer(&json, row[taken].name, (int64_t)s->taken[taken]);
    lac_json_close(&json, '}');
}

// What Prometheus is told.
static void note(const lac_forecast_set *set, lac_station *s)
{
    const lac_motion *m = set->motion;
    s->rate = m->velocities > 0 ? m->velocity[m->velocities - 1] : NAN;
    s->accelerating = set->accelerating;
    s->issued = (int)set->verdict.issued;
    s->alarms = (int)set->verdict.near;
    s->level = set->verdict.level;
    s->chance = set->verdict.chance;
}

static lac_status forecast(lac_watch *w, lac_station *s, const lac_line *l, bool late,
                           lac_error *err)
{
    const lac_readings readings = {.n = s->n,
                                   .time = s->time,
                                   .displacement = s->displacement,
                                   .sigma = w->def.fleet->sigma != NULL ? s->sigma : NULL,
                                   .displacement_digits = s->digit};
    lac_json json = {.out = w->out, .line = true};
    lac_forecast_set *set = NULL;
    lac_dataset *issue = NULL;
    lac_status status;
    LAC_TRY(lac_forecast_set_create(&w->def.forecast, &readings, &set, err));
    LAC_TRY(lac_issue_describe(set, w->dated, &issue, err));
    note(set, s);
    open_line(&json, s, l);
    if (late) {
        lac_json_boolean(&json, "late", true);
    }
    lac_dataset_json(issue, &json);
    lac_json_close(&json, '}');
out:
    lac_dataset_free(issue);
    lac_forecast_set_free(set);
    return status;
}

static lac_status take(lac_watch *w, const lac_line *l, const char *name, const char *where,
                       uint64_t number, lac_error *err)
{
    lac_station *s = NULL;
    lac_taken taken = LAC_TAKEN;
    if (w->known && l->dated != w->dated) {
        lac_watch_blame(w, where, number, name,
                        w->dated ? "the time must be a date, as before"
                                 : "the time must be a number, as before",
                        NULL);
        return LAC_OK;
    }
    LAC_TRY_RETURN(lac_stations_find(&w->stations, name, (size_t)w->def.fleet->most, &s, err));
    if (s == NULL) {
        lac_watch_blame(w, where, number, name, "one station more than most_stations", NULL);
        return LAC_OK;
    }
    w->known = true;
    w->dated = l->dated;
    LAC_TRY_RETURN(lac_station_take(s, l, w->def.fleet, w->now + w->def.fleet->ahead, &taken, err));
    if (taken > LAC_TAKEN_LATE) {
        say_dropped(w, s, l, taken);
        return LAC_OK;
    }
    w->counts.readings++;
    w->counts.late += taken == LAC_TAKEN_LATE ? 1 : 0;
    return forecast(w, s, l, taken == LAC_TAKEN_LATE, err);
}

lac_status lac_watch_line(lac_watch *w, lac_line_reader *reader, const char *station, char *text,
                          const char *where, uint64_t number, lac_error *err)
{
    lac_line line;
    char shown[64];
    (void)snprintf(shown, sizeof shown, "%.60s", text);
    locale_t before = uselocale(w->plain);
    const lac_line_kind kind = lac_line_read(reader, text, &line);
    (void)uselocale(before);
    w->since++;
    w->told = false;
    if (kind == LAC_LINE_LOST && station == NULL) {
        return lac_fail(err, LAC_EINPUT, "%s:%llu: %s", where, (unsigned long long)number,
                        line.text);
    }
    if (kind == LAC_LINE_WRONG || kind == LAC_LINE_LOST) { // of many files one may be no such
        lac_watch_blame(w, where, number, station, line.text, shown);
    }
    return kind == LAC_LINE_READING
               ? take(w, &line, station != NULL ? station : line.station, where, number, err)
               : LAC_OK;
}

void lac_watch_clock(lac_watch *w, double now) { w->now = now; }

lac_watch_counts lac_watch_count(const lac_watch *w)
{
    const lac_fleet *f = w->def.fleet;
    lac_watch_counts counts = w->counts;
    counts.stations = w->stations.n;
    counts.memory = (double)f->most * (sizeof(lac_station) + sizeof(void *) + LAC_LINE_STATION +
                                       4.0 * sizeof(double) * ((double)f->window_count + 1.0));
    return counts;
}

bool lac_watch_is_due(const lac_watch *w)
{
    return w->opened || w->since >= (uint64_t)w->def.fleet->checkpoint_lines;
}

bool lac_watch_has_news(const lac_watch *w) { return w->since > 0; }

static lac_status try_forecast(const lac_watch *w, lac_error *err)
{
    static const double zero = 0.0;
    const lac_readings one = {.n = 1, .time = &zero, .displacement = &zero};
    lac_forecast_set *set = NULL;
    const lac_status status = lac_forecast_set_create(&w->def.forecast, &one, &set, err);
    lac_forecast_set_free(set);
    return status == LAC_EINPUT ? lac_fail_within(err, status, "%s", w->def.fleet->path) : status;
}

static lac_status begin(lac_watch *w, lac_error *err)
{
    LAC_TRY_RETURN(try_forecast(w, err));
    w->plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    LAC_FAIL_MEMORY_IF(w->plain == (locale_t)0, err);
    LAC_TRY_RETURN(lac_watch_reader(w, true, "standard input", &w->reader, err));
    return lac_watch_open(w, err);
}

lac_status lac_watch_create(const lac_watch_def *def, lac_watch **out, lac_error *err)
{
    lac_watch *w = *out = calloc(1, sizeof *w);
    LAC_FAIL_MEMORY_IF(w == NULL, err);
    w->def = *def;
    w->out = def->out;
    w->now = NAN;
    w->lock = w->journal = -1;
    w->sum = w->skipped = 0xcbf29ce484222325u;
    const lac_status status = begin(w, err);
    LAC_MADE(status, out, lac_watch_free);
}

void lac_watch_free(lac_watch *w)
{
    if (w == NULL) {
        return;
    }
    if (w->owned && w->out != NULL) {
        (void)fclose(w->out);
    }
    for (int k = 0; k < 2; k++) {
        const int fd = k == 0 ? w->journal : w->lock;
        if (fd >= 0) {
            (void)close(fd);
        }
    }
    lac_watch_close_files(w);
    lac_line_reader_free(w->reader);
    lac_stations_clear(&w->stations);
    if (w->plain != (locale_t)0) {
        freelocale(w->plain);
    }
    free(w->pending);
    free(w);
}
