/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "report/report.h"
#include "store/store_file.h"

/// The page without its data, made from the files in `page/` when Lacuna is built; ends in '\0'.
/// The marks @TITLE@ and @DATA@ stand in it once each, @NONCE@ in the tag of each style and script.
extern const unsigned char lac_page_html[];

/// A page that is being made. Where something fails its sections go on without what they lack, and
/// the first failure counts: what was written is then no page.
typedef struct lac_page {
    const lac_page_def *def;
    lac_json json;
    lac_status status;
    lac_error *err;               ///< of the first failure; NULL after it
    struct lac_page_owned *owned; ///< freed with it
    lac_stored_file *file;        ///< of the run
    size_t n;                     ///< records that are whole
    const double *time;           ///< [n] since the start [s]
    double *before;               ///< [n] to the last record, exact where time is not
    bool readings;                ///< of the file of lacuna precursors, not of a run
    bool dated;
    double start; ///< of the run's clock, seconds since 1970; 0: not dated
} lac_page;

/// Reads of the run what is needed before anything is written.
void lac_page_begin(lac_page *page);
void lac_page_clear(lac_page *page);

/// Takes note of a failure. @return whether there is none
bool lac_page_good(lac_page *page, lac_status status);

/// Room that the page owns. @return NULL: there is none, which was noted
void *lac_page_room(lac_page *page, size_t bytes);

/// A variable of a file, read once; nothing where there is none. The page owns it.
lac_stored_values lac_page_values(lac_page *page, const lac_stored_file *file, const char *name);

/// A column over the run's time by its name in a file. @return [n] NULL: there is none
const double *lac_page_over_time(lac_page *page, const char *name);

/// Marks the records that a chart of these columns needs: the first and last of each of `buckets`
/// even parts of time, and of the logarithm of the time before the end, and where a column is least
/// and greatest in it. All, where there are few.
/// @param column  [columns] NULL: none
/// @param keep    [n] set here
/// @return how many
size_t lac_page_thin(size_t n, const double *time, const double *before, size_t buckets,
                     size_t columns, const double *const *column, uint8_t *keep);

/// The same by parts alone, so few, at most `most` / 2, that no more than `goal` are marked.
void lac_page_thin_to(size_t n, const double *time, const double *before, size_t most, size_t goal,
                      uint8_t *keep);

/// The same of a recording for the columns that a page cannot do without.
void lac_page_mark_records(const lac_recording *recording, size_t n, const double *time,
                           const double *before, uint8_t *keep);

/// The numbers of a column [n], NULL: none, at the records that are kept, NULL: all.
void lac_page_column(lac_page *page, const char *key, size_t n, const double *value,
                     const uint8_t *keep, int digits);

/// The contact cells as the page draws them: squares of `block` x `block` cells each.
typedef struct lac_page_raster {
    size_t cells;
    size_t nx, ny;    ///< squares of the whole interface
    size_t block;     ///< cells along the side of a square
    double dx, dy;    ///< sides of a square [m]
    size_t squares;   ///< that hold a contact cell
    uint32_t *square; ///< [cells] number of the square that a cell lies in
    double *place;    ///< [squares] row * nx + column
    uint32_t *count;  ///< [squares] contact cells in it
} lac_page_raster;

/// What a square shows of its cells.
typedef enum lac_page_summary {
    LAC_PAGE_MEAN,
    LAC_PAGE_MOST,
    LAC_PAGE_SHARE_ABOVE
} lac_page_summary;

/// @param value  [cells] NaN: missing
/// @param limit  of LAC_PAGE_SHARE_ABOVE
/// @param out    [squares]
void lac_page_raster_summarise(const lac_page_raster *raster, lac_page_summary how,
                               const double *value, double limit, double *out);

/// The points of a run by their names.
typedef struct lac_page_points {
    size_t all;
    char (*name)[64]; ///< [all]
} lac_page_points;

/// @return false: the run has none
bool lac_page_read_points(lac_page *page, lac_page_points *out);

/// What a variable over time and the points says of one. @return [n] NULL: nothing
const double *lac_page_point_column(lac_page *page, const lac_page_points *points, const char *name,
                                    size_t point);

/// The section of an ensemble.
void lac_page_of_ensemble(lac_page *page, const char *key);

/// The sections: each writes an object under its key, or nothing where the run has no data for it.
void lac_page_course(lac_page *page, const char *key);
void lac_page_series(lac_page *page, const char *key);
void lac_page_fit(lac_page *page, const char *key);
void lac_page_forecasts(lac_page *page, const char *key);
void lac_page_cells(lac_page *page, const char *key);
void lac_page_levels(lac_page *page, const char *key);
void lac_page_events(lac_page *page, const char *key);
void lac_page_points_section(lac_page *page, const char *key);

/// A method of forecasting. @param kind  NULL: this program does not know it, only its name
struct lac_forecast_kind;
void lac_page_method(lac_page *page, const char *name, const struct lac_forecast_kind *kind);

/// The same of the file of lacuna precursors.
bool lac_page_holds_readings(const lac_stored_file *file);
lac_status lac_page_open_readings(lac_page *page);
void lac_page_verdict(lac_page *page, const char *key);
void lac_page_readings(lac_page *page, const char *key);
void lac_page_alarm(lac_page *page, const char *key);
void lac_page_stored_forecasts(lac_page *page, const char *key);
