// SPDX-License-Identifier: GPL-3.0-or-later
// What every load must do, run on each one of the registries with random parameters.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka needs the headers above first
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "base/rng.h"
#include "lacuna/load.h"
#include "support/slot.h"

enum { TRIALS = 200, PROBES = 64 };

static const double t_first = -3, t_last = 30;

static double uniform(uint64_t i, uint64_t what, double low, double high)
{
    return low + (high - low) * lac_random_uniform(5, LAC_STREAM_TEST, i, what);
}

// A value of a parameter, within its range and of ordinary size; now and then an optional one is
// left out.
static double draw(const lac_param *param, uint64_t trial, uint64_t what)
{
    if ((param->flags & LAC_OPTIONAL) != 0 && uniform(trial, what + 50, 0, 1) < 0.3) {
        return NAN;
    }
    return uniform(trial, what, fmax(param->min, -20), fmin(param->max, 20));
}

static lac_slot drawn(const lac_descriptor *about, uint64_t trial)
{
    lac_slot slot;
    assert_int_equal(lac_slot_create(about, &slot, NULL), LAC_OK);
    for (size_t i = 0; i < about->param_count; i++) {
        if (about->params[i].type == LAC_REAL) {
            test_slot_set(&slot, about->params[i].key, draw(&about->params[i], trial, i));
        }
    }
    return slot;
}

// The values of a load and their rates.
enum { QUANTITIES = 5 };

typedef struct sample {
    double value[QUANTITIES], rate[QUANTITIES];
} sample;

static sample sample_of(const lac_load_state *s)
{
    return (sample){{s->ratio, s->stress, s->spring_stress, s->back_slip, s->pore},
                    {s->ratio_rate, s->stress_rate, s->spring_rate, s->back_rate, s->pore_rate}};
}

static sample sample_at(const lac_load_kind *kind, const lac_slot *slot, double t)
{
    lac_load_state sum = {0};
    kind->add(slot->params, t, &sum);
    return sample_of(&sum);
}

static double break_after(const lac_load_kind *kind, const lac_slot *slot, double t)
{
    return kind->next_break == NULL ? INFINITY : kind->next_break(slot->params, t);
}

// Between breaks a difference over any gap equals the mean of the rate over it.
static void assert_smooth(const lac_load_kind *kind, const lac_slot *slot, double from, double to)
{
    double gap = (to - from) / PROBES;
    for (size_t i = 0; i < PROBES; i++) {
        double t = from + gap * (double)i;
        sample left = sample_at(kind, slot, t), middle = sample_at(kind, slot, t + gap / 2);
        // the end of the interval belongs to what comes after it
        double end = i + 1 < PROBES ? t + gap : nextafter(to, from);
        sample right = sample_at(kind, slot, end);
        for (size_t k = 0; k < QUANTITIES; k++) {
            double scale = fabs(left.value[k]) + fabs(right.value[k]) + gap;
            double simpson = (left.rate[k] + 4 * middle.rate[k] + right.rate[k]) / 6;
            double grown = right.value[k] - left.value[k];
            assert_true(isfinite(left.value[k]) && isfinite(left.rate[k]));
            assert_true(fabs(grown - simpson * (end - t)) <= 1e-9 * scale);
        }
    }
}

static void assert_right_continuous(const lac_load_kind *kind, const lac_slot *slot, double t)
{
    sample at = sample_at(kind, slot, t), after = sample_at(kind, slot, t + 1e-12);
    for (size_t k = 0; k < QUANTITIES; k++) {
        assert_true(fabs(at.value[k] - after.value[k]) <= 1e-9);
        assert_true(fabs(at.rate[k] - after.rate[k]) <= 1e-9);
    }
}

typedef void check(const lac_load_kind *kind, bool is_pore);

static void on_every_load(check *run)
{
    size_t shear = 0, pore = 0;
    for (; lac_shear_load_at(shear) != NULL; shear++) {
        run(lac_shear_load_at(shear), false);
    }
    for (; lac_pore_load_at(pore) != NULL; pore++) {
        run(lac_pore_load_at(pore), true);
    }
    assert_true(shear >= 4 && pore >= 1);
}

static void check_rates_and_breaks(const lac_load_kind *kind, bool is_pore)
{
    (void)is_pore;
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        lac_slot slot = drawn(&kind->about, trial);
        double t = t_first;
        while (t < t_last) {
            double next = break_after(kind, &slot, t);
            assert_true(next > t);
            assert_smooth(kind, &slot, t, fmin(next, t_last));
            if (next < t_last) {
                assert_right_continuous(kind, &slot, next);
            }
            // no break hides between: the answer is the same from anywhere before it
            double between = t + 0.5 * (fmin(next, t_last) - t);
            assert_true(break_after(kind, &slot, between) == next);
            t = next;
        }
        lac_slot_clear(&slot);
    }
}

static void rates_are_slopes_and_breaks_the_only_jumps(void **state)
{
    (void)state;
    on_every_load(check_rates_and_breaks);
}

// Two loads together are their sum, and their breaks the earlier of both.
static void check_sum(const lac_load_kind *kind, bool is_pore)
{
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        lac_slot slots[2] = {drawn(&kind->about, trial), drawn(&kind->about, trial + TRIALS)};
        lac_load_set set = {.shear = slots,
                            .shear_count = is_pore ? 0 : 2,
                            .pore = slots,
                            .pore_count = is_pore ? 2 : 0};
        double t = uniform(trial, 90, t_first, t_last);
        lac_load_state both;
        lac_load_evaluate(&set, t, &both);
        sample sum = sample_of(&both), one = sample_at(kind, &slots[0], t),
               other = sample_at(kind, &slots[1], t);
        for (size_t k = 0; k < QUANTITIES; k++) {
            assert_true(sum.value[k] == one.value[k] + other.value[k]);
            assert_true(sum.rate[k] == one.rate[k] + other.rate[k]);
        }
        assert_true(lac_load_next_break(&set, t) ==
                    fmin(break_after(kind, &slots[0], t), break_after(kind, &slots[1], t)));
        lac_slot_clear(&slots[0]);
        lac_slot_clear(&slots[1]);
    }
}

static void the_sum_is_linear(void **state)
{
    (void)state;
    on_every_load(check_sum);
}

// A pore load leaves the shear alone and the other way round.
static void check_kind(const lac_load_kind *kind, bool is_pore)
{
    for (uint64_t trial = 0; trial < TRIALS; trial++) {
        lac_slot slot = drawn(&kind->about, trial);
        lac_load_state sum = {0};
        kind->add(slot.params, 4, &sum);
        if (is_pore) {
            assert_true(sum.ratio == 0 && sum.stress == 0 && sum.spring_stiffness == 0);
        } else {
            assert_true(sum.pore == 0 && sum.pore_rate == 0);
        }
        bool has_ratio = sum.ratio != 0 || sum.ratio_rate != 0;
        assert_true(kind->fixes_shear || !has_ratio);
        lac_slot_clear(&slot);
    }
}

static void each_kind_moves_only_its_own(void **state)
{
    (void)state;
    on_every_load(check_kind);
}

static void assert_documented(const lac_descriptor *about)
{
    assert_true(strlen(about->name) > 0 && strlen(about->summary) > 0 && about->reference != NULL);
    for (size_t i = 0; i < about->param_count; i++) {
        assert_true(strlen(about->params[i].doc) > 0 && strlen(about->params[i].unit) > 0);
        assert_true(about->params[i].offset < about->params_size);
        assert_true(about->params[i].min <= about->params[i].max);
    }
}

static void every_load_is_documented(void **state)
{
    (void)state;
    for (size_t i = 0; lac_normal_load_at(i) != NULL; i++) {
        assert_documented(&lac_normal_load_at(i)->about);
    }
    for (size_t i = 0; lac_shear_load_at(i) != NULL; i++) {
        assert_documented(&lac_shear_load_at(i)->about);
    }
    for (size_t i = 0; lac_pore_load_at(i) != NULL; i++) {
        assert_documented(&lac_pore_load_at(i)->about);
    }
}

// An approach or a dimension is what was given, and has no pressure of its own.
static void check_static(const lac_normal_load *load, const lac_slot *slot)
{
    double given;
    double (*const value)(const void *params) =
        load->approach != NULL ? load->approach : load->dimension;
    assert_true(load->approach == NULL || load->dimension == NULL);
    assert_int_equal(load->about.param_count, 1);
    memcpy(&given, (const char *)slot->params + load->about.params[0].offset, sizeof given);
    assert_true(value(slot->params) == given);
    assert_true(isnan(load->pressure(slot->params, 2700)));
}

// Every normal load is positive, finite, and proportional to the density where it needs one.
static void normal_loads_press(void **state)
{
    (void)state;
    size_t i = 0;
    for (; lac_normal_load_at(i) != NULL; i++) {
        const lac_normal_load *load = lac_normal_load_at(i);
        for (uint64_t trial = 0; trial < TRIALS; trial++) {
            lac_slot slot = drawn(&load->about, trial);
            if (load->approach != NULL || load->dimension != NULL) {
                check_static(load, &slot);
                lac_slot_clear(&slot);
                continue;
            }
            double once = load->pressure(slot.params, load->needs_density ? 1000 : NAN);
            double twice = load->pressure(slot.params, load->needs_density ? 2000 : NAN);
            assert_true(once > 0 && isfinite(once));
            assert_true(fabs(twice / once - (load->needs_density ? 2 : 1)) < 1e-14);
            lac_slot_clear(&slot);
        }
    }
    assert_true(i >= 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_load_is_documented),
        cmocka_unit_test(rates_are_slopes_and_breaks_the_only_jumps),
        cmocka_unit_test(the_sum_is_linear),
        cmocka_unit_test(each_kind_moves_only_its_own),
        cmocka_unit_test(normal_loads_press),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
