// SPDX-License-Identifier: GPL-3.0-or-later
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "cli/command.h"
#include "cli/fractal.h"
#include "cli/libraries.h"
#include "cli/measures.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "cli/run_outcome.h"
#include "cli/signals.h"
#include "cli/surface.h"
#include "cli/words.h"

static lac_status write_file(const cli_request *request, const lac_case *c,
                             const lac_scene_contact *contact, const char *path, lac_error *err)
{
    char libraries[256], *case_text = lac_case_text(c);
    if (case_text == NULL) {
        return lac_fail_memory(err);
    }
    lac_provenance provenance =
        cli_provenance(request, c, case_text, cli_libraries(libraries, sizeof libraries));
    const lac_scene_fractal *f = &contact->fractal;
    const lac_contact_view view = {.grid = &contact->grid,
                                   .heights = contact->heights,
                                   .gap = contact->gap,
                                   .pressure = contact->pressure,
                                   .report = contact->solved ? &contact->report : NULL,
                                   .boxes = contact->counted ? &contact->boxes : NULL,
                                   .clusters = f->clustered ? &f->clusters : NULL,
                                   .scaling = f->scaled ? &f->scaling : NULL,
                                   .sizes = f->sizes,
                                   .size = f->size,
                                   .surface = contact->solved ? &contact->surface : NULL};
    cli_signals_hold();
    lac_status status =
        lac_store_contact(path, cli_given(request, CLI_OPT_FORCE), &provenance, &view, err);
    free(case_text);
    return status;
}

static void print_result(const lac_case *c, const lac_scene_contact *contact, const char *path)
{
    const lac_contact_report *report = &contact->report;
    char cpu[32];
    if (c->title != NULL) {
        puts(c->title);
    }
    if (contact->solved) {
        cli_surface_print(&contact->surface);
    }
    cli_row_quantity("nominal pressure", contact->mean_pressure, "Pa");
    cli_measures_print(contact);
    cli_fractal_print(contact);
    if (contact->solved) {
        cli_row("iterations", "%" PRId64 " (%" PRId64 " elastic products)", report->iterations,
                report->products);
        cli_row("complementarity", "%.2g", report->complementarity_error);
        cli_row_quantity("penetration", fabs(report->penetration), "m");
        cli_row_quantity("approach", report->approach, "m");
    }
    cli_row("time taken", "CPU %s", cli_quantity(cli_cpu_time(), "s", cpu, sizeof cpu));
    cli_row("file", "%s", path);
}

static void write_result(const lac_scene_contact *contact, const char *path)
{
    const lac_contact_report *report = &contact->report;
    cli_json json = {.out = stdout};
    cli_json_open(&json, NULL, '{');
    cli_measures_json(&json, contact);
    cli_surface_json(&json, contact->solved ? &contact->surface : NULL);
    cli_json_number(&json, "mean_pressure_Pa", contact->mean_pressure);
    if (contact->solved) {
        cli_json_integer(&json, "iterations", report->iterations);
        cli_json_integer(&json, "products", report->products);
    } else {
        cli_json_null(&json, "iterations");
        cli_json_null(&json, "products");
    }
    cli_json_number(&json, "complementarity_error",
                    contact->solved ? report->complementarity_error : NAN);
    cli_json_number(&json, "penetration_m", contact->solved ? fabs(report->penetration) : NAN);
    cli_json_number(&json, "approach_m", contact->solved ? report->approach : NAN);
    cli_fractal_json(&json, contact);
    cli_json_number(&json, "cpu_time_s", cli_cpu_time());
    cli_json_text(&json, "output", path);
    cli_json_close(&json, '}');
}

lac_status cli_contact(const cli_request *request, lac_error *err)
{
    lac_case *c = NULL;
    lac_scene_contact contact = {0};
    lac_scene_measure_def measure;
    char *path = NULL;
    lac_status status;
    LAC_TRY(cli_fractal_read(request, &measure, err));
    LAC_TRY(cli_case_read(request, LAC_FOR_CONTACT, &c, NULL, err));
    LAC_TRY(cli_output_path(request, c, NULL, "-contact.nc", &path, err));
    cli_say(request, "solving the contact of %s", request->argument[0]);
    LAC_TRY(cli_blame(c, lac_scene_contact_solve(c, true, &contact, err), err));
    LAC_TRY(cli_blame(c, lac_scene_contact_measure(&measure, &contact, err), err));
    LAC_TRY(write_file(request, c, &contact, path, err));
    if (cli_given(request, CLI_OPT_JSON)) {
        write_result(&contact, path);
    } else {
        print_result(c, &contact, path);
        if (cli_given(request, CLI_OPT_VERBOSE)) {
            cli_fractal_tables(&contact);
        }
    }
out:
    lac_scene_contact_clear(&contact);
    lac_case_free(c);
    free(path);
    return status;
}
