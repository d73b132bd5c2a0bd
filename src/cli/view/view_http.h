/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/fail.h"

/// A server of pages on 127.0.0.1: `/` and `/data`, for reading only. docs/report.md
typedef struct cli_http cli_http;

/// In the place of a version: who asks names none, and is given the newest data.
#define CLI_HTTP_NEWEST UINT64_MAX

/// Makes JSON for who has the data of a version already, 0: none; NULL without memory; the server
/// frees it. Called on the server's one thread alone. @param last  nothing new will follow
typedef char *cli_http_data(void *context, uint64_t since, bool *last);

/// Loads libmicrohttpd, which nothing else needs, and serves from a thread of its own.
/// @param port  0: one that is free
/// @return LAC_OK; LAC_EINPUT (the port is taken); LAC_EIO (no library, built without it, no
/// socket); LAC_ENOMEM
lac_status cli_http_start(unsigned port, cli_http_data *data, void *context, cli_http **out,
                          lac_error *err);

/// How many pages are open that ask again and again and have not been sent the last data.
size_t cli_http_waiting(const cli_http *http);

/// The port that it is at.
unsigned cli_http_port(const cli_http *http);

/// Closes all connections and waits for its thread; NULL is fine.
void cli_http_stop(cli_http *http);
