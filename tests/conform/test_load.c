// SPDX-License-Identifier: GPL-3.0-or-later
// What every load must do, run on each one of the registries with random parameters.

#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "load/load.h"
#include "support/field_file.h"
#include "support/scratch.h"
#include "support/slot.h"
#include "support/test.h"

enum { TRIALS = 20, PROBES = 16 };

static scratch folder;
static char data_file[128];
static char field_file[2][128]; // with times, and without

// Where loads differ from cell to cell, one cell stands for the load.
static const lac_grid grid = {.nx = 3, .ny = 2, .dx = 4, .dy = 5};
static const uint32_t index_of[] = {0, 1, 2, 3, 4, 5};
static const lac_load_places places = {&grid, index_of, 6};
enum { CELL = 4 };

static const double t_first = -3.1, t_last = 30;

static double uniform(uint64_t i, uint64_t what, double low, double high)
{
    return low + (high - low) * lac_random_uniform(5, LAC_STREAM_TEST, i, what);
}

// A value of a parameter, within its range and of ordinary size; now and then an optional one is
// left out.
static double draw(const lac_param *param, uint64_t trial, uint64_t what)
{
    // Where swings are too fast or filters too sharp, quadrature gives up, not the load.
    static const struct {
        const char *key;
        double low, high;
    } gentle[] = {{"period", 2, 20},      {"frequency", 0.01, 0.5},
                  {"lag", 0.5, 20},       {"drain", 0.5, 20},
                  {"distance", 5, 20},    {"diffusivity", 0.1, 5},
                  {"interval", 0.1, 0.3}, {"radius", 0.5, 20},
                  {"x", 0, 12},           {"y", 0, 10}};
    double low = fmax(param->min, -20);
    double high = fmin(param->max, 20);
    if ((param->flags & LAC_OPTIONAL) != 0 && uniform(trial, what + 50, 0, 1) < 0.3) {
        return NAN;
    }
    for (size_t i = 0; i < sizeof gentle / sizeof gentle[0]; i++) {
        bool is_it = strcmp(gentle[i].key, param->key) == 0;
        low = is_it ? gentle[i].low : low;
        high = is_it ? gentle[i].high : high;
    }
    return uniform(trial, what, low, high);
}

static void set_text(lac_model *model, const lac_param *param, const char *text)
{
    char *copy = strdup(text);
    memcpy((char *)model->params + param->offset, &copy, sizeof copy);
}

static bool is_text(const lac_param *param)
{
    return param->type == LAC_PATH || param->type == LAC_TEXT;
}

// Optional files and their columns come together in every other trial; `per` never does.
static bool is_wanted(const lac_param *param, uint64_t trial)
{
    return (param->flags & LAC_OPTIONAL) == 0 || (trial % 2 == 1 && strcmp(param->key, "per") != 0);
}

// Random parameters; whatever names a file or its columns gets the one of this test.
static lac_model drawn_once(const lac_model_info *info, uint64_t trial)
{
    lac_model model;
    assert_int_equal(lac_model_create(info, &model, NULL), LAC_OK);
    for (size_t i = 0; i < info->param_count; i++) {
        const lac_param *param = &info->params[i];
        if (param->type == LAC_REAL) {
            test_slot_set(&model, param->key, draw(param, trial, i));
        } else if (param->type == LAC_CHOICE && strcmp(param->key, "outside") == 0) {
            test_slot_set(&model, param->key,
                          1 + (double)(trial % 2 < 1 || param->choices[2] == NULL ? 0 : 1));
        } else if (param->type == LAC_CHOICE && strcmp(param->key, "share") == 0) {
            test_slot_set(&model, param->key, (double)(trial % 3));
        } else if (param->type == LAC_CHOICE) {
            test_slot_set(&model, param->key, (double)(trial % 2));
        } else if (param->type == LAC_PATH && strcmp(info->name, "field") == 0 &&
                   strcmp(param->key, "file") == 0) {
            set_text(&model, param, field_file[trial % 2]);
        } else if (is_text(param) && is_wanted(param, trial)) {
            const char *column = strcmp(param->key, "time") == 0 ? "t" : "v";
            set_text(&model, param, param->type == LAC_PATH ? data_file : column);
        }
    }
    return model;
}

// Parameters that go together.
static lac_model drawn(const lac_model_info *info, uint64_t trial)
{
    lac_model model = drawn_once(info, trial);
    while (info->validate != NULL && info->validate(model.params) != NULL) {
        lac_model_clear(&model);
        trial += 10 * TRIALS;
        model = drawn_once(info, trial);
    }
    return model;
}

static lac_load_set placed_set(const lac_load_models *models)
{
    lac_load_set set = test_load_set(models);
    assert_int_equal(lac_load_set_place(&set, &places, NULL), LAC_OK);
    return set;
}

// The list of a case that a load is of.
typedef enum of_list { OF_SHEAR, OF_PORE, OF_NORMAL } of_list;

static of_list now; // that the loads under test are of

static const lac_load_kind *(*const registry[])(size_t) = {lac_shear_load_get, lac_pore_load_get,
                                                           lac_normal_stress_get};

static lac_load_models models_of(const lac_model *model, size_t count)
{
    return now == OF_SHEAR  ? (lac_load_models){.shear = model, .shear_count = count}
           : now == OF_PORE ? (lac_load_models){.pore = model, .pore_count = count}
                            : (lac_load_models){.normal = model, .normal_count = count};
}

// A load made ready.
typedef struct ready {
    lac_model model;
    lac_load_set set;
} ready;

static const lac_load *load_of(const ready *r) { return r->set.load; }

static ready ready_create(const lac_load_kind *kind, uint64_t trial)
{
    ready r = {.model = drawn(&kind->info, trial)};
    const lac_load_models models = models_of(&r.model, 1);
    r.set = placed_set(&models);
    return r;
}

static void ready_clear(ready *r)
{
    lac_load_set_clear(&r->set);
    lac_model_clear(&r->model);
}

// What one cell feels takes the place of what all feel.
static void add_cell(const lac_load_set *set, double t, lac_load_state *sum)
{
    double value[6], rate[6];
    if (!set->varies) {
        return;
    }
    const lac_load_state alike = *sum;
    lac_load_evaluate_pore(set, t, &alike, value, rate);
    sum->pore = value[CELL];
    sum->pore_rate = rate[CELL];
    lac_load_evaluate_normal(set, t, &alike, value, rate);
    sum->normal = value[CELL];
    sum->normal_rate = rate[CELL];
    lac_load_evaluate_cells(set, t, &alike, value, rate);
    assert_true(value[CELL] == sum->pore - sum->normal);
    assert_true(rate[CELL] == sum->pore_rate - sum->normal_rate);
}

// The values of a load and their rates.
enum { QUANTITIES = 9 };

typedef struct sample {
    double value[QUANTITIES], rate[QUANTITIES];
} sample;

static sample sample_of(const lac_load_state *s)
{
    return (sample){{s->ratio, s->stress, s->spring_stress, s->back_slip, s->pore, s->elastic,
                     s->equal_ratio, s->elastic_ratio, s->normal},
                    {s->ratio_rate, s->stress_rate, s->spring_rate, s->back_rate, s->pore_rate,
                     s->elastic_rate, 0, 0, s->normal_rate}};
}

static sample sample_at(const lac_load *load, double t)
{
    lac_load one = *load;
    lac_load_state sum;
    const lac_load_set set = {.load = &one,
                              .count = 1,
                              .shear = now == OF_SHEAR,
                              .pore = now == OF_PORE,
                              .varies = load->kind->cells != NULL,
                              .places = places};
    lac_load_evaluate(&set, t, &sum);
    add_cell(&set, t, &sum);
    return sample_of(&sum);
}

static double break_after(const lac_load *load, double t)
{
    return load->kind->next_break == NULL ? INFINITY : load->kind->next_break(load, t);
}

static double total(const double x[QUANTITIES])
{
    return x[0] + 0.7 * x[1] + 0.3 * x[2] + 0.9 * x[3] + 0.6 * x[4] + 0.8 * x[5] + x[6] + x[7] +
           0.5 * x[8];
}

static double total_rate(double t, void *load)
{
    sample s = sample_at(load, t);
    return total(s.rate);
}

// Between breaks a difference over any gap is the integral of the rate over it.
static void assert_smooth(const lac_load *load, double from, double to)
{
    const size_t probes = test_some(PROBES);
    double gap = (to - from) / (double)probes;
    (void)gsl_set_error_handler_off();
    gsl_integration_workspace *room = gsl_integration_workspace_alloc(200);
    gsl_function rate = {.function = total_rate, .params = (void *)load};
    for (size_t i = 0; i < probes; i++) {
        double t = from + gap * (double)i;
        // the end of the interval belongs to what comes after it
        double end = i + 1 < probes ? t + gap : nextafter(to, from);
        sample left = sample_at(load, t);
        sample right = sample_at(load, end);
        double scale = fabs(total(left.value)) + fabs(total(right.value)) + gap;
        double grown = total(right.value) - total(left.value);
        double integral;
        double error;
        assert_true(isfinite(total(left.value)) && isfinite(total(left.rate)));
        (void)gsl_integration_qag(&rate, t, end, 1e-11 * scale, 0, 200, GSL_INTEG_GAUSS61, room,
                                  &integral, &error);
        if (!(fabs(grown - integral) <= 1e-9 * scale)) {
            fail_msg("%s: grows by %.17g over %g ... %g, its rate says %.17g",
                     load->kind->info.name, grown, t, end, integral);
        }
    }
    gsl_integration_workspace_free(room);
}

static void assert_right_continuous(const lac_load *load, double t)
{
    sample at = sample_at(load, t), after = sample_at(load, t + 1e-12);
    for (size_t k = 0; k < QUANTITIES; k++) {
        double scale = 1.0 + fabs(at.value[k]) + fabs(at.rate[k]);
        assert_true(fabs(at.value[k] - after.value[k]) <= 1e-9 * scale);
    }
}

typedef void check(const lac_load_kind *kind);

static void on_every_load(check *run)
{
    static const size_t least[] = {8, 7, 5};
    for (now = OF_SHEAR; now <= OF_NORMAL; now++) {
        size_t count = 0;
        for (; registry[now](count) != NULL; count++) {
            run(registry[now](count));
        }
        assert_true(count >= least[now]);
    }
}

static void check_rates_and_breaks(const lac_load_kind *kind)
{
    for (uint64_t trial = 0; trial < test_some(TRIALS); trial++) {
        ready r = ready_create(kind, trial);
        const lac_load *load = load_of(&r);
        double t = t_first;
        while (t < t_last) {
            double next = break_after(load, t);
            assert_true(next > t);
            assert_smooth(load, t, fmin(next, t_last));
            if (next < t_last) {
                assert_right_continuous(load, next);
            }
            // no break hides between: the answer is the same from anywhere before it
            double between = t + 0.5 * (fmin(next, t_last) - t);
            assert_true(break_after(load, between) == next);
            t = next;
        }
        ready_clear(&r);
    }
}

static void rates_are_slopes_and_breaks_the_only_jumps(void **state)
{
    (void)state;
    on_every_load(check_rates_and_breaks);
}

// Two loads together are their sum, and their breaks the earlier of both.
static void check_sum(const lac_load_kind *kind)
{
    for (uint64_t trial = 0; trial < test_some(TRIALS); trial++) {
        lac_model models[2] = {drawn(&kind->info, trial), drawn(&kind->info, trial + TRIALS)};
        const lac_load_models named = models_of(models, 2);
        lac_load_set set = placed_set(&named);
        const lac_load *loads = set.load;
        double t = uniform(trial, 90, t_first, t_last);
        lac_load_state both;
        lac_load_evaluate(&set, t, &both);
        add_cell(&set, t, &both);
        sample sum = sample_of(&both), one = sample_at(&loads[0], t),
               other = sample_at(&loads[1], t);
        for (size_t k = 0; k < QUANTITIES; k++) {
            assert_true(sum.value[k] == one.value[k] + other.value[k]);
            assert_true(sum.rate[k] == one.rate[k] + other.rate[k]);
        }
        assert_true(lac_load_next_break(&set, t) ==
                    fmin(break_after(&loads[0], t), break_after(&loads[1], t)));
        lac_load_set_clear(&set);
        lac_model_clear(&models[0]);
        lac_model_clear(&models[1]);
    }
}

static void the_sum_is_linear(void **state)
{
    (void)state;
    on_every_load(check_sum);
}

static bool has_share(const lac_model_info *info)
{
    for (size_t i = 0; i < info->param_count; i++) {
        if (strcmp(info->params[i].key, "share") == 0 && info->params[i].type == LAC_CHOICE) {
            return true;
        }
    }
    return false;
}

// Shared one way or the other, the force is the same; none is in two shares.
static void check_share(const lac_load_kind *kind)
{
    assert_true(now == OF_SHEAR || !has_share(&kind->info));
    for (uint64_t trial = 0; has_share(&kind->info) && trial < test_some(TRIALS); trial++) {
        lac_model model = drawn(&kind->info, trial);
        lac_load_state seen[3];
        for (int share = 0; share < 3; share++) {
            test_slot_set(&model, "share", share);
            assert_int_equal(lac_load_models_share(&model), share);
            lac_load_set set = test_load_set(&(lac_load_models){.shear = &model, .shear_count = 1});
            assert_true(set.shaped == (share == LAC_SHARE_ELASTIC));
            lac_load_evaluate(&set, 5, &seen[share]);
            lac_load_set_clear(&set);
        }
        const lac_load_state *by = seen;
        assert_true(by[0].stress == by[1].spring_stress && by[0].stress == by[2].elastic);
        assert_true(by[0].stress_rate == by[1].spring_rate);
        assert_true(by[0].stress_rate == by[2].elastic_rate);
        assert_true(by[0].ratio == by[1].equal_ratio && by[0].ratio == by[2].elastic_ratio);
        for (int share = 0; share < 3; share++) {
            assert_true(lac_load_shear(&by[share], 3e6) == lac_load_shear(&by[0], 3e6));
        }
        assert_true(by[1].stress == 0 && by[2].stress == 0 && by[2].spring_stress == 0);
        assert_true(by[1].ratio == 0 && by[2].ratio == 0 && by[2].equal_ratio == 0);
        lac_model_clear(&model);
    }
}

static void a_force_is_the_same_however_shared(void **state)
{
    (void)state;
    on_every_load(check_share);
    size_t shared = 0;
    for (size_t i = 0; lac_shear_load_get(i) != NULL; i++) {
        shared += has_share(&lac_shear_load_get(i)->info);
    }
    assert_true(shared >= 7); // all but the spring and back-slip
}

// A load leaves what the other lists are of alone.
static void check_kind(const lac_load_kind *kind)
{
    for (uint64_t trial = 0; trial < test_some(TRIALS); trial++) {
        ready r = ready_create(kind, trial);
        lac_load_state sum;
        lac_load_evaluate(&r.set, 4, &sum);
        if (now != OF_SHEAR) {
            assert_true(sum.ratio == 0 && sum.stress == 0 && sum.spring_stiffness == 0);
            assert_true(sum.elastic == 0 && sum.equal_ratio == 0 && sum.elastic_ratio == 0);
        }
        assert_true(now == OF_PORE || (sum.pore == 0 && sum.pore_rate == 0));
        assert_true(now == OF_NORMAL || (sum.normal == 0 && sum.normal_rate == 0));
        bool has_ratio =
            sum.ratio != 0 || sum.ratio_rate != 0 || sum.equal_ratio != 0 || sum.elastic_ratio != 0;
        assert_true(kind->fixes_shear || !has_ratio);
        ready_clear(&r);
    }
}

static void each_kind_moves_only_its_own(void **state)
{
    (void)state;
    on_every_load(check_kind);
}

// An approach or a dimension is what was given, and has no pressure of its own.
static void check_static(const lac_normal_load *load, const lac_model *model)
{
    double given;
    double (*const value)(const void *params) =
        load->approach != NULL ? load->approach : load->dimension;
    assert_true(load->approach == NULL || load->dimension == NULL);
    assert_int_equal(load->info.param_count, 1);
    memcpy(&given, (const char *)model->params + load->info.params[0].offset, sizeof given);
    assert_true(value(model->params) == given);
    assert_true(isnan(load->pressure(model->params, 2700)));
}

// Every normal load is positive, finite, and proportional to the density where it needs one.
static void normal_loads_press(void **state)
{
    (void)state;
    size_t i = 0;
    for (; lac_normal_load_get(i) != NULL; i++) {
        const lac_normal_load *load = lac_normal_load_get(i);
        for (uint64_t trial = 0; trial < test_some(TRIALS); trial++) {
            lac_model model = drawn(&load->info, trial);
            if (load->approach != NULL || load->dimension != NULL) {
                check_static(load, &model);
                lac_model_clear(&model);
                continue;
            }
            double once = load->pressure(model.params, load->needs_density ? 1000 : NAN);
            double twice = load->pressure(model.params, load->needs_density ? 2000 : NAN);
            assert_true(once > 0 && isfinite(once));
            assert_true(fabs(twice / once - (load->needs_density ? 2 : 1)) < 1e-14);
            lac_model_clear(&model);
        }
    }
    assert_true(i >= 3);
}

// Readings some seconds apart, a gap among them, from before the probes to well within them.
static int write_data(void **state)
{
    char text[1024] = "t,v\n";
    double t = -6;
    (void)state;
    for (size_t i = 0; i < 12; i++) {
        char value[24];
        (void)snprintf(value, sizeof value, "%.6f", i == 5 ? NAN : uniform(i, 7, 0, 15));
        size_t used = strlen(text);
        (void)snprintf(text + used, sizeof text - used, "%.6f,%s\n", t, value);
        t += uniform(i, 8, 0.5, 4);
    }
    scratch_create(&folder);
    (void)snprintf(data_file, sizeof data_file, "%s",
                   scratch_write(&folder, "loads.csv", text, strlen(text)));
    for (size_t k = 0; k < 2; k++) {
        (void)snprintf(field_file[k], sizeof field_file[k], "%s",
                       scratch_write(&folder, k == 0 ? "a.nc" : "b.nc", "", 0));
        double values[7 * 9];
        for (size_t i = 0; i < 7 * 9; i++) {
            values[i] = uniform(i, 9, 0, 0.02);
        }
        field_file_write(field_file[k], k == 0 ? 7 : 0, values);
    }
    return 0;
}

static int remove_data(void **state)
{
    (void)state;
    scratch_remove(&folder);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rates_are_slopes_and_breaks_the_only_jumps),
        cmocka_unit_test(the_sum_is_linear),
        cmocka_unit_test(a_force_is_the_same_however_shared),
        cmocka_unit_test(each_kind_moves_only_its_own),
        cmocka_unit_test(normal_loads_press),
    };
    return cmocka_run_group_tests(tests, write_data, remove_data);
}
