// SPDX-License-Identifier: GPL-3.0-or-later
#include "lacuna/load.h"

#include <math.h>

// The descriptor is the first member of the kind's row.
static const lac_load_kind *kind_of(const lac_slot *slot)
{
    return (const lac_load_kind *)(const void *)slot->about;
}

static void add_all(const lac_slot *slots, size_t count, double t, lac_load_state *sum)
{
    for (size_t i = 0; i < count; i++) {
        kind_of(&slots[i])->add(slots[i].params, t, sum);
    }
}

static double first_break(const lac_slot *slots, size_t count, double t)
{
    double first = INFINITY;
    for (size_t i = 0; i < count; i++) {
        const lac_load_kind *kind = kind_of(&slots[i]);
        if (kind->next_break != NULL) {
            first = fmin(first, kind->next_break(slots[i].params, t));
        }
    }
    return first;
}

void lac_load_evaluate(const lac_load_set *set, double t, lac_load_state *sum)
{
    *sum = (lac_load_state){0};
    add_all(set->shear, set->shear_count, t, sum);
    add_all(set->pore, set->pore_count, t, sum);
}

double lac_load_next_break(const lac_load_set *set, double t)
{
    return fmin(first_break(set->shear, set->shear_count, t),
                first_break(set->pore, set->pore_count, t));
}
