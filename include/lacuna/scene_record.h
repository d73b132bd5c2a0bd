/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_SCENE_RECORD_H
#define LACUNA_SCENE_RECORD_H

#include "lacuna/linkage.h"
#include "lacuna/recording.h"
#include "lacuna/scene.h"

LAC_BEGIN_C

/// Who may stop a run.
typedef struct lac_interruption {
    bool (*interrupted)(void *context); ///< asked after every step
    void *context;
} lac_interruption;

/// Runs a case from its file to the end and keeps everything in memory: `lacuna run` in one call,
/// also for languages that cannot mirror the structures of a scene. Beside the variables of a run's
/// file there are, each one value: `failed` (0 or 1), `failure_time` [s], `steps`, and where the
/// case has a date `start_date` [s since 1970].
/// @param path  of the case
/// @param sets  [count] "key.path=value", as the option --set
/// @param stop  NULL: nobody stops it
/// @param out   NULL unless LAC_OK or LAC_EINTERRUPT, which keeps what was computed
///              (nothing, and NULL, where it comes in the pilot runs of solver.accuracy)
/// @return LAC_OK (also at failure of the slope); LAC_EINPUT with the first error of the case; what
///         lac_scene_create, lac_accuracy_choose, lac_scene_analysis_create and lac_run return
/// @cost   8 bytes a variable and record, and the run
lac_status lac_record_case(const char *path, size_t count, const char *const *sets,
                           const lac_interruption *stop, lac_recording **out, lac_error *err);

/// As lac_record_case, of a case that is in memory.
/// @param name  stands for the path in messages; what the case names relatively is looked for
/// beside it
/// @param text  [size] YAML, as in a case file
/// @return as lac_record_case
lac_status lac_record_case_text(const char *name, const char *text, size_t size, size_t count,
                                const char *const *sets, const lac_interruption *stop,
                                lac_recording **out, lac_error *err);

LAC_END_C

#endif
