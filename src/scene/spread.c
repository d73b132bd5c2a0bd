// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <string.h>

#include "base/rng.h"
#include "scene/internal.h"

// FNV-1a: parameters that share a seed still get numbers of their own.
static uint64_t hash(const char *text)
{
    uint64_t h = 14695981039346656037u;
    for (; *text != '\0'; text++) {
        h = (h ^ (unsigned char)*text) * 1099511628211u;
    }
    return h;
}

static double factor(const lac_spread *spread, uint64_t place, uint64_t key)
{
    double normal[2];
    switch ((lac_spread_kind)spread->kind) {
    case LAC_SPREAD_LOGNORMAL:
        lac_random_normal((uint64_t)spread->seed, LAC_STREAM_SPREAD, place, key, normal);
        return exp(spread->width * normal[0]);
    case LAC_SPREAD_NORMAL:
        lac_random_normal((uint64_t)spread->seed, LAC_STREAM_SPREAD, place, key, normal);
        return 1.0 + spread->width * normal[0];
    case LAC_SPREAD_UNIFORM:
        break;
    }
    double u = lac_random_uniform((uint64_t)spread->seed, LAC_STREAM_SPREAD, place, key);
    return 1.0 + spread->width * (2.0 * u - 1.0);
}

void lac_spread_fill(const lac_spread *spread, const lac_domain *domain, const double *nominal,
                     double *values)
{
    uint64_t key = hash(spread->key);
    for (size_t i = 0; i < domain->n; i++) {
        values[i] = nominal[i] * factor(spread, domain->index[i], key);
    }
}

const lac_spread *lac_spread_find(const lac_spread_list *list, const char *key)
{
    for (size_t i = 0; i < list->count; i++) {
        if (strcmp(list->item[i].key, key) == 0) {
            return &list->item[i];
        }
    }
    return NULL;
}
