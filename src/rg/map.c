// SPDX-License-Identifier: GPL-3.0-or-later
// The slipped fraction of a level from that of the finer one: the map fitted, and its fixed point.
#include <math.h>
#include <stdbool.h>

#include "base/statistics.h"
#include "rg/rg_map.h"

static const double lowest = 0.05; // below, and above 1 - lowest, counts are too few to tell
static const double ln2 = 0.69314718055994530941723212145818;

static double logit(double s) { return log(s / (1.0 - s)); }

static bool in_range(double s) { return s > lowest && s < 1.0 - lowest; }

lac_status lac_rg_map_fit(size_t n, const double *s, const double *s_next, lac_rg_map *map,
                          lac_error *err)
{
    lac_line line = {0};
    for (size_t i = 0; i < n; i++) {
        if (in_range(s[i]) && in_range(s_next[i])) {
            lac_line_add(&line, logit(s[i]), logit(s_next[i]));
        }
    }
    *map = (lac_rg_map){.points = (size_t)line.n, .fixed_point = NAN, .nu = NAN};
    LAC_FAIL_IF(map->points < 3 || !(line.xx > 1e-12 * line.n), err, LAC_EINPUT,
                "a map needs three pairs of slipped fractions between %g and %g, not %zu", lowest,
                1.0 - lowest, map->points);
    map->lambda = lac_line_slope(&line);
    map->g = lac_line_at(&line, 0.0);
    map->residual = sqrt(line.rest / line.n);
    if (map->lambda > 1.0) {
        map->fixed_point = 1.0 / (1.0 + exp(map->g / (map->lambda - 1.0)));
        map->nu = ln2 / log(map->lambda);
    }
    return LAC_OK;
}
