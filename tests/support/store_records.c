// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/store_records.h"
#include "base/fail.h"
#include "lacuna/simulation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "store/store_file.h"

lac_record record_of(size_t i)
{
    double x = (double)i;
    return (lac_record){.time_origin = 1000.0 * floor(x / 10.0),
                        .time_local = fmod(x, 10.0) * 1e-9 + 0.125,
                        .observation = {.mean_rate = 1e-9 * (x + 1.0),
                                        .max_rate = 1e-8 * (x + 1.0),
                                        .mean_slip = 1e-6 * x,
                                        .shear_force = 6e9 + x,
                                        .normal_force = 1e10 + 2.0 * x,
                                        .effective_force = 9e9 + x,
                                        .balance_residual = 1e-12 * x},
                        .step_size = i == 0 ? NAN : 0.5 * x,
                        .order = i == 0 ? 0 : 1 + (int64_t)(i % 5),
                        .rhs_evaluations = (int64_t)i * 3 + 5000000000};
}

lac_store_def store_def(const char *path)
{
    return (lac_store_def){.path = path,
                           .provenance = {.title = "A joint",
                                          .case_text = "lacuna: 1\ntitle: A joint\n",
                                          .command_line = "lacuna run joint.yaml",
                                          .libraries = "SUNDIALS 6.4.1",
                                          .seed = -3,
                                          .now = 1e9},
                           .of = {.dated = true, .start_date = -205286400.0},
                           .compression = 1,
                           .sync_every = 100};
}

lac_run_result run_result(void)
{
    return (lac_run_result){.end = LAC_END_FAILURE,
                            .failed = true,
                            .failure_origin = 8640000.0,
                            .failure_local = 0.75,
                            .time = 8640000.75,
                            .steps = 1234,
                            .rhs_evaluations = 2000,
                            .max_slip_rate = 3.0,
                            .mean_slip = 1.5,
                            .balance_residual = 1e-7};
}

typedef double value_of(const lac_record *r);

static double v_time(const lac_record *r) { return r->time_origin + r->time_local; }
static double v_origin(const lac_record *r) { return r->time_origin; }
static double v_local(const lac_record *r) { return r->time_local; }
static double v_slip(const lac_record *r) { return r->observation.mean_slip; }
static double v_rate(const lac_record *r) { return r->observation.mean_rate; }
static double v_max(const lac_record *r) { return r->observation.max_rate; }
static double v_shear(const lac_record *r) { return r->observation.shear_force; }
static double v_normal(const lac_record *r) { return r->observation.normal_force; }
static double v_effective(const lac_record *r) { return r->observation.effective_force; }
static double v_friction(const lac_record *r)
{
    return r->observation.shear_force / r->observation.normal_force;
}
static double v_residual(const lac_record *r) { return r->observation.balance_residual; }
static double v_step(const lac_record *r) { return r->step_size; }
static double v_order(const lac_record *r) { return r->order > 0 ? (double)r->order : NAN; }
static double v_rhs(const lac_record *r) { return (double)r->rhs_evaluations; }

static const struct {
    const char *name;
    value_of *value;
} variables[] = {
    {"time", v_time},
    {"time_origin", v_origin},
    {"time_local", v_local},
    {"slip", v_slip},
    {"slip_rate", v_rate},
    {"max_slip_rate", v_max},
    {"shear_force", v_shear},
    {"normal_force", v_normal},
    {"effective_normal_force", v_effective},
    {"apparent_friction", v_friction},
    {"balance_residual", v_residual},
    {"step_size", v_step},
    {"order", v_order},
    {"rhs_evaluations", v_rhs},
};

lac_status read_over_time(const char *path, const char *variable, double **values, size_t *n,
                          lac_error *err)
{
    lac_stored_file *file = NULL;
    lac_stored_values read = {0};
    lac_status status;
    LAC_TRY(lac_stored_file_open(path, &file, err));
    LAC_TRY(lac_stored_file_series(file, variable, &read, err));
out:
    lac_stored_file_close(file);
    *values = read.value;
    *n = read.n;
    return status;
}

lac_status check_records(const char *path, size_t *n, lac_error *err)
{
    for (size_t v = 0; v < sizeof variables / sizeof variables[0]; v++) {
        double *values = NULL;
        lac_status status = read_over_time(path, variables[v].name, &values, n, err);
        if (status != LAC_OK) {
            return status;
        }
        for (size_t i = 0; i < *n; i++) {
            lac_record record = record_of(i);
            double expected = variables[v].value(&record);
            bool same = values[i] == expected || (isnan(values[i]) && isnan(expected));
            if (!same && status == LAC_OK) {
                status = lac_fail(err, LAC_ENUMERIC, "%s[%zu] is %.17g, not %.17g",
                                  variables[v].name, i, values[i], expected);
            }
        }
        free(values);
        if (status != LAC_OK) {
            return status;
        }
    }
    return LAC_OK;
}
