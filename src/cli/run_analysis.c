// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/run_analysis.h"

#include <math.h>

#include "cli/words.h"

void cli_analysis_print(const lac_analysis *analysis)
{
    const lac_indicator *indicator;
    for (size_t i = 0; (indicator = lac_analysis_at(analysis, i)) != NULL; i++) {
        for (size_t k = 0; k < indicator->lines; k++) {
            cli_row(indicator->line[k].label, "%s", indicator->line[k].text);
        }
    }
}

void cli_analysis_json(cli_json *json, const lac_analysis *analysis)
{
    const lac_indicator *indicator;
    for (size_t i = 0; (indicator = lac_analysis_at(analysis, i)) != NULL; i++) {
        for (size_t k = 0; k < indicator->results; k++) {
            const lac_analysis_result *result = &indicator->result[k];
            if (result->text != NULL) {
                cli_json_text(json, result->key, result->text);
            } else if (result->value == rint(result->value) && fabs(result->value) < 1e15) {
                cli_json_integer(json, result->key, (int64_t)result->value); // 40, not 4e+01
            } else {
                cli_json_number(json, result->key, result->value);
            }
        }
    }
}
