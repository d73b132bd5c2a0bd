// SPDX-License-Identifier: GPL-3.0-or-later
// Whatever calls lead to an allocation of a whole run, it fails: each time the error is said, and
// nothing leaks (under sanitizers) or crashes.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/fail.h"
#include "fit/model_forecast.h"
#include "lacuna/contact.h"
#include "memory/failing_malloc.h"
#include "memory/forecast.h"
#include "memory/report.h"
#include "memory/trade.h"
#include "memory/whole_run.h"
#include "precursor/precursor.h"
#include "scene/scene_rg.h"
#include "simulation/simulation.h"
#include "support/contact_file.h"
#include "support/test.h"

// A joint of 8 x 8 cells, pressed and sheared in every way
static lac_status whole_shear(const char *path, lac_error *err)
{
    double heights[64];
    double pressure[64];
    lac_status status = LAC_OK;
    lac_tangential *t = NULL;
    lac_first_slip first;
    const double load[2] = {1e-4, 1e-4};
    const lac_tangential_target target = {{LAC_SHEAR_LOAD, LAC_SHEAR_SHIFT}, {1e-4, 1e-4}};
    lac_contact_def normal = lac_contact_default();
    lac_tangential_def def = lac_tangential_default();
    (void)path;
    for (size_t i = 0; i < 64; i++) {
        heights[i] = 1e-3 * (double)(i * i % 17);
    }
    normal.heights = heights;
    def.e_star = normal.e_star = 1.0;
    def.poisson = 0.25;
    def.friction = 0.5;
    normal.mean_pressure = 1e-2;
    for (int periodic = 0; periodic < 2; periodic++) {
        def.grid = normal.grid = (lac_grid){8, 8, 0.125, 0.125, periodic == 1};
        lac_tangential_free(t);
        t = NULL;
        LAC_TRY(lac_contact_solve(&normal, pressure, NULL, NULL, err));
        LAC_TRY(lac_tangential_create(&def, &t, err));
        LAC_TRY(lac_tangential_step(t, pressure, &target, NULL, err));
        LAC_TRY(lac_tangential_first_slip(&def, pressure, load, &first, err));
    }
out:
    lac_tangential_free(t);
    return status;
}

static const char sheared[] =
    "lacuna: 1\n"
    "interface: {size: 1, levels: 4, surface: {self-affine: {rms_height: 0.001}}}\n"
    "material: {shear_modulus: 1e9, poisson: 0.2}\n"
    "load:\n"
    "  normal: {pressure: 1e6}\n"
    "  history: {friction: 0.5, steps: [{ratio_x: 0.5}, {pressure: 8e5}, {shift_y: 1e-4}]}\n";

static lac_status put_step(void *context, const lac_history_record *record, lac_error *err)
{
    return lac_history_store_step(context, record, err);
}

static lac_status put_maps(void *context, const lac_history_maps *maps, lac_error *err)
{
    return lac_history_store_maps(context, maps, err);
}

static lac_status store_history(const lac_case *c, const lac_scene_contact *contact,
                                const char *path, lac_error *err)
{
    lac_history_store *store = NULL;
    lac_dataset *dataset = NULL;
    lac_status status = LAC_OK;
    lac_history_result result = {0};
    const lac_contact_outcome outcome = {
        .contact = contact, .friction = c->history.friction, .result = &result};
    LAC_TRY(lac_contact_describe(&outcome, &dataset, err));
    const lac_history_store_def def = {.path = path,
                                       .force = true,
                                       .provenance = {.title = "sheared", .seed = 1},
                                       .contact = dataset,
                                       .keep = LAC_KEEP_ALL,
                                       .pressed = true};
    LAC_TRY(lac_history_store_create(&def, &store, err));
    const lac_history_sink sink = {.context = store, .step = put_step, .maps = put_maps};
    LAC_TRY(lac_scene_history_run(c, contact, &sink, &result, err));
    LAC_TRY(lac_history_store_finish(store, "complete", err));
out:
    lac_history_store_free(store);
    lac_dataset_free(dataset);
    return status;
}

// Case to netCDF file, through a history of loads.
static lac_status whole_history(const char *path, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_case *c = NULL;
    lac_case_issues report = {0};
    lac_scene_contact contact = {0};
    const lac_case_request how = {.purpose = LAC_FOR_CONTACT};
    LAC_TRY(lac_case_read_text("case.yaml", sheared, sizeof sheared - 1, &how, &c, &report, err));
    LAC_TRY(lac_scene_contact_solve(c, LAC_SCENE_MEASURED, &contact, err));
    LAC_TRY(store_history(c, &contact, path, err));
out:
    lac_scene_contact_clear(&contact);
    lac_case_free(c);
    lac_case_issues_clear(&report);
    return status;
}

// The same in memory, by one call.
static lac_status computed_history(const char *path, lac_error *err)
{
    lac_status status;
    lac_case *c = NULL;
    lac_dataset *dataset = NULL;
    lac_case_options how = lac_case_options_default();
    (void)path;
    how.purpose = LAC_FOR_CONTACT;
    LAC_TRY(lac_case_parse("case.yaml", sheared, sizeof sheared - 1, &how, &c, err));
    LAC_TRY(lac_contact_compute(c, NULL, &dataset, err));
out:
    lac_dataset_free(dataset);
    lac_case_free(c);
    return status;
}

static const char cascading[] =
    "lacuna: 1\n"
    "interface: {size: 1, levels: 3, surface: {self-affine: {rms_height: 0.001}}}\n"
    "material: {shear_modulus: 1e9, poisson: 0.2}\n"
    "load: {normal: {pressure: 1e6}}\n"
    "rg: {friction: 0.6, shifts: 2, loads: 10, beta: [0.7]}\n";

// Case to netCDF file, through a cascade.
static lac_status whole_cascade(const char *path, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_case *c = NULL;
    lac_case_issues report = {0};
    lac_scene_rg rg = {0};
    lac_dataset *dataset = NULL;
    const lac_case_request how = {.purpose = LAC_FOR_RG};
    const lac_provenance provenance = {.title = "cascading", .seed = 1};
    LAC_TRY(
        lac_case_read_text("case.yaml", cascading, sizeof cascading - 1, &how, &c, &report, err));
    LAC_TRY(lac_scene_rg_run(c, NULL, &rg, err));
    const lac_rg_outcome outcome = {.source = c, .rg = &rg};
    LAC_TRY(lac_scene_rg_describe(&outcome, &dataset, err));
    LAC_TRY(lac_store_dataset(path, true, &provenance, dataset, err));
out:
    lac_dataset_free(dataset);
    lac_scene_rg_clear(&rg);
    lac_case_free(c);
    lac_case_issues_clear(&report);
    return status;
}

static const char pulled[] = "lacuna: 1\n"
                             "interface: {size: 1, levels: 1, domain: {full: {}}}\n"
                             "load: {normal: {pressure: 1e6}}\n"
                             "friction: {aging: {a: 0.01, b: 0.015, dc: 0.001}}\n"
                             "initial: {slip_rate: 1e-6, state: {ratio_to_steady: 0.5}}\n"
                             "transfer: {hierarchy: {k0: 1e9}}\n"
                             "time: {end: 10}\n";

// A run of each formulation and method that the others leave out.
static lac_status whole_formulations(const char *path, lac_error *err)
{
    static const int choices[][2] = {{LAC_FORMULATION_SLIP, LAC_ERK},
                                     {LAC_FORMULATION_SLIP, LAC_BDF},
                                     {LAC_FORMULATION_TRACTION, LAC_ADAMS}};
    lac_status status = LAC_OK;
    lac_case *c = NULL;
    lac_scene *scene = NULL;
    lac_case_issues report = {0};
    lac_run_result result;
    (void)path;
    LAC_TRY(lac_case_read_text("case.yaml", pulled, sizeof pulled - 1, NULL, &c, &report, err));
    c->run.projection = 1;
    for (size_t i = 0; i < sizeof choices / sizeof choices[0]; i++) {
        c->formulation = choices[i][0];
        c->run.method = (lac_method)choices[i][1];
        LAC_TRY(lac_scene_create(c, NULL, &scene, err));
        LAC_TRY(lac_run(scene->problem, &c->run, NULL, &result, err));
        lac_scene_free(scene);
        scene = NULL;
    }
out:
    lac_scene_free(scene);
    lac_case_free(c);
    lac_case_issues_clear(&report);
    return status;
}

// A file's cells, and the cascade on them.
static lac_status whole_stored_cascade(const char *path, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_case *c = NULL;
    lac_case_issues report = {0};
    lac_scene_contact contact = {0};
    lac_stored_cells cells = {0};
    lac_domain *domain = NULL;
    lac_scene_rg rg = {0};
    const lac_case_request how = {.purpose = LAC_FOR_CELLS};
    const lac_snapshot_choice last = {0};
    LAC_TRY(
        lac_case_read_text("case.yaml", cascading, sizeof cascading - 1, &how, &c, &report, err));
    LAC_TRY(lac_scene_contact_solve(c, LAC_SCENE_MEASURED, &contact, err));
    LAC_TRY(contact_file(&contact, path, true, cascading, err));
    LAC_TRY(lac_stored_cells_read(path, &last, &cells, err));
    LAC_TRY(lac_stored_domain_read(path, &domain, err));
    const lac_rg_cells given = {cells.domain, cells.shear, cells.time};
    LAC_TRY(lac_scene_rg_cells(c, &given, &rg, err));
out:
    lac_scene_rg_clear(&rg);
    lac_stored_cells_clear(&cells);
    lac_domain_free(domain);
    lac_scene_contact_clear(&contact);
    lac_case_free(c);
    lac_case_issues_clear(&report);
    return status;
}

static const char dense[] =
    "lacuna: 1\n"
    "interface: {size: 1, levels: 2, surface: {self-affine: {rms_height: 0.001}}}\n"
    "material: {shear_modulus: 1e9, poisson: 0.2}\n"
    "load: {normal: {dimension: 1.5}}\n";

// Case to contact, at the load that gives it a dimension.
static lac_status whole_dimension(const char *path, lac_error *err)
{
    (void)path;
    lac_status status = LAC_OK;
    lac_case *c = NULL;
    lac_case_issues report = {0};
    lac_scene_contact contact = {0};
    const lac_case_request how = {.purpose = LAC_FOR_CONTACT};
    LAC_TRY(lac_case_read_text("case.yaml", dense, sizeof dense - 1, &how, &c, &report, err));
    LAC_TRY(lac_scene_contact_solve(c, LAC_SCENE_DOMAIN, &contact, err));
out:
    lac_scene_contact_clear(&contact);
    lac_case_free(c);
    lac_case_issues_clear(&report);
    return status;
}

static const char wet[] =
    "lacuna: 1\n"
    "load:\n"
    "  normal: {pressure: 1e9}\n"
    "  shear: [{series: {file: wet.csv, time: t, value: v, interpolation: smooth}}, {ratio: 0.5}]\n"
    "  pore_pressure:\n"
    "    - {rain: {file: wet.csv, time: t, rain: v, rise: 1, drain: 2}}\n"
    "    - {reservoir: {file: wet.csv, time: t, level: v, elevation: 1, distance: 1, diffusivity: "
    "1}}\n"
    "friction: {aging: {a: 0.01, b: 0.015, dc: \"1 mm\"}}\n"
    "initial: {state: steady}\n"
    "time: {end: 5}\n";

// Case to loads made ready, from a file.
static lac_status whole_loads(const char *path, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_case *c = NULL;
    lac_case_issues report = {0};
    lac_load_set loads = {0};
    const lac_override overrides[] = {{"load.shear.0.series.file", path},
                                      {"load.pore_pressure.0.rain.file", path},
                                      {"load.pore_pressure.1.reservoir.file", path}};
    const lac_case_request how = {.overrides = overrides, .count = 3};
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    (void)fputs("t,v\n-1,2\n1,0\n2,3\n9,4\n", file);
    (void)fclose(file);
    LAC_TRY(lac_case_read_text("case.yaml", wet, sizeof wet - 1, &how, &c, &report, err));
    LAC_TRY(lac_load_set_create(&(lac_load_models){.shear = c->shear.item,
                                                   .shear_count = c->shear.count,
                                                   .pore = c->pore.item,
                                                   .pore_count = c->pore.count},
                                &(lac_load_clock){.end = c->run.end}, &loads, err));
out:
    lac_load_set_clear(&loads);
    lac_case_free(c);
    lac_case_issues_clear(&report);
    return status;
}

static const char loaded[] =
    "lacuna: 1\n"
    "interface: {size: 1, levels: 3, shape: line, boundary: free, domain: {full: {}}}\n"
    "material: {shear_modulus: 1e9, poisson: 0.2}\n"
    "load: {normal: {pressure: 1e6}, shear: [{back-slip: 1e-9}, {ramp: {rate: 1, share: "
    "elastic}}]}\n"
    "friction: {aging: {a: 0.01, b: 0.015, dc: 1e-3}}\n"
    "initial: {slip_rate: 1e-9, state: 1e5}\n"
    "transfer: {elastic: {outside: creeping}}\n"
    "time: {end: 10}\n";

// Case to the start of a run, through the elastic transfer.
static lac_status whole_elastic(const char *path, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_case *c = NULL;
    lac_scene *scene = NULL;
    lac_case_issues report = {0};
    const lac_case_request how = {.purpose = LAC_FOR_RUN};
    (void)path;
    LAC_TRY(lac_case_read_text("case.yaml", loaded, sizeof loaded - 1, &how, &c, &report, err));
    LAC_TRY(lac_scene_create(c, NULL, &scene, err));
out:
    lac_scene_free(scene);
    lac_case_free(c);
    lac_case_issues_clear(&report);
    return status;
}

static void every_allocation_fails(lac_status (*whole)(const char *path, lac_error *err),
                                   bool for_good)
{
    char path[] = "/tmp/lacuna-memory-XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    (void)close(fd);
    (void)unlink(path); // as it is after a run that failed
    lac_error all_well;
    watch_allocations();
    assert_int_equal(whole(path, &all_well), LAC_OK);
    const long all = allocations_watched();
    (void)unlink(path);
    long failed = 0;
    for (long k = 0;; k++) {
        // Where all that follow fail, what frees is what freed after the one: every third is looked
        // at.
        if (!allocation_counts(k, !for_good) || (for_good && k % 3 != 0)) {
            continue;
        }
        lac_error err = {""};
        fail_allocation(k, for_good);
        lac_status status = whole(path, &err);
        if (!stop_failing()) {
            assert_int_equal(status, LAC_OK);
            break;
        }
        failed++;
        if (status != LAC_ENOMEM || strstr(err.message, "memory") == NULL) {
            fail_msg("allocation %ld: status %d, \"%s\"", k, (int)status, err.message);
        }
    }
    printf("%ld of %ld allocations failed, one by one%s\n", failed, all,
           for_good ? " and all that follow" : "");
    assert_true(failed > (for_good ? 6 : 20));
    (void)unlink(path);
}

static void one_fails(void **state)
{
    (void)state;
    every_allocation_fails(whole_run, false);
    every_allocation_fails(whole_recording, false);
    every_allocation_fails(whole_contact, false);
    every_allocation_fails(whole_resumed, false);
    every_allocation_fails(whole_shear, false);
    every_allocation_fails(whole_history, false);
    every_allocation_fails(computed_history, false);
    every_allocation_fails(whole_cascade, false);
    every_allocation_fails(whole_formulations, false);
    every_allocation_fails(whole_stored_cascade, false);
    every_allocation_fails(whole_elastic, false);
    every_allocation_fails(whole_dimension, false);
    every_allocation_fails(whole_loads, false);
    every_allocation_fails(whole_forecast, false);
    every_allocation_fails(whole_trade, false);
    every_allocation_fails(whole_accuracy, false);
}

static void all_fail_from_one_on(void **state)
{
    (void)state;
    every_allocation_fails(whole_run, true);
    every_allocation_fails(whole_contact, true);
    every_allocation_fails(whole_resumed, true);
    every_allocation_fails(whole_shear, true);
    every_allocation_fails(whole_history, true);
    every_allocation_fails(whole_cascade, true);
    every_allocation_fails(whole_formulations, true);
    every_allocation_fails(whole_stored_cascade, true);
    every_allocation_fails(whole_elastic, true);
    every_allocation_fails(whole_dimension, true);
    every_allocation_fails(whole_loads, true);
    every_allocation_fails(whole_forecast, true);
    every_allocation_fails(whole_trade, true);
    every_allocation_fails(whole_accuracy, true);
}

static void a_page_fails(void **state)
{
    (void)state;
    report_prepare();
    every_allocation_fails(whole_report, false);
    every_allocation_fails(whole_report, true);
    every_allocation_fails(whole_live, false);
    every_allocation_fails(whole_live, true);
    report_remove();
}

static void a_branch_fails(void **state)
{
    (void)state;
    branch_prepare();
    every_allocation_fails(whole_branch, false);
    every_allocation_fails(whole_branch, true);
    branch_remove();
}

static void a_record_fails(void **state)
{
    (void)state;
    recording_stays_whole();
    recording_is_handed_on_whole();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_page_fails),         cmocka_unit_test(a_record_fails),
        cmocka_unit_test(a_branch_fails),       cmocka_unit_test(one_fails),
        cmocka_unit_test(all_fail_from_one_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
