// SPDX-License-Identifier: GPL-3.0-or-later
// What slips at each scale, against the fixed points of the cascade and of the run's own map.
#include <math.h>

#include "report/run.h"

enum { BUCKETS = 300, COMMENT = 600 };

// Variables of one number; null on the page where the file has none.
static void write_fixed_points(lac_page *page)
{
    static const char *const scalars[] = {
        "critical_fraction",
        "critical_fraction_low",
        "critical_fraction_high",
        "run_critical_fraction",
        "run_critical_fraction_low",
        "run_critical_fraction_high",
        "run_lambda",
        "run_lambda_low",
        "run_lambda_high",
    };
    static const char *const comments[][2] = {{"source", "critical_fraction"},
                                              {"definition", "n_slip"}};
    char comment[COMMENT];
    for (size_t i = 0; i < sizeof scalars / sizeof *scalars; i++) {
        const lac_stored_values value = lac_page_values(page, page->file, scalars[i]);
        lac_json_digits(&page->json, scalars[i], value.n == 1 ? value.value[0] : NAN, 6);
    }
    for (size_t i = 0; i < 2; i++) {
        (void)lac_stored_file_text(page->file, comments[i][1], "comment", comment, sizeof comment);
        lac_json_text(&page->json, comments[i][0], comment);
    }
}

static void write_counts(lac_page *page, const lac_stored_values *n_slip, const uint8_t *keep)
{
    lac_json_open(&page->json, "slipping", '[');
    for (size_t level = 0; level < n_slip->width; level++) {
        lac_json_open(&page->json, NULL, '[');
        for (size_t i = 0; i < page->n; i++) {
            if (keep[i]) {
                lac_json_digits(&page->json, NULL, n_slip->value[i * n_slip->width + level], 17);
            }
        }
        lac_json_close(&page->json, ']');
    }
    lac_json_close(&page->json, ']');
}

void lac_page_levels(lac_page *page, const char *key)
{
    const lac_stored_values n_slip = lac_page_values(page, page->file, "n_slip");
    const lac_stored_values size = lac_page_values(page, page->file, "block_size");
    const lac_stored_values total = lac_page_values(page, page->file, "n_tot");
    if (n_slip.value == NULL || n_slip.n < page->n || n_slip.width < 2 ||
        lac_page_over_time(page, "slip_fraction") == NULL ||
        lac_page_over_time(page, "correlation_length") == NULL || size.n != n_slip.width ||
        total.n != n_slip.width) {
        return; // the case did not ask for it, or it is a block
    }
    const uint8_t *keep = lac_page_keep(page, key, BUCKETS);
    if (keep != NULL) {
        lac_json_open(&page->json, key, '{');
        lac_page_column(page, "size", size.n, size.value, NULL, 8);
        lac_page_column(page, "total", total.n, total.value, NULL, 17);
        lac_page_records(page, key, keep);
        write_counts(page, &n_slip, keep);
        write_fixed_points(page);
        lac_json_close(&page->json, '}');
    }
}
