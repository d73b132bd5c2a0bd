// SPDX-License-Identifier: GPL-3.0-or-later
// The map and its errors for pairs that do not come from a study, such as those of a run.
#include "rg/study.h"

lac_status lac_rg_map_resample(size_t groups, const size_t *first, const double *s,
                               const double *s_next, size_t resamplings, lac_rg_fit *fit,
                               lac_error *err)
{
    const lac_rg_study_def def = {.resamplings = resamplings, .seed = 1};
    lac_rg_result result = {0};
    lac_status status = lac_rg_bootstrap(&def, groups, first, s, s_next, &result, err);
    *fit = (lac_rg_fit){.map = result.map,
                        .fixed_point = result.fixed_point,
                        .lambda = result.lambda,
                        .nu = result.nu};
    return status;
}
