// SPDX-License-Identifier: GPL-3.0-or-later
// The page of a run while it goes on. Three kinds of thread: the run's, which copies what it puts
// out into an inbox; the viewer's, which makes the page's data of that; the server's, which wait
// and send. netCDF is the run's alone.
#include "cli/view.h"

#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/select.h>
#include <time.h>
#include <unistd.h>

#include "base/date.h"
#include "base/hidden.h"
#include "cli/json.h"
#include "cli/libraries.h"
#include "cli/progress.h"
#include "cli/signals.h"
#include "cli/view_feed.h"
#include "cli/view_http.h"
#include "cli/view_inbox.h"
#include "cli/words.h"
#include "lacuna/report.h"
#include "lacuna/version.h"

// Between looks into the inbox, and between data; for so many times as long as the last data took
// none are made, so that the viewer takes little of a processor that the run may need.
static const double look = 0.2, least_pause = 1.0, rest = 15.0;
static const double last_wait = 10.0; // a busy machine takes its time to draw what came before

// Forecasts cost more than all else: they come more rarely, and of fewer times. The page keeps
// those it has.
enum { NO_FORECASTS = -1, SOME_FORECASTS = 12, ALL_FORECASTS = 0 };

// Data of a kind: when they were ready, how long they took.
typedef struct pace {
    double at, took; // [s]
} pace;

struct cli_view {
    cli_feed feed;
    cli_http *http;
    cli_inbox inbox;
    lac_recording *recording;
    lac_sink into; // the recording's
    pthread_t thread;
    bool fed, inboxed, running; // feed and inbox are made, the thread is
    bool stop;                  // under the feed's lock
    const char *path;           // of the run's file; NULL: not begun
    bool ended, stay;
    bool whole; // the data come from the run's file, which holds all
    // The viewer's thread alone:
    bool fresh;       // something came since the last data
    pace data, issue; // without forecasts, with them
};

static lac_status read_port(const char *text, unsigned *port, lac_error *err)
{
    char *end;
    const unsigned long n = strtoul(text, &end, 10);
    const bool sound = text[strspn(text, "0123456789")] == '\0' && n <= 65535;
    *port = (unsigned)n;
    return sound ? LAC_OK
                 : lac_fail(err, LAC_EINPUT, "--view: \"%s\" must be a port from 0 to 65535", text);
}

// A text as it stands in JSON, cut after a character where there is no room.
static void escape(const char *text, char *out, size_t size)
{
    size_t used = 0;
    for (const unsigned char *s = (const unsigned char *)text; *s != '\0' && used + 7 < size;) {
        const size_t length = cli_utf8_length(s);
        const bool plain = length > 1 ? lac_hidden_length((const char *)s, length) == 0
                                      : *s >= 0x20 && *s != '"' && *s != '\\' && *s != 0x7f;
        used += (size_t)(length > 0 && plain ? snprintf(out + used, size - used, "%.*s",
                                                        (int)length, (const char *)s)
                                             : snprintf(out + used, size - used, "\\u%04x",
                                                        length == 1 ? (unsigned)*s : 0xfffdU));
        s += length > 0 ? length : 1;
    }
    out[used] = '\0';
}

static void say(cli_view *view, const char *state, const lac_progress *now, const char *message,
                bool last)
{
    char json[CLI_FEED_EVENT], words[CLI_FEED_EVENT / 2];
    escape(message, words, sizeof words);
    (void)snprintf(
        json, sizeof json,
        "{\"state\":\"%s\",\"version\":%" PRIu64 ",\"time\":%.9g,\"end\":%.9g,"
        "\"rate\":%.4g,\"steps\":%" PRId64 ",\"last\":%s,\"missing\":%s,\"message\":\"%s\"}",
        state, view->feed.version, now->time, now->end,
        isfinite(now->mean_rate) ? now->mean_rate : 0.0, now->steps, last ? "true" : "false",
        !view->whole && cli_inbox_missing(&view->inbox) ? "true" : "false", words);
    cli_feed_event(&view->feed, json, last);
}

lac_status cli_view_open(const cli_request *request, cli_view **out, lac_error *err)
{
    unsigned port = 0;
    lac_status status;
    *out = NULL;
    if (!cli_given(request, CLI_OPT_VIEW)) {
        return LAC_OK;
    }
    cli_view *view = calloc(1, sizeof *view);
    if (view == NULL) {
        return lac_fail_memory(err);
    }
    LAC_TRY(read_port(request->view, &port, err));
    view->fed = cli_feed_create(&view->feed);
    view->inboxed = view->fed && cli_inbox_create(&view->inbox);
    LAC_TRY(view->inboxed ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(cli_http_start(port, &view->feed, &view->http, err));
    view->stay = isatty(STDERR_FILENO) == 1;
    cli_note("the run is to be seen at http://127.0.0.1:%u/", cli_http_port(view->http));
    say(view, "preparing", &(lac_progress){0}, "", false);
    *out = view;
    view = NULL;
out:
    cli_view_close(view);
    return status;
}

static lac_status put_number(cli_view *view, const char *name, double value, lac_error *err)
{
    char text[40];
    (void)snprintf(text, sizeof text, "%.17g", value);
    return lac_recording_text(view->recording, name, text, err);
}

static lac_status put_date(cli_view *view, const char *name, double seconds, lac_error *err)
{
    char text[40];
    return lac_recording_text(view->recording, name, lac_date_format(seconds, text, sizeof text),
                              err);
}

static lac_status put_grid(cli_view *view, const lac_grid *grid, lac_error *err)
{
    lac_status status;
    LAC_TRY(put_number(view, "grid_nx", (double)grid->nx, err));
    LAC_TRY(put_number(view, "grid_ny", (double)grid->ny, err));
    LAC_TRY(put_number(view, "grid_dx_m", grid->dx, err));
    LAC_TRY(put_number(view, "grid_dy_m", grid->dy, err));
    LAC_TRY(
        lac_recording_text(view->recording, "boundary", grid->periodic ? "periodic" : "free", err));
out:
    return status;
}

// What the run's file says of itself.
static lac_status describe(cli_view *view, const lac_store_def *def, lac_error *err)
{
    const lac_provenance *from = &def->provenance;
    char netcdf[32], libraries[320];
    const struct {
        const char *name, *text;
    } texts[] = {{"title", from->title},
                 {"institution", from->institution},
                 {"references", from->references},
                 {"source", "Lacuna " LACUNA_VERSION},
                 {"history", from->command_line},
                 {"libraries", libraries},
                 {"fidelity", from->fidelity},
                 {"case", from->case_text},
                 {"status", "running"}};
    lac_status status = LAC_OK;
    (void)cli_netcdf_version(netcdf, sizeof netcdf); // as the file has it
    (void)snprintf(libraries, sizeof libraries, "%s, netCDF %s", from->libraries, netcdf);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        if (texts[i].text != NULL) {
            LAC_TRY(lac_recording_text(view->recording, texts[i].name, texts[i].text, err));
        }
    }
    LAC_TRY(put_date(view, "date_created", from->now, err));
    LAC_TRY(put_grid(view, &def->domain->grid, err));
    if (from->seed != INT64_MIN) {
        LAC_TRY(put_number(view, "seed", (double)from->seed, err));
    }
    if (def->dated) {
        LAC_TRY(put_date(view, "time_coverage_start", def->start_date, err));
    }
out:
    return status;
}

static lac_status record(cli_view *view, const lac_store_def *def, const double *once,
                         lac_error *err)
{
    const lac_recording_def as = {.domain = def->domain,
                                  .hierarchy = def->hierarchy,
                                  .transfer = def->transfer,
                                  .fields = def->fields,
                                  .extras = def->extras,
                                  .extra = def->extra,
                                  .events = def->events};
    lac_status status;
    LAC_TRY(lac_recording_create(&as, &view->recording, err));
    LAC_TRY(describe(view, def, err));
    if (def->resume != NULL) {
        LAC_TRY(lac_recording_load(view->recording, def->path, def->resume, err));
        view->fresh = true;
    }
    if (once != NULL) {
        LAC_TRY(lac_recording_once(view->recording, once, err));
    }
out:
    return status;
}

// Memory stays bounded: one snapshot may be as large as all that a page shows.
static lac_status on_snapshot(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    cli_view *view = context;
    const lac_status status = view->into.snapshot(view->into.context, snapshot, err);
    return status == LAC_OK ? lac_report_thin(view->recording, err) : status;
}

static lac_status on_record(void *context, const lac_record *seen, lac_error *err)
{
    cli_view *view = context;
    return view->into.record(view->into.context, seen, err);
}

static lac_status on_event(void *context, const lac_event *event, lac_error *err)
{
    cli_view *view = context;
    return view->into.event(view->into.context, event, err);
}

// Data from the recording, or from the run's file once it is closed.
static bool make_data(cli_view *view, const lac_recording *recording, int issues)
{
    const lac_report_def def = {.run = view->path,
                                .recording = recording,
                                .made_by = "lacuna " LACUNA_VERSION,
                                .now = (double)time(NULL),
                                .issues = issues};
    char *json = NULL;
    const bool made = lac_report_data(&def, &json, NULL) == LAC_OK;
    if (made) {
        cli_feed_data(&view->feed, json);
    }
    return made;
}

static bool is_due(const pace *last, double now)
{
    return now - last->at >= fmax(least_pause, rest * last->took);
}

// With forecasts where it is time for them.
static bool make_next(cli_view *view)
{
    const double begun = cli_clock();
    const bool issue = is_due(&view->issue, begun);
    if (!view->fresh || !(issue || is_due(&view->data, begun))) {
        return false;
    }
    const bool made = make_data(view, view->recording, issue ? SOME_FORECASTS : NO_FORECASTS);
    const double now = cli_clock();
    pace *of = issue ? &view->issue : &view->data;
    view->data.at = now;
    *of = (pace){.at = now, .took = now - begun};
    view->fresh = !made;
    return made;
}

static void look_in(cli_view *view)
{
    const lac_sink sink = {
        .context = view, .record = on_record, .snapshot = on_snapshot, .event = on_event};
    lac_progress now;
    bool moved;
    view->fresh = cli_inbox_empty(&view->inbox, &sink, &now, &moved) > 0 || view->fresh;
    (void)lac_report_thin(view->recording, NULL);
    const bool made = cli_feed_watched(&view->feed) && make_next(view);
    if (made || moved) {
        say(view, "running", &now, "", false);
    }
}

static void *watch(void *context)
{
    cli_view *view = context;
    bool stop = false;
    while (!stop) {
        look_in(view);
        (void)pthread_mutex_lock(&view->feed.lock);
        if (!view->stop) {
            (void)cli_feed_wait(&view->feed, look);
        }
        stop = view->stop;
        (void)pthread_mutex_unlock(&view->feed.lock);
    }
    return NULL;
}

void cli_view_begin(cli_view *view, const lac_store_def *def, const double *once)
{
    if (view == NULL) {
        return;
    }
    view->path = def->path;
    view->inbox.extras = 0;
    view->inbox.cells = def->domain->n;
    view->inbox.fields = def->fields;
    view->data.at = view->issue.at = -INFINITY;
    lac_error err = {0};
    if (record(view, def, once, &err) != LAC_OK) {
        cli_note("warning: --view shows no charts: %s", err.message);
        lac_recording_free(view->recording);
        view->recording = NULL;
        return;
    }
    view->into = lac_recording_sink(view->recording);
    const size_t levels = def->hierarchy != NULL ? lac_hierarchy_levels(def->hierarchy) + 1 : 0;
    for (size_t i = 0; i < def->extras; i++) {
        const lac_extra_over over = def->extra[i].over;
        view->inbox.extras += over == LAC_OVER_LEVELS ? levels : over == LAC_OVER_TIME ? 1 : 0;
    }
}

lac_sink cli_view_sink(cli_view *view, const lac_sink *next)
{
    if (view == NULL || view->recording == NULL) {
        return *next;
    }
    sigset_t all, before;
    view->inbox.next = *next;
    (void)sigfillset(&all); // signals are the run's
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    view->running = pthread_create(&view->thread, NULL, watch, view) == 0;
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    return view->running ? cli_inbox_sink(&view->inbox) : *next;
}

void cli_view_progress(cli_view *view, const lac_progress *now)
{
    if (view != NULL) {
        cli_inbox_progress(&view->inbox, now);
    }
}

static void stop_watching(cli_view *view)
{
    if (view->running) {
        (void)pthread_mutex_lock(&view->feed.lock);
        view->stop = true;
        (void)pthread_cond_broadcast(&view->feed.changed);
        (void)pthread_mutex_unlock(&view->feed.lock);
        (void)pthread_join(view->thread, NULL);
        view->running = false;
    }
}

// The signal that ends it may come at any moment, also just before the wait, or to another thread,
// which wakes nobody here.
static void wait_for_signal(void)
{
    const struct timespec look_again = {.tv_nsec = 200000000};
    sigset_t stopping, before;
    (void)sigemptyset(&stopping);
    (void)sigaddset(&stopping, SIGINT);
    (void)sigaddset(&stopping, SIGTERM);
    (void)pthread_sigmask(SIG_BLOCK, &stopping, &before);
    while (!cli_signals_stop()) {
        (void)pselect(0, NULL, NULL, NULL, &look_again, &before);
    }
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
}

// The end as the file tells it, at once, then with all forecasts.
static void show_end(cli_view *view, const char *state, const char *message)
{
    const lac_progress *now = &view->inbox.progress;
    view->whole = view->path != NULL && make_data(view, NULL, NO_FORECASTS);
    if (view->whole) {
        say(view, state, now, message, false);
        (void)make_data(view, NULL, ALL_FORECASTS);
    } else if (view->recording != NULL) { // the file is not whole
        (void)make_data(view, view->recording, ALL_FORECASTS);
    }
}

void cli_view_end(cli_view *view, const char *status, bool failed, const char *message)
{
    if (view == NULL || view->ended) {
        return;
    }
    const bool stay = view->stay && view->path != NULL && !cli_signals_stop();
    const char *state = failed ? "failure" : status;
    stop_watching(view);
    view->ended = true;
    if (stay || cli_feed_streams(&view->feed)) {
        show_end(view, state, message);
    }
    say(view, state, &view->inbox.progress, message, true);
    if (stay) {
        cli_note("the run has ended; http://127.0.0.1:%u/ stays until Ctrl-C",
                 cli_http_port(view->http));
        wait_for_signal();
    } else {
        cli_feed_drain(&view->feed, last_wait);
    }
}

void cli_view_close(cli_view *view)
{
    if (view == NULL) {
        return;
    }
    if (view->http != NULL) {
        view->stay = false;
        cli_view_end(view, "failed", false, "the run was broken off");
    }
    cli_http_stop(view->http);
    lac_recording_free(view->recording);
    if (view->inboxed) {
        cli_inbox_clear(&view->inbox);
    }
    if (view->fed) {
        cli_feed_clear(&view->feed);
    }
    free(view);
}
