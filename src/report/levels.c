// SPDX-License-Identifier: GPL-3.0-or-later
// What slips at each scale, against the fixed points of the cascade and of the run's own map.
#include <math.h>
#include <stdlib.h>

#include "report/run.h"

enum { BUCKETS = 300, COMMENT = 600 };

// A variable of one number; null on the page where the file has none.
static lac_status write_scalar(const lac_page *page, const char *name, lac_error *err)
{
    lac_stored_values value = {0};
    const lac_status status = lac_stored_file_values(page->run->file, name, &value, err);
    const bool there = status == LAC_OK && value.value != NULL && value.n == 1;
    lac_page_number(page->text, name, there ? value.value[0] : NAN, 6);
    lac_stored_values_clear(&value);
    return status;
}

static lac_status write_fixed_points(const lac_page *page, lac_error *err)
{
    static const char *const scalars[] = {"critical_fraction",
                                          "critical_fraction_low",
                                          "critical_fraction_high",
                                          "run_critical_fraction",
                                          "run_critical_fraction_low",
                                          "run_critical_fraction_high",
                                          "run_lambda",
                                          "run_lambda_low",
                                          "run_lambda_high"};
    char comment[COMMENT];
    lac_status status = LAC_OK;
    for (size_t i = 0; i < sizeof scalars / sizeof *scalars; i++) {
        LAC_TRY(write_scalar(page, scalars[i], err));
    }
    lac_stored_file_comment(page->run->file, "critical_fraction", comment, sizeof comment);
    lac_page_string(page->text, "source", comment);
    lac_stored_file_comment(page->run->file, "n_slip", comment, sizeof comment);
    lac_page_string(page->text, "definition", comment);
out:
    return status;
}

static void write_counts(const lac_page *page, const lac_stored_values *n_slip, const uint8_t *keep)
{
    lac_page_open(page->text, "slipping", '[');
    for (size_t level = 0; level < n_slip->width; level++) {
        lac_page_open(page->text, NULL, '[');
        for (size_t i = 0; i < page->run->n; i++) {
            if (keep[i]) {
                lac_page_number(page->text, NULL, n_slip->value[i * n_slip->width + level], 17);
            }
        }
        lac_page_close(page->text, ']');
    }
    lac_page_close(page->text, ']');
}

static lac_status write_levels(const lac_page *page, const lac_stored_values *n_slip,
                               const lac_stored_values *size, const lac_stored_values *total,
                               const uint8_t *keep, lac_error *err)
{
    const lac_page_run *run = page->run;
    lac_page_text *text = page->text;
    const double *criticality = lac_page_run_column(run, LAC_PAGE_CRITICALITY);
    lac_page_open(text, "levels", '{');
    lac_page_column(text, "size", size->n, size->value, NULL, 8);
    lac_page_column(text, "total", total->n, total->value, NULL, 17);
    lac_page_column(text, "time", run->n, run->time, keep, 12);
    lac_page_column(text, "before", run->n, run->before, keep, 6);
    lac_page_column(text, "fraction", run->n, lac_page_run_column(run, LAC_PAGE_FRACTION), keep, 6);
    lac_page_column(text, "length", run->n, lac_page_run_column(run, LAC_PAGE_LENGTH), keep, 6);
    if (criticality != NULL) {
        lac_page_column(text, "criticality", run->n, criticality, keep, 6);
    }
    write_counts(page, n_slip, keep);
    const lac_status status = write_fixed_points(page, err);
    lac_page_close(text, '}');
    return status;
}

lac_status lac_page_levels(const lac_page *page, lac_error *err)
{
    const lac_page_run *run = page->run;
    const double *const columns[] = {lac_page_run_column(run, LAC_PAGE_FRACTION),
                                     lac_page_run_column(run, LAC_PAGE_LENGTH)};
    lac_stored_values n_slip = {0}, size = {0}, total = {0};
    uint8_t *keep = NULL;
    lac_status status;
    LAC_TRY(lac_stored_file_values(run->file, "n_slip", &n_slip, err));
    LAC_TRY(lac_stored_file_values(run->file, "block_size", &size, err));
    LAC_TRY(lac_stored_file_values(run->file, "n_tot", &total, err));
    if (n_slip.value == NULL || n_slip.n < run->n || n_slip.width < 2 || columns[0] == NULL ||
        columns[1] == NULL || size.n != n_slip.width || total.n != n_slip.width) {
        goto out; // the case did not ask for it, or it is a block
    }
    keep = malloc(run->n);
    LAC_TRY(keep != NULL ? LAC_OK : lac_fail_memory(err));
    (void)lac_page_thin(run->n, run->time, run->before, BUCKETS, 2, columns, keep);
    LAC_TRY(write_levels(page, &n_slip, &size, &total, keep, err));
out:
    free(keep);
    lac_stored_values_clear(&n_slip);
    lac_stored_values_clear(&size);
    lac_stored_values_clear(&total);
    return status;
}
