// SPDX-License-Identifier: GPL-3.0-or-later
// What slips at each scale, against the fixed points of the cascade and of the run's own map.
#include <math.h>
#include <stdlib.h>

#include "report/run.h"

enum { BUCKETS = 300, COMMENT = 600 };

// Variables of one number; null on the page where the file has none.
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
    static const char *const comments[][2] = {{"source", "critical_fraction"},
                                              {"definition", "n_slip"}};
    char comment[COMMENT];
    lac_stored_values value = {0};
    lac_status status = LAC_OK;
    for (size_t i = 0; i < sizeof scalars / sizeof *scalars; i++) {
        LAC_TRY(lac_stored_file_values(page->run->file, scalars[i], &value, err));
        const bool there = value.value != NULL && value.n == 1;
        lac_json_digits(page->json, scalars[i], there ? value.value[0] : NAN, 6);
        lac_stored_values_clear(&value);
    }
    for (size_t i = 0; i < 2; i++) {
        (void)lac_stored_file_text(page->run->file, comments[i][1], "comment", comment,
                                   sizeof comment);
        lac_json_text(page->json, comments[i][0], comment);
    }
out:
    return status;
}

static void write_counts(const lac_page *page, const lac_stored_values *n_slip, const uint8_t *keep)
{
    lac_json_open(page->json, "slipping", '[');
    for (size_t level = 0; level < n_slip->width; level++) {
        lac_json_open(page->json, NULL, '[');
        for (size_t i = 0; i < page->run->n; i++) {
            if (keep[i]) {
                lac_json_digits(page->json, NULL, n_slip->value[i * n_slip->width + level], 17);
            }
        }
        lac_json_close(page->json, ']');
    }
    lac_json_close(page->json, ']');
}

lac_status lac_page_levels(const lac_page *page, const char *key, lac_error *err)
{
    const lac_page_run *run = page->run;
    lac_stored_values n_slip = {0}, size = {0}, total = {0};
    uint8_t *keep = NULL;
    lac_status status;
    LAC_TRY(lac_stored_file_values(run->file, "n_slip", &n_slip, err));
    LAC_TRY(lac_stored_file_values(run->file, "block_size", &size, err));
    LAC_TRY(lac_stored_file_values(run->file, "n_tot", &total, err));
    if (n_slip.value == NULL || n_slip.n < run->n || n_slip.width < 2 ||
        lac_page_run_column(run, "slip_fraction") == NULL ||
        lac_page_run_column(run, "correlation_length") == NULL || size.n != n_slip.width ||
        total.n != n_slip.width) {
        goto out; // the case did not ask for it, or it is a block
    }
    LAC_TRY(lac_page_keep(page, key, BUCKETS, &keep, err));
    lac_json_open(page->json, key, '{');
    lac_page_column(page, "size", size.n, size.value, NULL, 8);
    lac_page_column(page, "total", total.n, total.value, NULL, 17);
    lac_page_records(page, key, keep);
    write_counts(page, &n_slip, keep);
    LAC_TRY(write_fixed_points(page, err));
    lac_json_close(page->json, '}');
out:
    free(keep);
    lac_stored_values_clear(&n_slip);
    lac_stored_values_clear(&size);
    lac_stored_values_clear(&total);
    return status;
}
