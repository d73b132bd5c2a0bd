// SPDX-License-Identifier: GPL-3.0-or-later
// The transfer of a lumped scene: classes of cells as the leaves of weighted blocks. No case names
// it; it is made from a scene's hierarchy.
#include "base/rows.h"
#include "transfer/transfer.h"

static void destroy(void *state) { lac_classes_free(state); }

static size_t work(const void *state) { return lac_classes_work(state); }

static void apply(const void *state, const double *slip, double *force, double *scratch)
{
    lac_classes_apply(state, slip, force, scratch);
}

static bool solve(const void *state, double k_mean, const double *diagonal, const double *y,
                  double *x, double *scratch)
{
    return lac_classes_solve(state, k_mean, diagonal, y, x, scratch);
}

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
    .free = destroy,
    .work = work,
    .apply = apply,
    .solve = solve,
    .stiffness = stiffness,
};

lac_transfer lac_transfer_of_classes(lac_classes *classes)
{
    return (lac_transfer){.kind = &classes_kind, .state = classes};
}
