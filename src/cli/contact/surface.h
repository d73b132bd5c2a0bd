/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_CONTACT_SURFACE_H
#define LACUNA_CLI_CONTACT_SURFACE_H

#include "surface/surface.h"

/// Prints what a surface is like and where it came from, a row each.
void cli_surface_print(const lac_surface_report *surface);

#endif
