// SPDX-License-Identifier: GPL-3.0-or-later
// In the place of view_http.c where libmicrohttpd's headers were not there to build it.
#include "cli/view/view_http.h"

lac_status cli_http_start(unsigned port, const cli_http_def *def, cli_http **out, lac_error *err)
{
    (void)port, (void)def;
    *out = NULL;
    return lac_fail(err, LAC_EIO, "--view: this lacuna was built without libmicrohttpd's headers");
}

unsigned cli_http_port(const cli_http *http)
{
    (void)http;
    return 0;
}

void cli_http_stop(cli_http *http) { (void)http; }
