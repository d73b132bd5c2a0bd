// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a file of heights: a sound map, or refused with a message. netCDF-4 is left out:
// HDF5 is not made for hostile files.
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "surface/fit.h"
#include "surface/read.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool sound)
{
    if (!sound) {
        abort();
    }
}

// A sound map can be filled and laid on a grid, in all ways, or does not fit with a message.
static void check_use(lac_height_map *map)
{
    enum { NX = 5, NY = 3 };
    double heights[NX * NY];
    const lac_grid grid = {NX, NY, isnan(map->dx) ? 1.0 : map->dx, isnan(map->dy) ? 1.0 : map->dy,
                           false};
    require(lac_fill_nearest(map, NULL) == LAC_OK);
    for (int fit = LAC_FIT_CROP; fit <= LAC_FIT_RESAMPLE; fit++) {
        lac_error err = {{0}};
        lac_placement place = lac_place_centred(map, fit, &grid);
        place.mirror_x = fit == LAC_FIT_PAD;
        lac_status status = lac_fit_map("fuzz", map, &place, &grid, heights, &err);
        require(status == LAC_OK || (status == LAC_EINPUT && err.message[0] != '\0'));
        for (size_t i = 0; status == LAC_OK && i < (size_t)NX * NY; i++) {
            require(isfinite(heights[i]) || fabs(map->heights[0]) > 1e300);
        }
    }
}

static void check_map(lac_height_map *map)
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
    require(map->format != NULL);
    check_use(map);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    lac_height_map *map = NULL;
    lac_error err = {{0}};
    const lac_bytes bytes = {"fuzz", data, size};
    if (lac_bytes_begin(&bytes, "\x89HDF")) {
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
