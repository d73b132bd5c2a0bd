// SPDX-License-Identifier: GPL-3.0-or-later
// Slip fractions of neighbouring levels, collected during a run, and the map fitted to them.
#include "analysis/run_map.h"

#include <stdlib.h>

enum { LEAST_BLOCKS = 8, STRETCH = 4, RESAMPLINGS = 400 };

lac_status lac_run_map_create(const lac_hierarchy *h, lac_run_map *out, lac_error *err)
{
    *out = (lac_run_map){.h = h, .levels = lac_hierarchy_levels(h)};
    size_t most = LAC_RUN_MAP_STATES * out->levels;
    out->s = malloc((2 * most + 1) * sizeof *out->s);
    LAC_FAIL_MEMORY_IF(out->s == NULL, err);
    out->s_next = out->s + most;
    return LAC_OK;
}

void lac_run_map_clear(lac_run_map *map)
{
    free(map->s);
    *map = (lac_run_map){0};
}

static double fraction(const lac_run_map *map, const lac_slip_blocks *blocks, size_t level)
{
    return (double)lac_slip_blocks_at(blocks, level) / (double)lac_hierarchy_blocks(map->h, level);
}

void lac_run_map_evaluate(lac_run_map *map, const lac_slip_blocks *blocks)
{
    size_t now = (size_t)(LAC_RUN_MAP_STATES * fraction(map, blocks, 0));
    if (now <= map->reached) {
        return;
    }
    map->reached = now;
    size_t n = map->first[map->states];
    for (size_t level = 0; level < map->levels; level++) {
        if (lac_hierarchy_blocks(map->h, level + 1) >= LEAST_BLOCKS) {
            map->s[n] = fraction(map, blocks, level);
            map->s_next[n++] = fraction(map, blocks, level + 1);
        }
    }
    map->first[++map->states] = n;
}

void lac_run_map_serialize(lac_run_map *map, lac_archive *archive)
{
    lac_archive_pass(archive, &map->states, sizeof map->states);
    lac_archive_pass(archive, &map->reached, sizeof map->reached);
    lac_archive_pass(archive, map->first, sizeof map->first);
    bool sound = map->states <= LAC_RUN_MAP_STATES;
    size_t pairs = sound ? map->first[map->states] : 0;
    if (!sound || pairs > LAC_RUN_MAP_STATES * map->levels) {
        archive->short_of = true;
        return;
    }
    lac_archive_pass(archive, map->s, pairs * sizeof *map->s);
    lac_archive_pass(archive, map->s_next, pairs * sizeof *map->s_next);
}

lac_status lac_run_map_fit(const lac_run_map *map, lac_rg_fit *fit, lac_error *err)
{
    size_t first[LAC_RUN_MAP_STATES / STRETCH + 2];
    size_t groups = 0;
    for (size_t state = 0; state < map->states; state += STRETCH) {
        first[groups++] = map->first[state];
    }
    first[groups] = map->first[map->states];
    return lac_rg_map_resample(groups, first, map->s, map->s_next, RESAMPLINGS, fit, err);
}
