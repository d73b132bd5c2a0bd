// SPDX-License-Identifier: GPL-3.0-or-later
// Components of a displacement: what they are projected on, and what noise and wrong readings do.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "series/series.h"
#include "support/scratch_group.h"
#include "support/test.h"

static lac_units *units;

static int open_all(void **state)
{
    (void)open_scratch(state);
    return lac_units_create(&units, NULL) == LAC_OK ? 0 : -1;
}

static int close_all(void **state)
{
    lac_units_free(units);
    return close_scratch(state);
}

enum { DAYS = 200, TEXT = 20000 };
static const double along[3] = {2.0 / 7.0, -3.0 / 7.0, -6.0 / 7.0};

// Numbers between -1 and 1 that are as good as random.
static double noise(int i, int axis)
{
    return 2.0 * fmod(1e4 * fabs(sin(12.9898 * i + 78.233 * axis + 1.0)), 1.0) - 1.0;
}

// A slope that moves along a line by `moved` mm in all, its readings wrong by up to `error` mm and
// one of them by a metre.
static lac_series *read_slope(double moved, double error, int wrong, const char *columns,
                              const char *sight, lac_error *err)
{
    static char text[TEXT];
    size_t used = (size_t)snprintf(text, sizeof text, "day,e,n,u\n");
    for (int i = 0; i < DAYS; i++) {
        const double d = moved * i * i / ((DAYS - 1.0) * (DAYS - 1.0));
        double x[3];
        for (int k = 0; k < 3; k++) {
            x[k] = 5000.0 * (k + 1) + along[k] * d + (i > 0 ? error * noise(i, k) : 0.0);
        }
        x[1] += i == wrong ? 1000.0 : 0.0;
        used += (size_t)snprintf(text + used, sizeof text - used, "%d,%.6f,%.6f,%.6f\n", i, x[0],
                                 x[1], x[2]);
    }
    const lac_series_def def = {.path = scratch_write(&folder, "axes.csv", text, used),
                                .time_format = "day",
                                .components = columns,
                                .line_of_sight = sight};
    lac_series *s = NULL;
    return lac_series_read(&def, units, &s, err) == LAC_OK ? s : NULL;
}

static double cosine(const lac_series *s)
{
    return s->direction[0] * along[0] + s->direction[1] * along[1] + s->direction[2] * along[2];
}

static void the_main_direction_is_found(void **state)
{
    (void)state;
    lac_series *s = read_slope(400.0, 0.0, -1, "e:mm,n:mm,u:mm", NULL, NULL);
    assert_non_null(s);
    assert_true(fabs(cosine(s) - 1.0) < 1e-9);
    assert_true(fabs(s->displacement[DAYS - 1] - 0.4) < 1e-8);
    assert_non_null(strstr(s->doubt[0], "0.286,-0.429,-0.857: 100 % of the motion"));
    lac_series_free(s);
}

// The length of noise is above 0 by about its size; what is projected is not.
static void noise_is_not_taken_for_motion(void **state)
{
    (void)state;
    lac_series *s = read_slope(400.0, 5.0, -1, "e:mm,n:mm,u:mm", NULL, NULL);
    double projected = 0.0, length = 0.0;
    const int early = DAYS / 10;
    assert_non_null(s);
    for (int i = 1; i <= early; i++) {
        double square = 0.0;
        const double d = 0.4 * i * i / ((DAYS - 1.0) * (DAYS - 1.0));
        for (int k = 0; k < 3; k++) {
            const double x = s->component[k][i] - s->component[k][0];
            square += x * x;
        }
        projected += (s->displacement[i] - d) / early;
        length += (sqrt(square) - d) / early;
    }
    assert_true(cosine(s) > 0.9998);
    assert_true(length > 2e-3);
    assert_true(fabs(projected) < 0.4 * length);
    lac_series_free(s);
}

static void one_wrong_reading_turns_nothing(void **state)
{
    (void)state;
    for (int wrong = 1; wrong < DAYS; wrong += 33) {
        lac_series *s = read_slope(400.0, 1.0, wrong, "e:mm,n:mm,u:mm", NULL, NULL);
        assert_non_null(s);
        assert_true(cosine(s) > 0.9999);
        lac_series_free(s);
    }
}

// Where nothing moves, noise has no direction, and that is said.
static void noise_alone_is_told(void **state)
{
    (void)state;
    lac_series *s = read_slope(0.0, 5.0, -1, "e:mm,n:mm,u:mm", NULL, NULL);
    assert_non_null(s);
    assert_non_null(strstr(s->doubt[0], "which is not straight or is noise"));
    lac_series_free(s);
    s = read_slope(0.0, 0.0, -1, "e:mm,n:mm,u:mm", NULL, NULL);
    assert_non_null(s);
    assert_true(s->displacement[DAYS - 1] == 0.0);
    lac_series_free(s);
}

// What is known later does not turn the direction of what is used.
static void later_readings_are_not_used(void **state)
{
    (void)state;
    double before[3];
    lac_series *s = read_slope(400.0, 5.0, -1, "e:mm,n:mm,u:mm", NULL, NULL);
    assert_non_null(s);
    lac_series_project(s, DAYS / 2);
    memcpy(before, s->direction, sizeof before);
    for (int i = DAYS / 2; i < DAYS; i++) {
        s->component[0][i] += 7.0;
    }
    lac_series_project(s, DAYS / 2);
    assert_memory_equal(before, s->direction, sizeof before);
    assert_int_equal(s->doubts, 1);
    lac_series_project(s, DAYS);
    assert_true(cosine(s) < 0.9);
    lac_series_free(s);
}

// Of any length; the reading before the first is no zero.
static void a_line_of_sight_is_projected_on(void **state)
{
    (void)state;
    lac_series *s = read_slope(400.0, 0.0, -1, "e:mm,n:mm,u:mm", "-3, 0, 4", NULL);
    assert_non_null(s);
    const double expected = 0.4 * (-3.0 * along[0] + 4.0 * along[2]) / 5.0;
    assert_true(fabs(s->displacement[DAYS - 1] - expected) < 1e-8);
    assert_true(s->displacement[0] == 0.0 && s->doubts == 0);
    lac_series_free(s);
    s = read_slope(400.0, 0.0, -1, "e:mm,u:cm", "0,1", NULL);
    assert_non_null(s);
    assert_true(fabs(s->displacement[DAYS - 1] - 4.0 * along[2]) < 1e-7);
    lac_series_free(s);
}

// A displacement counts from the first reading that has all components, and is missing without one.
static void what_is_missing_stays_missing(void **state)
{
    (void)state;
    const char text[] = "day,e,n\n0,,7\n1,10,20\n2,NA,21\n3,13,24\n4,16,28\n";
    const lac_series_def def = {.path = scratch_write(&folder, "gaps.csv", text, sizeof text - 1),
                                .time_format = "day",
                                .components = "e:m,n:m"};
    lac_series *s = NULL;
    assert_int_equal(lac_series_read(&def, units, &s, NULL), LAC_OK);
    assert_int_equal(s->first, 1);
    assert_true(isnan(s->displacement[0]) && isnan(s->displacement[2]));
    assert_true(s->displacement[1] == 0.0);
    assert_true(fabs(s->displacement[3] - 5.0) < 1e-12);
    assert_true(fabs(s->displacement[4] - 10.0) < 1e-12);
    lac_series_free(s);
}

static void wrong_words_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *columns, *sight, *says;
    } cases[] = {{"e:mm", NULL, "must be two or three columns"},
                 {"e:mm,n:mm,u:mm,x:mm", NULL, "must be two or three columns"},
                 {"e:mm,,u:mm", NULL, "must be two or three columns"},
                 {"e:,n:mm", NULL, "must be two or three columns"},
                 {"e:mm,n:mm", "1,2,3", "a number for each of the 2 components"},
                 {"e:mm,n:mm,u:mm", "1,2", "a number for each of the 3 components"},
                 {"e:mm,n:mm,u:mm", "0,0,0", "must be a direction"},
                 {"e:mm,n:mm,u:mm", "1,2,x", "must be a direction"},
                 {"e:mm,n:mm,u:mm", "1,2,3,", "must be a direction"},
                 {"e:mm,n:mm,u:mm", "1,2,inf", "must be a direction"},
                 {"e:mm,n:kg", NULL, "n: unit \"kg\""},
                 {"e:mm,w:mm", NULL, "has no column \"w\""},
                 {NULL, "1,2,3", "goes with components"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        lac_error err = {""};
        if (cases[i].columns == NULL) {
            const lac_series_def def = {.path = scratch_write(&folder, "x.csv", "t,d\n1,1\n", 8),
                                        .displacement = "d",
                                        .line_of_sight = cases[i].sight};
            lac_series *s = NULL;
            assert_int_equal(lac_series_read(&def, units, &s, &err), LAC_EINPUT);
        } else {
            assert_null(read_slope(1.0, 0.0, -1, cases[i].columns, cases[i].sight, &err));
        }
        if (strstr(err.message, cases[i].says) == NULL) {
            fail_msg("%s %s: %s", cases[i].columns, cases[i].sight, err.message);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_main_direction_is_found),
        cmocka_unit_test(noise_is_not_taken_for_motion),
        cmocka_unit_test(one_wrong_reading_turns_nothing),
        cmocka_unit_test(noise_alone_is_told),
        cmocka_unit_test(later_readings_are_not_used),
        cmocka_unit_test(a_line_of_sight_is_projected_on),
        cmocka_unit_test(what_is_missing_stays_missing),
        cmocka_unit_test(wrong_words_are_refused),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
