/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "contact/contact.h"

/// A field over the cells of an interface, in a netCDF file.
typedef struct lac_map_def {
    const char *path;
    const char *variable; ///< NULL: the only one that fits the grid
    const char *unit;     ///< SI unit of the result; "1" where dimensionless
} lac_map_def;

/// Reads a field at the contact cells of a domain: over the grid, (y, x) or with its dimensions
/// named x and y in any order, coordinates rising; over its points where the grid is a line; or
/// over the contact cells in the order of the domain. Packed values are unpacked; `units` must
/// convert to the unit asked for, and may be missing only where that is "1".
/// @param values  [domain->n] SI; overwritten
/// @return LAC_OK; LAC_EIO (no netCDF file, damaged); LAC_EINPUT (no such variable, another shape
/// or
///         dimension, a contact cell without a value); LAC_ENOMEM
lac_status lac_map_read(const lac_map_def *def, const lac_domain *domain, double *values,
                        lac_error *err);
