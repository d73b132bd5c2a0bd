// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a file of heights: a sound map, or refused with a message. netCDF is left out: its
// library is not made for hostile files.
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "surface/read.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool sound)
{
    if (!sound) {
        abort();
    }
}

static void check_map(const lac_height_map *map)
{
    size_t masked = 0;
    require(map->nx > 0 && map->ny > 0);
    for (size_t i = 0; i < map->nx * map->ny; i++) {
        require(!isinf(map->heights[i]));
        masked += isnan(map->heights[i]) ? 1 : 0;
    }
    require(masked == map->masked && masked < map->nx * map->ny);
    require(isnan(map->dx) || (map->dx > 0.0 && isfinite(map->dx)));
    require(isnan(map->dy) || (map->dy > 0.0 && isfinite(map->dy)));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    lac_height_map *map = NULL;
    lac_error err = {{0}};
    const lac_bytes bytes = {"fuzz", data, size};
    if (lac_bytes_begin(&bytes, "CDF") || lac_bytes_begin(&bytes, "\x89HDF")) {
        return 0;
    }
    lac_status status = lac_height_map_parse(&bytes, &map, &err);
    if (status == LAC_OK) {
        check_map(map);
    } else {
        require(status == LAC_EINPUT && map == NULL && strncmp(err.message, "fuzz:", 5) == 0);
    }
    lac_height_map_free(map);
    return 0;
}
