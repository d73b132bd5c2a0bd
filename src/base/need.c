// SPDX-License-Identifier: GPL-3.0-or-later
// Libraries that are there from the start. Where they are opened when they are needed,
// tools/cmake/lazy.c.in has the functions that take the place of these.
#include "base/need.h"

__attribute__((weak)) lac_status lac_need_netcdf(lac_error *err)
{
    (void)err;
    return LAC_OK;
}

__attribute__((weak)) lac_status lac_need_sundials(lac_error *err)
{
    (void)err;
    return LAC_OK;
}
