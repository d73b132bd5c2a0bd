/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_STORE_RG_H
#define LACUNA_STORE_RG_H

#include "lacuna/rg_study.h"
#include "lacuna/store.h"

/// The results of a cascade, as they are written.
typedef struct lac_rg_view {
    const char *rule, *field;
    const lac_grid *grid;
    const lac_domain *domain; ///< of the last interface
    size_t betas;
    const double *beta;                 ///< [betas] a mean where cells differ
    const lac_rg_result *const *result; ///< [betas]
    const lac_rg_interface *interface;  ///< [joints of the results]
    double strength;                    ///< Q_nom over the nominal area [Pa]
} lac_rg_view;

/// Writes them to a netCDF-4 file of their own; docs/format.md.
/// @return as lac_store_create
lac_status lac_store_rg(const char *path, bool force, const lac_provenance *provenance,
                        const lac_rg_view *view, lac_error *err);

#endif
