// SPDX-License-Identifier: GPL-3.0-or-later
// What a run says of cells that were taken together, as text and JSON.
#include "cli/run/run_lump.h"

#include "cli/common/words.h"

void cli_lump_print(cli_lump of)
{
    if (of.lump != NULL) {
        cli_row("  cells", "%zu stand for %zu, in blocks of level %zu", of.lump->domain->n,
                of.cells, of.lump->level);
        if (isfinite(of.error)) {
            cli_row("  error", "%.2g of %s by estimate; %g is allowed (solver.lump.error)",
                    of.error, of.result, of.asked);
        } else {
            cli_row("  error", "cannot be told; %g is allowed (solver.lump.error)", of.asked);
        }
    }
}

void cli_lump_json(lac_json *json, cli_lump of)
{
    if (of.lump == NULL) {
        return;
    }
    lac_json_open(json, "lump", '{');
    lac_json_integer(json, "cells", (int64_t)of.lump->domain->n);
    lac_json_integer(json, "level", (int64_t)of.lump->level);
    lac_json_integer(json, "blocks", (int64_t)of.lump->blocks);
    lac_json_number(json, "error_asked", of.asked);
    lac_json_close(json, '}');
    lac_json_number(json, "lump_error_estimated",
                    of.error > 0.0 && isfinite(of.error) ? of.error : (double)NAN);
}
