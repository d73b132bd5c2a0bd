// SPDX-License-Identifier: GPL-3.0-or-later
// The table of commands: arguments, help and options of each, and the function that does it.
#include "cli/common/command.h"

enum { CLI_OPT_WRITES = CLI_OPT_OUTPUT | CLI_OPT_FORCE };

const cli_command cli_commands[] = {
    {"run", "CASE", "integrate a case in time, write a netCDF series",
     "The file is -o FILE, else output.file of the case, else CASE.nc in this folder. SIGINT "
     "(Ctrl-C) ends the run after its step and keeps what was computed, for --resume to go on "
     "from; a second one kills it. SIGUSR1 prints how far it is.\n",
     "lacuna run cases/vajont.yaml -o vajont.nc", 1, 1,
     CLI_OPT_WRITES | CLI_OPT_UNTIL | CLI_OPT_RESUME | CLI_OPT_SET | CLI_OPT_ACCURACY |
         CLI_OPT_VIEW | CLI_OPT_FROM,
     cli_run},
    {"check", "CASE", "validate a case, print it and what it will cost",
     "Lists all errors. The output is itself a case: every value in SI, defaults filled in.\n",
     "lacuna check cases/vajont.yaml --set interface.levels=9", 1, 1,
     CLI_OPT_SET | CLI_OPT_FROM | CLI_OPT_PIPE, cli_check},
    {"contact", "CASE", "press the surface, measure its contact, and stop",
     "Writes maps, fractal measures and histories to -o FILE, else CASE-contact.nc here; -v prints "
     "every specimen.\n",
     "lacuna contact cases/vajont.yaml -o contact.nc", 1, 1,
     CLI_OPT_WRITES | CLI_OPT_SET | CLI_OPT_FRACTAL, cli_contact},
    {"rg", "CASE|OUT.nc", "the cascade of slip and its critical shear force",
     "Takes a case, or the cells and tractions in the file of a run or a contact. Writes slipped "
     "fractions of every level at every load, and what follows from them, to -o FILE, else "
     "CASE-rg.nc in this folder; -v prints them too.\n",
     "lacuna rg cases/rg/rough-joint.yaml --set rg.rule=cons", 1, 1,
     CLI_OPT_WRITES | CLI_OPT_PIPE | CLI_OPT_RESUME | CLI_OPT_SET | CLI_OPT_SNAPSHOT | CLI_OPT_JOBS,
     cli_rg},
    {"precursors", "RUN.nc|SERIES.csv", "indicators and forecasts of the time of failure", "",
     "lacuna precursors series.csv --displacement disp:mm --rolling", 1, 1,
     CLI_OPT_WRITES | CLI_OPT_RESUME | CLI_OPT_UNTIL | CLI_OPT_SERIES | CLI_OPT_FORECAST |
         CLI_OPT_DRIVER | CLI_OPT_LINES | CLI_OPT_SET | CLI_OPT_JOBS | CLI_OPT_PIPE,
     cli_precursors},
    {"fit", "CASE SERIES", "fit a case's parameters to a monitoring series",
     "The case's section fit says what is estimated, from which columns unless options name them. "
     "Writes the draws, the predicted series and the times of failure to -o FILE, else CASE-fit.nc "
     "in this folder, and the fitted case beside it as FILE.yaml. -v prints every correlation.\n",
     "lacuna fit cases/fit/century.yaml cases/data/century_prism_31-2008.csv", 2, 2,
     CLI_OPT_WRITES | CLI_OPT_PIPE | CLI_OPT_RESUME | CLI_OPT_SET | CLI_OPT_JOBS | CLI_OPT_SERIES,
     cli_fit},
    {"trade", "CASE", "error against cost, and the settings to choose",
     "Runs the case at other settings, each in a process of its own, and compares error and CPU "
     "time. Dials: rtol, method, formulation; if named fidelity, levels, transfer, planning, "
     "precision; for a cascade contacts, shifts, field; for a contact levels. Writes -o FILE, else "
     "CASE-trade.nc here; tools/plot/plot_trade.py draws it.\n",
     "lacuna trade cases/vajont.yaml --reach 1% --dials rtol,method", 1, 1,
     CLI_OPT_WRITES | CLI_OPT_UNTIL | CLI_OPT_RESUME | CLI_OPT_SET | CLI_OPT_TRADE | CLI_OPT_JOBS |
         CLI_OPT_PIPE,
     cli_trade},
    {"sweep", "CASE", "many runs of a case, and what they say together",
     "Varies keys of the case by --over: lists and ranges (every value with every other), or "
     "distributions (uniform, loguniform, normal, lognormal, triangular); keys joined by + take "
     "one value. Prints how likely it fails, when, and what decides. Writes -o FILE, else "
     "CASE-sweep.nc here; lacuna report FILE draws it.\n",
     "lacuna sweep cases/block.yaml --over \"friction.aging.dc=1 mm, 2 mm\"", 1, 1,
     CLI_OPT_WRITES | CLI_OPT_RESUME | CLI_OPT_UNTIL | CLI_OPT_SET | CLI_OPT_SWEEP | CLI_OPT_BY |
         CLI_OPT_JOBS | CLI_OPT_PIPE,
     cli_sweep},
    {"gather", "SHARD.nc...", "the parts of a sweep as one file",
     "Joins the shards 0/N to N-1/N of lacuna sweep in -o FILE; without -o it only answers --of "
     "and "
     "--by. Every member must be there once.\n",
     "lacuna gather SHARD-0.nc SHARD-1.nc -o ALL.nc", 1, CLI_MANY,
     CLI_OPT_WRITES | CLI_OPT_BY | CLI_OPT_PIPE, cli_gather},
    {"report", "RUN.nc|SERIES.csv", "a run, or readings, as one HTML page to look at",
     "Writes -o FILE, else NAME.html in this folder; it needs no network. A series is forecast as "
     "by precursors --rolling, with the same options; a file of precursors is shown as it is. "
     "--compare lays readings beside a run; --displacement and --velocity name their columns, "
     "unless the run's case does. --fit draws what lacuna fit forecasts.\n",
     "lacuna report series.csv --displacement disp:mm", 1, 1,
     CLI_OPT_WRITES | CLI_OPT_COMPARE | CLI_OPT_SERIES | CLI_OPT_FORECAST | CLI_OPT_DRIVER |
         CLI_OPT_UNTIL | CLI_OPT_SET | CLI_OPT_BY,
     cli_report_page},
    {"export", "FILE.nc", "what a file holds as tables for a spreadsheet",
     "Writes a CSV for each set of dimensions (time.csv, issue-method.csv ...) to the folder -o, "
     "else "
     "to one called after the file. --variable picks some; if they make one table, it goes to "
     "stdout or to -o FILE.csv. Fields over the cells are written only if they are named. "
     "--stations writes NAME.dat for each of output.points.\n",
     "lacuna export OUT.nc --csv -o tables", 1, 1, CLI_OPT_WRITES | CLI_OPT_EXPORT, cli_export},
    {"watch", "FLEET.yaml", "forecasts for many stations as readings come",
     "Reads lines `station,time,displacement` from standard input, or follows files that grow, as "
     "FLEET.yaml says, and writes a line of JSON for each reading to -o FILE.jsonl, else to "
     "standard output. With --state DIR it goes on where it was stopped, however that was.\n",
     "lacuna watch fleet.yaml --state watch -o lines.jsonl < readings.csv", 1, 1,
     CLI_OPT_WRITES | CLI_OPT_STATE, cli_watch},
    {"mend", "FILE.nc", "make the file of a killed run readable",
     "The last values of a killed run, or of a history of loads, may be in FILE.nc.journal only, "
     "and FILE.nc may not open. Lacuna reads it all the same. This mends it in place for every "
     "program. run --resume still goes on from it.\n",
     "lacuna mend OUT.nc", 1, 1, 0, cli_mend},
    {"new", "[NAME]", "write a commented case file to start from",
     "Writes NAME.yaml, else case.yaml; a joint unless --kind says otherwise. It runs as it is, in "
     "seconds.\n",
     "lacuna new slope --kind slope", 0, 1, CLI_OPT_FORCE | CLI_OPT_KIND, cli_new},
    {"describe", "[KIND [NAME]|WORD]", "models: parameters, units, ranges, references",
     "KIND is a kind of model (friction, transfer ...), a section of a case (time ...), or levels: "
     "the thresholds of precursors --levels as a file. Any other WORD (water, angle, clay) lists "
     "where it occurs.\n",
     "lacuna describe friction aging", 0, 2, CLI_OPT_PIPE, cli_describe},
    {"completion", "SHELL", "completion of commands and options for a shell",
     "SHELL is bash, zsh or fish. Prints what the shell reads; an installed lacuna brings it.\n",
     "source <(lacuna completion bash)", 1, 1, 0, cli_completion},
    {0},
};
