// SPDX-License-Identifier: GPL-3.0-or-later
// Where a file comes from, as its attributes: program, command, case, date and libraries.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/date.h"
#include "lacuna/version.h"
#include "store/nc.h"

// `date: command line`, a line of the form that NCO and CDO add to.
static lac_status put_history(const lac_nc *file, const char *date, const char *command,
                              lac_error *err)
{
    if (command == NULL) {
        return LAC_OK;
    }
    size_t size = strlen(date) + strlen(command) + 3;
    char *text = malloc(size);
    if (text == NULL) {
        return lac_fail_memory(err);
    }
    (void)snprintf(text, size, "%s%s%s", date, *date != '\0' ? ": " : "", command);
    lac_status status = lac_nc_text(file, NC_GLOBAL, "history", text, err);
    free(text);
    return status;
}

// The caller's libraries, and the one that is known only here.
static lac_status put_libraries(const lac_nc *file, const char *libraries, lac_error *err)
{
    char version[32];
    (void)snprintf(version, sizeof version, "%s", nc_inq_libvers());
    version[strcspn(version, " ")] = '\0';
    const char *others = libraries != NULL ? libraries : "";
    size_t size = strlen(others) + sizeof version + 16;
    char *text = malloc(size);
    if (text == NULL) {
        return lac_fail_memory(err);
    }
    (void)snprintf(text, size, "%s%snetCDF %s", others, *others != '\0' ? ", " : "", version);
    lac_status status = lac_nc_text(file, NC_GLOBAL, "libraries", text, err);
    free(text);
    return status;
}

lac_status lac_nc_provenance(const lac_nc *file, const lac_provenance *provenance,
                             const char *summary, lac_error *err)
{
    lac_status status = LAC_OK;
    char date[32];
    (void)lac_date_format(provenance->now, date, sizeof date);
    const struct {
        const char *name, *text;
    } texts[] = {
        {"Conventions", "CF-1.10 ACDD-1.3"},
        {"title", provenance->title},
        {"summary", summary},
        {"institution", provenance->institution},
        {"source", "Lacuna " LACUNA_VERSION},
        {"references", provenance->references},
        {"date_created", date},
        {"lacuna_format_version", "1"},
        {"case", provenance->case_text},
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        LAC_TRY(lac_nc_text(file, NC_GLOBAL, texts[i].name, texts[i].text, err));
    }
    if (provenance->fidelity != NULL) {
        LAC_TRY(lac_nc_text(file, NC_GLOBAL, "fidelity", provenance->fidelity, err));
    }
    if (provenance->accuracy != NULL) {
        LAC_TRY(lac_nc_text(file, NC_GLOBAL, "accuracy", provenance->accuracy, err));
        LAC_TRY(lac_nc_real(file, NC_GLOBAL, "accuracy_asked", provenance->accuracy_asked, err));
        LAC_TRY(lac_nc_real(file, NC_GLOBAL, "accuracy_estimated", provenance->accuracy_estimated,
                            err));
    }
    LAC_TRY(put_history(file, date, provenance->command_line, err));
    LAC_TRY(put_libraries(file, provenance->libraries, err));
    if (provenance->seed != INT64_MIN) {
        LAC_TRY(lac_nc_integer(file, NC_GLOBAL, "seed", provenance->seed, err));
    }
out:
    return status;
}
