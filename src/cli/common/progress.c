// SPDX-License-Identifier: GPL-3.0-or-later
// How far the work is, on stderr: a bar on a terminal, and a line where SIGUSR1 asks for one. Other
// signals: a run stops with its file whole; a file that broke is named.
#include "cli/common/progress.h"

#include <signal.h>
#include <stdarg.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#include "cli/common/command.h"
#include "cli/common/words.h"
#include "lacuna/simulation.h"

// Signal handlers can reach nothing but globals: these, and MPI's team, are the only ones.
static volatile sig_atomic_t stop_asked, report_asked, held, hushed;
static char output[1024];
static struct sigaction fault_before;

static void put(const char *text)
{
    ssize_t written = write(STDERR_FILENO, text, strlen(text));
    (void)written;
}

static void on_stop(int signal_number, siginfo_t *from, void *context)
{
    (void)context;
    if (!held) {
        if (!hushed || signal_number != SIGTERM || from->si_pid != getppid()) {
            put("lacuna: interrupted before anything was written\n");
        }
        _exit(CLI_EXIT_INTERRUPTED);
    }
    stop_asked = 1;
}

static void on_report(int signal_number, siginfo_t *from, void *context)
{
    (void)signal_number, (void)from, (void)context;
    report_asked = 1;
}

// netCDF 4.9 reads what HDF5 has freed already where the system refuses to write or close a file.
static void on_fault(int signal_number, siginfo_t *from, void *context)
{
    (void)from, (void)context;
    const int reason = errno;
    (void)sigaction(signal_number, &fault_before, NULL);
    if (output[0] == '\0' || (reason != ENOSPC && reason != EDQUOT && reason != EFBIG &&
                              reason != EIO && reason != EROFS)) {
        return; // what broke breaks again, as it would without us
    }
    put("lacuna: ");
    put(output);
    put(": cannot be written or closed: ");
    put(strerror(reason));
    put("\n");
    _exit(CLI_EXIT_FILE);
}

static void install(int signal_number, void (*handler)(int, siginfo_t *, void *), int flags)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_sigaction = handler;
    action.sa_flags = flags | SA_SIGINFO;
    (void)sigemptyset(&action.sa_mask);
    (void)sigaction(signal_number, &action, NULL);
}

void cli_signals_install(void)
{
    install(SIGINT, on_stop, (int)(SA_RESTART | SA_RESETHAND));
    install(SIGTERM, on_stop, (int)(SA_RESTART | SA_RESETHAND));
    install(SIGUSR1, on_report, SA_RESTART);
    (void)sigaction(SIGSEGV, NULL, &fault_before);
    install(SIGSEGV, on_fault, 0);
    (void)signal(SIGPIPE, SIG_IGN);
    (void)signal(SIGXFSZ, SIG_IGN);
}

void cli_signals_writing(const char *path) { (void)snprintf(output, sizeof output, "%s", path); }

void cli_signals_remedy(char *out, size_t room)
{
    char checkpoint[sizeof output + 16];
    (void)snprintf(checkpoint, sizeof checkpoint, "%s.checkpoint", output);
    const bool goes_on = access(checkpoint, F_OK) == 0;
    out[0] = '\0';
    if (output[0] != '\0' && access(output, F_OK) == 0) {
        (void)snprintf(out, room, "; `lacuna mend %s` makes whole what they wrote%s", output,
                       goes_on ? ", and --resume goes on" : "");
    }
}

void cli_signals_hold(void) { held = 1; }

void cli_signals_hush(bool parent) { hushed = parent; }

bool cli_signals_stop(void *context)
{
    (void)context;
    return stop_asked != 0;
}

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

static void draw(cli_progress *progress, double part, const char *text)
{
    enum { BAR = 20 };
    static const char full[] = "####################", empty[] = "--------------------";
    struct winsize size;
    const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    int done = (int)(BAR * part), room = (known ? size.ws_col : 80) - BAR - 10;
    const char *on = progress->colour ? "\033[32m" : "", *off = progress->colour ? "\033[0m" : "";
    (void)fprintf(stderr, "\r[%s%.*s%s%.*s] %3.0f %% %.*s\033[K", on, done, full, off, BAR - done,
                  empty, 100 * part, room > 0 ? room : 0, text);
    (void)fflush(stderr);
    progress->drawn = true;
}

// Whether a line that was asked for or the bar is due after a step: nothing is formatted before.
static bool is_due(cli_progress *progress)
{
    const double interval = 0.1, clock = progress->bar ? cli_clock() : 0;
    progress->line_due = report_asked != 0;
    report_asked = 0;
    progress->bar_due = progress->bar && clock - progress->last >= interval;
    progress->last = progress->bar_due ? clock : progress->last;
    return progress->line_due || progress->bar_due;
}

static void put_out(cli_progress *progress, double part, const char *text)
{
    if (progress->line_due) {
        cli_progress_clear(progress);
        cli_note("%s, %.1f s so far", text, cli_clock() - progress->started);
    }
    if (progress->bar_due) {
        draw(progress, part, text);
    }
}

void cli_progress_show(cli_progress *progress, const lac_progress *now)
{
    if (is_due(progress)) {
        const cli_text text = cli_format("%s of %s, mean slip rate %s, %" PRId64 " steps",
                                         cli_amount(now->time, "s").s, cli_amount(now->end, "s").s,
                                         cli_amount(now->mean_rate, "m/s").s, now->steps);
        const double part = now->end > 0 ? now->time / now->end : 0;
        put_out(progress, fmin(fmax(part, 0.0), 1.0), text.s);
    }
}

void cli_progress_stage(cli_progress *progress, const char *what, size_t done, size_t total)
{
    if (is_due(progress)) {
        put_out(progress, total > 0 ? (double)done / (double)total : 0.0,
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
