// SPDX-License-Identifier: GPL-3.0-or-later
// A case from its file to a run in memory.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lacuna/accuracy.h"
#include "lacuna/scene_analysis.h"
#include "lacuna/scene_record.h"

// "key.path=value" cut at its first "=". The keys are the caller's to free.
static lac_status cut(const char *set, lac_override *out, lac_error *err)
{
    const char *equals = strchr(set, '=');
    if (equals == NULL || equals == set) {
        return lac_fail(err, LAC_EINPUT, "\"%s\" must be key.path=value", set);
    }
    out->value = equals + 1;
    out->key = strndup(set, (size_t)(equals - set));
    return out->key != NULL ? LAC_OK : lac_fail_memory(err);
}

static const lac_case_issue *first_error(const lac_case_report *report)
{
    for (size_t i = 0; i < report->count; i++) {
        if (!report->issue[i].warning) {
            return &report->issue[i];
        }
    }
    return NULL;
}

// Where a case comes from: the file `name`, or text that goes by this name.
typedef struct lac_case_origin {
    const char *name, *text; // text NULL: the file
    size_t size;
} lac_case_origin;

static lac_status read_case(const lac_case_origin *from, size_t count, const char *const *sets,
                            lac_case **out, lac_error *err)
{
    lac_case_report report = {0};
    lac_status status = LAC_OK;
    lac_override *overrides = calloc(count + 1, sizeof *overrides);
    if (overrides == NULL) {
        return lac_fail_memory(err);
    }
    for (size_t i = 0; i < count; i++) {
        LAC_TRY(cut(sets[i], &overrides[i], err));
    }
    lac_case_request request = {.purpose = LAC_FOR_RUN, .overrides = overrides, .count = count};
    status = from->text == NULL ? lac_case_read(from->name, &request, out, &report, err)
                                : lac_case_read_text(from->name, from->text, from->size, &request,
                                                     out, &report, err);
    const lac_case_issue *issue = first_error(&report);
    if (status == LAC_EINPUT && issue != NULL && err != NULL) {
        (void)lac_case_issue_format(issue, err->message, sizeof err->message);
    }
out:
    lac_case_report_clear(&report);
    for (size_t i = 0; i < count; i++) {
        free((char *)overrides[i].key);
    }
    free(overrides);
    return status;
}

// solver.accuracy: as the command does before it runs.
static lac_status pick(lac_scene *scene, lac_case *c, const lac_interruption *stop, lac_error *err)
{
    lac_accuracy_pick picked;
    lac_run_def how = lac_run_default();
    if (stop != NULL) {
        how.interrupted = stop->interrupted;
        how.context = stop->context;
    }
    return isnan(c->accuracy) ? LAC_OK : lac_accuracy_choose(scene, c, &how, &picked, err);
}

static lac_status create(const lac_scene *scene, const lac_analysis *analysis, lac_recording **out,
                         lac_error *err)
{
    lac_recording_def def = {.domain = scene->contact.domain,
                             .hierarchy = scene->hierarchy,
                             .fields = scene->source->fields,
                             .events = lac_analysis_has_events(analysis)};
    const double *once;
    if (analysis != NULL) {
        def.extras = lac_analysis_extras(analysis, &def.extra, &once);
    }
    return lac_recording_create(&def, out, err);
}

static lac_status add_outcome(lac_recording *recording, const lac_case *c,
                              const lac_run_result *result, lac_error *err)
{
    const struct {
        const char *name, *unit, *long_name;
        double value;
    } table[] = {
        {"failed", "1", "whether the joint failed, by its mean slip rate or its mean slip",
         result->failed},
        {"failure_time", "s", "time of failure since the start of the run",
         result->failure_origin + result->failure_local},
        {"steps", "1", "steps of the integrator", (double)result->steps},
        {"start_date", "s", "start of the run, since 1970", c->dated ? c->start_date : NAN},
    };
    lac_status status = LAC_OK;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        LAC_TRY(lac_recording_add(recording, table[i].name, table[i].unit, table[i].long_name,
                                  table[i].value, err));
    }
out:
    return status;
}

static lac_status run(const lac_scene *scene, lac_analysis *analysis, const lac_interruption *stop,
                      lac_recording *recording, lac_error *err)
{
    lac_sink sink = lac_recording_sink(recording);
    lac_run_def def = scene->source->run;
    lac_run_result result;
    if (analysis != NULL) {
        sink = lac_analysis_sink(analysis, &sink);
    }
    if (stop != NULL) {
        def.interrupted = stop->interrupted;
        def.context = stop->context;
    }
    lac_status ended = lac_run(scene->problem, &def, &sink, &result, err);
    if (ended != LAC_OK && ended != LAC_EINTERRUPT) {
        return ended;
    }
    lac_status status = LAC_OK;
    if (analysis != NULL) {
        const lac_extra *extra;
        const double *once;
        LAC_TRY(lac_analysis_finish(analysis, &result, err));
        (void)lac_analysis_extras(analysis, &extra, &once);
        LAC_TRY(lac_recording_once(recording, once, err));
    }
    LAC_TRY(add_outcome(recording, scene->source, &result, err));
out:
    return status == LAC_OK ? ended : status;
}

static lac_status record(const lac_case_origin *from, size_t count, const char *const *sets,
                         const lac_interruption *stop, lac_recording **out, lac_error *err)
{
    lac_case *source = NULL;
    lac_scene *scene = NULL;
    lac_analysis *analysis = NULL;
    lac_recording *recording = NULL;
    lac_status status;
    *out = NULL;
    LAC_TRY(read_case(from, count, sets, &source, err));
    LAC_TRY(lac_scene_create(source, &scene, err));
    LAC_TRY(pick(scene, source, stop, err));
    LAC_TRY(lac_scene_analysis_create(scene, NULL, &analysis, err));
    LAC_TRY(create(scene, analysis, &recording, err));
    status = run(scene, analysis, stop, recording, err);
    if (status == LAC_OK || status == LAC_EINTERRUPT) {
        *out = recording;
        recording = NULL;
    }
out:
    lac_recording_free(recording);
    lac_analysis_free(analysis);
    lac_scene_free(scene);
    lac_case_free(source);
    return status;
}

lac_status lac_record_case(const char *path, size_t count, const char *const *sets,
                           const lac_interruption *stop, lac_recording **out, lac_error *err)
{
    const lac_case_origin file = {.name = path};
    return record(&file, count, sets, stop, out, err);
}

lac_status lac_record_case_text(const char *name, const char *text, size_t size, size_t count,
                                const char *const *sets, const lac_interruption *stop,
                                lac_recording **out, lac_error *err)
{
    const lac_case_origin memory = {.name = name, .text = text, .size = size};
    return record(&memory, count, sets, stop, out, err);
}
