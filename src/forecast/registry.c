// SPDX-License-Identifier: GPL-3.0-or-later
// The methods of forecasting in their order: a case's own comes before the baseline, which is last.
#include "base/rows.h"
#include "forecast/kinds.h"

static const lac_forecast_kind *const kinds[] = {
    &lac_forecast_inv8,  &lac_forecast_inv,   &lac_forecast_slo,
    &lac_forecast_saito, &lac_forecast_log,   &lac_forecast_voight,
    &lac_forecast_block, &lac_forecast_lppls, &lac_forecast_persistence,
};

enum { KINDS = sizeof kinds / sizeof kinds[0] };

LAC_KINDS_AT(lac_forecast_kind, lac_forecast_kind_get, kinds)

size_t lac_forecast_count(const lac_forecast_def *def)
{
    return KINDS + (def->model != NULL ? 1 : 0);
}

const lac_forecast_kind *lac_forecast_kind_of(const lac_forecast_def *def, size_t index)
{
    if (def->model == NULL || index < KINDS - 1) {
        return lac_forecast_kind_get(index);
    }
    return index == KINDS - 1 ? def->model->kind : lac_forecast_kind_get(KINDS - 1);
}
