// SPDX-License-Identifier: GPL-3.0-or-later
// What was run, from what, and how it ended.
#include <stdlib.h>
#include <string.h>

#include "base/date.h"
#include "report/run.h"

enum { LONGEST_TEXT = 1 << 18 }; // a case; the history of a run that was resumed often is long too

static lac_status write_texts(const lac_page *page, const char *const *names, size_t count,
                              lac_error *err)
{
    char *value = malloc(LONGEST_TEXT);
    if (value == NULL) {
        return lac_fail_memory(err);
    }
    for (size_t i = 0; i < count; i++) {
        if (lac_page_attribute_text(page->run->file, names[i], value, LONGEST_TEXT)) {
            lac_page_string(page->text, names[i], value);
        }
    }
    free(value);
    return LAC_OK;
}

static void write_numbers(const lac_page *page, const char *const *names, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const double value = lac_page_attribute(page->run->file, names[i]);
        if (value == value) {
            lac_page_number(page->text, names[i], value, 12);
        }
    }
}

lac_status lac_page_about(const lac_page *page, lac_error *err)
{
    static const char *const texts[] = {
        "title",    "institution", "references",   "source",        "history",
        "status",   "libraries",   "date_created", "date_modified", "failure_date",
        "ended_by", "boundary",    "fidelity",     "resumed",       "case"};
    static const char *const numbers[] = {"seed",
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
                                          "wall_time_s"};
    const char *slash = strrchr(page->run->path, '/');
    lac_page_text *text = page->text;
    char date[32];
    lac_page_open(text, "about", '{');
    lac_page_string(text, "file", slash != NULL ? slash + 1 : page->run->path);
    lac_page_string(text, "made_by", page->def->made_by);
    lac_page_string(text, "made", lac_date_format(page->def->now, date, sizeof date));
    lac_page_bool(text, "dated", page->run->dated);
    lac_page_number(text, "start", page->run->start, 17);
    lac_page_number(text, "records", (double)page->run->n, 17);
    write_numbers(page, numbers, sizeof numbers / sizeof *numbers);
    const lac_status status = write_texts(page, texts, sizeof texts / sizeof *texts, err);
    lac_page_close(text, '}');
    return status;
}
