/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_RG_H
#define LACUNA_RG_H

#include "lacuna/case.h"
#include "lacuna/dataset.h"

LAC_BEGIN_C

/// How a cascade is computed; from lac_rg_options_default.
typedef struct lac_rg_options {
    size_t size; ///< of this structure, as the default has it
    /// Asked before each of the case's rg.seeds interfaces; false: ends here. NULL: never asked.
    bool (*go_on)(void *context, size_t done, size_t seeds);
    void *context;
} lac_rg_options;

/// Nobody is asked.
static inline lac_rg_options lac_rg_options_default(void)
{
    lac_rg_options options = LAC_ZEROS;
    options.size = sizeof options;
    return options;
}

/// The cascade of slip over the blocks of a case: its critical force and renormalization, as
/// `lacuna rg` has them.
/// @param c        read with LAC_FOR_RG; must outlive the dataset
/// @param options  NULL: the default
/// @param out      its variables are those of docs/format.md; NULL unless LAC_OK
/// @return LAC_OK; LAC_EINPUT (no beta follows from the friction law, no contact ...);
///         LAC_ENUMERIC; LAC_EINTERRUPT where go_on ended it; LAC_ENOMEM
/// @cost   with rg.field `elastic` 24 contacts a seed; some 300 passes a place and beta
lac_status lac_rg_compute(const lac_case *c, const lac_rg_options *options, lac_dataset **out,
                          lac_error *err);

LAC_END_C

#endif
