// SPDX-License-Identifier: GPL-3.0-or-later
// Loads that read files: against closed forms, and what is refused.

#include <gsl/gsl_integration.h>
#include <math.h>
#include <netcdf.h>
#include <stdlib.h>
#include <string.h>

#include "load/load.h"
#include "support/scratch.h"
#include "support/slot.h"
#include "support/test.h"

static scratch folder;

static const lac_load_kind *named(const char *name, bool is_pore)
{
    const lac_load_kind *kind = NULL;
    size_t i = 0;
    do {
        kind = is_pore ? lac_pore_load_get(i) : lac_shear_load_get(i);
        i++;
    } while (kind != NULL && strcmp(kind->info.name, name) != 0);
    assert_non_null(kind);
    return kind;
}

static void set_text(lac_model *model, const char *key, const char *text)
{
    for (size_t i = 0; i < model->info->param_count; i++) {
        const lac_param *param = &model->info->params[i];
        if (strcmp(param->key, key) == 0) {
            char *copy = strdup(text);
            memcpy((char *)model->params + param->offset, &copy, sizeof copy);
            return;
        }
    }
    fail_msg("no parameter %s", key);
}

// A model over the file `csv`; `column` is the key that names the column.
static lac_model slot_over(const char *name, bool is_pore, const char *csv, const char *column,
                           const char *value)
{
    lac_model model;
    assert_int_equal(lac_model_create(&named(name, is_pore)->info, &model, NULL), LAC_OK);
    set_text(&model, "file", scratch_write(&folder, "load.csv", csv, strlen(csv)));
    set_text(&model, "time", "t");
    set_text(&model, column, value);
    return model;
}

typedef struct ready {
    lac_model model;
    lac_load_set set;
} ready;

static lac_status prepare(ready *r, const lac_load_clock *clock, lac_error *err)
{
    bool is_pore = false;
    for (size_t i = 0; lac_pore_load_get(i) != NULL; i++) {
        is_pore = is_pore || &lac_pore_load_get(i)->info == r->model.info;
    }
    lac_load_models models = {.shear = &r->model, .shear_count = is_pore ? 0 : 1};
    if (is_pore) {
        models = (lac_load_models){.pore = &r->model, .pore_count = 1};
    }
    return lac_load_set_create(&models, clock, &r->set, err);
}

static void must_prepare(ready *r, const lac_load_clock *clock)
{
    lac_error err = {""};
    if (prepare(r, clock, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
}

static void clear(ready *r)
{
    lac_load_set_clear(&r->set);
    lac_model_clear(&r->model);
}

// Sum of shear stress and pore pressure; only one of them is there.
static double at(const ready *r, double t)
{
    lac_load_state sum;
    lac_load_evaluate(&r->set, t, &sum);
    return sum.stress + sum.pore;
}

static void assert_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance)) {
        fail_msg("%.17g is not %.17g within %g", value, expected, tolerance);
    }
}

static const lac_load_clock ten_seconds = {.end = 10};

static void readings_are_met_and_joined(void **state)
{
    (void)state;
    const char *csv = "t,p\n-1,2\n1,4\n2,NA\n4,1\n11,1\n";
    ready r = {.model = slot_over("series", false, csv, "value", "p:kPa")};
    test_slot_set(&r.model, "scale", 0.5);
    must_prepare(&r, &ten_seconds);
    assert_near(at(&r, 0), 1500, 1e-9);
    assert_near(at(&r, 1), 2000, 1e-9);
    assert_near(at(&r, 3), 1000, 1e-9); // the missing reading is passed over
    assert_near(at(&r, 9), 500, 1e-9);
    assert_true(lac_load_next_break(&r.set, 0) == 1 && lac_load_next_break(&r.set, 1) == 4);
    assert_true(lac_load_next_break(&r.set, 11) == INFINITY);
    clear(&r);
}

// Smooth: through every reading, no overshoot, and the parabola's slope where that is allowed.
static void smooth_curves_overshoot_nowhere(void **state)
{
    (void)state;
    const double t[] = {0, 1, 2, 3, 5, 6, 12};
    const double v[] = {0, 1, 4, 9, 9, 2, 7};
    const char *csv = "t,v\n0,0\n1,1\n2,4\n3,9\n5,9\n6,2\n12,7\n";
    ready r = {.model = slot_over("series", true, csv, "value", "v")};
    test_slot_set(&r.model, "interpolation", 1);
    must_prepare(&r, &ten_seconds);
    for (size_t i = 0; i + 1 < sizeof t / sizeof t[0]; i++) {
        assert_near(at(&r, t[i]), v[i], 1e-12);
        double low = fmin(v[i], v[i + 1]);
        double high = fmax(v[i], v[i + 1]);
        for (int k = 1; k < 100; k++) {
            double value = at(&r, t[i] + (t[i + 1] - t[i]) * k / 100);
            assert_true(value >= low - 1e-12 && value <= high + 1e-12);
        }
    }
    lac_load_state sum;
    lac_load_evaluate(&r.set, 1, &sum); // secants 1 and 3: the parabola's 2 is within twice both
    assert_near(sum.pore_rate, 2, 1e-12);
    lac_load_evaluate(&r.set, 3, &sum); // secants 5 and 0
    assert_near(sum.pore_rate, 0, 1e-12);
    assert_true(lac_load_next_break(&r.set, 0) == 1 && lac_load_next_break(&r.set, 3) == 5);
    assert_near(lac_load_longest_step(&r.set, 3), 0.25, 1e-12);
    assert_true(lac_load_longest_step(&r.set, 12) == INFINITY);
    clear(&r);
}

// Two times of the file that an offset makes one.
static void smooth_curves_need_one_reading_at_a_time(void **state)
{
    (void)state;
    const char *csv = "t,v\n0,0\n1000,50\n1000.0000000000001,60\n86400,70\n";
    ready r = {.model = slot_over("series", true, csv, "value", "v")};
    lac_error err = {""};
    test_slot_set(&r.model, "interpolation", 1);
    test_slot_set(&r.model, "outside", 1);
    must_prepare(&r, &ten_seconds);
    lac_load_set_clear(&r.set);
    test_slot_set(&r.model, "offset", 3600);
    assert_int_equal(prepare(&r, &ten_seconds, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "two readings are at one time"));
    clear(&r);
}

// What one unit of the column makes; dates on the clock of the run; zero outside.
static void columns_of_any_quantity(void **state)
{
    (void)state;
    const char *csv = "t,a\n2020-01-01,-98.1\n2020-01-02,98.1\n";
    const lac_load_clock clock = {.dated = true, .start = 1577836800.0 - 86400.0, .end = 1e6};
    ready r = {.model = slot_over("series", false, csv, "value", "a:cm/s2")};
    set_text(&r.model, "per", "2e5 kg/m2");
    test_slot_set(&r.model, "outside", 2);
    must_prepare(&r, &clock);
    assert_near(at(&r, 86400.0), -0.981 * 2e5, 1e-6);
    assert_near(at(&r, 1.75 * 86400.0), 0.5 * 0.981 * 2e5, 1e-6);
    assert_near(at(&r, 86399.0), 0, 0);
    assert_near(at(&r, 2 * 86400.0), 0, 0);
    clear(&r);
}

static const char *write_netcdf(const char *time_unit, const char *unit)
{
    const char *path = scratch_path(&folder, "series.nc");
    const double t[] = {0, 0.5, 1, 2};
    const double v[] = {1, NC_FILL_DOUBLE, 3, 7};
    int id = 0, dim = 0, var[2];
    assert_int_equal(nc_create(path, NC_NETCDF4 | NC_CLOBBER, &id), NC_NOERR);
    (void)nc_def_dim(id, "time", 4, &dim);
    (void)nc_def_var(id, "t", NC_DOUBLE, 1, &dim, &var[0]);
    (void)nc_def_var(id, "level", NC_DOUBLE, 1, &dim, &var[1]);
    (void)nc_put_att_text(id, var[0], "units", strlen(time_unit), time_unit);
    if (unit != NULL) {
        (void)nc_put_att_text(id, var[1], "units", strlen(unit), unit);
    }
    (void)nc_enddef(id);
    (void)nc_put_var_double(id, var[0], t);
    (void)nc_put_var_double(id, var[1], v);
    assert_int_equal(nc_close(id), NC_NOERR);
    return path;
}

static void netcdf_reads_as_csv(void **state)
{
    (void)state;
    const lac_load_clock clock = {.dated = true, .start = 1577836800.0, .end = 86400.0};
    ready r = {.model = slot_over("series", true, "", "value", "level:m")};
    char **file = (char **)r.model.params;
    free(*file);
    *file = strdup(write_netcdf("days since 2020-01-01 00:00", "cm"));
    set_text(&r.model, "per", "9807 Pa/m");
    must_prepare(&r, &clock);
    assert_near(at(&r, 0), 98.07, 1e-9);
    assert_near(at(&r, 43200), 2 * 98.07, 1e-9); // the missing one is passed over
    assert_near(at(&r, 86400), 3 * 98.07, 1e-9);
    clear(&r);
}

// A column of a file says its unit itself, or has none: SI, and a doubt.
static void a_missing_unit_is_doubted(void **state)
{
    (void)state;
    static const struct {
        const char *unit, *per; // of the file; of the case
        double value;
        const char *doubt;
    } cases[] = {{"kPa", NULL, 1000.0, NULL},
                 {NULL, NULL, 1.0, "series.nc: level: no unit is named: taken as Pa"},
                 {NULL, "9807 Pa", 9807.0, NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        lac_load_clock clock = {.dated = true, .start = 1577836800.0, .end = 86400.0};
        assert_int_equal(lac_load_files_create(&clock.files, NULL), LAC_OK);
        ready r = {.model = slot_over("series", true, "", "value", "level")};
        char **file = (char **)r.model.params;
        free(*file);
        *file = strdup(write_netcdf("days since 2020-01-01 00:00", cases[i].unit));
        if (cases[i].per != NULL) {
            set_text(&r.model, "per", cases[i].per);
        }
        must_prepare(&r, &clock);
        assert_near(at(&r, 0), cases[i].value, 1e-9);
        const char *doubt = lac_load_files_doubt(clock.files, 0);
        assert_true((doubt != NULL) == (cases[i].doubt != NULL));
        assert_true(doubt == NULL || strstr(doubt, cases[i].doubt) != NULL);
        assert_null(lac_load_files_doubt(clock.files, 1));
        clear(&r);
        lac_load_files_free(clock.files);
    }
}

// A lake that rises evenly for 4 s from the interface's elevation, then stands.
static const char *const rising = "t,h\n-100,10\n0,10\n4,18\n20,18\n";

static void a_lagging_reservoir_follows_exponentially(void **state)
{
    (void)state;
    const double lag = 2.5;
    const double rate = 2.0 * 1000.0; // unit weight 1 kPa/m
    ready r = {.model = slot_over("reservoir", true, rising, "level", "h:m")};
    test_slot_set(&r.model, "elevation", 10);
    test_slot_set(&r.model, "unit_weight", 1000);
    test_slot_set(&r.model, "lag", lag);
    must_prepare(&r, &ten_seconds);
    assert_near(at(&r, -1), 0, 0);
    double at_four = rate * (4 - lag * -expm1(-4 / lag));
    assert_near(at(&r, 1e-6), rate * 0.5e-12 / lag, 1e-15);
    assert_near(at(&r, 4), at_four, 1e-9);
    assert_near(at(&r, 9), 8000 + (at_four - 8000) * exp(-5 / lag), 1e-9);
    clear(&r);
}

// The step answer of a half-space, laid over the rise of the level.
typedef struct kernel {
    double t, distance, diffusivity;
} kernel;

static double step_answer(double from, void *p)
{
    const kernel *k = p;
    return 2000.0 * erfc(k->distance / sqrt(4.0 * k->diffusivity * (k->t - from)));
}

static void a_diffusing_reservoir_is_a_convolution(void **state)
{
    (void)state;
    const double probes[] = {0.5, 2, 3.999, 4.5, 8, 9.5};
    ready r = {.model = slot_over("reservoir", true, rising, "level", "h:m")};
    test_slot_set(&r.model, "elevation", 10);
    test_slot_set(&r.model, "unit_weight", 1000);
    test_slot_set(&r.model, "distance", 3);
    test_slot_set(&r.model, "diffusivity", 0.7);
    must_prepare(&r, &ten_seconds);
    gsl_integration_workspace *room = gsl_integration_workspace_alloc(500);
    for (size_t i = 0; i < sizeof probes / sizeof probes[0]; i++) {
        kernel k = {probes[i], 3, 0.7};
        gsl_function f = {step_answer, &k};
        double integral, error;
        (void)gsl_integration_qag(&f, 0, fmin(probes[i], 4), 1e-9, 1e-11, 500, GSL_INTEG_GAUSS31,
                                  room, &integral, &error);
        assert_near(at(&r, probes[i]), integral, 1e-6);
    }
    gsl_integration_workspace_free(room);
    clear(&r);
}

// Water below the interface does nothing; the crossing is met in time, both ways.
static void a_lake_below_the_interface_is_dry(void **state)
{
    (void)state;
    ready r = {.model =
                   slot_over("reservoir", true, "t,h\n0,9\n4,13\n8,9\n12,9\n", "level", "h:m")};
    test_slot_set(&r.model, "elevation", 10);
    test_slot_set(&r.model, "unit_weight", 1000);
    test_slot_set(&r.model, "share", 0.5);
    must_prepare(&r, &ten_seconds);
    assert_near(at(&r, 0.9), 0, 0);
    assert_near(at(&r, 2), 500, 1e-9);
    assert_near(at(&r, 4), 1500, 1e-9);
    assert_near(at(&r, 6), 500, 1e-9);
    assert_near(at(&r, 7.5), 0, 0);
    assert_near(lac_load_next_break(&r.set, 0), 1, 1e-12);
    assert_near(lac_load_next_break(&r.set, 4), 7, 1e-12);
    clear(&r);
}

// Two showers; between them and after them it drains.
static void rain_fills_and_drains(void **state)
{
    (void)state;
    const double rise = 3e4, drain = 5;
    ready r = {.model = slot_over("rain", true, "t,r\n1,20\n2,0\n7,10\n20,0\n", "rain", "r:mm")};
    test_slot_set(&r.model, "rise", rise);
    test_slot_set(&r.model, "drain", drain);
    test_slot_set(&r.model, "interval", 2);
    test_slot_set(&r.model, "stamp", 1);
    test_slot_set(&r.model, "outside", 1);
    lac_error err = {""};
    assert_int_equal(prepare(&r, &ten_seconds, &err), LAC_EINPUT); // 1 s apart, 2 s long
    assert_non_null(strstr(err.message, "interval must not be longer"));
    test_slot_set(&r.model, "interval", 1);
    must_prepare(&r, &ten_seconds);
    double first = rise * 0.02 * drain * -expm1(-1 / drain);
    assert_near(at(&r, 0.5), 0, 0);
    assert_near(at(&r, 2), first, 1e-9);
    assert_near(at(&r, 7), first * exp(-5 / drain), 1e-9);
    double second = rise * 0.01 * drain * -expm1(-1 / drain) + first * exp(-6 / drain);
    assert_near(at(&r, 8), second, 1e-9);
    assert_near(at(&r, 9.5), second * exp(-1.5 / drain), 1e-9);
    clear(&r);
    // stamped at its end, from one reading to the next
    r = (ready){.model = slot_over("rain", true, "t,r\n-1,5\n1,20\n11,0\n", "rain", "r:mm")};
    test_slot_set(&r.model, "rise", rise);
    test_slot_set(&r.model, "drain", drain);
    must_prepare(&r, &ten_seconds);
    assert_near(at(&r, 1), rise * 0.01 * drain * -expm1(-2 / drain), 1e-9);
    clear(&r);
}

typedef struct wrong {
    const char *load, *csv, *column, *value, *key, *text, *message;
} wrong;

static const wrong wrongs[] = {
    {"series", "t,p\n0,1\n5,2\n", "value", "p", NULL, NULL, "load.pore_pressure.0.series: /tmp/"},
    {"series", "t,p\n0,1\n5,2\n", "value", "p", NULL, NULL,
     "ends 5 s before the run's end; must reach it"},
    {"series", "t,p\n1,1\n50,2\n", "value", "p", NULL, NULL, "begins 1 s after the run's start"},
    {"series", "t,p\n0,1\n50,2\n", "value", "p:m", NULL, NULL,
     "series: the column's unit \"m\" must be one such as \"Pa\""},
    {"series", "t,p\n0,1\n50,2\n", "value", "p:word", NULL, NULL,
     "series: the column's unit \"word\" must be one such as \"Pa\""},
    {"reservoir", "t,p\n0,1\n50,2\n", "level", "p:Pa", NULL, NULL,
     "reservoir: the column's unit \"Pa\" must be one such as \"m\""},
    {"series", "t,p\n0,1\n50,2\n", "value", "p:m", "per", "kPa/m",
     "series: per: \"kPa/m\" must be a number and a unit such as \"1 Pa/m\""},
    {"series", "t,p\n0,1\n50,2\n", "value", "p", "per", "p",
     "series: per: \"p\" must be a number and a unit such as \"1 Pa\""},
    {"series", "t,p\n0,1\n50,2\n", "value", "p:m", "per", "3 parsec", "(\"3 parsec\")"},
    {"series", "t,p\n0,1\n50,2\n", "value", "q", NULL, NULL, "has no column \"q\""},
    {"series", "t,p\n0,1\n50,2\n", "value", ":m", NULL, NULL, "must be a column and its unit"},
    {"series", "t,p\n0,NA\n50,\n", "value", "p", NULL, NULL, "every reading is missing"},
    {"series", "t,p\n2020-01-01,1\n2021-01-01,1\n", "value", "p", NULL, NULL,
     "has dates, so time.start must be a date"},
    {"rain", "t,p\n-1,1\n50,-2\n", "rain", "p", NULL, NULL, "rain of -2 m; must be >= 0"},
    {"rain", "t,p\n-1,1\n", "rain", "p", NULL, NULL,
     "ends 11 s before the run's end; must reach it"},
    {"reservoir", "t,p\n-1,1\n5,1\n", "level", "p", NULL, NULL, "or say outside: hold"},
};

static void what_does_not_fit_is_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof wrongs / sizeof wrongs[0]; i++) {
        const wrong *w = &wrongs[i];
        lac_error err = {""};
        ready r = {.model = slot_over(w->load, true, w->csv, w->column, w->value)};
        if (w->key != NULL) {
            set_text(&r.model, w->key, w->text);
        }
        for (size_t k = 0; k < r.model.info->param_count; k++) {
            const lac_param *param = &r.model.info->params[k];
            if (param->type == LAC_REAL && isnan(param->fallback) &&
                (param->flags & LAC_OPTIONAL) == 0) {
                test_slot_set(&r.model, param->key, 1);
            }
        }
        assert_int_equal(prepare(&r, &ten_seconds, &err), LAC_EINPUT);
        if (strstr(err.message, w->message) == NULL) {
            fail_msg("%s: %s", w->message, err.message);
        }
        clear(&r);
    }
    lac_error err;
    ready r = {.model = slot_over("series", true, "", "value", "p")};
    char **file = (char **)r.model.params;
    free(*file);
    *file = strdup("/nowhere/at/all.csv");
    assert_int_equal(prepare(&r, &ten_seconds, &err), LAC_EIO);
    clear(&r);
}

static int create_folder(void **state)
{
    (void)state;
    scratch_create(&folder);
    return 0;
}

static int remove_folder(void **state)
{
    (void)state;
    scratch_remove(&folder);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(readings_are_met_and_joined),
        cmocka_unit_test(smooth_curves_overshoot_nowhere),
        cmocka_unit_test(smooth_curves_need_one_reading_at_a_time),
        cmocka_unit_test(columns_of_any_quantity),
        cmocka_unit_test(netcdf_reads_as_csv),
        cmocka_unit_test(a_missing_unit_is_doubted),
        cmocka_unit_test(a_lagging_reservoir_follows_exponentially),
        cmocka_unit_test(a_diffusing_reservoir_is_a_convolution),
        cmocka_unit_test(a_lake_below_the_interface_is_dry),
        cmocka_unit_test(rain_fills_and_drains),
        cmocka_unit_test(what_does_not_fit_is_refused),
    };
    return cmocka_run_group_tests(tests, create_folder, remove_folder);
}
