// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a case into the file that it names, as `lacuna run` does: docs/howto-embed.md.
#include <lacuna/lacuna.h>
#include <stdio.h>
#include <time.h>

int main(int argc, char **argv)
{
    lac_error err = {0};
    lac_case *c = NULL;
    lac_simulation *simulation = NULL;
    lac_write_options options = lac_write_options_default();
    options.now = (double)time(NULL);
    lac_status status = lac_case_load(argc > 1 ? argv[1] : "case.yaml", NULL, &c, &err);
    status = status == LAC_OK ? lac_simulation_create(c, NULL, &simulation, &err) : status;
    status = status == LAC_OK ? lac_simulation_write(simulation, NULL, &options, &err) : status;
    if (status != LAC_OK) {
        fprintf(stderr, "keep: %s\n", err.message);
    } else {
        const lac_accuracy_pick *pick = lac_simulation_accuracy(simulation);
        printf("ended by: %s\n", lac_end_name(lac_simulation_result(simulation)->end));
        puts(pick != NULL ? pick->text : "settings as given");
    }
    lac_simulation_free(simulation);
    lac_case_free(c);
    return status;
}
