// SPDX-License-Identifier: GPL-3.0-or-later
// The command line: the table of all options, and how words become a request that makes sense.
#include "cli/common/options.h"

#include "base/temp_file.h"
#include "cli/common/words.h"

// An option that is told by its bit or that apply() has a line for, and one whose word has a place
// of its own in the request, or one behind those of its like.
#define PLAIN(bit_, letter_, name_, value_, ...)                                           \
    {                                                                                      \
        .name = "--" name_, .bit = CLI_OPT_##bit_, .letter = (letter_), .value = (value_), \
        .doc = __VA_ARGS__                                                                 \
    }
#define KEPT(bit, letter, name, value, place, ...) \
    PLAIN(bit, letter, name, value, __VA_ARGS__, .at = offsetof(cli_request, place))
#define LISTED(bit, letter, name, value, place, ...) \
    PLAIN(bit, letter, name, value, __VA_ARGS__, .words = offsetof(cli_request, place))

const cli_option cli_options[] = {
    KEPT(OUTPUT, 'o', "output", "FILE", output, "where to write the file"),
    PLAIN(FORCE, 0, "force", NULL, "replace a file that exists"),
    PLAIN(PIPE, 0, "pipe", NULL, "write the file's content to stdout instead, for programs"),
    PLAIN(RESUME, 0, "resume", NULL, "go on from what was kept when it was stopped"),
    KEPT(FROM, 0, "from", "RUN.nc", from, "go on from a run; without CASE by its own case"),
    KEPT(FROM, 0, "at", "TIME", at, "when: last, a time, a date, a snapshot's number"),
    KEPT(UNTIL, 0, "until", "TIME", until, "end earlier: \"10 day\", or a date"),
    KEPT(KIND, 0, "kind", "KIND", kind,
         "block, fit, injection, joint, laboratory, reservoir, slope"),
    KEPT(FRACTAL, 0, "boxes", "S:S", boxes, "sides of boxes that D_box is fitted to: 2:32"),
    KEPT(FRACTAL, 0, "coarsest", "N", coarsest, "cells a side of the coarsest resolution: 64"),
    KEPT(FRACTAL, 0, "coarsening", "HOW", coarsening, "coarser grids by sample or block-mean"),
    KEPT(FRACTAL, 0, "sizes", "LIST", sizes, "specimens of the size effect: \"50 mm, 1 m\""),
    KEPT(SNAPSHOT, 0, "snapshot", "WHICH", snapshot,
         "one of a file: last, a number from 0, a time"),
    KEPT(COMPARE, 0, "compare", "SERIES", compare, "monitoring data to lay beside the run"),
    KEPT(COMPARE, 0, "point", "NAME", point, "place of output.points that the series is of"),
    KEPT(COMPARE, 0, "fit", "FIT", fit, "file of lacuna fit: its forecast beside the run"),
    KEPT(SERIES, 0, "time", "COLUMN", series.time, "column of times (default: the first)"),
    KEPT(SERIES, 0, "time-format", "FORMAT", series.time_format,
         "iso, unix, excel, \"%d/%m/%Y %H:%M\", day ..."),
    KEPT(SERIES, 0, "clock", "COLUMN", series.clock,
         "column of the time of day, if dates have their own"),
    KEPT(SERIES, 0, "skip", "N", series.skip, "lines before the header (default: it is found)"),
    KEPT(SERIES, 0, "displacement", "COL:UNIT", series.displacement,
         "column and unit: \"disp_mm:mm\"; may be repeated",
         .words = offsetof(cli_request, displacements)),
    KEPT(SERIES, 0, "components", "LIST", series.components,
         "east, north, up instead: \"e:mm,n:mm,u:mm\""),
    KEPT(SERIES, 0, "line-of-sight", "E,N,U", series.line_of_sight,
         "project them on this (default: the main direction)"),
    KEPT(SERIES, 0, "velocity", "COL:UNIT", series.velocity, "column and unit: \"rate:mm/day\""),
    KEPT(SERIES, 0, "sigma", "COL:UNIT", series.sigma, "standard error of each displacement"),
    LISTED(DRIVER, 0, "driver", "COL:UNIT", drivers,
           "a possible cause: \"rain.csv/mm:mm:sum\"; may be repeated"),
    KEPT(FORECAST, 0, "smooth", "HOW", forecast.smooth,
         "velocities: average:5, window:\"3 day\", savgol:7,2"),
    KEPT(FORECAST, 0, "raw", NULL, forecast.raw, "keep outliers and sensor resets"),
    KEPT(FORECAST, 0, "since", "TIME", forecast.since,
         "fit from here, not from the onset of acceleration"),
    KEPT(FORECAST, 0, "onset", "S,L", forecast.onset,
         "accelerates if the mean of S is above that of L: 3,7"),
    KEPT(FORECAST, 0, "window", "WINDOW", forecast.window,
         "use the last \"2000\" readings, \"90 day\", or both, only"),
    KEPT(FORECAST, 0, "rolling", NULL, forecast.rolling, "forecasts as issued at each reading"),
    KEPT(FORECAST, 0, "issues", "N", forecast.issues, "most issue times of --rolling: 200"),
    KEPT(LINES, 0, "jsonl", NULL, forecast.lines, "--rolling as JSON, a line an issue time"),
    KEPT(FORECAST, 0, "failed-at", "TIME", forecast.failed_at, "when it failed: judges --rolling"),
    KEPT(FORECAST, 0, "levels", "FILE", forecast.levels,
         "thresholds of the level: see describe levels"),
    KEPT(FORECAST, 0, "horizon", "TIME", forecast.horizon, "an alarm if so near: \"7 day\""),
    KEPT(FORECAST, 0, "case", "CASE", forecast.case_file,
         "also forecast by this case, fitted to the series"),
    KEPT(TRADE, 0, "quantity", "NAME", trade.quantity,
         "failure, slip, rate, q-crit, contact-fraction ..."),
    KEPT(TRADE, 0, "reach", "ERROR", trade.reach, "error: 1%, or \"1 h\" of a time of failure"),
    KEPT(TRADE, 0, "spend", "TIME", trade.budget, "time that a run may take: \"10 min\""),
    KEPT(TRADE, 0, "dials", "LIST", trade.settings,
         "rtol,method, or positions: rtol=1e-3:1e-6,levels"),
    KEPT(TRADE, 0, "crossed", NULL, trade.crossed, "every position of a dial with every other"),
    LISTED(SWEEP, 0, "over", "KEY=VALUES", over,
           "vary: \"1 cm, 2 cm\", 1:100, \"uniform(1 cm, 5 cm)\"; may be repeated"),
    KEPT(SWEEP, 0, "design", "DESIGN", sweep.design, "grid, random, lhs, sobol, saltelli, tornado"),
    KEPT(SWEEP, 0, "members", "N", sweep.members, "runs in all, if the design leaves it open"),
    KEPT(SWEEP, 0, "seed", "S", sweep.seed, "seed of the random numbers: 1"),
    KEPT(SWEEP, 0, "table", "FILE", sweep.table,
         "keys that vary together: a column each (\"KEY:unit\"), a row a member"),
    KEPT(SWEEP, 0, "series", "AXIS", sweep.series,
         "slip rates kept: time:50, rate:2 (when passed), left:2 (before failure)"),
    KEPT(SWEEP, 0, "shard", "I/N", sweep.shard, "only part I of N, counted from 0: see gather"),
    KEPT(SWEEP, 0, "keep-fields", "MEMBERS", sweep.keep,
         "keep these runs whole, as FILE-member-I.nc: 0, 7, 20:30"),
    KEPT(SWEEP, 0, "member", "I", sweep.member, "only this member of a sweep"),
    KEPT(BY, 0, "of", "RESULT", sweep.of, "result asked for: failure_time, mean_slip ..."),
    KEPT(BY, 0, "by", "TIME", sweep.by,
         "probability of failure by then: \"2 year\", a date; of --of: that it is at most this"),
    KEPT(JOBS, 0, "jobs", "N", trade.jobs,
         "runs at a time (default: one a processor; for a fit one)"),
    KEPT(ACCURACY, 0, "accuracy", "ERROR", accuracy, "keep this: 1%; pilot runs pick settings"),
    KEPT(STATE, 0, "state", "DIR", watch_state, "where to keep what a restart needs"),
    KEPT(VIEW, 0, "view", "[PORT]", view, "show its page while it runs, on 127.0.0.1"),
    KEPT(EXPORT, 0, "csv", NULL, csv, "comma-separated tables, the default"),
    KEPT(EXPORT, 0, "stations", NULL, stations, "output.points in the SEAS benchmarks' format"),
    LISTED(EXPORT, 0, "variable", "NAME", variables, "only this one; may be repeated"),
    PLAIN(SET, 0, "set", "KEY=VALUE", "override the case; may be repeated"),
    PLAIN(JSON, 0, "json", NULL, "results as one JSON object, in SI"),
    PLAIN(QUIET, 'q', "quiet", NULL, "no progress, no warnings"),
    PLAIN(VERBOSE, 'v', "verbose", NULL, "say what is being done"),
    PLAIN(THREADS, 0, "threads", "N", "threads to compute with (default 1)"),
    PLAIN(NO_PROGRESS, 0, "no-progress", NULL, "no progress bar"),
    PLAIN(VERSION, 0, "version", NULL, "version, and those of the libraries"),
    PLAIN(HELP, 'h', "help", NULL, "this text"),
    {0},
};

void cli_options_help(unsigned mask)
{
    for (const cli_option *o = cli_options; o->name != NULL; o++) {
        char left[40], lead[48], letter[] = {'-', o->letter, ',', ' ', '\0'};
        (void)snprintf(left, sizeof left, "%s%s %s", o->letter != '\0' ? letter : "    ", o->name,
                       o->value == NULL ? "" : o->value);
        (void)snprintf(lead, sizeof lead, "  %-23s ", left);
        if ((o->bit & mask) != 0) {
            cli_wrap_after(lead, "                          ", o->doc);
        }
    }
}

// What is left of the command line while it is read.
typedef struct cursor {
    int argc, at;
    char **argv;
} cursor;

const cli_option *cli_option_find(const char *word, size_t length)
{
    const cli_option *o = cli_options;
    for (; o->name != NULL; o++) {
        if (word[1] == '-' ? strncmp(o->name, word, length) == 0 && o->name[length] == '\0'
                           : o->letter != '\0' && o->letter == word[1]) {
            return o;
        }
    }
    return NULL;
}

static lac_status keep_override(cli_request *request, const char *key, size_t length,
                                const char *value, lac_error *err)
{
    LAC_TRY_RETURN(lac_grow((void *)&request->overrides, &request->set_room, request->set_count + 1,
                            sizeof *request->overrides, err));
    char *copy = strndup(key, length);
    LAC_FAIL_MEMORY_IF(copy == NULL, err);
    request->overrides[request->set_count++] = (lac_override){.key = copy, .value = value};
    return LAC_OK;
}

static lac_status keep_word(cli_words *words, const char *value, lac_error *err)
{
    LAC_TRY_RETURN(
        lac_grow((void *)&words->word, &words->room, words->n + 1, sizeof *words->word, err));
    words->word[words->n++] = value;
    return LAC_OK;
}

static lac_status apply(cli_request *request, const cli_option *o, const char *value,
                        lac_error *err)
{
    static const char accuracy[] = "solver.accuracy";
    const char *word = o->value != NULL ? value : o->name, *equals = strchr(value, '=');
    request->given |= o->bit;
    LAC_FAIL_IF(o->value != NULL && value[0] == '\0', err, LAC_EINPUT, "%s: needs a value: %s %s",
                o->name, o->name, o->value);
    if (o->words != 0) {
        LAC_TRY_RETURN(keep_word((cli_words *)((char *)request + o->words), value, err));
    }
    if (o->at != 0) {
        memcpy((char *)request + o->at, &word, sizeof word);
    }
    switch (o->bit) {
    case CLI_OPT_SET:
        LAC_FAIL_IF(equals == NULL || equals == value, err, LAC_EINPUT,
                    "--set: \"%s\" must be key.path=value", value);
        return keep_override(request, value, (size_t)(equals - value), equals + 1, err);
    case CLI_OPT_ACCURACY:
        return keep_override(request, accuracy, strlen(accuracy), value, err);
    case CLI_OPT_THREADS:
        return cli_count(o->name, value, 1024, &request->threads, err);
    default:
        return LAC_OK;
    }
}

// The next word as an option's value; "" where there is none. A value that may be left out is a
// number: other words are not taken for it, and "0" stands where there is none.
static const char *next_word(cursor *c, const cli_option *o, cli_request *request)
{
    const char *word = c->at < c->argc ? c->argv[c->at] : "";
    if (o->value[0] == '[' && (word[0] == '\0' || word[strspn(word, "0123456789")] != '\0')) {
        return "0";
    }
    request->open = c->at < c->argc ? NULL : o;
    c->at += c->at < c->argc;
    return word;
}

static lac_status read_long(cursor *c, const char *word, cli_request *request, lac_error *err)
{
    char name[64]; // that of no option is as long
    const size_t length = strcspn(word, "=");
    const char *value = "";
    (void)snprintf(name, sizeof name, "%.*s", (int)(length < 62 ? length : 62), word);
    const cli_option *o = cli_find("", name, "option", cli_options, sizeof *cli_options, err);
    if (o == NULL) {
        return LAC_EINPUT;
    }
    if (word[length] == '=') {
        value = word + length + 1;
        LAC_FAIL_IF(o->value == NULL, err, LAC_EINPUT, "%s: takes no value, not \"%s\"", o->name,
                    value);
    } else if (o->value != NULL) {
        value = next_word(c, o, request);
    }
    return apply(request, o, value, err);
}

// -q, -qv, -o FILE, -oFILE
static lac_status read_letters(cursor *c, const char *letters, cli_request *request, lac_error *err)
{
    lac_status status = LAC_OK;
    while (status == LAC_OK && *letters != '\0') {
        const cli_option *o = cli_option_find(letters - 1, 2);
        const char *rest = ++letters;
        LAC_FAIL_IF(o == NULL, err, LAC_EINPUT, "\"-%c\" is no option; see lacuna --help",
                    rest[-1]);
        if (o->value != NULL) {
            letters = "";
            rest = *rest != '\0' ? rest : next_word(c, o, request);
        }
        status = apply(request, o, o->value != NULL ? rest : "", err);
    }
    return status;
}

static lac_status read_argument(const char *word, cli_request *request, lac_error *err)
{
    if (request->command == NULL) {
        if (strcmp(word, "help") == 0) {
            request->given |= CLI_OPT_HELP;
            return LAC_OK;
        }
        request->command = cli_find("", word, "command", cli_commands, sizeof *cli_commands, err);
        return request->command != NULL ? LAC_OK : LAC_EINPUT;
    }
    if (request->command->most == CLI_MANY) {
        return keep_word(&request->files, word, err);
    }
    LAC_FAIL_IF(request->count >= request->command->most, err, LAC_EINPUT,
                "%s: \"%.60s\" is one argument too many", request->command->name, word);
    request->argument[request->count++] = word;
    return LAC_OK;
}

static lac_status read_word(cursor *c, cli_request *request, lac_error *err)
{
    const char *word = c->argv[c->at++];
    if (request->only_arguments || word[0] != '-' || word[1] == '\0') {
        return read_argument(word, request, err);
    }
    if (strcmp(word, "--") == 0) {
        request->only_arguments = true;
        return LAC_OK;
    }
    return word[1] == '-' ? read_long(c, word, request, err)
                          : read_letters(c, word + 1, request, err);
}

// The whole must make sense: a command, its arguments, no option that it does not take.
static lac_status check_request(const cli_request *request, lac_error *err)
{
    const cli_command *command = request->command;
    if (cli_given(request, CLI_OPT_HELP) || cli_given(request, CLI_OPT_VERSION)) {
        return LAC_OK;
    }
    LAC_FAIL_IF(command == NULL, err, LAC_EINPUT, "no command given; see lacuna --help");
    for (const cli_option *o = cli_options; o->name != NULL; o++) {
        const bool taken = (o->bit & (command->options | CLI_OPT_COMMON)) != 0;
        const char *at = (const char *)request;
        const char *word = NULL;
        memcpy(&word, at + o->at, sizeof word);
        const bool listed = o->words != 0 && ((const cli_words *)(at + o->words))->n > 0;
        const bool given = o->at != 0      ? word != NULL
                           : o->words != 0 ? listed
                                           : cli_given(request, o->bit); // bits are shared
        LAC_FAIL_IF(!taken && given, err, LAC_EINPUT,
                    "%s: not an option of %s; see lacuna %s --help", o->name, command->name,
                    command->name);
    }
    LAC_FAIL_IF(request->displacements.n > 1 && (command->options & CLI_OPT_FORECAST) == 0, err,
                LAC_EINPUT, "--displacement: %s takes one column, and %zu were named",
                command->name, request->displacements.n);
    LAC_FAIL_IF(request->at != NULL && request->from == NULL, err, LAC_EINPUT,
                "--at: says when of --from RUN.nc, which is missing");
    LAC_FAIL_IF(request->count + request->files.n < command->least && request->from == NULL, err,
                LAC_EINPUT, "%s: %s is missing; see lacuna %s --help", command->name,
                command->arguments, command->name);
    return LAC_OK;
}

// The command line as one text, for the file's history.
static char *join(int argc, char **argv)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (out == NULL) {
        return NULL;
    }
    (void)fputs("lacuna", out);
    for (int i = 1; i < argc; i++) {
        const char *quote = strpbrk(argv[i], " \t\"$*;&|<>()") != NULL ? "'" : "";
        (void)fprintf(out, " %s%s%s", quote, argv[i], quote);
    }
    return lac_text_made(out, &text);
}

void cli_request_begin(int count, char **word, cli_request *request)
{
    lac_error ignored;
    cursor c = {.argc = count, .argv = word};
    *request = (cli_request){0};
    while (c.at < c.argc) {
        (void)read_word(&c, request, &ignored);
    }
}

lac_status cli_request_read(int argc, char **argv, cli_request *request, lac_error *err)
{
    *request = (cli_request){.command_line = join(argc, argv)};
    LAC_FAIL_MEMORY_IF(request->command_line == NULL, err);
    cli_libraries(request->libraries, sizeof request->libraries);
    cursor c = {.argc = argc, .at = 1, .argv = argv};
    while (c.at < c.argc) {
        LAC_TRY_RETURN(read_word(&c, request, err));
    }
    LAC_TRY_RETURN(check_request(request, err));
    request->argument[0] = request->count > 0 ? request->argument[0] : request->from;
    return LAC_OK;
}

void cli_request_clear(cli_request *request)
{
    for (size_t i = 0; i < request->set_count; i++) {
        free((char *)request->overrides[i].key);
    }
    free(request->overrides);
    for (const cli_option *o = cli_options; o->name != NULL; o++) {
        if (o->words != 0) {
            free((void *)((cli_words *)((char *)request + o->words))->word);
        }
    }
    free((void *)request->files.word);
    free(request->command_line);
    free(request->work);
    *request = (cli_request){0};
}
