/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "series/series.h"
#include "store/recording.h"

/// An ensemble as its page shows it.
typedef struct lac_page_ensemble {
    const struct lac_sample *sample;   ///< with names
    const struct lac_answers *answers; ///< of it
    size_t records;
    const double *place; ///< [records] time since the start, or what `label` says
    const char *label;   ///< NULL: a time
    const float *rate;   ///< [members][records] slip rate
} lac_page_ensemble;

/// What a page shows. Texts are borrowed.
typedef struct lac_page_def {
    const char *run;                   ///< file of a run, or of lacuna precursors
    const char *name;                  ///< what the page says that it was made from; NULL: the file
    const lac_recording *recording;    ///< read instead of the file, with its attributes; NULL
    const lac_series *series;          ///< laid beside it; NULL: none
    const char *series_name;           ///< what it is called
    const char *point;                 ///< of the run that it is of; NULL: of the whole joint
    const char *fit;                   ///< file of lacuna fit, whose forecast is drawn; NULL: none
    const lac_page_ensemble *ensemble; ///< that the file is of; NULL: none
    const char *made_by;               ///< program and version
    double now;                        ///< seconds since 1970 UTC: the library reads no clock
    int issues; ///< times of forecasts, which cost more than all else; 0: 24, -1: none
} lac_page_def;

/// The data of a page as one JSON object, which a page's script draws: every section that the file
/// holds something for, its series thinned to what can be told apart on a screen. A reading of a
/// series without dates counts from the start of the run.
/// @param json  ends in '\0'; the caller frees it; NULL where it fails
/// Of the file of lacuna precursors what it holds of readings and forecasts; `recording`, `series`,
/// `fit` and `issues` say nothing then.
/// @return LAC_OK; LAC_EINPUT (no record; a series or fit with dates beside a run without, or the
///         other way round a fit); LAC_EIO (not the file of a run, or of a fit; damaged);
///         LAC_ENOMEM
/// @cost  memory of all records of one column set, and of 12 000 numbers for each of 40 snapshots
lac_status lac_page_data(const lac_page_def *def, char **json, lac_error *err);

/// Writes the page. @param path  taken only once the page is whole
/// @return as lac_page_data; LAC_EINPUT where the file exists and `force` is not set
lac_status lac_page_write(const lac_page_def *def, const char *path, bool force, lac_error *err);

/// The page of a run that goes on: without data, which its script asks for at `data` again and
/// again. docs/report.md
/// @param nonce  of the Content-Security-Policy that it is sent with
/// @param html   as the data; LAC_ENOMEM
lac_status lac_page_live_page(const char *nonce, char **html, lac_error *err);

/// Keeps a recording that grows as small as its page allows: of many records those that a chart
/// needs, of many snapshots some (fewer of more cells, 256 MiB in all). To be called after every
/// few records, and after every snapshot.
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_page_thin_recording(lac_recording *recording, lac_error *err);
