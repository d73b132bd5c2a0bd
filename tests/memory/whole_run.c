// SPDX-License-Identifier: GPL-3.0-or-later
#include "memory/whole_run.h"
#include "base/fail.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "fit/model_forecast.h"
#include "precursor/precursor.h"
#include "scene/scene_rg.h"
#include "simulation/simulation.h"
#include "support/contact_file.h"
#include "support/test.h"

static const char text[] =
    "lacuna: 1\n"
    "title: Everything at once\n"
    "interface:\n"
    "  size: \"16 m\"\n"
    "  levels: 3\n"
    "  surface: {self-affine: {hurst: 0.8, rms_height: \"2 cm\", shortest: \"4 m\"}}\n"
    "material: {shear_modulus: \"10 GPa\", density: \"2700 kg/m3\"}\n"
    "load:\n"
    "  normal: {pressure: \"5 MPa\"}\n"
    "  shear: [{ramp: {rate: \"1 kPa/day\"}}]\n"
    "  pore_pressure: [{constant: \"0.1 MPa\"}]\n"
    "friction:\n"
    "  composite: {a: 0.01, b: 0.015, dc: \"1 mm\", v1: 1, v2: 0.1, alpha: 0.2}\n"
    "  spread:\n"
    "    dc: [{lognormal: {sigma: 0.2}}, {size: {reference: \"1 m\"}}]\n"
    "    a: {uniform: {half_width: 0.1}}\n"
    "initial:\n"
    "  slip_rate: \"1 mm/day\"\n"
    "  state: {ratio_to_steady: 0.5}\n"
    "  spread: {slip_rate: {normal: {sigma: 0.1}}}\n"
    "transfer: {hierarchy: {stiffness: elastic}}\n"
    "time: {start: \"2020-01-01\", end: \"1 min\"}\n"
    "output: {every: \"20 s\", fields: [slip, traction], fields_every: \"30 s\"}\n"
    "analysis: {rg: {critical_fraction: 0.5}}\n"
    "compare: [{file: nowhere.csv, time: t, displacement: \"d:mm\"}]\n";

static lac_status store_run(const lac_case *c, const char *path, lac_error *err)
{
    lac_simulation *simulation = NULL;
    lac_store *store = NULL;
    lac_store_def def;
    lac_status status;
    LAC_TRY(lac_simulation_create(c, NULL, &simulation, err));
    LAC_TRY(lac_simulation_file(simulation, &def, err));
    def.path = path;
    def.force = true;
    def.sync_every = 10;
    LAC_TRY(lac_store_create(&def, &store, err));
    const lac_outcome *of = lac_simulation_outcome(simulation);
    const lac_sink sink = lac_store_sink(store);
    LAC_TRY(lac_simulation_run(simulation, &sink, err));
    LAC_TRY(lac_store_finish(store, of->status, &of->run, 1.0, err));
out:
    lac_store_free(store);
    lac_simulation_free(simulation);
    return status;
}

// Case to netCDF file.
lac_status whole_run(const char *path, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_case *c = NULL;
    lac_case_issues report = {0};
    const lac_override overrides[] = {{"solver.method", "bdf"}, {"friction.composite.f0", "0.6"}};
    const lac_case_request how = {.overrides = overrides, .count = 2};
    LAC_TRY(lac_case_read_text("case.yaml", text, sizeof text - 1, &how, &c, &report, err));
    LAC_TRY(store_run(c, path, err));
out:
    lac_case_free(c);
    lac_case_issues_clear(&report);
    return status;
}

// Case file to a dataset in memory.
lac_status whole_recording(const char *path, lac_error *err)
{
    const lac_override sets[] = {{"solver.method", "bdf"}, {"friction.composite.f0", "0.6"}};
    lac_case_options how = lac_case_options_default();
    lac_case *c = NULL;
    lac_simulation *simulation = NULL;
    lac_dataset *recording = NULL;
    lac_status status;
    FILE *file = fopen(path, "w");
    if (file == NULL || fputs(text, file) == EOF || fclose(file) != 0) {
        return lac_fail(err, LAC_EIO, "%s: not written", path);
    }
    how.overrides = sets;
    how.count = 2;
    LAC_TRY(lac_case_load(path, &how, &c, err));
    LAC_TRY(lac_simulation_create(c, NULL, &simulation, err));
    LAC_TRY(lac_simulation_record(simulation, &recording, err));
out:
    lac_dataset_free(recording);
    lac_simulation_free(simulation);
    lac_case_free(c);
    return status;
}

static const char begun[] = "lacuna: 1\n"
                            "load: {normal: {pressure: 5e6}, shear: [{ratio: {value: 0.55}}]}\n"
                            "friction: {aging: {f0: 0.6, a: 0.015, b: 0.01, dc: 1e-3, v0: 1e-6}}\n"
                            "initial: {state: 1e6}\n"
                            "time: {end: 1e5}\n"
                            "output: {fields: [slip, slip_rate, state], fields_every: 2e4}\n";
static const char source[] = "/tmp/lacuna-memory-branch.nc";

void branch_prepare(void)
{
    lac_error err = {""};
    lac_case *c = NULL;
    assert_int_equal(lac_case_parse("case.yaml", begun, sizeof begun - 1, NULL, &c, &err), LAC_OK);
    assert_int_equal(store_run(c, source, &err), LAC_OK);
    lac_case_free(c);
}

void branch_remove(void) { (void)unlink(source); }

lac_status whole_branch(const char *path, lac_error *err)
{
    const lac_override sets[] = {{"initial.run.file", source},
                                 {"initial.run.at", "5e4 s"},
                                 {"load.shear.0.ratio.value", "0.56"}};
    lac_case_options how = lac_case_options_default();
    lac_case *c = NULL;
    lac_status status;
    how.overrides = sets;
    how.count = 3;
    LAC_TRY(lac_case_parse("case.yaml", begun, sizeof begun - 1, &how, &c, err));
    LAC_TRY(store_run(c, path, err));
out:
    lac_case_free(c);
    return status;
}

static const char measured[] =
    "lacuna: 1\n"
    "interface: {size: 1, levels: 4, surface: {self-affine: {rms_height: 0.001}}}\n"
    "material: {shear_modulus: 1e9, poisson: 0.2}\n"
    "load: {normal: {pressure: 1e6}}\n";

// Case to netCDF file, through a contact and all that is measured of it.
lac_status whole_contact(const char *path, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_case *c = NULL;
    lac_case_issues report = {0};
    lac_scene_contact contact = {0};
    const lac_case_request ask = {.purpose = LAC_FOR_CONTACT};
    lac_scene_measure_def how = lac_scene_measure_default();
    how.scaling.coarsest = 2;
    how.boxes.largest = 4;
    LAC_TRY(lac_case_read_text("case.yaml", measured, sizeof measured - 1, &ask, &c, &report, err));
    LAC_TRY(lac_scene_contact_solve(c, LAC_SCENE_MEASURED, &contact, err));
    LAC_TRY(lac_scene_contact_measure(&how, &contact, err));
    assert_true(contact.counted && contact.fractal.clustered && contact.fractal.scaled);
    LAC_TRY(contact_file(&contact, path, true, NULL, err));
out:
    lac_scene_contact_clear(&contact);
    lac_case_free(c);
    lac_case_issues_clear(&report);
    return status;
}

static const char stopped[] =
    "lacuna: 1\n"
    "interface: {size: 1, levels: 2, domain: {file: {path: cells.asc, pressures: scaled}}}\n"
    "material: {shear_modulus: 1e9}\n"
    "load: {normal: {pressure: 1e6}, shear: [{spring: {stiffness: 1e9, speed: 1e-6}}]}\n"
    "friction: {aging: {a: 0.01, b: 0.015, dc: 1e-5}}\n"
    "initial: {slip_rate: 1e-6, state: 9}\n"
    "transfer: {hierarchy: {k0: 1e9}}\n"
    "time: {end: 0.5}\n"
    "analysis: {events: {slip_rate: 1e-8}, rg: {critical_fraction: 0.5}}\n"
    "output: {every: {steps: 2}, checkpoint: {steps: 8}, fields: [slip], fields_every: 0.3}\n";

// The linker sends the library's calls here: what is stored need not outlast a loss of power.
int __wrap_fsync(int fd);

int __wrap_fsync(int fd)
{
    (void)fd;
    return 0;
}

// Stops a run at the step that it counts down to.
static bool stop(void *context)
{
    int *left = context;
    return --*left <= 0;
}

// A part of the run of `stopped`: to a stop, or from its checkpoint to the end.
static lac_status run_part(const lac_case *c, const char *path, int left, lac_error *err)
{
    lac_simulation *simulation = NULL;
    lac_store *store = NULL;
    lac_store_def def;
    lac_checkpoint_file kept = {0};
    lac_simulation_options options = lac_simulation_options_default();
    lac_status status;
    const bool resumes = left == INT_MAX;
    options.interrupted = stop;
    options.context = &left;
    LAC_TRY(lac_simulation_create(c, &options, &simulation, err));
    LAC_TRY(lac_simulation_file(simulation, &def, err));
    def.path = path;
    def.force = !resumes;
    def.provenance.case_text = "case";
    def.provenance.libraries = "these";
    def.inputs = "cells.asc";
    if (resumes) {
        LAC_TRY(lac_checkpoint_file_read(path, &kept, err));
        def.resume = &kept;
        lac_simulation_resume(simulation, &kept.from);
    }
    LAC_TRY(lac_store_create(&def, &store, err));
    const lac_outcome *of = lac_simulation_outcome(simulation);
    const lac_sink sink = lac_store_sink(store);
    const lac_status ran = lac_simulation_run(simulation, &sink, err);
    status = ran;
    if (ran == LAC_OK || ran == LAC_EINTERRUPT) {
        LAC_TRY(lac_store_finish(store, of->status, &of->run, 1.0, err));
        status = ran;
    }
out:
    lac_store_free(store);
    lac_checkpoint_file_clear(&kept);
    lac_simulation_free(simulation);
    return status;
}

// Cells of a file to a run, left at the path, that is stopped amid its events, and on from its
// checkpoint.
lac_status whole_resumed(const char *path, lac_error *err)
{
    char cells[64], out[64];
    lac_status status = LAC_OK;
    lac_case *c = NULL;
    lac_case_issues report = {0};
    (void)snprintf(cells, sizeof cells, "%s.asc", path);
    (void)snprintf(out, sizeof out, "%s.nc", path);
    const lac_override given = {"interface.domain.file.path", cells};
    const lac_case_request how = {.overrides = &given, .count = 1};
    FILE *file = fopen(cells, "w");
    assert_non_null(file);
    (void)fputs("ncols 4\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 0.25\n"
                "1 1 0 0\n2 1 0 0\n0 0 3 0\n0 1 1 1\n",
                file);
    (void)fclose(file);
    LAC_TRY(lac_case_read_text("case.yaml", stopped, sizeof stopped - 1, &how, &c, &report, err));
    status = run_part(c, out, 10, err);
    if (status == LAC_EINTERRUPT) {
        LAC_TRY(run_part(c, out, INT_MAX, err));
    }
out:
    lac_case_free(c);
    lac_case_issues_clear(&report);
    (void)unlink(cells);
    (void)rename(out, path);
    (void)snprintf(out, sizeof out, "%s.nc.checkpoint", path);
    (void)unlink(out);
    return status;
}
