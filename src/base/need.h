/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

// Libraries that the program and the shared library open only where they are used, as what they
// draw in costs more to load than most commands take. Whoever calls their functions asks for them
// first: what makes a file or a context of theirs does. Where they are linked there is nothing to
// do.

/// netCDF, before a file is opened or created.
/// @return LAC_OK; LAC_EIO: it cannot be opened
lac_status lac_need_netcdf(lac_error *err);

/// SUNDIALS, before a context is created.
/// @return LAC_OK; LAC_EIO: it cannot be opened
lac_status lac_need_sundials(lac_error *err);
