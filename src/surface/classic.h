/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_SURFACE_CLASSIC_H
#define LACUNA_SURFACE_CLASSIC_H

#include "surface/read.h"

/// Walks the header of a classic netCDF file (CDF-1, 2 and 5) and holds every count in it against
/// the bytes at hand: netCDF itself allocates what a count says.
/// @pre    the content begins with "CDF" and a version
/// @return LAC_OK; LAC_EINPUT with the byte where the header cannot be
/// @source "The NetCDF Classic Format Specification", NetCDF Users' Guide, appendix B
lac_status lac_classic_check(const lac_bytes *bytes, lac_error *err);

#endif
