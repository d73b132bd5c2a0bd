// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a case through the library and prints when its slope fails: docs/howto-embed.md.
#include <lacuna/lacuna.h>
#include <stdio.h>

// Gets every record as the run makes it.
static lac_status print_decade(void *context, const lac_record *record, lac_error *err)
{
    double *next = context;
    (void)err;
    if (record->seen.mean_rate >= *next) {
        printf("%.3e m/s after %.4f day\n", record->seen.mean_rate,
               (record->time_origin + record->time_local) / 86400);
        *next = 10 * record->seen.mean_rate;
    }
    return LAC_OK;
}

int main(int argc, char **argv)
{
    lac_error err = {0};
    lac_case_report report = {0};
    lac_case *c = NULL;
    lac_scene *scene = NULL;
    lac_run_result result;
    double next = 0;
    lac_sink sink = {.context = &next, .record = print_decade};
    lac_status status = lac_case_read(argc > 1 ? argv[1] : "case.yaml", NULL, &c, &report, &err);
    if (status == LAC_OK) {
        c->run.beyond &= ~(unsigned)LAC_BEYOND_OUTPUT; // the sink takes the place of a file
        status = lac_scene_create(c, &scene, &err);
    }
    status = status == LAC_OK ? lac_run(scene->problem, &c->run, &sink, &result, &err) : status;
    if (status != LAC_OK) {
        fprintf(stderr, "creep: %s\n", err.message);
    } else if (result.failed) {
        printf("fails after %.4f day\n", (result.failure_origin + result.failure_local) / 86400);
    }
    lac_scene_free(scene);
    lac_case_free(c);
    lac_case_report_clear(&report);
    return status;
}
