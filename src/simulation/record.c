// SPDX-License-Identifier: GPL-3.0-or-later
// A simulation run into memory, which is handed out as a dataset, or into its file.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/ask.h"
#include "data/dataset.h"
#include "simulation/internal.h"

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
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        LAC_TRY_RETURN(lac_recording_add(recording, table[i].name, table[i].unit,
                                         table[i].long_name, table[i].value, err));
    }
    return LAC_OK;
}

lac_run_output lac_outcome_output(const lac_outcome *of)
{
    return (lac_run_output){.domain = of->scene->contact.domain,
                            .hierarchy = of->scene->hierarchy,
                            .transfer = &of->scene->transfer,
                            .fields = of->source->fields,
                            .extras = of->extras,
                            .extra = of->extra,
                            .events = lac_analysis_has_events(of->analysis),
                            .dated = of->source->dated,
                            .start_date = of->source->start_date};
}

lac_status lac_simulation_record(lac_simulation *simulation, lac_dataset **out, lac_error *err)
{
    lac_recording *recording = NULL;
    lac_status status;
    LAC_TRY(LAC_NEED(err, simulation, out));
    *out = NULL;
    const lac_outcome *outcome = lac_simulation_outcome(simulation);
    const lac_recording_def def = lac_outcome_output(outcome);
    LAC_TRY(lac_recording_create(&def, &recording, err));
    const lac_sink sink = lac_recording_sink(recording);
    const lac_status ended = lac_simulation_run(simulation, &sink, err);
    if (ended == LAC_OK || ended == LAC_EINTERRUPT) {
        LAC_TRY(add_outcome(recording, outcome->source, &outcome->run, err));
        *out = lac_recording_hand_out(recording);
        recording = NULL;
    }
    status = ended;
out:
    lac_recording_free(recording);
    return status;
}

static lac_status open_file(lac_simulation *simulation, const char *path,
                            const lac_write_options *options, lac_store **out, lac_error *err)
{
    lac_store_def def;
    const lac_status status = lac_simulation_file(simulation, &def, err);
    if (status != LAC_OK) {
        return status;
    }
    lac_provenance_sign(&def.provenance, options);
    def.path = path != NULL ? path : def.path;
    def.force = options->force;
    return def.path != NULL
               ? lac_store_create(&def, out, err)
               : lac_fail(err, LAC_EINPUT, "%s: names no output.file, nor does the caller",
                          lac_simulation_outcome(simulation)->source->path);
}

lac_status lac_simulation_write(lac_simulation *simulation, const char *path,
                                const lac_write_options *options, lac_error *err)
{
    lac_write_options own = lac_write_options_default();
    lac_store *store = NULL;
    lac_status status;
    LAC_TRY(LAC_NEED(err, simulation));
    LAC_TRY(lac_take_options("lac_write_options", options, &own, sizeof own, err));
    LAC_TRY(open_file(simulation, path, &own, &store, err));
    const lac_outcome *of = lac_simulation_outcome(simulation);
    const lac_sink sink = lac_store_sink(store);
    const lac_status ran = lac_simulation_run(simulation, &sink, err);
    status = lac_store_finish(store, of->status, &of->run, NAN, ran == LAC_OK ? err : NULL);
    status = ran == LAC_OK ? status : ran;
out:
    lac_store_free(store);
    return status;
}
