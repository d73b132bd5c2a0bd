// SPDX-License-Identifier: GPL-3.0-or-later
// The page of a run while it goes on. Two threads: the run's, which adds what it puts out to a
// recording, and the server's, which makes the page's data of it when a page asks. Under their one
// lock only pointers move, and a record is copied. netCDF is the run's alone.
#include "cli/view/view.h"

#include <pthread.h>
#include <time.h>
#include <unistd.h>

#include "base/temp_file.h"
#include "cli/common/progress.h"
#include "cli/common/words.h"
#include "lacuna/version.h"
#include "report/report.h"

// Between data; for so many times as long as the last data took none are made, so that the server
// takes little of a processor that the run may need.
static const double least_pause = 1.0, rest = 15.0;
static const double last_wait = 10.0; // a busy machine takes its time to draw what came before

// Forecasts cost more than all else: they come more rarely, and of fewer times. The page keeps
// those it has.
enum { NO_FORECASTS = -1, SOME_FORECASTS = 12, ALL_FORECASTS = 0 };

// Data of a kind: when they were ready, how long they took.
typedef struct pace {
    double at, took; // [s]
} pace;

// The data of a page.
typedef struct page_data {
    char *json;       // owned; NULL: none
    uint64_t version; // grows, from one process to the next too: when they were made [ms]
    bool forecasts;   // are among them
} page_data;

// Where a run stands.
typedef struct standing {
    const char *state;
    lac_progress now;
    bool begun;    // there is a recording
    bool last;     // nothing new will come
    bool missing;  // memory was short: not all came through
    lac_error why; // it ended
} standing;

struct cli_view {
    lac_sink next; // where records go first; the run's thread alone
    pthread_mutex_t lock;
    // Under the lock:
    lac_recording *coming; // what the run has put out since the server looked
    bool fresh;            // there is some of it
    page_data from_file;   // once the run has ended
    standing is;
    // The server's thread alone; after it, whoever frees:
    lac_recording *taken, *whole; // what it has just taken, all of it
    page_data newest, with;       // with forecasts, where the newest are without
    bool stale;                   // something came since the newest
    bool closed;                  // the newest are the file's
    bool dropped;                 // memory was short here
    pace data, issue;             // without forecasts, with them
    // The run's thread alone:
    cli_http *http;
    lac_sink into;    // where records go then
    const char *path; // of the run's file; NULL: not begun
    bool ended, stay;
};

// Data from the recording, or from the run's file once it is closed. NULL: none
static page_data make_data(const cli_view *view, const lac_recording *recording, int issues)
{
    const lac_page_def def = {.run = view->path,
                              .recording = recording,
                              .made_by = "lacuna " LACUNA_VERSION,
                              .now = (double)time(NULL),
                              .issues = issues};
    page_data made = {.forecasts = issues != NO_FORECASTS};
    (void)lac_page_data(&def, &made.json, NULL);
    return made;
}

// Puts data in the place of the newest ones. Those with forecasts stay beside newer ones without,
// for pages that have not had them yet.
static void renew(cli_view *view, page_data made)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_REALTIME, &now);
    const uint64_t at = (uint64_t)now.tv_sec * 1000 + (uint64_t)now.tv_nsec / 1000000;
    page_data *old = view->newest.forecasts ? &view->with : &view->newest;
    free(old->json);
    *old = view->newest;
    made.version = at > view->newest.version ? at : view->newest.version + 1;
    view->newest = made;
}

// What the run has handed over since the last time.
static standing take(cli_view *view)
{
    (void)pthread_mutex_lock(&view->lock);
    const standing is = view->is;
    const page_data from_file = view->from_file;
    view->from_file.json = NULL;
    view->stale = view->stale || view->fresh;
    view->fresh = false;
    if (is.begun) {
        (void)lac_recording_move(view->taken, view->coming, NULL); // into an empty one: pointers
    }
    (void)pthread_mutex_unlock(&view->lock);
    if (is.begun) {
        view->dropped =
            lac_recording_move(view->whole, view->taken, NULL) != LAC_OK || view->dropped;
        (void)lac_page_thin_recording(view->whole, NULL);
    }
    if (from_file.json != NULL) {
        view->closed = true;
        renew(view, from_file);
    }
    return is;
}

static bool is_due(const pace *last, double now)
{
    return now - last->at >= fmax(least_pause, rest * last->took);
}

// With forecasts where it is time for them; all of them where the run's file cannot tell its end.
static void make_next(cli_view *view, bool last)
{
    const double begun = cli_clock();
    const bool issue = last || is_due(&view->issue, begun);
    if (!view->stale || !(issue || is_due(&view->data, begun))) {
        return;
    }
    const int issues = last ? ALL_FORECASTS : issue ? SOME_FORECASTS : NO_FORECASTS;
    const page_data made = make_data(view, view->whole, issues);
    const double now = cli_clock();
    pace *of = issue ? &view->issue : &view->data;
    view->data.at = now;
    *of = (pace){.at = now, .took = now - begun};
    if (made.json != NULL) {
        view->stale = false;
        renew(view, made);
    }
}

// Where the run stands, and data or none.
static char *write_answer(const cli_view *view, const standing *is, const page_data *data,
                          bool has_it, bool last)
{
    char *text = NULL;
    size_t size;
    lac_json json = {.out = open_memstream(&text, &size)};
    if (json.out == NULL) {
        return NULL;
    }
    lac_json_open(&json, NULL, '{');
    lac_json_open(&json, "run", '{');
    lac_json_text(&json, "state", is->state);
    lac_json_integer(&json, "version", (int64_t)data->version);
    lac_json_number(&json, "time", is->now.time);
    lac_json_number(&json, "end", is->now.end);
    lac_json_number(&json, "rate", isfinite(is->now.mean_rate) ? is->now.mean_rate : 0.0);
    lac_json_integer(&json, "steps", is->now.steps);
    lac_json_boolean(&json, "last", last);
    lac_json_boolean(&json, "missing", !view->closed && (is->missing || view->dropped));
    lac_json_text(&json, "message", is->why.message);
    lac_json_close(&json, '}');
    if (has_it) {
        lac_json_close(&json, '}');
    } else {
        (void)fprintf(json.out, ",%s", data->json + 1); // its brace is open already
    }
    return lac_text_made(json.out, &text);
}

// Who lacks the forecasts that are kept gets them first.
static char *answer(void *context, uint64_t since, bool *last)
{
    cli_view *view = context;
    const standing is = take(view);
    if (is.begun && !view->closed) {
        make_next(view, is.last);
    }
    const page_data *newest = &view->newest;
    const page_data *data = since < view->with.version && !newest->forecasts ? &view->with : newest;
    *last = is.last && data == newest;
    return write_answer(view, &is, data, data->json == NULL || since == data->version, *last);
}

lac_status cli_view_open(const cli_request *request, cli_view **out, lac_error *err)
{
    const char *text = request->view;
    lac_status status;
    *out = NULL;
    if (!cli_given(request, CLI_OPT_VIEW)) {
        return LAC_OK;
    }
    const unsigned long port = strtoul(text, NULL, 10);
    LAC_FAIL_IF(text[strspn(text, "0123456789")] != '\0' || port > 65535, err, LAC_EINPUT,
                "--view: \"%s\" must be a port from 0 to 65535", text);
    cli_view *view = *out = calloc(1, sizeof *view);
    LAC_FAIL_MEMORY_IF(view == NULL, err);
    view->lock = (pthread_mutex_t)PTHREAD_MUTEX_INITIALIZER;
    view->is.state = "preparing";
    view->data.at = view->issue.at = -INFINITY;
    LAC_TRY(cli_http_start((unsigned)port, answer, view, &view->http, err));
    view->stay = isatty(STDERR_FILENO) == 1;
    cli_note("the run is to be seen at http://127.0.0.1:%u/", cli_http_port(view->http));
out:
    LAC_MADE(status, out, cli_view_close);
}

static lac_status record(cli_view *view, const lac_store_def *def, const double *once,
                         lac_error *err)
{
    lac_recording_def as = def->of;
    LAC_TRY_RETURN(lac_recording_create(&as, &view->whole, err));
    as.passing = true;
    LAC_TRY_RETURN(lac_recording_create(&as, &view->taken, err));
    LAC_TRY_RETURN(lac_recording_create(&as, &view->coming, err));
    view->into = lac_recording_sink(view->coming);
    LAC_TRY_RETURN(lac_recording_sign(view->whole, &def->provenance, err));
    LAC_TRY_RETURN(lac_recording_text(view->whole, "status", "running", err));
    if (def->resume != NULL) {
        LAC_TRY_RETURN(lac_recording_load(view->coming, def->path, def->resume, err));
    }
    if (once != NULL) {
        LAC_TRY_RETURN(lac_recording_sink(view->whole).once(view->whole, once, err));
    }
    return LAC_OK;
}

void cli_view_begin(cli_view *view, const lac_store_def *def, const double *once)
{
    if (view == NULL) {
        return;
    }
    lac_error err = {0};
    view->path = def->path;
    const bool recorded = record(view, def, once, &err) == LAC_OK;
    if (!recorded) {
        cli_note("warning: --view shows no charts: %s", err.message);
    }
    (void)pthread_mutex_lock(&view->lock);
    view->is.state = "running";
    view->is.begun = recorded;
    view->fresh = def->resume != NULL;
    (void)pthread_mutex_unlock(&view->lock);
}

// After something was kept, or was not, under the lock, which is let go. Memory stays bounded where
// nobody looks: one snapshot may be as large as all that a page shows.
static void note_kept(cli_view *view, lac_status status)
{
    view->is.missing = view->is.missing || status != LAC_OK;
    view->fresh = true;
    (void)lac_page_thin_recording(view->coming, NULL);
    (void)pthread_mutex_unlock(&view->lock);
}

// What is passed on and, where that was well, kept.
#define SHOWN(what, type)                                                                \
    static lac_status on_##what(void *context, const type *observation, lac_error *err)  \
    {                                                                                    \
        cli_view *view = context;                                                        \
        const lac_status status = view->next.what(view->next.context, observation, err); \
        if (status == LAC_OK) {                                                          \
            (void)pthread_mutex_lock(&view->lock);                                       \
            note_kept(view, view->into.what(view->into.context, observation, NULL));     \
        }                                                                                \
        return status;                                                                   \
    }
SHOWN(record, lac_record)
SHOWN(snapshot, lac_snapshot)
SHOWN(event, lac_event)

lac_sink cli_view_sink(cli_view *view, const lac_sink *next)
{
    if (view == NULL || !view->is.begun) {
        return *next;
    }
    view->next = *next;
    lac_sink sink = lac_sink_before(&view->next);
    sink.record = on_record;
    sink.snapshot = sink.snapshot != NULL ? on_snapshot : NULL;
    sink.event = sink.event != NULL ? on_event : NULL;
    return sink;
}

void cli_view_progress(cli_view *view, const lac_progress *now)
{
    if (view != NULL) {
        (void)pthread_mutex_lock(&view->lock);
        view->is.now = *now;
        (void)pthread_mutex_unlock(&view->lock);
    }
}

// The end; with the file's data, where there are any.
static void say_end(cli_view *view, const char *state, const char *message, page_data from_file,
                    bool last)
{
    (void)pthread_mutex_lock(&view->lock);
    if (from_file.json != NULL) {
        free(view->from_file.json);
        view->from_file = from_file;
    }
    view->is.state = state;
    view->is.last = last;
    (void)snprintf(view->is.why.message, sizeof view->is.why.message, "%s", message);
    view->fresh = true;
    (void)pthread_mutex_unlock(&view->lock);
}

void cli_view_end(cli_view *view, const char *status, bool failed, const char *message)
{
    if (view == NULL || view->ended) {
        return;
    }
    const bool stay = view->stay && view->path != NULL && !cli_signals_stop(NULL);
    const char *state = failed ? "failure" : status;
    page_data data = {0};
    view->ended = true;
    if (view->path != NULL &&
        (stay || cli_http_waiting(view->http) > 0)) { // at once, then with all forecasts
        data = make_data(view, NULL, NO_FORECASTS);
        if (data.json != NULL) {
            say_end(view, state, message, data, false);
            data = make_data(view, NULL, ALL_FORECASTS);
        }
    }
    say_end(view, state, message, data, true);
    if (stay) {
        cli_note("the run has ended; http://127.0.0.1:%u/ stays until Ctrl-C",
                 cli_http_port(view->http));
    }
    // until Ctrl-C, or for as long as the pages that are open take to fetch the end
    const struct timespec look_again = {.tv_nsec = 50000000};
    const double end = cli_clock() + last_wait;
    while (stay ? !cli_signals_stop(NULL) : cli_http_waiting(view->http) > 0 && cli_clock() < end) {
        (void)nanosleep(&look_again, NULL);
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
    lac_recording_free(view->coming);
    lac_recording_free(view->taken);
    lac_recording_free(view->whole);
    free(view->from_file.json);
    free(view->newest.json);
    free(view->with.json);
    free(view);
}
