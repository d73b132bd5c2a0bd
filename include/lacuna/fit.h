/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_FIT_H
#define LACUNA_FIT_H

#include "lacuna/case.h"
#include "lacuna/dataset.h"
#include "lacuna/series.h"

LAC_BEGIN_C

/// How a fit is computed; from lac_fit_options_default.
typedef struct lac_fit_options {
    size_t size;                        ///< of this structure, as the default has it
    bool (*interrupted)(void *context); ///< asked after every run; NULL: never
    void *context;
    void (*progress)(void *context, const char *stage, size_t done, size_t total); ///< NULL
    int threads; ///< that compute at the same time; 0: 1
} lac_fit_options;

/// No callbacks, one thread.
static inline lac_fit_options lac_fit_options_default(void)
{
    lac_fit_options options = LAC_ZEROS;
    options.size = sizeof options;
    return options;
}

/// Reads a series by the columns that the section `fit` of a case names.
/// @return as lac_series_create
lac_status lac_fit_series(const lac_case *c, const char *path, lac_series **out, lac_error *err);

/// Fits the parameters that the section `fit` of a case names to a series: least squares, then the
/// sampler, then the predictions, as the case says; docs/theory/fitting.md.
/// @param c        read with LAC_FOR_FIT; its own values are the first start; outlives the dataset
/// @param series   from lac_fit_series
/// @param options  NULL: the default
/// @param out      its variables are those of docs/format.md; NULL unless LAC_OK or, with what was
///                 computed, where it was interrupted or has not converged
/// @return LAC_OK; LAC_EINPUT (too few readings, a date against none ...); LAC_ENUMERIC (no start
///         has a likelihood; with a dataset: the sampler has not converged); LAC_EINTERRUPT;
///         LAC_ENOMEM
lac_status lac_fit_compute(const lac_case *c, const lac_series *series,
                           const lac_fit_options *options, lac_dataset **out, lac_error *err);

LAC_END_C

#endif
