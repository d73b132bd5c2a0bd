// SPDX-License-Identifier: GPL-3.0-or-later
#include "forecast/kinds.h"

static const lac_forecast_kind *const kinds[] = {
    &lac_forecast_inv8,  &lac_forecast_inv,   &lac_forecast_slo,
    &lac_forecast_saito, &lac_forecast_log,   &lac_forecast_voight,
    &lac_forecast_block, &lac_forecast_lppls, &lac_forecast_persistence,
};

const lac_forecast_kind *lac_forecast_kind_at(size_t index)
{
    return index < sizeof kinds / sizeof kinds[0] ? kinds[index] : NULL;
}
