/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/archive.h"
#include "contact/contact.h"

/// A cell in its cluster: the way to the root is a sum of steps, so that clusters round a periodic
/// edge keep their shape.
typedef struct lac_cluster_node {
    uint32_t parent;
    int32_t x, y; ///< place relative to the parent [cells]
} lac_cluster_node;

/// What a root knows of its cluster.
typedef struct lac_cluster_box {
    uint32_t size;          ///< cells
    int32_t x0, x1, y0, y1; ///< relative to the root [cells]
} lac_cluster_box;

/// The clusters of slipping cells, 8 neighbours, through the edges where periodic. Cells are joined
/// as they begin to slip; when one ceases, all are joined anew, as soon as that costs no more than
/// an eighth of all cells a record since the last time.
typedef struct lac_slip_clusters {
    lac_grid grid;
    size_t n;
    uint32_t *neighbour;    ///< [8 n] of each cell; UINT32_MAX: none
    lac_cluster_node *node; ///< [n]
    lac_cluster_box *box;   ///< [n] of roots
    uint8_t *in;            ///< [n] whether the cell is in a cluster
    size_t credit;          ///< cells that may be joined anew by now
    bool stale;             ///< cells have ceased to slip and are still joined
    double extent; ///< xi, the longest side of any cluster [m]; 0: no cell slips; NaN where
                   ///< stale
} lac_slip_clusters;

lac_status lac_slip_clusters_create(const lac_domain *domain, lac_slip_clusters *out,
                                    lac_error *err);
void lac_slip_clusters_clear(lac_slip_clusters *c);

/// Brings the clusters up to date at a record.
/// @param slipping how many slip
/// @param changed  [changes] cells where it differs from before
void lac_slip_clusters_update(lac_slip_clusters *c, const uint8_t *slips, size_t slipping,
                              const uint32_t *changed, size_t changes);

/// Passes the clusters as they are.
void lac_slip_clusters_serialize(lac_slip_clusters *c, lac_archive *archive);
