/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_STORE_RG_H
#define LACUNA_STORE_RG_H

#include "lacuna/linkage.h"
#include "lacuna/rg_study.h"
#include "lacuna/store.h"

LAC_BEGIN_C

/// The file whose cells were followed, and what the joint was like in it.
typedef struct lac_rg_origin {
    const char *file, *status;
    size_t snapshot;
    double time;        ///< of the snapshot [s]; NaN: not in time
    double load;        ///< Q/Q_nom
    double share;       ///< effective over total normal pressure
    double weakest_gap; ///< least further stress that makes a cell slip [Pa]
    double weakest[2];  ///< centre of that cell [m]
} lac_rg_origin;

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
    const lac_rg_origin *origin;        ///< NULL: of a case
} lac_rg_view;

/// Writes them to a netCDF-4 file of their own; docs/format.md.
/// @return as lac_store_create
lac_status lac_store_rg(const char *path, bool force, const lac_provenance *provenance,
                        const lac_rg_view *view, lac_error *err);

LAC_END_C

#endif
