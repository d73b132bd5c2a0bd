// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a case into the file that it names, as `lacuna run` does: docs/howto-embed.md.
#include <lacuna/lacuna.h>
#include <stdio.h>
#include <time.h>

static lac_status keep(lac_simulation *simulation, lac_error *err)
{
    const lac_outcome *of = lac_simulation_result(simulation);
    lac_store_def file;
    lac_store *store = NULL;
    lac_status status = LAC_OK;
    LAC_TRY(lac_simulation_file(simulation, &file, err));
    file.path = file.path != NULL ? file.path : "out.nc";
    file.provenance.now = (double)time(NULL);
    LAC_TRY(lac_store_create(&file, &store, err));
    const lac_sink sink = lac_store_sink(store);
    const lac_status ran = lac_simulation_run(simulation, &sink, err);
    status = lac_store_finish(store, of->status, &of->run, 0, ran == LAC_OK ? err : NULL);
    status = ran == LAC_OK ? status : ran;
    printf("%s: %s, %s\n", file.path, of->status, lac_end_name(of->run.end));
    if (of->accuracy != NULL) {
        puts(of->accuracy->text);
    }
out:
    lac_store_free(store);
    return status;
}

int main(int argc, char **argv)
{
    lac_error err = {0};
    lac_case_report report = {0};
    lac_case *c = NULL;
    lac_simulation *simulation = NULL;
    lac_status status = lac_case_read(argc > 1 ? argv[1] : "case.yaml", NULL, &c, &report, &err);
    status = status == LAC_OK ? lac_simulation_create(c, NULL, &simulation, &err) : status;
    status = status == LAC_OK ? keep(simulation, &err) : status;
    if (status != LAC_OK) {
        fprintf(stderr, "keep: %s\n", err.message);
    }
    lac_simulation_free(simulation);
    lac_case_free(c);
    lac_case_report_clear(&report);
    return status;
}
