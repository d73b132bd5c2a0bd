// SPDX-License-Identifier: GPL-3.0-or-later
// Where a file comes from, as its attributes: program, command, case, date and libraries.
#include "base/date.h"
#include "base/need.h"
#include "base/temp_file.h"
#include "lacuna/version.h"
#include "store/writer.h"

static lac_status put_joined(const char *name, const char *first, const char *between,
                             const char *second, lac_put_attribute *put, void *to, lac_error *err)
{
    char *text = lac_text_join(first, between, second);
    LAC_FAIL_MEMORY_IF(text == NULL, err);
    lac_status status = put(to, name, text, NAN, false, err);
    free(text);
    return status;
}

lac_status lac_provenance_put(const lac_provenance *of, const char *summary, lac_put_attribute *put,
                              void *to, lac_error *err)
{
    char date[32], version[32], netcdf[40];
    const bool picked = of->accuracy != NULL;
    const struct {
        const char *name, *text;
        double number;
    } all[] = {
        {"Conventions", "CF-1.10 ACDD-1.3", NAN},
        {"title", of->title, NAN},
        {"summary", summary, NAN},
        {"institution", of->institution, NAN},
        {"source", "Lacuna " LACUNA_VERSION, NAN},
        {"references", of->references, NAN},
        {"date_created", lac_date_format(of->now, date, sizeof date), NAN},
        {"lacuna_format_version", "1", NAN},
        {"case", of->case_text, NAN},
        {"fidelity", of->fidelity, NAN},
        {"fidelity_why", of->fidelity_why, NAN},
        {"fidelity_error", NULL, of->fidelity_why != NULL ? of->fidelity_error : NAN},
        {"lumped", of->lumped, NAN},
        {"accuracy", of->accuracy, NAN},
        {"accuracy_asked", NULL, picked ? of->accuracy_asked : NAN},
        {"accuracy_estimated", NULL, picked ? of->accuracy_estimated : NAN},
        {"branch", of->branch, NAN},
        {"branch_file", of->branch_file, NAN},
        {"branch_case_sum", of->branch_case_sum, NAN},
        {"branch_changes", of->branch_changes, NAN},
        {"branch_time_s", NULL, of->branch != NULL ? of->branch_time : NAN},
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        LAC_TRY_RETURN(put(to, all[i].name, all[i].text, all[i].number, false, err));
    }
    if (of->command_line != NULL) { // a line of the form that NCO and CDO add to
        LAC_TRY_RETURN(put_joined("history", date, ": ", of->command_line, put, to, err));
    }
    LAC_TRY_RETURN(lac_need_netcdf(err));
    (void)snprintf(version, sizeof version, "%s", nc_inq_libvers());
    version[strcspn(version, " ")] = '\0';
    (void)snprintf(netcdf, sizeof netcdf, "netCDF %s", version); // known only here
    LAC_TRY_RETURN(put_joined("libraries", of->libraries != NULL ? of->libraries : "", ", ", netcdf,
                              put, to, err));
    if (of->seed != INT64_MIN) {
        LAC_TRY_RETURN(put(to, "seed", NULL, (double)of->seed, true, err));
    }
    return LAC_OK;
}

lac_status lac_nc_put_attribute(void *to, const char *name, const char *text, double number,
                                bool whole, lac_error *err)
{
    return isnan(number) ? lac_nc_text(to, NC_GLOBAL, name, text, err)
                         : lac_nc_number(to, NC_GLOBAL, name, number, whole, err);
}

lac_status lac_recording_put_attribute(void *to, const char *name, const char *text, double number,
                                       bool whole, lac_error *err)
{
    char digits[32];
    (void)whole;
    (void)snprintf(digits, sizeof digits, "%.17g", number);
    text = isnan(number) ? text : digits;
    return text != NULL && *text != '\0' ? lac_recording_text(to, name, text, err) : LAC_OK;
}

lac_status lac_recording_sign(lac_recording *recording, const lac_provenance *provenance,
                              lac_error *err)
{
    return lac_provenance_put(provenance, NULL, lac_recording_put_attribute, recording, err);
}
