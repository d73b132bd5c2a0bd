/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "contact/contact.h"

/// Which of a file's snapshots.
typedef struct lac_snapshot_choice {
    enum { LAC_SNAPSHOT_LAST = 0, LAC_SNAPSHOT_INDEX, LAC_SNAPSHOT_TIME } by;
    size_t index; ///< from 0
    double time;  ///< since the start [s]: the last snapshot that is not later
} lac_snapshot_choice;

/// What a file is.
typedef enum lac_stored_kind {
    LAC_STORED_RUN,     ///< of `lacuna run`; its snapshots in time
    LAC_STORED_CONTACT, ///< of `lacuna contact`: one snapshot, without shear
    LAC_STORED_HISTORY, ///< of `lacuna contact` with a history: its steps
} lac_stored_kind;

/// The contact cells of a file at one of its snapshots.
typedef struct lac_stored_cells {
    lac_stored_kind kind;
    lac_domain *domain; ///< pressures before pore pressure
    double *shear;      ///< [n] traction along x [Pa]
    size_t snapshots;   ///< that are whole
    size_t index;       ///< of this one
    double time;        ///< since the start [s]; NaN: not in time
    char *case_text;    ///< attribute `case`
    char status[16];    ///< attribute `status`
} lac_stored_cells;

/// Reads the cells of a file of a run or a contact. The last snapshot of a run that was killed is
/// passed over where it is torn. LAC_EINPUT: no such snapshot, no tractions kept, a force along y.
/// @param out  cleared by the caller, whatever the status
lac_status lac_stored_cells_read(const char *path, const lac_snapshot_choice *choice,
                                 lac_stored_cells *out, lac_error *err);

/// The contact cells alone: of a run, of a contact, or of the last step of a history that kept its
/// pressures. LAC_EINPUT: there is no contact cell.
/// @param domain  pressures before pore pressure; NULL where it fails
lac_status lac_stored_domain_read(const char *path, lac_domain **domain, lac_error *err);

/// Whether what a file holds begins as a netCDF file does; false where it cannot be read.
bool lac_stored_is_netcdf(const char *path);

/// Frees what it holds.
void lac_stored_cells_clear(lac_stored_cells *cells);

/// A field over the cells of an interface, in a netCDF file.
typedef struct lac_map_def {
    const char *path;
    const char *variable; ///< NULL: the only one that fits the grid
    const char *unit;     ///< SI unit of the result; "1" where dimensionless
} lac_map_def;

/// Reads a field at the contact cells of a domain: over the grid, (y, x) or with its dimensions
/// named x and y in any order, coordinates rising; over its points where the grid is a line; or
/// over the contact cells in the order of the domain. Packed values are unpacked; `units` must
/// convert to the unit asked for, and may be missing only where that is "1". LAC_EINPUT: no such
/// variable, another shape or dimension, a contact cell without a value.
/// @param values  [domain->n] SI; overwritten
lac_status lac_map_read(const lac_map_def *def, const lac_domain *domain, double *values,
                        lac_error *err);
