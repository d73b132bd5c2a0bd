// SPDX-License-Identifier: GPL-3.0-or-later
// How far the work is, on stderr: a bar on a terminal, and a line where SIGUSR1 asks for one.
#include "cli/common/progress.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include "cli/common/signals.h"
#include "cli/common/words.h"

double cli_clock(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double cli_cpu_time(void)
{
    struct timespec used;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return (double)used.tv_sec + 1e-9 * (double)used.tv_nsec;
}

void cli_progress_start(cli_progress *progress, const cli_request *request)
{
    const char *term = getenv("TERM"), *no_colour = getenv("NO_COLOR");
    bool terminal = isatty(STDERR_FILENO) && term != NULL && strcmp(term, "dumb") != 0;
    *progress = (cli_progress){
        .bar = terminal && !cli_given(request, CLI_OPT_QUIET | CLI_OPT_NO_PROGRESS),
        .colour = no_colour == NULL || no_colour[0] == '\0',
        .started = cli_clock(),
    };
}

// 0 to 1
static double fraction(const lac_progress *now)
{
    double x = now->end > 0 ? now->time / now->end : 0;
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

static int terminal_width(void)
{
    struct winsize size;
    bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return known ? size.ws_col : 80;
}

static void draw(cli_progress *progress, double part, const char *text)
{
    enum { BAR = 20 };
    static const char full[] = "####################", empty[] = "--------------------";
    int done = (int)(BAR * part), room = terminal_width() - BAR - 10;
    const char *on = progress->colour ? "\033[32m" : "", *off = progress->colour ? "\033[0m" : "";
    (void)fprintf(stderr, "\r[%s%.*s%s%.*s] %3.0f %% %.*s\033[K", on, done, full, off, BAR - done,
                  empty, 100 * part, room > 0 ? room : 0, text);
    (void)fflush(stderr);
    progress->drawn = true;
}

// What is due after a step: a line that was asked for, the bar. Nothing is written or formatted
// before it is known to be.
typedef struct due {
    bool line, bar;
} due;

static bool is_due(cli_progress *progress, due *now)
{
    const double interval = 0.1, clock = progress->bar ? cli_clock() : 0;
    now->line = cli_signals_take_report();
    now->bar = progress->bar && clock - progress->last >= interval;
    progress->last = now->bar ? clock : progress->last;
    return now->line || now->bar;
}

static void put_out(cli_progress *progress, const due *now, double part, const char *text)
{
    if (now->line) {
        cli_progress_clear(progress);
        cli_note("%s, %.1f s so far", text, cli_clock() - progress->started);
    }
    if (now->bar) {
        draw(progress, part, text);
    }
}

void cli_progress_show(cli_progress *progress, const lac_progress *now)
{
    due wanted;
    if (is_due(progress, &wanted)) {
        const cli_text text = cli_format("%s of %s, mean slip rate %s, %" PRId64 " steps",
                                         cli_amount(now->time, "s").s, cli_amount(now->end, "s").s,
                                         cli_amount(now->mean_rate, "m/s").s, now->steps);
        put_out(progress, &wanted, fraction(now), text.s);
    }
}

void cli_progress_stage(cli_progress *progress, const char *what, size_t done, size_t total)
{
    due wanted;
    if (is_due(progress, &wanted)) {
        put_out(progress, &wanted, total > 0 ? (double)done / (double)total : 0.0,
                cli_format("%zu of %zu %s", done, total, what).s);
    }
}

void cli_progress_clear(cli_progress *progress)
{
    if (progress->drawn) {
        (void)fputs("\r\033[K", stderr);
        progress->drawn = false;
    }
}

void cli_say(const cli_request *request, const char *format, ...)
{
    if (!cli_given(request, CLI_OPT_VERBOSE) || cli_given(request, CLI_OPT_QUIET)) {
        return;
    }
    va_list args;
    va_start(args, format);
    cli_note_list(format, args);
    va_end(args);
}
