// SPDX-License-Identifier: GPL-3.0-or-later
// In the place of view_http.c where libmicrohttpd's headers were not there to build it.
#include "cli/view/view.h"

lac_status cli_http_start(unsigned port, cli_http_data *data, void *context, cli_http **out,
                          lac_error *err)
{
    (void)port, (void)data, (void)context;
    *out = NULL;
    return lac_fail(err, LAC_EIO, "--view: this lacuna was built without libmicrohttpd's headers");
}

unsigned cli_http_port(const cli_http *http) { return (void)http, 0; }
size_t cli_http_waiting(const cli_http *http) { return (void)http, 0; }
void cli_http_stop(cli_http *http) { (void)http; }
