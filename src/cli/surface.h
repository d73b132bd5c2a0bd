/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_SURFACE_H
#define LACUNA_CLI_SURFACE_H

#include "cli/json.h"
#include "lacuna/surface.h"

/// Prints what a surface is like and where it came from, a row each.
void cli_surface_print(const lac_surface_report *surface);

/// The same as an object `surface`; null where NULL.
void cli_surface_json(cli_json *json, const lac_surface_report *surface);

#endif
