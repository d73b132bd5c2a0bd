// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of the loads that a case can name, from the lists of kinds.h: one each of normal
// loads, shear loads, pore pressures and normal stresses that come on top.
#include "load/kinds.h"

static const lac_normal_load *const normal[] = {LAC_NORMAL_LOADS(LAC_ROW_ADDRESS)};
static const lac_load_kind *const shear[] = {LAC_SHEAR_LOADS(LAC_ROW_ADDRESS)};
static const lac_load_kind *const pore[] = {LAC_PORE_LOADS(LAC_ROW_ADDRESS)};
static const lac_load_kind *const stress[] = {LAC_NORMAL_STRESSES(LAC_ROW_ADDRESS)};

LAC_KINDS_AT(lac_normal_load, lac_normal_load_get, normal)

LAC_KINDS_AT(lac_load_kind, lac_shear_load_get, shear)

LAC_KINDS_AT(lac_load_kind, lac_pore_load_get, pore)

LAC_KINDS_AT(lac_load_kind, lac_normal_stress_get, stress)
