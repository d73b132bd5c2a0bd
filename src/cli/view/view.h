/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/options.h"
#include "lacuna/simulation.h"
#include "store/store.h"

/// The page of a run while it goes on (`lacuna run --view`). Nothing here stops a run: what fails
/// is missing on the page. All functions take NULL, a run without --view.
typedef struct cli_view cli_view;

/// Where --view is given: serves from now on and says where; else *out is NULL and nothing is
/// loaded, started or allocated.
/// @return LAC_OK; LAC_EINPUT (not a port, one that is taken); LAC_EIO (no library); LAC_ENOMEM
lac_status cli_view_open(const cli_request *request, cli_view **out, lac_error *err);

/// Begins to show a run. Before its file is opened for writing: what a run that goes on has put out
/// already is read from there.
/// @param def  outlives the view with what it points to
/// @param once  values of its extra quantities over nothing; NULL: none
void cli_view_begin(cli_view *view, const lac_store_def *def, const double *once);

/// A sink that shows what it passes on; `next` where there is no view.
lac_sink cli_view_sink(cli_view *view, const lac_sink *next);

/// After every step.
void cli_view_progress(cli_view *view, const lac_progress *now);

/// Shows how the run ended, from its file, which is closed; then, on a terminal, stays until
/// Ctrl-C, else for as long as the pages that are open take to fetch it, 10 seconds at most.
/// @param failed  the slope did
/// @param message  what went wrong; ""
void cli_view_end(cli_view *view, const char *status, bool failed, const char *message);

/// Ends the server; a run that has not ended on the page is shown as broken off.
void cli_view_close(cli_view *view);

/// A server of pages on 127.0.0.1: `/` and `/data`, for reading only. docs/report.md
typedef struct cli_http cli_http;

/// Makes JSON for who has the data of a version already, 0: none; NULL without memory; the server
/// frees it. Called on the server's one thread alone. @param last  nothing new will follow
typedef char *cli_http_data(void *context, uint64_t since, bool *last);

/// Loads libmicrohttpd, which nothing else needs, and serves from a thread of its own.
/// @param port  0: one that is free
/// @return LAC_OK; LAC_EINPUT (the port is taken); LAC_EIO (no library, no socket); LAC_ENOMEM
lac_status cli_http_start(unsigned port, cli_http_data *data, void *context, cli_http **out,
                          lac_error *err);

/// How many pages are open that ask again and again and have not been sent the last data.
size_t cli_http_waiting(const cli_http *http);

/// The port that it is at.
unsigned cli_http_port(const cli_http *http);

/// Closes all connections and waits for its thread; NULL is fine.
void cli_http_stop(cli_http *http);
