// SPDX-License-Identifier: GPL-3.0-or-later
// What was run, from what, and how it ended.
#include <stdio.h>
#include <string.h>

#include "base/date.h"
#include "report/run.h"

enum { LONGEST_TEXT = 1 << 18 }; // a case; the history of a run that was resumed often is long too

// Attributes of the file.
static const char numbers[] =
    "seed grid_nx grid_ny grid_dx_m grid_dy_m failed failure_time_s time_reached_s mean_slip_m "
    "max_slip_rate_m_s steps rhs_evaluations restarts newton_iterations linear_solves "
    "error_test_fails nonlinear_fails balance_residual_max wall_time_s ";
static const char texts[] =
    "title institution references source history status libraries date_created date_modified "
    "failure_date ended_by boundary fidelity resumed case ";

static void write_attributes(lac_page *page, const char *names, char *text)
{
    char name[32];
    for (size_t length; (length = strcspn(names, " ")) > 0; names += length + 1) {
        (void)snprintf(name, sizeof name, "%.*s", (int)length, names);
        const double value = lac_stored_file_number(page->file, NULL, name);
        if (text == NULL && value == value) {
            lac_json_digits(&page->json, name, value, 12);
        } else if (text != NULL &&
                   lac_stored_file_text(page->file, NULL, name, text, LONGEST_TEXT)) {
            lac_json_text(&page->json, name, text);
        }
    }
}

void lac_page_about(lac_page *page, const char *key)
{
    lac_json *json = &page->json;
    char date[32], *text = lac_page_room(page, LONGEST_TEXT);
    if (text == NULL) {
        return;
    }
    lac_json_open(json, key, '{');
    lac_json_text(json, "file", lac_page_name(page->def->run));
    lac_json_text(json, "made_by", page->def->made_by);
    lac_json_text(json, "made", lac_date_format(page->def->now, date, sizeof date));
    lac_json_boolean(json, "dated", page->dated);
    lac_json_digits(json, "start", page->start, 17);
    lac_json_integer(json, "records", (int64_t)page->n);
    write_attributes(page, numbers, NULL);
    write_attributes(page, texts, text);
    lac_json_close(json, '}');
}
