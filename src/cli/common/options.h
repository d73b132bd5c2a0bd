/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "case/case.h"

/// Options, as bits: which were given, and which a command takes.
enum {
    CLI_OPT_OUTPUT = 1 << 0,
    CLI_OPT_FORCE = 1 << 1,
    CLI_OPT_UNTIL = 1 << 2,
    CLI_OPT_KIND = 1 << 3,
    CLI_OPT_SET = 1 << 4,
    CLI_OPT_JSON = 1 << 5,
    CLI_OPT_QUIET = 1 << 6,
    CLI_OPT_VERBOSE = 1 << 7,
    CLI_OPT_THREADS = 1 << 8,
    CLI_OPT_NO_PROGRESS = 1 << 9,
    CLI_OPT_HELP = 1 << 10,
    CLI_OPT_VERSION = 1 << 11,
    CLI_OPT_EXPORT = 1 << 12,  ///< which tables
    CLI_OPT_FROM = 1 << 13,    ///< a run to go on from
    CLI_OPT_FRACTAL = 1 << 16, ///< how contact is measured
    CLI_OPT_DRIVER = 1 << 17,
    CLI_OPT_STATE = 1 << 18, ///< of a watch
    CLI_OPT_LINES = 1 << 19, ///< forecasts, a line each
    CLI_OPT_SNAPSHOT = 1 << 20,
    CLI_OPT_RESUME = 1 << 21,
    CLI_OPT_SERIES = 1 << 22,   ///< how a monitoring file is read
    CLI_OPT_FORECAST = 1 << 23, ///< how forecasts are made and judged
    CLI_OPT_JOBS = 1 << 14,     ///< processes at a time
    CLI_OPT_SWEEP = 1 << 24,    ///< what is varied, and how
    CLI_OPT_BY = 1 << 25,       ///< which answers of a sweep
    CLI_OPT_TRADE = 1 << 26,    ///< what is traded, and for what
    CLI_OPT_ACCURACY = 1 << 27, ///< of a run
    CLI_OPT_COMPARE = 1 << 28,
    CLI_OPT_VIEW = 1 << 29, ///< a run's page while it goes on
    CLI_OPT_PIPE = 1 << 30, ///< the dataset on stdout
    CLI_OPT_COMMON = CLI_OPT_JSON | CLI_OPT_QUIET | CLI_OPT_VERBOSE | CLI_OPT_THREADS |
                     CLI_OPT_NO_PROGRESS | CLI_OPT_HELP | CLI_OPT_VERSION,
};

enum { CLI_MAX_ARGUMENTS = 2, CLI_MANY = 1 << 20 }; ///< any number

/// One option.
typedef struct cli_option {
    const char *name; ///< with its dashes
    unsigned bit;
    char letter;       ///< '\0': none
    const char *value; ///< what its value is called; NULL: takes none; "[...]": only a number is it
    const char *doc;
    size_t at;    ///< of the text in the request that is set to its value, or to its name where it
                  ///< takes none; 0: no such text
    size_t words; ///< of the cli_words of one that may be repeated; 0: may not
} cli_option;

/// All of them; the name of the last one is NULL.
extern const cli_option cli_options[];

/// The option of "--NAME" of that length, or of "-LETTER" and more; NULL where there is none.
const cli_option *cli_option_find(const char *word, size_t length);

typedef struct cli_request cli_request;

/// One command of the program.
typedef struct cli_command {
    const char *name;
    const char *arguments; ///< "CASE", "[NAME]"
    const char *summary;   ///< one line
    const char *notes;     ///< a paragraph of the help text, wrapped, ending in a newline
    const char *example;
    size_t least, most; ///< number of arguments
    unsigned options;   ///< CLI_OPT_* it takes besides the common ones
    /// Does the command; prints results on stdout. An error it has already printed leaves the
    /// message in `err` empty.
    lac_status (*run)(const cli_request *request, lac_error *err);
} cli_command;

/// All of them; the name of the last one is NULL.
extern const cli_command cli_commands[];

/// Options of monitoring series and of forecasts, as they were written; NULL: not given.
typedef struct cli_series_words {
    const char *time, *time_format, *clock, *skip, *displacement, *velocity, *sigma;
    const char *components, *line_of_sight;
} cli_series_words;

/// What an option that may be repeated was given, in order.
typedef struct cli_words {
    size_t n, room;
    const char **word; ///< [n]; owned, texts borrowed from argv
} cli_words;

typedef struct cli_forecast_words {
    const char *smooth, *raw, *since, *onset, *rolling, *issues, *failed_at, *horizon, *case_file,
        *window, *lines, *levels;
} cli_forecast_words;

typedef struct cli_trade_words {
    const char *quantity, *reach, *budget, *settings, *crossed, *jobs;
} cli_trade_words;

typedef struct cli_sweep_words {
    const char *design, *members, *seed, *by, *of, *table, *series, *shard, *member, *keep;
} cli_sweep_words;

/// What the command line asks for. Texts are borrowed from argv unless said.
struct cli_request {
    const cli_command *command; ///< NULL: only --help or --version
    unsigned given;             ///< CLI_OPT_*
    bool only_arguments;        ///< there was a "--"
    const cli_option *open;     ///< the last one, where the line ended before its value; else NULL
    size_t count;               ///< arguments after the command
    const char *argument[CLI_MAX_ARGUMENTS];
    const char *output, *until, *kind;
    const char *from, *at;                             ///< a run to go on from, and when
    const char *boxes, *coarsest, *coarsening, *sizes; ///< of the fractal measures
    const char *snapshot;                              ///< which one of a file
    const char *compare, *point, *fit; ///< a series, of which point, and a fit laid beside a run
    const char *accuracy;              ///< among the overrides too, as solver.accuracy
    const char *watch_state;           ///< folder
    const char *view;                  ///< port of its page, 0 where none is named
    cli_series_words series;           ///< its displacement is the last one
    cli_words displacements;           ///< --displacement
    cli_forecast_words forecast;
    cli_trade_words trade;
    int threads;                ///< 0: not given
    int pipe;                   ///< where --pipe writes to; 0: not given
    char *work;                 ///< owned: `output` with --pipe; NULL
    size_t set_count, set_room; ///< --set, in order
    lac_override *overrides;    ///< [set_count]; keys owned, values borrowed from argv
    cli_words variables;        ///< --variable
    cli_words drivers;          ///< --driver
    cli_sweep_words sweep;
    cli_words over;             ///< --over
    cli_words files;            ///< arguments of a command that takes any number of them
    const char *csv, *stations; ///< kinds of tables
    lac_team *team;             ///< who do the same; NULL: nobody
    char *command_line;         ///< owned
    char libraries[256];        ///< that the program runs with, their versions
};

/// The libraries that the program runs with and their versions, on one line; without netCDF, whose
/// version stands in every file anyway.
void cli_libraries(char *text, size_t size);

/// Reads the command line; options may stand before or after the command and its arguments.
/// @return LAC_OK; LAC_EINPUT (unknown, missing value ...); LAC_ENOMEM
lac_status cli_request_read(int argc, char **argv, cli_request *request, lac_error *err);

/// Reads the begin of a command line that is still typed, past all that is wrong in it.
/// @param word  [count] after the program's name
void cli_request_begin(int count, char **word, cli_request *request);

/// Frees what the request owns.
void cli_request_clear(cli_request *request);

/// Whether an option was given.
static inline bool cli_given(const cli_request *request, unsigned option)
{
    return (request->given & option) != 0;
}

/// Prints the help lines of the options in `mask` on stdout.
void cli_options_help(unsigned mask);
