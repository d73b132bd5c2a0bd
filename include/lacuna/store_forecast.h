/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_STORE_FORECAST_H
#define LACUNA_STORE_FORECAST_H

#include "lacuna/hindcast.h"
#include "lacuna/linkage.h"
#include "lacuna/precursor.h"
#include "lacuna/store.h"

LAC_BEGIN_C

/// Forecasts, as they are written. Texts are borrowed and may be NULL.
typedef struct lac_forecast_file {
    const char *source;             ///< the file that they are of
    const char *attribution;        ///< of its data
    bool dated;                     ///< times are seconds since 1970 UTC
    double failed_at;               ///< [s]; NaN: not known; INFINITY: never
    const lac_outlook *outlook;     ///< at the last reading
    const lac_rolling *rolling;     ///< NULL: the outlook alone is written
    bool interrupted;               ///< rolling has not all issue times that it should have
    size_t indicators;              ///< kinds of them; 0: none
    const lac_precursor *indicator; ///< [issue times][indicators]
} lac_forecast_file;

/// Writes them to a netCDF-4 file of their own; docs/format.md.
/// @return as lac_store_create
lac_status lac_store_forecast(const char *path, bool force, const lac_provenance *provenance,
                              const lac_forecast_file *content, lac_error *err);

LAC_END_C

#endif
