// SPDX-License-Identifier: GPL-3.0-or-later
// The cascade of a file: its case, its cells, which snapshot.
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/common/words.h"
#include "cli/report/report.h"
#include "cli/rg/rg.h"

bool cli_rg_is_file(const char *path)
{
    const size_t length = strlen(path);
    return (length > 3 && strcmp(path + length - 3, ".nc") == 0) || lac_stored_is_netcdf(path);
}

// A file holds one interface with its tractions: only rg's own keys can differ, and not all.
static lac_status check_override(const lac_override *set, lac_error *err)
{
    if (strncmp(set->key, "rg.", 3) != 0) {
        return lac_fail(err, LAC_EINPUT,
                        "--set: %s: cannot be changed in a file that holds its results; only keys "
                        "of rg can, such as rg.beta",
                        set->key);
    }
    if (strcmp(set->key, "rg.field") == 0 && strcmp(set->value, "equal") != 0) {
        return lac_fail(err, LAC_EINPUT,
                        "--set: rg.field: \"%s\" must be equal: a further load on the tractions "
                        "of a file",
                        set->value);
    }
    if (strcmp(set->key, "rg.seeds") == 0 && strcmp(set->value, "1") != 0) {
        return lac_fail(err, LAC_EINPUT,
                        "--set: rg.seeds: \"%s\" must be 1: a file holds one "
                        "interface",
                        set->value);
    }
    if (strcmp(set->key, "rg.path") == 0 || strcmp(set->key, "rg.contacts") == 0) {
        return lac_fail(
            err, LAC_EINPUT,
            "--set: %s: \"%s\" has no meaning for a file, whose cells are loaded further "
            "without new contacts",
            set->key, set->value);
    }
    return LAC_OK;
}

static lac_status read_case(const cli_request *request, const char *text, lac_case **c,
                            lac_error *err)
{
    lac_case_report report = {0};
    const lac_case_request how = {LAC_FOR_CELLS, request->overrides, request->set_count};
    for (size_t i = 0; i < request->set_count; i++) {
        lac_status status = check_override(&request->overrides[i], err);
        if (status != LAC_OK) {
            return status;
        }
    }
    lac_status status =
        lac_case_read_text(request->argument[0], text, strlen(text), &how, c, &report, err);
    cli_report_print_of(&report, request, "rg"); // other warnings were given when it was made
    if (report.errors > 0) {
        err->message[0] = '\0'; // said already, line by line
    }
    lac_case_report_clear(&report);
    return status;
}

static lac_status parse_time(const char *text, const lac_case *c, double *time, lac_error *err)
{
    lac_status status = cli_parse_time(text, c, time, err);
    return status == LAC_EINPUT
               ? lac_fail(err, status,
                          "--snapshot: \"%s\" must be last, a number from 0, or a time such as "
                          "\"10 day\"%s",
                          text, c->dated ? " or a date" : "")
               : status;
}

// The last, or a number; a time only when the case is known, which says from when it counts.
static lac_snapshot_choice choose(const char *text)
{
    lac_snapshot_choice choice = {.by = LAC_SNAPSHOT_LAST};
    if (text == NULL || strcmp(text, "last") == 0) {
        return choice;
    }
    bool number = text[strspn(text, "0123456789")] == '\0';
    choice.by = number ? LAC_SNAPSHOT_INDEX : LAC_SNAPSHOT_TIME;
    choice.index = number ? (size_t)strtoull(text, NULL, 10) : 0; // the largest where too large
    return choice;
}

lac_status cli_rg_file_read(const cli_request *request, lac_case **c, lac_stored_cells *cells,
                            lac_error *err)
{
    const char *path = request->argument[0];
    lac_snapshot_choice choice = choose(request->snapshot);
    const lac_snapshot_choice any = {.by = LAC_SNAPSHOT_LAST};
    const bool by_time = choice.by == LAC_SNAPSHOT_TIME;
    lac_status status;
    LAC_TRY(lac_stored_cells_read(path, by_time ? &any : &choice, cells, err));
    LAC_TRY(read_case(request, cells->case_text, c, err));
    if (by_time) {
        LAC_TRY(parse_time(request->snapshot, *c, &choice.time, err));
        lac_stored_cells_clear(cells);
        LAC_TRY(lac_stored_cells_read(path, &choice, cells, err));
    }
    (*c)->rg.field = LAC_RG_EQUAL; // of the further load, whatever the case says
    (*c)->rg.seeds = 1;
out:
    return status;
}

void cli_rg_file_print(const lac_stored_cells *cells, const lac_scene_rg *rg)
{
    char text[32];
    if (cells->kind == LAC_STORED_RUN) {
        cli_row("snapshot", "%zu (0 to %zu), at %s; the run is %s", cells->index,
                cells->snapshots - 1, cli_quantity(cells->time, "s", text, sizeof text),
                cells->status);
    } else if (cells->kind == LAC_STORED_HISTORY) {
        cli_row("step", "%zu (0 to %zu) of a history", cells->index, cells->snapshots - 1);
    } else {
        cli_row("contact", "without shear");
    }
    if (rg->now.share != 1.0) {
        cli_row("effective pressure", "%.4g %% of the total", 100.0 * rg->now.share);
    }
    cli_row("Q/Q_nom now", "%.4f", rg->now.load);
    cli_row("weakest cell", "at (%.4g, %.4g) m, lacks %s", rg->now.weakest[0], rg->now.weakest[1],
            cli_quantity(rg->now.weakest_gap, "Pa", text, sizeof text));
}
