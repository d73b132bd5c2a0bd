/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_MEMORY_FORECAST_H
#define LACUNA_TESTS_MEMORY_FORECAST_H

#include "lacuna/error.h"

/// What `lacuna precursors --rolling -o PATH` does with readings that stand here.
lac_status whole_forecast(const char *path, lac_error *err);

#endif
