/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stddef.h>

/// The libraries that the program runs with and their versions, on one line; without netCDF,
/// whose version stands in every file anyway.
/// @return text, which also stands in `text`
const char *cli_libraries(char *text, size_t size);

/// Version of netCDF.
const char *cli_netcdf_version(char *text, size_t size);
