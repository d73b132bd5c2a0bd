// SPDX-License-Identifier: GPL-3.0-or-later
// The gates of forecasts, as lacuna describe forecast tells them.
#include "cli/common/describe.h"
#include "cli/common/words.h"
#include "precursor/precursor.h"

void cli_describe_gates(void)
{
    const lac_forecast_gate *gate;
    puts("  no forecast is issued where a gate is shut:");
    for (size_t i = 0; (gate = lac_forecast_gate_get(i)) != NULL; i++) {
        cli_row_wrap(gate->name, gate->text);
    }
}

void cli_describe_gates_json(lac_json *json)
{
    const lac_forecast_gate *gate;
    lac_json_open(json, "gates", '[');
    for (size_t i = 0; (gate = lac_forecast_gate_get(i)) != NULL; i++) {
        LAC_JSON_TEXTS(json, "name", gate->name, "text", gate->text);
    }
    lac_json_close(json, ']');
}
