// SPDX-License-Identifier: GPL-3.0-or-later
// Series over time: motion, forces, what the integrator did.
#include <math.h>
#include <stdlib.h>

#include "report/run.h"

enum { BUCKETS = 500, MOST = 8 };

// A column under its key on the page.
typedef struct shown {
    const char *key;
    enum lac_page_columns column;
} shown;

static bool has_all(const lac_page_run *run, size_t count, const shown *what)
{
    for (size_t i = 0; i < count; i++) {
        if (lac_page_run_column(run, what[i].column) == NULL) {
            return false;
        }
    }
    return true;
}

// An object of columns, at the records that their charts need. It is left out of a file that some
// tool took one of them from.
static lac_status write_section(const lac_page *page, const char *key, size_t count,
                                const shown *what, lac_error *err)
{
    const lac_page_run *run = page->run;
    lac_page_text *text = page->text;
    const double *column[MOST] = {0};
    if (!has_all(run, count, what)) {
        return LAC_OK;
    }
    uint8_t *keep = malloc(run->n);
    if (keep == NULL) {
        return lac_fail_memory(err);
    }
    for (size_t i = 0; i < count; i++) {
        column[i] = lac_page_run_column(run, what[i].column);
    }
    (void)lac_page_thin(run->n, run->time, run->before, BUCKETS, count, column, keep);
    lac_page_open(text, key, '{');
    lac_page_number(text, "records", (double)run->n, 17);
    lac_page_column(text, "time", run->n, run->time, keep, 12);
    lac_page_column(text, "before", run->n, run->before, keep, 6);
    for (size_t i = 0; i < count; i++) {
        lac_page_column(text, what[i].key, run->n, column[i], keep, 6);
    }
    lac_page_close(text, '}');
    free(keep);
    return LAC_OK;
}

lac_status lac_page_motion(const lac_page *page, lac_error *err)
{
    static const shown motion[] = {
        {"slip", LAC_PAGE_SLIP}, {"rate", LAC_PAGE_RATE}, {"max_rate", LAC_PAGE_MAX_RATE}};
    return write_section(page, "motion", sizeof motion / sizeof *motion, motion, err);
}

// Whether a column changes by more than what its digits are worth.
static bool varies(const lac_page_run *run, enum lac_page_columns which)
{
    const double *v = lac_page_run_column(run, which);
    double least = INFINITY, most = -INFINITY;
    for (size_t i = 0; v != NULL && i < run->n; i++) {
        least = fmin(least, v[i]);
        most = fmax(most, v[i]);
    }
    return most - least > 1e-6 * fmax(fabs(most), fabs(least));
}

lac_status lac_page_forces(const lac_page *page, lac_error *err)
{
    static const shown forces[] = {{"friction", LAC_PAGE_FRICTION},
                                   {"shear", LAC_PAGE_SHEAR},
                                   {"normal", LAC_PAGE_NORMAL},
                                   {"effective", LAC_PAGE_EFFECTIVE}};
    const lac_page_run *run = page->run;
    if (!varies(run, LAC_PAGE_FRICTION) && !varies(run, LAC_PAGE_SHEAR) &&
        !varies(run, LAC_PAGE_EFFECTIVE)) {
        return LAC_OK; // constant loads are told by the case
    }
    return write_section(page, "forces", sizeof forces / sizeof *forces, forces, err);
}

lac_status lac_page_solver(const lac_page *page, lac_error *err)
{
    static const shown solver[] = {{"step", LAC_PAGE_STEP},
                                   {"order", LAC_PAGE_ORDER},
                                   {"evaluations", LAC_PAGE_RHS},
                                   {"residual", LAC_PAGE_RESIDUAL}};
    return write_section(page, "solver", sizeof solver / sizeof *solver, solver, err);
}
