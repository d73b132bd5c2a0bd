/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_STORE_INDICATORS_H
#define LACUNA_STORE_INDICATORS_H

#include "lacuna/store_forecast.h"
#include "store/nc.h"

/// Writes `INDICATOR_KEY(issue)` for each number that any issue time has, and how many points went
/// into each indicator.
/// @param dim     of the issue times
/// @param issues  how many
/// @return LAC_OK; LAC_EIO; LAC_ENOMEM
lac_status lac_nc_indicators(const lac_nc *file, const lac_forecast_file *content, int dim,
                             size_t issues, lac_error *err);

#endif
