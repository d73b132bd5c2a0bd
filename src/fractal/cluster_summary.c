// SPDX-License-Identifier: GPL-3.0-or-later
// Contact clusters in a few numbers: how many there are of each size, the mean, the largest.
#include <math.h>

#include "fractal/fractal.h"

static size_t octave_of(uint32_t size)
{
    size_t i = 0;
    while (size >>= 1) {
        i++;
    }
    return i;
}

lac_cluster_summary lac_clusters_summarise(const lac_clusters *clusters, const lac_grid *grid)
{
    lac_cluster_summary s = {.n = clusters->n, .cells = clusters->cells};
    double squares = 0;
    for (size_t k = 0; k < clusters->n; k++) {
        size_t i = octave_of(clusters->size[k]);
        s.count[i]++;
        s.cells_of[i] += clusters->size[k];
        s.widest = fmax(s.widest, lac_cluster_extent(clusters, grid, k));
        squares += (double)clusters->size[k] * clusters->size[k];
    }
    if (clusters->n > 0) { // largest first
        s.largest = clusters->size[0];
        s.largest_extent = lac_cluster_extent(clusters, grid, 0);
        s.octaves = octave_of(clusters->size[0]) + 1;
        s.mean = (double)clusters->cells / (double)clusters->n;
        s.weighted = squares / (double)clusters->cells;
    }
    return s;
}
