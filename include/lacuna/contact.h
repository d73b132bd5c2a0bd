/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CONTACT_H
#define LACUNA_CONTACT_H

#include "lacuna/case.h"
#include "lacuna/dataset.h"

LAC_BEGIN_C

/// How a contact is computed; from lac_contact_options_default.
typedef struct lac_contact_options {
    size_t size; ///< of this structure, as the default has it
    bool quick; ///< only the contact itself: nothing of clusters, area scaling and size effect, and
                ///< no history
    bool (*interrupted)(void *context); ///< asked before every step of a history; NULL: never
    void *context;
    // How it is measured, as options of `lacuna contact`; NULL: as without them.
    const char *boxes;      ///< sides of boxes that D_box is fitted to: "2:32"
    const char *coarsest;   ///< cells a side of the coarsest resolution: "64"
    const char *coarsening; ///< how grids are made coarser: "sample" or "block-mean"
    const char *sizes;      ///< specimens of the size effect: "50 mm, 1 m"
} lac_contact_options;

/// All that is measured.
static inline lac_contact_options lac_contact_options_default(void)
{
    lac_contact_options options = LAC_ZEROS;
    options.size = sizeof options;
    return options;
}

/// Presses the surface of a case, measures its contact and follows its history of loads, as
/// `lacuna contact` does.
/// @param c        read with LAC_FOR_CONTACT, or for more; must outlive the dataset
/// @param options  NULL: the default
/// @param out      its variables are those of docs/format.md; NULL unless LAC_OK
/// @return LAC_OK; LAC_EINPUT; LAC_ENUMERIC (no convergence); LAC_EINTERRUPT; LAC_ENOMEM
/// @cost   O(n log n) an iteration; what is measured takes half as much again. With a history as
///         much a step and, of the cells of a step that load.history.fields keeps, 41 bytes each
lac_status lac_contact_compute(const lac_case *c, const lac_contact_options *options,
                               lac_dataset **out, lac_error *err);

LAC_END_C

#endif
