// SPDX-License-Identifier: GPL-3.0-or-later
// What every indicator must: know nothing of the future, not care when time began, give only the
// numbers that its row declares, and go on once it has begun.
#include <stdlib.h>

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/rng.h"
#include "base/units.h"
#include "forecast/hindcast.h"
#include "precursor/precursor.h"
#include "support/test.h"

enum { N = 44, LEVELS = 3, EVENTS = 400, ISSUES = 4, SURROGATES = 19 };
static const size_t issues[ISSUES] = {28, 33, 39, 44}; // readings seen
static const double n_tot[LEVELS] = {64.0, 16.0, 4.0};

// A joint that accelerates as the log law has it, with noise, cells that begin to slip, and ever
// more events of which some last long.
typedef struct joint {
    double time[N], displacement[N], n_slip[N * LEVELS], length[N];
    double start[EVENTS], end[EVENTS], moment[EVENTS];
    lac_event_list events;
    lac_slip_history slip;
    lac_indicator_inputs evidence;
} joint;

static double uniform(uint64_t a, uint64_t b)
{
    return lac_random_uniform(31, LAC_STREAM_TEST, a, b);
}

static void make(joint *j)
{
    const double failure = N + 4.0;
    for (size_t i = 0; i < N; i++) {
        const double left = failure - (double)i;
        j->time[i] = 1024.0 * ((double)i + 0.25 * (double)(i % 3));
        j->displacement[i] = -log(left / failure) + 0.002 * uniform(i, 0);
        for (size_t level = 0; level < LEVELS; level++) {
            j->n_slip[i * LEVELS + level] = floor(n_tot[level] * (double)i / (2.0 * N));
        }
        j->length[i] = (double)(1 + i / 4);
    }
    for (size_t i = 0; i < EVENTS; i++) {
        j->start[i] = 1024.0 * (N - 1) * sqrt(((double)i + 0.5) / EVENTS);
        j->end[i] = j->start[i] + (i % 5 == 0 ? 4096.0 : 1.0);
        j->moment[i] = 1e9 * pow(uniform(i, 1), -1.5);
    }
    j->events = (lac_event_list){EVENTS, j->start, j->moment, j->end};
    j->slip = (lac_slip_history){N, LEVELS, j->time, j->n_slip, n_tot, j->length, 0.6};
    j->evidence = (lac_indicator_inputs){&j->events, &j->slip, 1, SURROGATES};
}

static lac_forecast_set *forecast(const joint *j, size_t n)
{
    const lac_readings readings = {.n = n, .time = j->time, .displacement = j->displacement};
    const lac_forecast_def def = lac_forecast_default();
    lac_forecast_set *forecasts = NULL;
    assert_int_equal(lac_forecast_set_create(&def, &readings, &forecasts, NULL), LAC_OK);
    return forecasts;
}

// All indicators as of the n-th reading.
static size_t look(const joint *j, size_t n, lac_precursor *out)
{
    lac_forecast_set *forecasts = forecast(j, n);
    size_t count = 0;
    assert_int_equal(lac_precursors_at(&j->evidence, forecasts, out, &count, NULL), LAC_OK);
    lac_forecast_set_free(forecasts);
    return count;
}

static void rows_are_whole(void **state)
{
    (void)state;
    const lac_precursor_kind *kind;
    lac_units *units = NULL;
    size_t k = 0;
    double scale, offset;
    assert_int_equal(lac_units_create(&units, NULL), LAC_OK);
    for (; (kind = lac_precursor_kind_get(k)) != NULL; k++) {
        assert_true(kind->info.name[0] != '\0' && kind->info.summary[0] != '\0');
        assert_true(kind->info.reference[0] != '\0' && kind->estimator[0] != '\0');
        assert_true(kind->evaluate != NULL && lac_needs_name(kind->needs)[0] != '\0');
        assert_true(kind->headline < kind->value_count);
        assert_true(kind->value_count <= LAC_FORECAST_VALUES);
        for (size_t v = 0; v < kind->value_count; v++) {
            const lac_precursor_value *value = &kind->value[v];
            assert_true(value->key[0] != '\0' && value->text[0] != '\0');
            assert_int_equal(
                lac_units_convert(units, value->unit, value->unit, &scale, &offset, NULL), LAC_OK);
        }
    }
    assert_true(k > 0 && k <= LAC_PRECURSORS_MAX);
    lac_units_free(units);
}

// What was found is declared, in its order, and finite; probabilities are.
static void assert_declared(const lac_precursor *p)
{
    const lac_precursor_kind *kind = p->kind;
    size_t v = 0;
    for (size_t i = 0; i < p->found.count; i++, v++) {
        const lac_fitted *found = &p->found.value[i];
        while (v < kind->value_count && strcmp(kind->value[v].key, found->key) != 0) {
            v++;
        }
        if (v == kind->value_count) {
            fail_msg("%s: %s is not declared there", kind->info.name, found->key);
        }
        if (!isfinite(found->value)) {
            fail_msg("%s: %s is %g", kind->info.name, found->key, found->value);
        }
        const char *end = strrchr(found->key, '_');
        if (strcmp(end != NULL ? end : found->key, end != NULL ? "_p" : "p") == 0) {
            assert_true(found->value > 0.0 && found->value <= 1.0);
        }
    }
    assert_true(p->found.count > 0 || p->found.reason[0] != '\0');
}

static void all_say_what_they_declare(void **state)
{
    (void)state;
    static joint j;
    lac_precursor found[LAC_PRECURSORS_MAX];
    make(&j);
    const size_t count = look(&j, N, found);
    for (size_t k = 0; k < count; k++) {
        assert_declared(&found[k]);
        for (size_t v = 0; v < found[k].kind->value_count; v++) {
            const char *key = found[k].kind->value[v].key;
            const bool no_such_level = strncmp(key, "level_", 6) == 0 && atoi(key + 6) >= LEVELS;
            if (isnan(lac_forecast_fit_find(&found[k].found, key)) != no_such_level) {
                fail_msg("%s: %s: %s", found[k].kind->info.name, key, found[k].found.reason);
            }
        }
    }
}

static void assert_same(const lac_precursor *a, const lac_precursor *b)
{
    assert_true(a->kind == b->kind && a->found.count == b->found.count);
    assert_int_equal(a->found.points, b->found.points);
    assert_string_equal(a->found.reason, b->found.reason);
    for (size_t i = 0; i < a->found.count; i++) {
        assert_string_equal(a->found.value[i].key, b->found.value[i].key);
        if (a->found.value[i].value != b->found.value[i].value) {
            fail_msg("%s: %s knows the future", a->kind->info.name, a->found.value[i].key);
        }
    }
}

// Whatever is known only after `seen` readings becomes something else.
static void spoil(joint *j, size_t seen)
{
    const double now = j->time[seen - 1];
    for (size_t i = seen; i < N; i++) {
        j->time[i] += 1e7;
        j->displacement[i] = -1e3 * uniform(i, 2);
        j->n_slip[i * LEVELS] = 64.0;
        j->length[i] = 1e6;
    }
    for (size_t i = 0; i < EVENTS; i++) {
        if (j->end[i] > now) {
            j->end[i] += 1e6;
            j->moment[i] = 1e30;
        }
    }
}

static void the_future_changes_nothing(void **state)
{
    (void)state;
    static joint j;
    lac_precursor before[LAC_PRECURSORS_MAX], after[LAC_PRECURSORS_MAX];
    for (size_t i = 0; i < test_some(ISSUES - 1); i++) {
        make(&j);
        const size_t count = look(&j, issues[i], before);
        spoil(&j, issues[i]);
        assert_int_equal(look(&j, issues[i], after), count);
        for (size_t k = 0; k < count; k++) {
            assert_same(&before[k], &after[k]);
        }
    }
}

// A hindcast's course is what each time would have said alone.
static void a_course_is_its_times(void **state)
{
    (void)state;
    static joint j;
    lac_precursor alone[LAC_PRECURSORS_MAX];
    make(&j);
    const lac_readings readings = {.n = N, .time = j.time, .displacement = j.displacement};
    const lac_forecast_def def = lac_forecast_default();
    lac_forecast_outcome of = {.readings = &readings, .failed_at = (double)NAN};
    assert_int_equal(lac_forecast_look(&def, &j.evidence, 4, NULL, &of, NULL), LAC_OK);
    const lac_indicator_series *course = of.indicator_series;
    assert_int_equal(course->issues, 4);
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(look(&j, 11 * (i + 1), alone), course->kinds);
        for (size_t k = 0; k < course->kinds; k++) {
            assert_same(&alone[k], &course->found[i * course->kinds + k]);
        }
    }
    lac_forecast_outcome_clear(&of);
}

// A shift of the clock by a power of two changes nothing but rounding.
static void the_clock_does_not_matter(void **state)
{
    (void)state;
    static joint j;
    const double shift = 1073741824.0;
    lac_precursor here[LAC_PRECURSORS_MAX], there[LAC_PRECURSORS_MAX];
    make(&j);
    const size_t count = look(&j, N, here);
    for (size_t i = 0; i < N; i++) {
        j.time[i] += shift;
    }
    for (size_t i = 0; i < EVENTS; i++) {
        j.start[i] += shift;
        j.end[i] += shift;
    }
    assert_int_equal(look(&j, N, there), count);
    for (size_t k = 0; k < count; k++) {
        assert_int_equal(here[k].found.count, there[k].found.count);
        for (size_t i = 0; i < here[k].found.count; i++) {
            const double a = here[k].found.value[i].value;
            const double b = there[k].found.value[i].value;
            if (fabs(a - b) > 1e-4 * fabs(a) + DBL_MIN) {
                fail_msg("%s: %s: %g, %g", here[k].kind->info.name, here[k].found.value[i].key, a,
                         b);
            }
        }
    }
}

static void once_begun_all_go_on(void **state)
{
    (void)state;
    static joint j;
    lac_precursor found[LAC_PRECURSORS_MAX];
    bool begun[LAC_PRECURSORS_MAX] = {false};
    make(&j);
    for (size_t i = 0; i < ISSUES; i += test_few() ? 3 : 1) {
        const size_t count = look(&j, issues[i], found);
        for (size_t k = 0; k < count; k++) {
            const lac_precursor_kind *kind = found[k].kind;
            const bool has =
                !isnan(lac_forecast_fit_find(&found[k].found, kind->value[kind->headline].key));
            if (begun[k] && !has) {
                fail_msg("%s: %s", kind->info.name, found[k].found.reason);
            }
            begun[k] = has;
        }
    }
}

// No, one, equal or absurd events and records: a reason or a finite number.
static void any_evidence_is_survived(void **state)
{
    (void)state;
    static joint j;
    lac_precursor found[LAC_PRECURSORS_MAX];
    static const double moments[] = {NAN, 0.0, DBL_MIN, 1e300, -1.0, 1.0};
    make(&j);
    lac_forecast_set *early = forecast(&j, 1);
    lac_forecast_set *late = forecast(&j, N);
    for (size_t kind = 0; kind < sizeof moments / sizeof *moments; kind++) {
        make(&j);
        for (size_t i = 0; i < EVENTS; i++) {
            j.moment[i] = moments[kind];
            j.start[i] = kind % 2 == 0 ? 0.0 : j.start[i];
            j.end[i] = kind % 2 == 0 ? 0.0 : j.end[i];
        }
        for (size_t i = 0; i < N; i++) {
            j.length[i] = i % 2 == 0 ? NAN : 0.0;
            j.n_slip[i * LEVELS] = kind % 2 == 0 ? 0.0 : 64.0;
        }
        j.slip.critical_fraction = NAN;
        for (size_t n = 0; n <= EVENTS; n = 20 * n + 1) {
            j.events.n = n;
            j.slip.n = n < N ? n : N;
            size_t count = 0;
            assert_int_equal(
                lac_precursors_at(&j.evidence, kind == 0 ? early : late, found, &count, NULL),
                LAC_OK);
            for (size_t k = 0; k < count; k++) {
                assert_declared(&found[k]);
            }
        }
    }
    lac_forecast_set_free(early);
    lac_forecast_set_free(late);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_whole),
        cmocka_unit_test(all_say_what_they_declare),
        cmocka_unit_test(the_future_changes_nothing),
        cmocka_unit_test(a_course_is_its_times),
        cmocka_unit_test(the_clock_does_not_matter),
        cmocka_unit_test(once_begun_all_go_on),
        cmocka_unit_test(any_evidence_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
