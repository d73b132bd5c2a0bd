// SPDX-License-Identifier: GPL-3.0-or-later
// The loads that a case can name: one table each of normal loads, shear loads and pore pressures.
#include "base/rows.h"
#include "load/kinds.h"

static const lac_normal_load *const normal[] = {
    &lac_normal_pressure, &lac_normal_depth,     &lac_normal_slope,
    &lac_normal_approach, &lac_normal_dimension,
};

static const lac_load_kind *const shear[] = {
    &lac_shear_ratio, &lac_shear_slope,   &lac_shear_ramp,   &lac_shear_spring,    &lac_shear_step,
    &lac_shear_sine,  &lac_shear_shaking, &lac_shear_series, &lac_shear_back_slip,
};

static const lac_load_kind *const pore[] = {
    &lac_pore_constant, &lac_pore_ramp,      &lac_pore_step, &lac_pore_sine,
    &lac_pore_series,   &lac_pore_reservoir, &lac_pore_rain,
};

LAC_KINDS_AT(lac_normal_load, lac_normal_load_get, normal)

LAC_KINDS_AT(lac_load_kind, lac_shear_load_get, shear)

LAC_KINDS_AT(lac_load_kind, lac_pore_load_get, pore)
