// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <stdio.h>

#include "fractal/fractal.h"
#include "support/test.h"

// Eight times the size at 2 - Delta_S = 1/3 halves the strength.
static void strength_falls_as_a_power(void **state)
{
    (void)state;
    const lac_size_def def = {
        .dimension = 5.0 / 3.0, .error = 1.0 / 3.0, .size = 0.1, .pressure = 2e6};
    const double size[] = {0.0125, 0.1, 0.8, 100.0};
    lac_size_strength rows[4];
    assert_int_equal(lac_size_effect(&def, 4, size, rows, NULL), LAC_OK);
    const double want[] = {2.0, 1.0, 0.5, 0.1};
    const double spread[] = {2.0, 1.0, 2.0, 10.0};
    for (size_t i = 0; i < 4; i++) {
        assert_true(rows[i].size == size[i]);
        assert_true(fabs(rows[i].relative / want[i] - 1.0) < 1e-13);
        assert_true(fabs(rows[i].pressure / (2e6 * want[i]) - 1.0) < 1e-13);
        assert_true(fabs(rows[i].low * spread[i] / want[i] - 1.0) < 1e-13);
        assert_true(fabs(rows[i].high / spread[i] / want[i] - 1.0) < 1e-13);
    }
}

// A dense contact has no size effect.
static void dense_contact_has_none(void **state)
{
    (void)state;
    const lac_size_def def = {.dimension = 2.0, .error = 0.0, .size = 0.1, .pressure = 1.0};
    const double size[] = {1e-3, 1e4};
    lac_size_strength rows[2];
    assert_int_equal(lac_size_effect(&def, 2, size, rows, NULL), LAC_OK);
    for (size_t i = 0; i < 2; i++) {
        assert_true(rows[i].relative == 1.0 && rows[i].low == 1.0 && rows[i].high == 1.0);
    }
    assert_int_equal(lac_size_effect(&def, 0, NULL, NULL, NULL), LAC_OK);
}

// p* of an area scaling gives back the pressure on an interface of its own size.
static void fractal_pressure_is_the_same_at_every_size(void **state)
{
    (void)state;
    const double dimension = 1.7;
    lac_scaling s = {.n = 4};
    for (size_t i = 0; i < 4; i++) {
        double r = 0.5 * exp2(-6.0 - (double)i);
        double area = 0.25 * 0.3 * pow(r / 0.5, 2.0 - dimension); // of an interface of 0.5 m
        s.at[i] = (lac_resolution){.cell = r, .area = area, .pressure = 1e6 * 0.25 / area};
    }
    lac_scaling_fit(&s, 0);
    lac_size_def def = {.dimension = s.dimension, .error = 0.0, .size = 0.5, .pressure = 1e6};
    const double size[] = {2.0};
    lac_size_strength row;
    assert_int_equal(lac_size_effect(&def, 1, size, &row, NULL), LAC_OK);
    // The contact of the larger one, A* ~ b^Delta_S, under P = p_0 b^2.
    double area = s.fractal_area * pow(2.0 / 0.5, s.dimension);
    assert_true(fabs(row.pressure * 4.0 / area / s.fractal_pressure - 1.0) < 1e-12);
}

static void refuse(lac_size_def def, double size, const char *word)
{
    lac_size_strength row;
    lac_error err = {""};
    assert_int_equal(lac_size_effect(&def, 1, &size, &row, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, word));
}

static void what_makes_no_sense_is_refused(void **state)
{
    (void)state;
    const double bad[] = {0.0, -1.0, NAN, INFINITY};
    for (size_t i = 0; i < 4; i++) {
        refuse((lac_size_def){bad[i], 0.0, 1.0, 1.0}, 1.0, "dimension");
        refuse((lac_size_def){1.5, 0.0, bad[i], 1.0}, 1.0, "both must be");
        refuse((lac_size_def){1.5, 0.0, 1.0, bad[i]}, 1.0, "both must be");
        refuse((lac_size_def){1.5, 0.0, 1.0, 1.0}, bad[i], "specimen");
    }
    refuse((lac_size_def){2.01, 0.0, 1.0, 1.0}, 1.0, "dimension");
    refuse((lac_size_def){1.5, -0.1, 1.0, 1.0}, 1.0, "error");
    refuse((lac_size_def){1.5, NAN, 1.0, 1.0}, 1.0, "error");
}

// Each row of the shipped table keeps x = 2 - Delta_S where it states both, and names its source.
static void shipped_table_is_consistent(void **state)
{
    (void)state;
    FILE *file = fopen(LACUNA_SOURCE_DIR "/cases/data/size_effect.csv", "r");
    assert_non_null(file);
    char line[512];
    size_t rows = 0;
    size_t with_dimension = 0;
    while (fgets(line, sizeof line, file) != NULL) {
        if (line[0] == '#' || strncmp(line, "quantity", 8) == 0) {
            continue;
        }
        double x[2];
        double d[2];
        rows++;
        assert_non_null(strstr(line, ",\""));
        int found = sscanf(line, "%*[^,],%lf,%lf,%lf,%lf", &x[0], &x[1], &d[0], &d[1]);
        assert_true(found == 2 || found == 4);
        assert_true(x[0] > 0.0 && x[0] <= x[1] && x[1] < 1.0);
        with_dimension += found == 4;
        assert_true(found == 2 || (fabs(x[0] + d[1] - 2.0) < 1e-12 && d[0] <= d[1]));
    }
    assert_int_equal(rows, 8);
    assert_int_equal(with_dimension, 3);
    assert_int_equal(fclose(file), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strength_falls_as_a_power),
        cmocka_unit_test(dense_contact_has_none),
        cmocka_unit_test(fractal_pressure_is_the_same_at_every_size),
        cmocka_unit_test(what_makes_no_sense_is_refused),
        cmocka_unit_test(shipped_table_is_consistent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
