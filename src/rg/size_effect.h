/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_RG_SIZE_EFFECT_H
#define LACUNA_RG_SIZE_EFFECT_H

#include "rg/rg.h"

/// What is known of a block on the way along a path.
typedef struct lac_rg_block_state {
    double gap, force; ///< at the load before [Pa], sum of its cells' tractions [Pa]
    double fall;       ///< of `gap` in the step to that load, over the load [Pa]
    double load;       ///< Q/Q_nom at which it slipped by itself, where it has
    double carried;    ///< `force` then
    bool slipped;      ///< whether it has
} lac_rg_block_state;

/// @param states  [blocks of all layers] layer by layer; the caller frees
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_rg_states_create(const lac_rg_tree *tree, lac_rg_block_state **states,
                                lac_error *err);

/// After a pass at `load`: takes note of the blocks that have slipped since the load `before`:
/// when, by interpolation between thresholds; where they end at 0, by how they fell before; and
/// midway where there are none (LUMP).
void lac_rg_states_note(const lac_rg_tree *tree, double before, double load,
                        lac_rg_block_state *states);

/// The size effect that follows.
/// @param sizes  [levels + 1] overwritten
void lac_rg_states_summarise(const lac_rg_tree *tree, const lac_rg_block_state *states, bool line,
                             lac_rg_sizes *sizes);

/// The block that is the whole joint slips at its critical load, whatever the scan saw.
/// @param critical  Q/Q_nom
/// @param sizes     [levels + 1]
void lac_rg_sizes_close(const lac_rg_tree *tree, bool line, double critical, lac_rg_sizes *sizes);

#endif
