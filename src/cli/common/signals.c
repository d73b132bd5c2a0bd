// SPDX-License-Identifier: GPL-3.0-or-later
// Signals: a run stops with its file whole or tells how far it is; a file that broke is named.
#include "cli/common/signals.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "cli/common/command.h"

// Signal handlers can reach nothing but globals: these are the program's only ones.
static volatile sig_atomic_t stop_asked, report_asked, held;
static char output[1024];
static struct sigaction fault_before;

static void put(const char *text)
{
    ssize_t written = write(STDERR_FILENO, text, strlen(text));
    (void)written;
}

static void on_stop(int signal_number)
{
    (void)signal_number;
    if (!held) {
        put("lacuna: interrupted before anything was written\n");
        _exit(CLI_EXIT_INTERRUPTED);
    }
    stop_asked = 1;
}

static void on_report(int signal_number)
{
    (void)signal_number;
    report_asked = 1;
}

// netCDF 4.9 reads what HDF5 has freed already where the system refuses to write or close a file.
static void on_fault(int signal_number)
{
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

static void install(int signal_number, void (*handler)(int), int flags)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = handler;
    action.sa_flags = flags;
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
    install(SIGPIPE, SIG_IGN, 0);
    install(SIGXFSZ, SIG_IGN, 0);
}

void cli_signals_writing(const char *path) { (void)snprintf(output, sizeof output, "%s", path); }

void cli_signals_hold(void) { held = 1; }

bool cli_signals_stop(void) { return stop_asked != 0; }

bool cli_signals_take_report(void)
{
    bool asked = report_asked != 0;
    report_asked = 0;
    return asked;
}
