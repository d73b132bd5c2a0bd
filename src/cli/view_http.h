/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_VIEW_HTTP_H
#define LACUNA_CLI_VIEW_HTTP_H

#include "cli/view_feed.h"
#include "lacuna/error.h"

/// A server of pages on 127.0.0.1: `/`, `/data` and `/events`, for reading only. docs/report.md
typedef struct cli_http cli_http;

/// Loads libmicrohttpd, which nothing else needs, and serves from threads of its own.
/// @param port  0: one that is free
/// @param feed  outlives the server
/// @return LAC_OK; LAC_EINPUT (the port is taken); LAC_EIO (no library, built without it, no
/// socket); LAC_ENOMEM
lac_status cli_http_start(unsigned port, cli_feed *feed, cli_http **out, lac_error *err);

/// The port that it is at.
unsigned cli_http_port(const cli_http *http);

/// Closes all connections and waits for its threads; NULL is fine. The feed is closed.
void cli_http_stop(cli_http *http);

#endif
