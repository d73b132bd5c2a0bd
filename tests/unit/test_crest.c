// SPDX-License-Identifier: GPL-3.0-or-later
// Crests of slip rates between the ends of steps, and the events of an interface as a whole,
// against rates that are known at all times.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/slip_events.h"
#include "lacuna/simulation.h"
#include "support/test.h"

enum { CELLS = 3 };

typedef double rate_at(size_t cell, double t);

static lac_step step_to(rate_at *rate, double t, double h, double v[CELLS])
{
    lac_step step = {.time_origin = 1e9, .time_local = t, .step = h, .n = CELLS, .slip_rate = v};
    for (size_t i = 0; i < CELLS; i++) {
        v[i] = rate(i, t);
        step.max_rate = fmax(step.max_rate, fabs(v[i]));
    }
    return step;
}

// The largest that cell 0 is found to come to in steps of h, alternately a third longer.
static double crest_in_steps(rate_at *rate, double from, double end, double h, double *when)
{
    lac_crest crest;
    double v[CELLS], most = 0.0;
    assert_int_equal(lac_crest_create(CELLS, &crest, NULL), LAC_OK);
    lac_step step = step_to(rate, from, 0.0, v);
    lac_crest_take(&crest, &step);
    for (size_t k = 0; step.time_local < end; k++) {
        const double length = k % 2 == 0 ? h : 4.0 / 3.0 * h;
        double since = NAN, before = step.time_local;
        step = step_to(rate, before + length, length, v);
        const double top = lac_crest_top(&crest, &step, 0, &since);
        if (top > most) {
            most = top;
            *when = before + since;
        }
        lac_crest_take(&crest, &step);
    }
    lac_crest_clear(&crest);
    return most;
}

static double cubic(size_t cell, double t)
{
    const double x = t - 0.37;
    return cell == 0 ? -2.0 * exp(0.3 - 0.7 * x * x + 0.05 * x * x * x) : 1e-9;
}

static void a_cubic_is_found_to_rounding(void **state)
{
    (void)state;
    double when = NAN;
    const double top = crest_in_steps(cubic, -1.0, 1.5, 0.21, &when);
    assert_true(fabs(top / (2.0 * exp(0.3)) - 1.0) < 1e-14);
    assert_true(fabs(when - 0.37) < 1e-7); // flat there
}

// Rises in 1/2 s and falls in 2 s an e-fold.
static double pulse(size_t cell, double t)
{
    return cell == 0 ? 3.0 / (exp(-2.0 * t) + exp(0.5 * t)) : 1e-9;
}

static void a_pulse_is_found_with_steps_that_it_takes_to_be_resolved(void **state)
{
    (void)state;
    const double at = log(4.0) / 2.5, want = pulse(0, at);
    const double lengths[] = {0.2, 0.1, 0.05};
    double when = NAN, ends = 0.0, last = 0.0;
    for (size_t k = 0; k < 3; k++) {
        const double h = lengths[k];
        const double off = fabs(crest_in_steps(pulse, -2.03, 3.0, h, &when) / want - 1.0);
        print_message("steps of %g s: off by %.1e, %.1e s\n", h, off, when - at);
        assert_true(k == 0 || off < last / 8.0); // of fourth order
        assert_true(fabs(when - at) < 0.1 * h);
        last = off;
    }
    for (double t = -2.03; t < 3.0; t += 0.05) {
        ends = fmax(ends, pulse(0, t));
    }
    assert_true(last < 1e-6 && last < 0.1 * (1.0 - ends / want));
}

static double rising(size_t cell, double t) { return cell == 0 ? exp(t) : 0.0; }
static double spike(size_t cell, double t) { return cell == 0 ? exp(-40.0 * fabs(t)) : 0.0; }

static void there_is_none_where_none_is_resolved(void **state)
{
    (void)state;
    double when = NAN;
    assert_true(crest_in_steps(rising, 0.0, 2.0, 0.1, &when) == 0.0);
    assert_true(crest_in_steps(spike, -1.0, 1.0, 0.1, &when) == 0.0);
    // across a jump of the loads
    lac_crest crest;
    double v[CELLS];
    assert_int_equal(lac_crest_create(CELLS, &crest, NULL), LAC_OK);
    for (int k = 0; k < 4; k++) {
        lac_step step = step_to(cubic, 0.1 * k, k == 2 ? 0.0 : 0.1, v);
        assert_true(k < 3 || lac_crest_top(&crest, &step, 0, NULL) == 0.0);
        lac_crest_take(&crest, &step);
    }
    lac_crest_clear(&crest);
}

// Two pulses, each of two cells one after the other, the second the faster; it begins fast.
static double twice(size_t cell, double t)
{
    if (cell == 2) {
        return t < 1.0 ? 1e-2 * exp(-10.0 * t) : 1e-9;
    }
    const double x = t < 10.0 ? t - 5.0 : t - 15.0;
    return cell == 0 ? 0.5 * exp(-x * x) : 0.8 * exp(-(x - 1.03) * (x - 1.03)) + 1e-12;
}

static lac_slip_events list(size_t saved_after)
{
    lac_slip_events all = {0};
    const double h = 0.1;
    for (size_t k = 0; k <= 168; k++) {
        double v[CELLS];
        lac_step step = step_to(twice, h * (double)k, k > 0 ? h : 0.0, v);
        assert_int_equal(lac_slip_events_step(&all, &step, NULL), LAC_OK);
        if (k == saved_after) { // goes on from what was saved
            lac_archive archive = {0};
            lac_slip_events_serialize(&all, &archive);
            lac_slip_events_clear(&all);
            archive.loading = true;
            lac_slip_events_serialize(&all, &archive);
            assert_true(lac_archive_good(&archive) && archive.at == archive.size);
            free(archive.bytes);
        }
    }
    return all;
}

static void an_interface_has_its_events(void **state)
{
    (void)state;
    lac_slip_events all = list(SIZE_MAX);
    assert_int_equal(all.count, 3);
    const lac_slip_event *e = all.event;
    assert_true(isnan(e[0].start) && e[0].max_rate == 1e-2 && e[0].peak == 1e9);
    assert_true(fabs(e[0].end - 1e9 - log(20.0) / 10.0) < 1e-6);
    // exp(-x^2) crosses at sqrt(ln(v/limit)); between steps ln v is taken as linear
    assert_true(fabs(e[1].start - 1e9 - (5.0 - sqrt(log(500.0)))) < 1e-3);
    assert_true(fabs(e[1].end - 1e9 - (6.03 + sqrt(log(1600.0)))) < 1e-3);
    for (int k = 1; k < 3; k++) {
        assert_true(fabs(e[k].max_rate / 0.8 - 1.0) < 1e-6);
        assert_true(fabs(e[k].peak - 1e9 - (k == 1 ? 6.03 : 16.03)) < 1e-5);
    }
    assert_true(isnan(e[2].end)); // the run ends before
    lac_slip_events_clear(&all);
}

static void events_go_on_from_what_was_saved(void **state)
{
    (void)state;
    lac_slip_events whole = list(SIZE_MAX);
    for (size_t k = 0; k <= 168; k++) {
        lac_slip_events parted = list(k);
        assert_int_equal(parted.count, whole.count);
        assert_memory_equal(parted.event, whole.event, whole.count * sizeof *whole.event);
        lac_slip_events_clear(&parted);
    }
    lac_slip_events_clear(&whole);
}

static void what_was_saved_may_be_cut(void **state)
{
    (void)state;
    lac_slip_events all = list(SIZE_MAX);
    lac_archive archive = {0};
    lac_slip_events_serialize(&all, &archive);
    lac_slip_events_clear(&all);
    archive.loading = true;
    const size_t size = archive.size;
    for (size_t cut = 0; cut < size; cut++) {
        lac_slip_events back = {0};
        archive.size = cut;
        archive.at = 0;
        archive.short_of = false;
        lac_slip_events_serialize(&back, &archive);
        assert_true(archive.short_of && back.count == 0);
        lac_slip_events_clear(&back);
    }
    free(archive.bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cubic_is_found_to_rounding),
        cmocka_unit_test(a_pulse_is_found_with_steps_that_it_takes_to_be_resolved),
        cmocka_unit_test(there_is_none_where_none_is_resolved),
        cmocka_unit_test(an_interface_has_its_events),
        cmocka_unit_test(events_go_on_from_what_was_saved),
        cmocka_unit_test(what_was_saved_may_be_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
