// SPDX-License-Identifier: GPL-3.0-or-later
// What was run, from what, and how it ended.
#include <stdlib.h>
#include <string.h>

#include "base/date.h"
#include "report/run.h"

enum { LONGEST_TEXT = 1 << 18 }; // a case; the history of a run that was resumed often is long too

// Attributes of the file: numbers, then texts.
static const char *const names[] = {"seed",
                                    "grid_nx",
                                    "grid_ny",
                                    "grid_dx_m",
                                    "grid_dy_m",
                                    "failed",
                                    "failure_time_s",
                                    "time_reached_s",
                                    "mean_slip_m",
                                    "max_slip_rate_m_s",
                                    "steps",
                                    "rhs_evaluations",
                                    "restarts",
                                    "newton_iterations",
                                    "linear_solves",
                                    "error_test_fails",
                                    "nonlinear_fails",
                                    "balance_residual_max",
                                    "wall_time_s",
                                    "title",
                                    "institution",
                                    "references",
                                    "source",
                                    "history",
                                    "status",
                                    "libraries",
                                    "date_created",
                                    "date_modified",
                                    "failure_date",
                                    "ended_by",
                                    "boundary",
                                    "fidelity",
                                    "resumed",
                                    "case"};
enum { NUMBERS = 19, NAMES = sizeof names / sizeof *names };

lac_status lac_page_about(const lac_page *page, const char *key, lac_error *err)
{
    const lac_page_run *run = page->run;
    lac_json *json = page->json;
    char date[32], *text = malloc(LONGEST_TEXT);
    LAC_FAIL_MEMORY_IF(text == NULL, err);
    lac_json_open(json, key, '{');
    lac_json_text(json, "file", lac_page_name(run->path));
    lac_json_text(json, "made_by", page->def->made_by);
    lac_json_text(json, "made", lac_date_format(page->def->now, date, sizeof date));
    lac_json_boolean(json, "dated", run->dated);
    lac_json_digits(json, "start", run->start, 17);
    lac_json_integer(json, "records", (int64_t)run->n);
    for (size_t i = 0; i < NAMES; i++) {
        const double value = i < NUMBERS ? lac_stored_file_number(run->file, NULL, names[i]) : 0.0;
        if (i < NUMBERS && value == value) {
            lac_json_digits(json, names[i], value, 12);
        } else if (i >= NUMBERS &&
                   lac_stored_file_text(run->file, NULL, names[i], text, LONGEST_TEXT)) {
            lac_json_text(json, names[i], text);
        }
    }
    lac_json_close(json, '}');
    free(text);
    return LAC_OK;
}
