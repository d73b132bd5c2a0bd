/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_RG_RG_H
#define LACUNA_CLI_RG_RG_H

#include "cli/common/options.h"
#include "scene/scene_rg.h"
#include "store/store_cells.h"

/// Whether an argument is a netCDF file, by its first bytes or its name, and no case.
bool cli_rg_is_file(const char *path);

/// The case that a file holds, and its cells at the snapshot asked for.
/// @param cells  the caller clears it, whatever the status
lac_status cli_rg_file_read(const cli_request *request, lac_case **c, lac_stored_cells *cells,
                            lac_error *err);

/// What the joint of a file is like at the snapshot, on stdout.
void cli_rg_file_print(const lac_stored_cells *cells, const lac_scene_rg *rg);

/// The results as tables on stdout.
void cli_rg_print(const lac_case *c, const lac_scene_rg *rg, bool verbose);

#endif
