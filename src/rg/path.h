/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_RG_PATH_H
#define LACUNA_RG_PATH_H

#include "lacuna/rg.h"

/// Whether every cell gets the same stress, up to its cap.
bool lac_rg_path_is_equal(const lac_rg_path *path);

/// That stress [Pa]: sum min(tau, strength) = load * sum strength.
double lac_rg_path_stress(const lac_rg_path *path, double load);

#endif
