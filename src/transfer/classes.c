// SPDX-License-Identifier: GPL-3.0-or-later
// The transfer of a lumped scene: classes of cells as the leaves of weighted blocks. No case names
// it; it is made from a scene's hierarchy.
#include "base/rows.h"
#include "transfer/transfer.h"

// Of the stiffest block: what an explicit method's steps are bounded by.
static double stiffness(const void *state, size_t level)
{
    const lac_classes *classes = state;
    double most = 0.0;
    for (size_t i = 0; level == 0 && i < classes->nodes; i++) {
        most = classes->k[i] > most ? classes->k[i] : most;
    }
    return most;
}

static const lac_transfer_kind classes_kind = {
    .info = LAC_ABOUT("classes", "classes of cells as the leaves of weighted blocks",
                      "docs/theory/lumped.md"),
    .free = lac_classes_free,
    .work = lac_classes_work,
    .apply = lac_classes_apply,
    .solve = lac_classes_solve,
    .stiffness = stiffness,
};

lac_transfer lac_transfer_of_classes(lac_classes *classes)
{
    return (lac_transfer){.kind = &classes_kind, .state = classes};
}
