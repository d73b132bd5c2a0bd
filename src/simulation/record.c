// SPDX-License-Identifier: GPL-3.0-or-later
// A simulation kept in memory; a case from its file to that.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "simulation/simulation.h"

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

// @param text  NULL: the case is in the file of this name
static lac_status read_case(const char *name, const char *text, size_t size, size_t count,
                            const char *const *sets, lac_case **out, lac_error *err)
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
    const lac_case_request how = {LAC_FOR_RUN, overrides, count};
    status = text == NULL ? lac_case_read(name, &how, out, &report, err)
                          : lac_case_read_text(name, text, size, &how, out, &report, err);
out:
    lac_case_report_clear(&report);
    for (size_t i = 0; i < count; i++) {
        free((char *)overrides[i].key);
    }
    free(overrides);
    return status;
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

static lac_recording_def made_from(const lac_outcome *of)
{
    return (lac_recording_def){.domain = of->scene->contact.domain,
                               .hierarchy = of->scene->hierarchy,
                               .transfer = &of->scene->transfer,
                               .fields = of->source->fields,
                               .extras = of->extras,
                               .extra = of->extra,
                               .events = lac_analysis_has_events(of->analysis)};
}

lac_status lac_simulation_record(lac_simulation *simulation, lac_recording **out, lac_error *err)
{
    const lac_outcome *outcome = lac_simulation_result(simulation);
    const lac_recording_def def = made_from(outcome);
    lac_recording *recording = NULL;
    lac_status status;
    *out = NULL;
    LAC_TRY(lac_recording_create(&def, &recording, err));
    const lac_sink sink = lac_recording_sink(recording);
    const lac_status ended = lac_simulation_run(simulation, &sink, err);
    status = ended;
    if (ended == LAC_OK || ended == LAC_EINTERRUPT) {
        LAC_TRY(add_outcome(recording, outcome->source, &outcome->run, err));
        status = ended;
        *out = recording;
        recording = NULL;
    }
out:
    lac_recording_free(recording);
    return status;
}

lac_status lac_record_case_text(const char *name, const char *text, size_t size, size_t count,
                                const char *const *sets, const lac_simulation_options *options,
                                lac_recording **out, lac_error *err)
{
    lac_case *source = NULL;
    lac_simulation *simulation = NULL;
    lac_status status;
    *out = NULL;
    LAC_TRY(read_case(name, text, size, count, sets, &source, err));
    LAC_TRY(lac_simulation_create(source, options, &simulation, err));
    status = lac_simulation_record(simulation, out, err);
out:
    lac_simulation_free(simulation);
    lac_case_free(source);
    return status;
}

lac_status lac_record_case(const char *path, size_t count, const char *const *sets,
                           const lac_simulation_options *options, lac_recording **out,
                           lac_error *err)
{
    return lac_record_case_text(path, NULL, 0, count, sets, options, out, err);
}
