// SPDX-License-Identifier: GPL-3.0-or-later
// Where the program starts: help, the command that was asked for, and the exit status.
#include <fcntl.h>
#include <gsl/gsl_errno.h>
#include <omp.h>
#include <unistd.h>

#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/common/progress.h"
#include "cli/common/words.h"
#include "cli/team/team.h"
#include "lacuna/version.h"
#include "store/store_file.h"

int cli_exit_status(lac_status status)
{
    static const int exits[] = {
        [LAC_OK] = CLI_EXIT_DONE,       [LAC_EINPUT] = CLI_EXIT_WRONG,
        [LAC_EIO] = CLI_EXIT_FILE,      [LAC_ENUMERIC] = CLI_EXIT_FAILED,
        [LAC_ENOMEM] = CLI_EXIT_FAILED, [LAC_EINTERRUPT] = CLI_EXIT_INTERRUPTED};
    return exits[status];
}

static void print_help(void)
{
    puts("Lacuna: creep, acceleration and failure of rough rock joints.\n"
         "usage: lacuna COMMAND [ARGUMENTS] [OPTIONS]\n");
    for (const cli_command *command = cli_commands; command->name != NULL; command++) {
        printf("  %-10s %-17s %s\n", command->name, command->arguments, command->summary);
    }
    puts("\nOptions of all commands; lacuna COMMAND --help has the rest:");
    cli_options_help(CLI_OPT_COMMON);
    (void)fputs(cli_team_help, stdout);
    puts("example: lacuna new && lacuna run case.yaml\n"
         "Exit status: 0 done, 1 computation broke, 2 request wrong, 3 file, 4 interrupted");
}

static void print_command_help(const cli_command *command)
{
    printf("usage: lacuna %s%s%s [OPTIONS]\n\n%s\n", command->name,
           command->arguments[0] != '\0' ? " " : "", command->arguments, command->summary);
    cli_wrap("", command->notes);
    puts("");
    cli_options_help(command->options & ~(unsigned)CLI_OPT_COMMON);
    printf("Of all commands, in lacuna --help: --json -q -v --threads, and exit statuses.\n"
           "example: %s\n",
           command->example);
}

static void print_version(const cli_request *request)
{
    const char *text = request->libraries, *netcdf = cli_netcdf_version();
    if (!cli_given(request, CLI_OPT_JSON)) {
        printf("lacuna %s\n%s, netCDF %s\n", LACUNA_VERSION, text, netcdf);
        return;
    }
    lac_json json = {.out = stdout};
    LAC_JSON_TEXTS(&json, "version", LACUNA_VERSION, "libraries", text, "netcdf", netcdf);
}

// A file that was not closed is read here, but not by others.
static void say_what_is_cut(const cli_request *request)
{
    const bool resumed = cli_given(request, CLI_OPT_RESUME) && request->output != NULL;
    const char *path = resumed ? request->output : request->argument[0];
    if (request->command->run == cli_mend || cli_given(request, CLI_OPT_QUIET) || path == NULL) {
        return;
    }
    lac_store_loss loss;
    if (lac_store_is_damaged(path, &loss)) {
        cli_note("warning: %s.journal: is damaged: its last %" PRIu64 " bytes, from byte %" PRIu64
                 " on, cannot be read; %s is read %s, which may lack what was synced",
                 path, loss.unread, loss.at, path,
                 loss.own >= (int64_t)loss.records ? "without it" : "up to there");
    } else if (lac_store_is_cut(path)) {
        cli_note("warning: %s: its writer was stopped before it had closed it; all that it left is "
                 "read; lacuna mend %s makes it readable for every program",
                 path, path);
    }
}

static lac_status dispatch(const cli_request *request, lac_error *err)
{
    if (cli_given(request, CLI_OPT_VERSION)) {
        print_version(request);
        return LAC_OK;
    }
    if (cli_given(request, CLI_OPT_HELP)) {
        if (request->command == NULL) {
            print_help();
        } else {
            print_command_help(request->command);
        }
        return LAC_OK;
    }
    const cli_command *command = request->command;
    const bool runs = command->run == cli_run;
    // the commands that ranks share, or each of them does alike
    const bool shared = command->run == cli_check || command->run == cli_contact ||
                        (runs && !cli_given(request, CLI_OPT_VIEW | CLI_OPT_FROM));
    LAC_FAIL_IF(request->team != NULL && !shared, err, LAC_EINPUT,
                "%s%s is not shared by ranks: do it on one, with lacuna %s", command->name,
                runs ? " with --view or --from" : "", command->name);
    say_what_is_cut(request);
    // One thread unless asked for more: two that share a busy core are slower than one.
    omp_set_num_threads(request->threads > 0 ? request->threads : 1);
    return request->command->run(request, err);
}

// A standard stream that was closed would be taken by the first file opened: occupy it, so that
// using it is an error instead.
static void occupy_standard_streams(void)
{
    for (int fd = 0; fd <= 2; fd++) {
        if (fcntl(fd, F_GETFD) < 0 && errno == EBADF) {
            (void)open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY);
        }
    }
}

// What could not be printed shows up here at the latest.
static lac_status flush_results(lac_error *err)
{
    errno = 0;
    bool failed = ferror(stdout) != 0;
    LAC_FAIL_IF(fflush(stdout) != 0 || failed, err, LAC_EIO, "standard output: %s",
                errno != 0 ? strerror(errno) : "could not be written");
    return LAC_OK;
}

int main(int argc, char **argv)
{
    lac_error err = {0};
    lac_team *team = NULL;
    cli_request request = {0};
    occupy_standard_streams();
    if (argc > 1 && strcmp(argv[1], "__complete") == 0) { // for shells: no command, and no errors
        cli_complete(argc - 2, argv + 2);
        return CLI_EXIT_DONE;
    }
    (void)gsl_set_error_handler_off(); // it would abort; every call's status is looked at
    cli_signals_install();
    cli_clean_stdout();
    lac_status status = cli_team_join(&team, &err);
    if (status == LAC_OK) {
        status = cli_request_read(argc, argv, &request, &err);
        request.team = team;
    }
    if (status == LAC_OK && cli_given(&request, CLI_OPT_PIPE)) {
        status = cli_pipe_open(&request, &err);
    }
    if (status == LAC_OK) {
        status = dispatch(&request, &err);
    }
    status = cli_team_end(team, status, &err);
    if (status != LAC_OK && err.message[0] != '\0') {
        cli_note("%s", err.message);
    }
    lac_status flushed = flush_results(&err);
    if (flushed != LAC_OK) {
        cli_note("%s", err.message);
        status = status == LAC_OK ? flushed : status;
    }
    cli_request_clear(&request);
    cli_team_leave();
    if (status == LAC_EIO) {
        // HDF5's handlers at exit would stumble over a file that could not be closed.
        _exit(cli_exit_status(status));
    }
    return cli_exit_status(status);
}
