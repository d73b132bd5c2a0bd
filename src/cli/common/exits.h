/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_COMMON_EXITS_H
#define LACUNA_CLI_COMMON_EXITS_H

/// Exit statuses of the program.
enum {
    CLI_EXIT_DONE = 0,
    CLI_EXIT_FAILED = 1,      ///< the computation broke
    CLI_EXIT_WRONG = 2,       ///< usage, case or data
    CLI_EXIT_FILE = 3,        ///< could not be read or written
    CLI_EXIT_INTERRUPTED = 4, ///< what was computed is whole
};

#endif
