// SPDX-License-Identifier: GPL-3.0-or-later
// The motion at a run's points in the text format in which the earthquake-cycle community compares
// its codes (SEAS benchmarks): a file for each station, columns between blanks.
#include "cli/export/export.h"
#include "scene/scene.h"

enum { LONGEST_CASE = 1 << 20 };

static const char *const columns[] = {
    "time", "point_slip", "point_slip_rate", "point_traction", "point_state", "point_x", "point_y"};

// The stress of the format is what friction holds: radiation damping is taken off the traction,
// which must be that of full contact without mass. @param eta  of it [Pa s/m]
static lac_status find_damping(const lac_stored_file *file, double *eta, lac_error *err)
{
    const lac_case_request how = {.purpose = LAC_FOR_CELLS};
    lac_case *c = NULL;
    char *text = malloc(LONGEST_CASE);
    lac_status status;
    LAC_TRY(text != NULL ? LAC_OK : lac_fail_memory(err));
    (void)lac_stored_file_text(file, NULL, "case", text, LONGEST_CASE);
    LAC_TRY(lac_case_read_text("the file's case", text, strlen(text), &how, &c, NULL, err));
    const lac_domain_source *domain = (const void *)c->domain.info;
    const bool full = c->surface.info == NULL && (domain == NULL || domain->full);
    status = full && lac_inertia_mass(c) == 0.0
                 ? LAC_OK
                 : lac_fail(err, LAC_EINPUT,
                            "--stations: needs full contact and no inertia, where friction is the "
                            "traction without radiation damping");
    *eta = lac_damping_of(&c->material);
out:
    lac_case_free(c);
    free(text);
    return status;
}

lac_status cli_stations_read(const cli_tables *e, cli_stations *s, lac_error *err)
{
    lac_stored_shape shape;
    for (size_t i = 0; i < e->count; i++) {
        const bool turns = strcmp(e->variable[i].name, "point_slip_x") == 0;
        LAC_FAIL_IF(turns, err, LAC_EINPUT, "--stations: slip in two directions has no column");
    }
    for (size_t k = 0; k < CLI_STATION_VALUES; k++) {
        LAC_TRY_RETURN(lac_stored_file_values(e->file, columns[k], &s->value[k], err));
        LAC_FAIL_IF(s->value[k].value == NULL, err, LAC_EINPUT,
                    "--stations: the file has no %s: name places in output.points", columns[k]);
    }
    LAC_TRY_RETURN(lac_stored_file_shape(e->file, "point_name", &shape, err));
    LAC_TRY_RETURN(lac_stored_file_texts(e->file, "point_name", &shape, &s->name, err));
    s->count = shape.count;
    for (size_t i = 0; i < s->count; i++) {
        LAC_FAIL_IF(strchr(s->name[i], '/') != NULL, err, LAC_EINPUT,
                    "--stations: \"%s\" is no name of a file", s->name[i]);
    }
    return find_damping(e->file, &s->eta, err);
}

void cli_stations_clear(cli_stations *s)
{
    for (size_t k = 0; k < CLI_STATION_VALUES; k++) {
        lac_stored_values_clear(&s->value[k]);
    }
    free((void *)s->name);
}

void cli_stations_write(const cli_tables *e, const cli_stations *s, size_t which, FILE *out)
{
    char title[600], source[100];
    (void)lac_stored_file_text(e->file, NULL, "title", title, sizeof title);
    (void)lac_stored_file_text(e->file, NULL, "source", source, sizeof source);
    (void)fprintf(out,
                  "# problem=%s\n# code=%s\n# element_size=%g m\n# station=%s, x %g m, y %g m\n"
                  "# Column #1 = Time (s)\n# Column #2 = Slip (m)\n"
                  "# Column #3 = Slip rate (log10 m/s)\n# Column #4 = Shear stress (MPa)\n"
                  "# Column #5 = State (log10 s)\nt slip slip_rate shear_stress state\n",
                  title, source, lac_stored_file_number(e->file, NULL, "grid_dx_m"), s->name[which],
                  s->value[5].value[which], s->value[6].value[which]);
    for (size_t row = 0; row < s->value[0].n; row++) {
        const size_t at = row * s->count + which;
        const double rate = s->value[2].value[at];
        (void)fprintf(out, "%.14E %.9E %.9E %.9E %.9E\n", s->value[0].value[row],
                      s->value[1].value[at], log10(fabs(rate)),
                      1e-6 * (s->value[3].value[at] - s->eta * rate), log10(s->value[4].value[at]));
    }
}
