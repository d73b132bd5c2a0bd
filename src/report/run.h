/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_REPORT_RUN_H
#define LACUNA_REPORT_RUN_H

#include "report/report.h"
#include "report/text.h"
#include "store/store_file.h"

/// Columns over time that a page may show.
enum lac_page_columns {
    LAC_PAGE_SLIP,
    LAC_PAGE_RATE,
    LAC_PAGE_MAX_RATE,
    LAC_PAGE_FRICTION,
    LAC_PAGE_SHEAR,
    LAC_PAGE_EFFECTIVE,
    LAC_PAGE_NORMAL,
    LAC_PAGE_STEP,
    LAC_PAGE_ORDER,
    LAC_PAGE_RHS,
    LAC_PAGE_RESIDUAL,
    LAC_PAGE_FRACTION,
    LAC_PAGE_CRITICALITY,
    LAC_PAGE_LENGTH,
    LAC_PAGE_COLUMNS
};

/// What is read of a run's file before anything is written.
typedef struct lac_page_run {
    const char *path;
    lac_stored_file *file;                      ///< owned
    size_t n;                                   ///< records that are whole
    double *time;                               ///< [n] since the start [s]
    double *before;                             ///< [n] to the last record, exact where time is not
    lac_stored_values column[LAC_PAGE_COLUMNS]; ///< those that the file has, n records at least
    bool dated;
    double start; ///< of the run's clock, seconds since 1970; 0: not dated
    bool failed;
    double failure; ///< since the start [s]; NaN: it did not fail
} lac_page_run;

/// Reads it.
/// @return LAC_OK; LAC_EINPUT (no record); LAC_EIO (not a run of Lacuna, damaged); LAC_ENOMEM
lac_status lac_page_run_read(const lac_report_def *def, lac_page_run *out, lac_error *err);
void lac_page_run_clear(lac_page_run *run);

/// A column, NULL where the file has none.
const double *lac_page_run_column(const lac_page_run *run, enum lac_page_columns column);

/// Marks the records that a chart of these columns needs: the first and last of each of `buckets`
/// even parts of time, and of the logarithm of the time before the end, and where a column is least
/// and greatest in it. All, where there are few.
/// @param keep  [n] set here
/// @return how many
size_t lac_page_thin(size_t n, const double *time, const double *before, size_t buckets,
                     size_t columns, const double *const *column, uint8_t *keep);

/// A number or text of the file's attributes; NaN, or false, where it has none.
double lac_page_attribute(const lac_stored_file *file, const char *name);
bool lac_page_attribute_text(const lac_stored_file *file, const char *name, char *text,
                             size_t size);

/// What each section needs.
typedef struct lac_page {
    const lac_report_def *def;
    const lac_page_run *run;
    lac_page_text *text;
} lac_page;

/// The sections: each writes an object of its own, or nothing where the run has no data for it.
/// @return LAC_OK; LAC_EIO; LAC_ENOMEM
lac_status lac_page_about(const lac_page *page, lac_error *err);
lac_status lac_page_motion(const lac_page *page, lac_error *err);
lac_status lac_page_forces(const lac_page *page, lac_error *err);
lac_status lac_page_solver(const lac_page *page, lac_error *err);
lac_status lac_page_series(const lac_page *page, lac_error *err);
lac_status lac_page_fit(const lac_page *page, lac_error *err);
lac_status lac_page_forecasts(const lac_page *page, lac_error *err);
lac_status lac_page_cells(const lac_page *page, lac_error *err);
lac_status lac_page_levels(const lac_page *page, lac_error *err);
lac_status lac_page_events(const lac_page *page, lac_error *err);

#endif
