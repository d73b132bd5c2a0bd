// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna watch FLEET.yaml: waits for readings, has the watch take them, and keeps its state.
#include "watch/watch.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "cli/common/command.h"
#include "cli/common/progress.h"
#include "cli/precursors/precursors.h"

enum { CHUNK = 4096, PATIENCE = 1000 }; // bytes at a time; ms between looks

typedef struct watch_job {
    const cli_request *request;
    lac_units *units;
    lac_fleet *fleet;
    lac_watch *watch;
    double kept, told; // when, on the clock [s]
} watch_job;

// Velocities and onset are those of precursors, in its words.
static lac_status read_plan(const watch_job *job, lac_forecast_def *def, lac_error *err)
{
    const lac_fleet *f = job->fleet;
    const struct {
        const char *smooth, *onset;
        size_t line;
    } part[] = {{f->smooth, NULL, f->smooth_line}, {NULL, f->onset, f->onset_line}};
    cli_forecast_plan plan;
    *def = lac_forecast_default();
    for (size_t i = 0; i < 2; i++) {
        const cli_request words = {.forecast = {.smooth = part[i].smooth, .onset = part[i].onset}};
        lac_status status = cli_forecast_plan_read(&words, false, job->units, &plan, err);
        LAC_TRY_RETURN(lac_fail_within(err, status, "%s:%zu", f->path, part[i].line));
        if (i == 0) {
            *def = plan.def;
        }
    }
    def->onset = plan.def.onset;
    def->short_run = plan.def.short_run;
    def->long_run = plan.def.long_run;
    def->motion.raw = f->raw == 1;
    def->window_count = (size_t)f->window_count;
    def->window_time = f->window_time;
    def->levels = f->levels;
    return LAC_OK;
}

// After a batch: the state where it is due, the file for Prometheus once a second.
static lac_status keep(watch_job *job, bool quiet, lac_error *err)
{
    const double now = cli_clock();
    const bool news = lac_watch_has_news(job->watch);
    if (lac_watch_is_due(job->watch) || (news && now - job->kept >= job->fleet->checkpoint_time)) {
        LAC_TRY_RETURN(lac_watch_checkpoint(job->watch, err));
        job->kept = now;
    }
    if (quiet || now - job->told >= 1e-3 * PATIENCE) {
        LAC_TRY_RETURN(lac_watch_tell(job->watch, err));
        job->told = now;
    }
    return LAC_OK;
}

static lac_status read_stream(watch_job *job, lac_error *err)
{
    char bytes[CHUNK];
    struct pollfd input = {.fd = STDIN_FILENO, .events = POLLIN};
    while (!cli_signals_stop(NULL)) {
        const int ready = poll(&input, 1, PATIENCE);
        LAC_FAIL_IF(ready < 0 && errno != EINTR, err, LAC_EIO, "standard input: %s",
                    strerror(errno));
        if (ready > 0) {
            const ssize_t n = read(STDIN_FILENO, bytes, sizeof bytes);
            LAC_FAIL_IF(n < 0 && errno != EINTR && errno != EAGAIN, err, LAC_EIO,
                        "standard input: %s", strerror(errno));
            if (n == 0) {
                return LAC_OK;
            }
            lac_watch_clock(job->watch, (double)time(NULL));
            LAC_TRY_RETURN(n > 0 ? lac_watch_stream(job->watch, bytes, (size_t)n, err) : LAC_OK);
        }
        LAC_TRY_RETURN(keep(job, ready == 0, err));
    }
    return LAC_OK;
}

static lac_status follow(watch_job *job, lac_error *err)
{
    struct rlimit limit;
    // a file stays open, so that what is written to it after it was rotated away is read
    if (getrlimit(RLIMIT_NOFILE, &limit) == 0) {
        limit.rlim_cur = limit.rlim_max;
        (void)setrlimit(RLIMIT_NOFILE, &limit);
    }
    while (!cli_signals_stop(NULL)) {
        bool more = false;
        lac_watch_clock(job->watch, (double)time(NULL));
        LAC_TRY_RETURN(lac_watch_poll(job->watch, &more, err));
        LAC_TRY_RETURN(keep(job, !more, err));
        if (!more && !cli_signals_stop(NULL)) {
            (void)poll(NULL, 0, PATIENCE);
        }
    }
    return LAC_OK;
}

static void print(const watch_job *job, const lac_watch_counts *c)
{
    const struct {
        const char *name;
        uint64_t value;
    } row[] = {{"stations", c->stations}, {"lines", c->lines},     {"readings", c->readings},
               {"late", c->late},         {"doubled", c->doubled}, {"old", c->old},
               {"ahead", c->ahead},       {"bad", c->bad},         {"restored", c->restored}};
    struct rusage use;
    const int64_t peak = getrusage(RUSAGE_SELF, &use) == 0 ? (int64_t)use.ru_maxrss * 1024 : 0;
    lac_json json = {.out = stdout};
    if (!cli_given(job->request, CLI_OPT_JSON)) {
        for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
            cli_row(row[i].name, "%" PRIu64, row[i].value);
        }
        cli_row("memory", "%.1f MB, of stations at most %.1f MB", 1e-6 * (double)peak,
                1e-6 * c->memory);
        cli_row("file", "%s", job->request->output);
        return;
    }
    lac_json_open(&json, NULL, '{');
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        lac_json_integer(&json, row[i].name, (int64_t)row[i].value);
    }
    lac_json_number(&json, "memory_of_stations_at_most_bytes", c->memory);
    lac_json_integer(&json, "peak_memory_bytes", peak);
    lac_json_number(&json, "cpu_time_s", cli_cpu_time());
    lac_json_text(&json, "output", job->request->output);
    lac_json_close(&json, '}');
}

// What was sent and not taken is said.
static lac_status finish(watch_job *job, lac_error *err)
{
    const lac_watch_counts counts = lac_watch_count(job->watch);
    const bool stopped = cli_signals_stop(NULL);
    LAC_TRY_RETURN(lac_watch_checkpoint(job->watch, err));
    LAC_TRY_RETURN(lac_watch_tell(job->watch, err));
    if (job->request->output != NULL) {
        print(job, &counts);
    }
    LAC_FAIL_IF(stopped, err, LAC_EINTERRUPT, "stopped after %" PRIu64 " readings",
                counts.readings);
    LAC_FAIL_IF(lac_watch_missing(job->watch) > 0, err, LAC_EINPUT,
                "standard input: ended %" PRIu64 " lines before those that %s was made from: it "
                "is `stream: live` in %s where it begins with what is new",
                lac_watch_missing(job->watch), job->request->watch_state, job->fleet->path);
    if (lac_watch_waiting(job->watch) > 0 && !cli_given(job->request, CLI_OPT_QUIET)) {
        cli_note("warning: standard input: its last line has no end, and was not taken");
    }
    return LAC_OK;
}

lac_status cli_watch(const cli_request *request, lac_error *err)
{
    watch_job job = {.request = request, .kept = cli_clock(), .told = -INFINITY};
    lac_watch_def def = {.out = stdout,
                         .state = request->watch_state,
                         .output = request->output,
                         .force = cli_given(request, CLI_OPT_FORCE),
                         .stop = cli_signals_stop};
    lac_status status;
    LAC_TRY(lac_units_create(&job.units, err));
    LAC_TRY(lac_fleet_read(request->argument[0], job.units, &job.fleet, err));
    LAC_TRY(read_plan(&job, &def.forecast, err));
    LAC_LEAVE_IF(cli_given(request, CLI_OPT_JSON) && request->output == NULL, err, LAC_EINPUT,
                 "--json: sums up at the end, and needs -o for the lines");
    def.fleet = job.fleet;
    def.units = job.units;
    cli_signals_hold();
    LAC_TRY(lac_watch_create(&def, &job.watch, err));
    cli_say(request, "%" PRIu64 " lines done again", lac_watch_count(job.watch).restored);
    status = lac_watch_follows(job.watch) ? follow(&job, err) : read_stream(&job, err);
    LAC_TRY(status);
    LAC_TRY(finish(&job, err));
out:
    lac_watch_free(job.watch);
    lac_fleet_free(job.fleet);
    lac_units_free(job.units);
    return status;
}
