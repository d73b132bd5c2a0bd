// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a case through the library and prints when its slope fails: docs/howto-embed.md.
#include <lacuna/lacuna.h>
#include <stdio.h>

// Gets every record as the run makes it.
static lac_status print_decade(void *context, const lac_record *record, lac_error *err)
{
    double *next = context;
    (void)err;
    if (record->observation.mean_rate >= *next) {
        printf("%.3e m/s after %.4f day\n", record->observation.mean_rate,
               (record->time_origin + record->time_local) / 86400);
        *next = 10 * record->observation.mean_rate;
    }
    return LAC_OK;
}

int main(int argc, char **argv)
{
    lac_error err = {0};
    lac_case *c = NULL;
    lac_simulation *simulation = NULL;
    double next = 0;
    lac_sink sink = lac_sink_default();
    sink.context = &next;
    sink.record = print_decade;
    lac_status status = lac_case_load(argc > 1 ? argv[1] : "case.yaml", NULL, &c, &err);
    status = status == LAC_OK ? lac_simulation_create(c, NULL, &simulation, &err) : status;
    status = status == LAC_OK ? lac_simulation_run(simulation, &sink, &err) : status;
    const lac_run_result *run = lac_simulation_result(simulation);
    if (status != LAC_OK) {
        fprintf(stderr, "creep: %s\n", err.message);
    } else if (run->failed) {
        printf("fails after %.4f day\n", (run->failure_origin + run->failure_local) / 86400);
    }
    lac_simulation_free(simulation);
    lac_case_free(c);
    return status;
}
