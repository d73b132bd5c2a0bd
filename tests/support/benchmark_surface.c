// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/benchmark_surface.h"

#include <math.h>
#include <string.h>

#include "surface/surface.h"

static int generate(int name, size_t n, double *heights)
{
    for (size_t i = 0; lac_surface_source_get(i) != NULL; i++) {
        const lac_model_info *info = &lac_surface_source_get(i)->info;
        if (strcmp(info->name, "benchmark") == 0) {
            lac_benchmark params = {name, NAN, NAN, INT64_MIN};
            lac_grid grid = {n, n, 1.0 / (double)n, 1.0 / (double)n, true};
            lac_model model = {info, &params};
            return lac_surface_generate(&model, &grid, heights, NULL, NULL) == LAC_OK ? 0 : -1;
        }
    }
    return -1;
}

int benchmark_surface(size_t n, double *heights) { return generate(LAC_BENCHMARK_A08, n, heights); }

int joint_surface(size_t n, double *heights) { return generate(LAC_BENCHMARK_J07, n, heights); }
