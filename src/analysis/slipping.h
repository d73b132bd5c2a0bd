/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "analysis/analysis.h"

/// Which cells slip, from one record to the next.
typedef struct lac_slipping {
    const lac_friction *friction;
    size_t n;
    bool begun, by_rate;
    double strength;    ///< part of the strength at the start at or below which a cell slips [1]
    double rate;        ///< least slip rate of a slipping cell [m/s]
    double *most_state; ///< [n] ln theta at which the strength has come down; NaN: never; NULL by
                        ///< rate
    uint8_t *slips;     ///< [n]
    uint32_t *changed;  ///< [n] cells that began or ceased at the last look, in their order
    size_t changes;
} lac_slipping;

/// @param strength  part where slip is told by the strength; NaN: by the rate
lac_status lac_slipping_create(const lac_friction *friction, double strength, double rate,
                               lac_slipping *out, lac_error *err);
void lac_slipping_clear(lac_slipping *s);

/// Looks at the cells; at the first look it takes their strength at the start, a friction
/// coefficient at v0: f(v0, theta).
void lac_slipping_evaluate(lac_slipping *s, const lac_record *record);

void lac_slipping_serialize(lac_slipping *s, lac_archive *archive);

/// The definition in words.
void lac_slipping_describe(const lac_slipping *s, char *text, size_t size);

/// Blocks of each level all of whose contact cells slip, kept up to date cell by cell.
typedef struct lac_slip_blocks {
    const lac_hierarchy *h;
    size_t levels;       ///< above the cells
    size_t *slipping;    ///< [levels + 1] blocks that slip as a whole, N_slip
    uint32_t **sticking; ///< [levels] of [blocks of the next level]: children that do not slip;
                         ///< NULL where the next level merges no blocks
    uint32_t *memory;
} lac_slip_blocks;

/// All cells stick. The hierarchy must outlive them.
lac_status lac_slip_blocks_create(const lac_hierarchy *h, lac_slip_blocks *out, lac_error *err);
void lac_slip_blocks_clear(lac_slip_blocks *b);

/// A cell begins to slip or ceases.
void lac_slip_blocks_change(lac_slip_blocks *b, uint32_t cell, bool slips);

enum { LAC_NEIGHBOURS = 8 };

/// The contact cells that touch each one by side or corner, through the edges where periodic.
/// @return [8 n] UINT32_MAX: none there; the caller frees it; NULL: no memory
uint32_t *lac_neighbours_find(const lac_domain *domain);

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

void lac_slip_clusters_serialize(lac_slip_clusters *c, lac_archive *archive);
