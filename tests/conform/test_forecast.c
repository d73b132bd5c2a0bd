// SPDX-License-Identifier: GPL-3.0-or-later
// What every method of forecasting must: know nothing of the future, and not care when time began.
#include <stdlib.h>

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/rng.h"
#include "forecast/hindcast.h"
#include "support/test.h"

enum { N = 18, CUT = 13 };

static double times[N], displacement[N];

static double normal(size_t i)
{
    double pair[2];
    lac_random_normal(11, LAC_STREAM_TEST, i, 0, pair);
    return pair[0];
}

static void fill(void)
{
    for (size_t i = 0; i < N; i++) {
        times[i] = 86400.0 * ((double)i + 0.2 * sin((double)i));
        displacement[i] =
            -log((86400.0 * (N + 5) - times[i]) / (86400.0 * (N + 5))) + 0.003 * normal(i);
    }
}

// A model that a caller brings: it says what it was shown.
static lac_status tell_what_is_seen(void *context, const lac_motion *m, double now,
                                    lac_forecast_fit *found, lac_error *err)
{
    (void)context, (void)err;
    assert_true(m->time[m->n - 1] == now);
    found->remaining = 1e5 + fabs(m->displacement[m->n - 1]);
    found->error = 0.1;
    found->misfit = 0.0;
    found->excess = 0.0;
    found->points = m->n;
    return m->n > 12 ? LAC_OK : lac_forecast_fit_refuse(found, "%zu readings", m->n);
}

static const lac_forecast_kind own_kind = {.info = {.name = "own"},
                                           .least = 1,
                                           .worst = 1.0,
                                           .calibration = {0.0, 0.1, -2.0, -1.0, 0.0, 1.0, 2.0}};
static const lac_forecast_model own = {.kind = &own_kind, .fit = tell_what_is_seen};

static lac_rolling *roll(size_t n)
{
    const lac_readings readings = {.n = n, .time = times, .displacement = displacement};
    lac_forecast_def def = lac_forecast_default();
    def.model = &own;
    lac_rolling *r = NULL;
    assert_int_equal(lac_rolling_create(&def, &readings, n, NULL, &r, NULL), LAC_OK);
    return r;
}

static lac_forecast_set *look(void)
{
    const lac_readings readings = {.n = N, .time = times, .displacement = displacement};
    const lac_forecast_def def = lac_forecast_default();
    lac_forecast_set *o = NULL;
    assert_int_equal(lac_forecast_set_create(&def, &readings, &o, NULL), LAC_OK);
    return o;
}

// Every method has a text for each thing that is printed of it.
static void rows_are_whole(void **state)
{
    (void)state;
    const lac_forecast_kind *kind;
    for (size_t k = 0; (kind = lac_forecast_kind_get(k)) != NULL; k++) {
        const lac_calibration *c = &kind->calibration;
        assert_true(kind->info.name[0] != '\0' && kind->info.summary[0] != '\0');
        assert_true(kind->info.reference[0] != '\0' && kind->estimator[0] != '\0');
        assert_true(kind->fit != NULL && kind->least > 0 && kind->worst > 0.0);
        assert_true(c->spread > 0.0 && c->low90 < c->low50 && c->low50 < c->median &&
                    c->median < c->high50 && c->high50 < c->high90);
        assert_true(c->pull >= 0.0 && c->pull < 1.0);
    }
}

static bool same(double a, double b) { return isnan(a) ? isnan(b) : a == b; }

static void assert_same(const lac_forecast *a, const lac_forecast *b)
{
    assert_true(a->kind == b->kind && a->issued == b->issued);
    assert_true(same(a->issue_time, b->issue_time) && same(a->window_start, b->window_start));
    assert_true(same(a->time, b->time) && same(a->raw_time, b->raw_time));
    assert_true(same(a->low50, b->low50) && same(a->high50, b->high50) &&
                same(a->low90, b->low90) && same(a->high90, b->high90));
    assert_true(same(a->fit.rms, b->fit.rms) && same(a->fit.error, b->fit.error));
    assert_string_equal(a->fit.reason, b->fit.reason);
}

static void assert_in_order(const lac_forecast *f)
{
    if (f->issued) {
        assert_true(f->issue_time <= f->low90 && f->low90 < f->low50 && f->low50 < f->time &&
                    f->time < f->high50 && f->high50 < f->high90 && isfinite(f->high90));
        assert_true(f->issue_time < f->raw_time && isfinite(f->raw_time));
        assert_true(f->fit.reason[0] == '\0');
    } else {
        assert_true(f->fit.reason[0] != '\0');
        assert_true(isnan(f->low90));
    }
}

static void a_model_stands_before_the_baseline(void **state)
{
    (void)state;
    fill();
    lac_rolling *r = roll(N);
    const lac_forecast *last = &r->forecast[(N - 1) * r->methods];
    assert_true(last[r->methods - 2].kind == &own_kind && last[r->methods - 2].issued);
    assert_int_equal(last[r->methods - 2].fit.points, N);
    assert_true(last[r->methods - 1].kind == lac_forecast_kind_get(r->methods - 2));
    assert_true(last[0].kind == lac_forecast_kind_get(0));
    assert_null(lac_forecast_kind_get(r->methods - 1));
    lac_rolling_free(r);
}

static void the_future_changes_nothing(void **state)
{
    (void)state;
    fill();
    lac_rolling *whole = roll(N);
    lac_rolling *cut = roll(CUT);
    size_t issued = 0;
    assert_int_equal(cut->issues, CUT);
    for (size_t i = CUT; i < N; i++) {
        displacement[i] = -1e3 * normal(i);
        times[i] += 1e9;
    }
    lac_rolling *other = roll(N);
    for (size_t i = 0; i < (size_t)CUT * whole->methods; i++) {
        assert_same(&whole->forecast[i], &cut->forecast[i]);
        assert_same(&whole->forecast[i], &other->forecast[i]);
        assert_in_order(&cut->forecast[i]);
        issued += cut->forecast[i].issued ? 1 : 0;
    }
    assert_true(issued > CUT / 2);
    lac_rolling_free(whole);
    lac_rolling_free(cut);
    lac_rolling_free(other);
}

static bool before_cut(void *context, size_t done, size_t all)
{
    (void)context, (void)all;
    return done < CUT;
}

// What was issued before an interruption is kept.
static void an_interruption_keeps_what_was_issued(void **state)
{
    (void)state;
    fill();
    lac_forecast_def def = lac_forecast_default();
    def.model = &own;
    const lac_readings readings = {.n = N, .time = times, .displacement = displacement};
    const lac_rolling_watch watch = {.go_on = before_cut};
    lac_error err = {0};
    lac_rolling *whole = roll(N);
    lac_rolling *part = NULL;
    assert_int_equal(lac_rolling_create(&def, &readings, N, &watch, &part, &err), LAC_EINTERRUPT);
    assert_non_null(part);
    assert_int_equal(part->issues, CUT);
    for (size_t i = 0; i < (size_t)CUT * whole->methods; i++) {
        assert_same(&whole->forecast[i], &part->forecast[i]);
    }
    lac_rolling_free(part);
    lac_rolling_free(whole);
}

// A shift of the clock by a power of two, and metres turned into others, change nothing but
// rounding.
static void clock_and_metre_do_not_matter(void **state)
{
    (void)state;
    const double shift = 1073741824.0;
    fill();
    lac_forecast_set *here = look();
    for (size_t i = 0; i < N; i++) {
        times[i] += shift;
        displacement[i] = 1024.0 * displacement[i];
    }
    lac_forecast_set *there = look();
    for (size_t k = 0; k < here->count; k++) {
        const lac_forecast *a = &here->forecast[k];
        const lac_forecast *b = &there->forecast[k];
        assert_int_equal(a->issued, b->issued);
        if (a->issued) {
            assert_true(fabs(b->time - shift - a->time) < 1e-2 * (a->time - a->issue_time));
            assert_true(fabs(b->raw_time - shift - a->raw_time) <
                        1e-3 * (a->raw_time - a->issue_time));
            assert_true(fabs(b->high90 - shift - a->high90) < 1e-2 * (a->high90 - a->issue_time));
        }
    }
    lac_forecast_set_free(here);
    lac_forecast_set_free(there);
}

// What is no motion of a slope is refused with a reason, or forecast; never a crash, never NaN
// issued.
static void any_numbers_are_survived(void **state)
{
    (void)state;
    lac_forecast_def def = lac_forecast_default();
    for (size_t kind = 0; kind < 18; kind++) {
        def.since = kind < 9 ? NAN : 0.0; // which has the methods asked at any motion
        for (size_t n = 1; n <= N; n = 4 * n + 1) {
            for (size_t i = 0; i < N; i++) {
                const double u = (double)i;
                const double shapes[] = {0.0,
                                         1e-300 * u * u,
                                         1e300 * u / N,
                                         i + 1 == n ? 1e300 : 0.0,
                                         NAN,
                                         (double)(i % 2),
                                         i % 3 == 0 ? NAN : u * u,
                                         exp(u),
                                         u < 20 ? 0.0 : pow(u - 20, 8)};
                times[i] = kind % 9 == 7 ? u * DBL_MIN : u * 1e5;
                displacement[i] = shapes[kind % 9];
            }
            const lac_readings readings = {.n = n, .time = times, .displacement = displacement};
            lac_forecast_set *o = NULL;
            assert_int_equal(lac_forecast_set_create(&def, &readings, &o, NULL), LAC_OK);
            for (size_t k = 0; k < o->count; k++) {
                const lac_forecast *f = &o->forecast[k];
                assert_in_order(f);
                assert_true(f->issue_time == times[n - 1] || f->fit.reason[0] != '\0');
                assert_true(isfinite(f->issue_time));
            }
            lac_forecast_set_free(o);
        }
    }
}

// Too large or too small to square: refused in words, with no nan or inf in them.
static void numbers_out_of_range_are_refused(void **state)
{
    (void)state;
    static const double sizes[] = {1e149, 1e151, 1e307, DBL_MAX, 1e-149, 1e-151, DBL_MIN};
    static const bool refused[] = {false, true, true, true, false, true, true};
    double velocity[N];
    const lac_forecast_def def = lac_forecast_default();
    const lac_readings readings = {.n = N, .time = times, .velocity = velocity};
    for (size_t kind = 0; kind < sizeof sizes / sizeof *sizes; kind++) {
        for (size_t i = 0; i < N; i++) {
            times[i] = (double)i;
            velocity[i] = sizes[kind] / (double)(N - i);
        }
        lac_forecast_set *o = NULL;
        assert_int_equal(lac_forecast_set_create(&def, &readings, &o, NULL), LAC_OK);
        for (size_t k = 0; k < o->count; k++) {
            const char *reason = o->forecast[k].fit.reason;
            assert_int_equal(strstr(reason, "out of range") != NULL, refused[kind]);
            assert_null(strstr(reason, "inf"));
            assert_null(strstr(reason, "nan"));
        }
        lac_forecast_set_free(o);
    }
}

static void skill_is_measured(void **state)
{
    (void)state;
    lac_skill skill[16];
    fill();
    lac_rolling *r = roll(N);
    const double failed_at = 86400.0 * (N + 5);
    assert_true(r->methods <= 16);
    assert_int_equal(lac_rolling_measure(r, failed_at, 10 * 86400.0, skill, NULL), LAC_OK);
    for (size_t k = 0; k < r->methods; k++) {
        const lac_skill *s = &skill[k];
        size_t leads = 0;
        for (size_t lead = 0; lead < LAC_LEADS; lead++) {
            leads += s->lead_count[lead];
        }
        assert_int_equal(s->asked, N);
        assert_int_equal(leads, s->issued);
        assert_int_equal(s->hits + s->false_alarms, s->alarms);
        assert_int_equal(s->hits + s->misses, 5); // readings of the last 10 days before
        assert_true(s->inside50 <= s->inside90 && s->inside90 <= s->issued);
    }
    assert_true(skill[4].crps < skill[4].persistence_crps); // the log law on its own data
    assert_int_equal(lac_rolling_measure(r, INFINITY, 10 * 86400.0, skill, NULL), LAC_OK);
    for (size_t k = 0; k < r->methods; k++) {
        assert_true(skill[k].hits == 0 && skill[k].misses == 0 && isnan(skill[k].crps));
    }
    lac_rolling_free(r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_whole),
        cmocka_unit_test(a_model_stands_before_the_baseline),
        cmocka_unit_test(the_future_changes_nothing),
        cmocka_unit_test(an_interruption_keeps_what_was_issued),
        cmocka_unit_test(clock_and_metre_do_not_matter),
        cmocka_unit_test(any_numbers_are_survived),
        cmocka_unit_test(numbers_out_of_range_are_refused),
        cmocka_unit_test(skill_is_measured),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
