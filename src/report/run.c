// SPDX-License-Identifier: GPL-3.0-or-later
// What a page reads of a run, from its file or from memory: columns, and the time to the end.
#include "report/run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/date.h"

static const char *const names[LAC_PAGE_COLUMNS] = {
    [LAC_PAGE_SLIP] = "slip",
    [LAC_PAGE_RATE] = "slip_rate",
    [LAC_PAGE_MAX_RATE] = "max_slip_rate",
    [LAC_PAGE_FRICTION] = "apparent_friction",
    [LAC_PAGE_SHEAR] = "shear_force",
    [LAC_PAGE_EFFECTIVE] = "effective_normal_force",
    [LAC_PAGE_NORMAL] = "normal_force",
    [LAC_PAGE_STEP] = "step_size",
    [LAC_PAGE_ORDER] = "order",
    [LAC_PAGE_RHS] = "rhs_evaluations",
    [LAC_PAGE_RESIDUAL] = "balance_residual",
    [LAC_PAGE_FRACTION] = "slip_fraction",
    [LAC_PAGE_CRITICALITY] = "criticality",
    [LAC_PAGE_LENGTH] = "correlation_length",
};

bool lac_page_attribute_text(const lac_stored_file *file, const char *name, char *text, size_t size)
{
    return lac_stored_file_attribute(file, name, text, size, NULL) == LAC_OK;
}

double lac_page_attribute(const lac_stored_file *file, const char *name)
{
    char text[64];
    return lac_page_attribute_text(file, name, text, sizeof text) ? strtod(text, NULL) : NAN;
}

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
        LAC_TRY(lac_stored_file_values(run->file, names[c], column, err));
        if (column->value != NULL && (column->n < run->n || column->width != 1)) {
            LAC_TRY(lac_fail(err, LAC_EIO, "%s: %s does not run over time", run->path, names[c]));
        }
    }
out:
    return status;
}

// Times of the file's records, or of those that are in memory.
static lac_status open_run(const lac_report_def *def, lac_page_run *out, lac_error *err)
{
    lac_stored_values time = {0};
    lac_status status;
    if (def->recording == NULL) {
        LAC_TRY(lac_store_read(def->run, "time", &out->time, &out->n, err));
        LAC_TRY(lac_stored_file_open(def->run, &out->file, err));
    } else {
        LAC_TRY(lac_stored_file_of(def->recording, &out->file, err));
        LAC_TRY(lac_stored_file_values(out->file, "time", &time, err));
        out->time = time.value;
        out->n = time.n;
    }
out:
    return status;
}

lac_status lac_page_run_read(const lac_report_def *def, lac_page_run *out, lac_error *err)
{
    const char *path = def->run;
    char text[64];
    lac_status status;
    *out = (lac_page_run){.path = path};
    LAC_TRY(open_run(def, out, err));
    if (out->n == 0) {
        LAC_TRY(lac_fail(err, LAC_EINPUT, "%s: holds no record", path));
    }
    LAC_TRY(read_before(out, err));
    LAC_TRY(read_columns(out, err));
    for (size_t c = LAC_PAGE_SLIP; c <= LAC_PAGE_MAX_RATE; c++) {
        if (out->column[c].value == NULL) {
            LAC_TRY(
                lac_fail(err, LAC_EIO, "%s: is not the file of a run: has no %s", path, names[c]));
        }
    }
    out->dated = lac_page_attribute_text(out->file, "time_coverage_start", text, sizeof text) &&
                 lac_date_parse(text, &out->start);
    out->failed = lac_page_attribute(out->file, "failed") == 1.0;
    out->failure = out->failed ? lac_page_attribute(out->file, "failure_time_s") : NAN;
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

const double *lac_page_run_column(const lac_page_run *run, enum lac_page_columns column)
{
    return run->column[column].value;
}
