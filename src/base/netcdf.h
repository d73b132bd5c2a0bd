/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

// What the readers of other people's netCDF files share. `id` is an open file's.

/// Whether the first bytes of a file are those of a netCDF file, of any kind.
/// @param head  [size]; four are enough
bool lac_netcdf_begins(const void *head, size_t size);

/// Opens a file to read it. @return LAC_OK; LAC_EINPUT where netCDF cannot; LAC_ENOMEM
lac_status lac_netcdf_open(const char *path, int *id, lac_error *err);

/// Holds all counts in the header of a classic file against its bytes; LAC_OK for other kinds.
lac_status lac_netcdf_check_header(const char *path, const void *bytes, size_t size,
                                   lac_error *err);

/// What a call of netCDF returned, as an error: `path: netCDF cannot read WHAT: why`.
lac_status lac_netcdf_check(const char *path, int code, const char *what, lac_error *err);

/// Looks up a variable. @return LAC_OK; LAC_EINPUT: there is none; it names those there are
lac_status lac_netcdf_find(const char *path, int id, const char *name, int *var, lac_error *err);

/// Whether a variable is numbers over so many dimensions. @param dims  [rank] set where it is
bool lac_netcdf_runs_over(int id, int var, int rank, int *dims);

/// The coordinates of a dimension. @param name  [NC_MAX_NAME + 1] its own, and the variable's
/// @return whether there are any
bool lac_netcdf_axis(int id, int dim, char *name, int *var);

/// A text attribute, of characters or one string; "" where there is none or it is too long.
/// @param text  [size] overwritten
/// @return whether it is there
bool lac_netcdf_text(int id, int var, const char *name, char *text, size_t size);

/// A numeric attribute of one value; `fallback` where there is none.
double lac_netcdf_number(int id, int var, const char *name, double fallback);

/// What a variable holds where nothing was written: its _FillValue, or what netCDF itself leaves.
double lac_netcdf_fill(int id, int var);

/// Stored numbers of a variable to values: missing ones (_FillValue, missing_value, and what netCDF
/// leaves where nothing was written) to NaN, packed ones (scale_factor, add_offset) unpacked.
void lac_netcdf_unpack(int id, int var, double *x, size_t n);

/// All n numbers of a variable, unpacked, missing ones NaN. @param name  for messages
lac_status lac_netcdf_values(const char *path, int id, int var, const char *name, size_t n,
                             double *x, lac_error *err);
