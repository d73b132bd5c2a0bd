/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_FIT_FIT_H
#define LACUNA_CLI_FIT_FIT_H

#include "cli/common/options.h"
#include "fit/fit.h"

/// What a fit came to and where it stands.
typedef struct cli_fit_view {
    lac_fit_outcome outcome;
    const char *series; ///< file
    const lac_series *readings;
    const char *output, *case_output; ///< case_output NULL: not written
    double wall_time;
} cli_fit_view;

enum { CLI_FIT_COLUMNS = 5 };

/// A request whose options for the columns are settings of the case.
typedef struct cli_fit_columns {
    cli_request request; ///< borrows from the one it was made of
    lac_override *overrides;
    char *text[CLI_FIT_COLUMNS];
} cli_fit_columns;

/// @return LAC_OK; LAC_ENOMEM. To be cleared whatever the status.
lac_status cli_fit_columns_create(const cli_request *request, cli_fit_columns *out, lac_error *err);
void cli_fit_columns_clear(cli_fit_columns *columns);

/// Prints it on stdout.
void cli_fit_print(const cli_fit_view *view, bool verbose);

/// Writes the posterior, the predictions and the readings.
/// @return as lac_store_dataset
lac_status cli_fit_store(const cli_request *request, const cli_fit_view *view, lac_error *err);

/// Prints all as one JSON object on stdout.
/// @return LAC_OK; LAC_ENOMEM
lac_status cli_fit_json(const cli_fit_view *view, lac_error *err);

/// Writes the case with the best fit in it, which runs as it is; its files are named from the
/// folder that it stands in, or in full where that is another than the working folder.
/// @param c  a case of the same parameters; changed
/// @return LAC_OK; LAC_EIO; LAC_ENOMEM
lac_status cli_fit_write_case(const cli_fit_view *view, lac_case *c, lac_error *err);

#endif
