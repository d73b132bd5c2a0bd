// SPDX-License-Identifier: GPL-3.0-or-later
// What a page reads of a run, from its file or from memory: the columns of its sections over time,
// and the time to the end.
#include "report/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/date.h"

enum { BUCKETS = 500 };

// Columns over time: where the page shows them, and under which key.
static const struct {
    const char *section, *key, *name;
    bool aside; // may be missing, and does not say which records are kept
} shown[LAC_PAGE_COLUMNS] = {
    {"motion", "slip", "slip", false},
    {"motion", "rate", "slip_rate", false},
    {"motion", "max_rate", "max_slip_rate", false},
    {"forces", "friction", "apparent_friction", false},
    {"forces", "shear", "shear_force", false},
    {"forces", "normal", "normal_force", false},
    {"forces", "effective", "effective_normal_force", false},
    {"solver", "step", "step_size", false},
    {"solver", "order", "order", false},
    {"solver", "evaluations", "rhs_evaluations", false},
    {"solver", "residual", "balance_residual", false},
    {"levels", "fraction", "slip_fraction", false},
    {"levels", "length", "correlation_length", false},
    {"levels", "criticality", "criticality", true},
};

// Time before the last record, from the pair that tells the last milliseconds apart.
static lac_status read_before(lac_page_run *run, lac_error *err)
{
    lac_stored_values origin = {0}, local = {0};
    lac_status status;
    run->before = malloc(run->n * sizeof *run->before);
    LAC_TRY(run->before != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(lac_stored_file_values(run->file, "time_origin", &origin, err));
    LAC_TRY(lac_stored_file_values(run->file, "time_local", &local, err));
    const size_t last = run->n - 1;
    const bool pair =
        origin.value != NULL && local.value != NULL && origin.n >= run->n && local.n >= run->n;
    for (size_t i = 0; i < run->n; i++) {
        run->before[i] =
            pair ? (origin.value[last] - origin.value[i]) + (local.value[last] - local.value[i])
                 : run->time[last] - run->time[i];
    }
out:
    lac_stored_values_clear(&origin);
    lac_stored_values_clear(&local);
    return status;
}

static lac_status read_columns(lac_page_run *run, lac_error *err)
{
    lac_status status = LAC_OK;
    for (size_t c = 0; c < LAC_PAGE_COLUMNS; c++) {
        lac_stored_values *column = &run->column[c];
        LAC_TRY(lac_stored_file_values(run->file, shown[c].name, column, err));
        if (column->value != NULL && (column->n < run->n || column->width != 1)) {
            LAC_TRY(
                lac_fail(err, LAC_EIO, "%s: %s does not run over time", run->path, shown[c].name));
        }
    }
    for (size_t c = 0; c < LAC_PAGE_COLUMNS; c++) {
        if (strcmp(shown[c].section, "motion") == 0 && run->column[c].value == NULL) {
            LAC_TRY(lac_fail(err, LAC_EIO, "%s: is not the file of a run: has no %s", run->path,
                             shown[c].name));
        }
    }
out:
    return status;
}

// Times of the file's records, or of those that are in memory.
static lac_status open_run(const lac_page_def *def, lac_page_run *out, lac_error *err)
{
    lac_stored_values time = {0};
    lac_status status;
    status = def->recording == NULL ? lac_stored_file_open(def->run, &out->file, err)
                                    : lac_stored_file_of(def->recording, &out->file, err);
    LAC_TRY(status);
    LAC_TRY(lac_stored_file_series(out->file, "time", &time, err));
    out->time = time.value;
    out->n = time.n;
out:
    return status;
}

lac_status lac_page_run_read(const lac_page_def *def, lac_page_run *out, lac_error *err)
{
    char text[64];
    lac_status status;
    *out = (lac_page_run){.path = def->run};
    LAC_TRY(open_run(def, out, err));
    if (out->n == 0) {
        LAC_TRY(lac_fail(err, LAC_EINPUT, "%s: holds no record", def->run));
    }
    LAC_TRY(read_before(out, err));
    LAC_TRY(read_columns(out, err));
    out->dated = lac_stored_file_text(out->file, NULL, "time_coverage_start", text, sizeof text) &&
                 lac_date_parse(text, &out->start);
out:
    return status;
}

void lac_page_run_clear(lac_page_run *run)
{
    lac_stored_file_close(run->file);
    free(run->time);
    free(run->before);
    for (size_t c = 0; c < LAC_PAGE_COLUMNS; c++) {
        lac_stored_values_clear(&run->column[c]);
    }
}

const double *lac_page_run_column(const lac_page_run *run, const char *name)
{
    for (size_t c = 0; c < LAC_PAGE_COLUMNS; c++) {
        if (strcmp(shown[c].name, name) == 0) {
            return run->column[c].value;
        }
    }
    return NULL;
}

void lac_page_column(const lac_page *page, const char *key, size_t n, const double *value,
                     const uint8_t *keep, int digits)
{
    lac_json_open(page->json, key, '[');
    for (size_t i = 0; value != NULL && i < n; i++) {
        if (keep == NULL || keep[i]) {
            lac_json_digits(page->json, NULL, value[i], digits);
        }
    }
    lac_json_close(page->json, ']');
}

lac_status lac_page_keep(const lac_page *page, const char *section, size_t buckets, uint8_t **keep,
                         lac_error *err)
{
    const lac_page_run *run = page->run;
    const double *column[LAC_PAGE_COLUMNS];
    size_t columns = 0;
    for (size_t c = 0; c < LAC_PAGE_COLUMNS; c++) {
        if (strcmp(shown[c].section, section) == 0 && !shown[c].aside) {
            column[columns++] = run->column[c].value;
        }
    }
    *keep = malloc(run->n);
    LAC_FAIL_MEMORY_IF(*keep == NULL, err);
    (void)lac_page_thin(run->n, run->time, run->before, buckets, columns, column, *keep);
    return LAC_OK;
}

void lac_page_records(const lac_page *page, const char *section, const uint8_t *keep)
{
    const lac_page_run *run = page->run;
    lac_page_column(page, "time", run->n, run->time, keep, 12);
    lac_page_column(page, "before", run->n, run->before, keep, 6);
    for (size_t c = 0; c < LAC_PAGE_COLUMNS; c++) {
        if (strcmp(shown[c].section, section) == 0 && run->column[c].value != NULL) {
            lac_page_column(page, shown[c].key, run->n, run->column[c].value, keep, 6);
        }
    }
}

// Whether a column changes by more than what its digits are worth.
static bool varies(const lac_page_run *run, const char *name)
{
    const double *v = lac_page_run_column(run, name);
    double least = INFINITY, most = -INFINITY;
    for (size_t i = 0; v != NULL && i < run->n; i++) {
        least = fmin(least, v[i]);
        most = fmax(most, v[i]);
    }
    return most - least > 1e-6 * fmax(fabs(most), fabs(least));
}

// Not of a file that some tool took a column from, nor of constant loads, which the case tells.
static bool is_there(const lac_page_run *run, const char *section)
{
    for (size_t c = 0; c < LAC_PAGE_COLUMNS; c++) {
        if (strcmp(shown[c].section, section) == 0 && run->column[c].value == NULL) {
            return false;
        }
    }
    return strcmp(section, "forces") != 0 || varies(run, "apparent_friction") ||
           varies(run, "shear_force") || varies(run, "effective_normal_force");
}

lac_status lac_page_course(const lac_page *page, const char *key, lac_error *err)
{
    uint8_t *keep = NULL;
    lac_status status = LAC_OK;
    if (!is_there(page->run, key)) {
        return LAC_OK;
    }
    LAC_TRY(lac_page_keep(page, key, BUCKETS, &keep, err));
    lac_json_open(page->json, key, '{');
    lac_json_integer(page->json, "records", (int64_t)page->run->n);
    lac_page_records(page, key, keep);
    lac_json_close(page->json, '}');
out:
    free(keep);
    return status;
}
