/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "data/json.h"
#include "report/report.h"
#include "store/store_file.h"

enum { LAC_PAGE_COLUMNS = 14 };

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
} lac_page_run;

/// Reads it.
/// @return LAC_OK; LAC_EINPUT (no record); LAC_EIO (not a run of Lacuna, damaged); LAC_ENOMEM
lac_status lac_page_run_read(const lac_page_def *def, lac_page_run *out, lac_error *err);
void lac_page_run_clear(lac_page_run *run);

/// A column over time by its name in a file, NULL where there is none.
const double *lac_page_run_column(const lac_page_run *run, const char *name);

/// Marks the records that a chart of these columns needs: the first and last of each of `buckets`
/// even parts of time, and of the logarithm of the time before the end, and where a column is least
/// and greatest in it. All, where there are few.
/// @param keep  [n] set here
/// @return how many
size_t lac_page_thin(size_t n, const double *time, const double *before, size_t buckets,
                     size_t columns, const double *const *column, uint8_t *keep);

/// The same by parts alone, so few, at most `most` / 2, that no more than `goal` are marked.
void lac_page_thin_to(size_t n, const double *time, const double *before, size_t most, size_t goal,
                      uint8_t *keep);

/// What each section needs.
typedef struct lac_page {
    const lac_page_def *def;
    const lac_page_run *run;
    lac_json *json;
} lac_page;

/// The file's name without its folder.
const char *lac_page_name(const char *path);

/// The numbers of a column at the records that are kept.
/// @param value  [n] NULL: none
/// @param keep   [n] NULL: all
void lac_page_column(const lac_page *page, const char *key, size_t n, const double *value,
                     const uint8_t *keep, int digits);

/// The records that the charts of a section's columns need. @param keep  [n] owned by the caller
lac_status lac_page_keep(const lac_page *page, const char *section, size_t buckets, uint8_t **keep,
                         lac_error *err);

/// Times and the columns of a section, at the records that are kept.
void lac_page_records(const lac_page *page, const char *section, const uint8_t *keep);

/// Times of the series' readings on the run's clock. @param time  [n] owned by the caller
lac_status lac_page_readings(const lac_page *page, double **time, lac_error *err);

/// The sections: each writes an object under its key, or nothing where the run has no data for it.
/// @return LAC_OK; LAC_EIO; LAC_ENOMEM
lac_status lac_page_about(const lac_page *page, const char *key, lac_error *err);
lac_status lac_page_course(const lac_page *page, const char *key, lac_error *err);
lac_status lac_page_series(const lac_page *page, const char *key, lac_error *err);
lac_status lac_page_fit(const lac_page *page, const char *key, lac_error *err);
lac_status lac_page_forecasts(const lac_page *page, const char *key, lac_error *err);
lac_status lac_page_cells(const lac_page *page, const char *key, lac_error *err);
lac_status lac_page_levels(const lac_page *page, const char *key, lac_error *err);
lac_status lac_page_events(const lac_page *page, const char *key, lac_error *err);
