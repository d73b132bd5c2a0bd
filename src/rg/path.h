/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "rg/rg.h"

#define LAC_RG_WITHIN_SOLVED 1e-6 // of Q/Q_nom: contacts are solved to 1e-8

enum { LAC_RG_SCAN = 60 }; // loads at which it is seen whether the joint slides, at least

/// Whether the joint carries tractions before the path begins.
bool lac_rg_path_is_preloaded(const lac_rg_path *path);

/// Q/Q_nom at a part of the path, 0 to 1.
double lac_rg_path_load(const lac_rg_path *path, double part);

/// Two loads of a path, the joint sticking at the lower and sliding at the higher one.
typedef struct lac_rg_bracket {
    double low, high;       ///< Q/Q_nom
    double at_low, at_high; ///< threshold of the root there [Pa]; INFINITY: not known
} lac_rg_bracket;

/// Takes note of the threshold of the root at a load. @return whether the joint sticks there
bool lac_rg_bracket_note(lac_rg_bracket *bracket, const lac_rg_tree *tree, double load,
                         double root);

/// Threshold of the root at a load. @param work  [2 cells]
double lac_rg_root(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path, double load,
                   double *work);

/// The load between the two at which the joint slides, to 1e-9.
double lac_rg_close(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path,
                    lac_rg_bracket bracket, double *work);
