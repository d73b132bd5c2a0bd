// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <stdio.h>

#include "fractal/fractal.h"
#include "support/sets.h"
#include "support/test.h"

enum { SIDE = 16 };

static lac_cluster_summary summary_of(const lac_grid *grid, const uint8_t *occupied)
{
    lac_clusters *clusters = NULL;
    lac_domain *domain = set_domain(grid, occupied);
    assert_non_null(domain);
    assert_int_equal(lac_clusters_create(domain, &clusters, NULL), LAC_OK);
    lac_cluster_summary s = lac_clusters_summarise(clusters, grid);
    lac_clusters_free(clusters);
    set_domain_free(domain);
    return s;
}

// A block of 5 x 3, a row of 9 (the widest), two single cells.
static void clusters_are_summed_up(void **state)
{
    (void)state;
    const lac_grid grid = {SIDE, SIDE, 0.5, 0.25, true};
    uint8_t occupied[SIDE * SIDE] = {0};
    for (size_t i = 0; i < 15; i++) {
        occupied[i / 5 * SIDE + i % 5] = 1;
    }
    memset(&occupied[6 * SIDE], 1, 9);
    occupied[10 * SIDE + 4] = 1;
    occupied[12 * SIDE + 9] = 1;
    lac_cluster_summary s = summary_of(&grid, occupied);
    assert_int_equal(s.n, 4);
    assert_int_equal(s.cells, 26);
    assert_int_equal(s.largest, 15);
    assert_true(s.largest_extent == 2.5);
    assert_true(s.widest == 4.5);
    assert_true(s.mean == 6.5);
    assert_true(fabs(s.weighted - (15.0 * 15.0 + 9.0 * 9.0 + 2.0) / 26.0) < 1e-14);
    assert_int_equal(s.octaves, 4);
    const size_t count[4] = {2, 0, 0, 2};
    const size_t cells[4] = {2, 0, 0, 24};
    assert_memory_equal(s.count, count, sizeof count);
    assert_memory_equal(s.cells_of, cells, sizeof cells);
}

static void one_cell_and_all_cells(void **state)
{
    (void)state;
    const lac_grid grid = {SIDE, SIDE, 1.0, 1.0, true};
    uint8_t occupied[SIDE * SIDE] = {0};
    occupied[37] = 1;
    lac_cluster_summary s = summary_of(&grid, occupied);
    assert_true(s.n == 1 && s.octaves == 1 && s.count[0] == 1 && s.widest == 1.0);
    memset(occupied, 1, sizeof occupied);
    s = summary_of(&grid, occupied);
    assert_true(s.n == 1 && s.octaves == 9 && s.count[8] == 1 && s.cells_of[8] == 256);
    assert_true(s.largest_extent == SIDE && s.mean == 256.0 && s.weighted == 256.0);
}

// A ramp against a flat, of which the pressures on the finest grid are given: a patch of 6 x 4
// cells in the middle, or in the corner, where half of its sides are the edge of a free grid.
static lac_scaling ramp(bool periodic, size_t corner, lac_error *err)
{
    double h[SIDE * SIDE];
    double p[SIDE * SIDE] = {0.0};
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        h[i] = 1e-3 * (double)(i % SIDE);
    }
    for (size_t i = 0; i < 24; i++) {
        p[(corner + i / 6) * SIDE + corner + i % 6] = 2.0;
    }
    lac_contact_def contact = lac_contact_default();
    contact.grid = (lac_grid){SIDE, SIDE, 0.5, 0.25, periodic};
    contact.heights = h;
    contact.e_star = 1.0;
    contact.mean_pressure = 1e-4;
    const lac_scaling_def def = {.coarsest = 4, .finest = p};
    lac_scaling s;
    assert_int_equal(lac_scaling_measure(&contact, &def, &s, err), LAC_OK);
    return s;
}

static void resolutions_are_observed(void **state)
{
    (void)state;
    lac_error err = {""};
    lac_scaling s = ramp(false, 5, &err);
    assert_int_equal(s.n, 3);
    // The step back to the foot of the ramp is no slope where the grid does not repeat.
    for (size_t i = 0; i < 3; i++) {
        assert_true(fabs(s.at[i].slope - 2e-3) < 1e-15);
    }
    const lac_resolution *finest = &s.at[2];
    assert_int_equal(finest->cells, 24);
    assert_true(finest->area == 24 * 0.125 && finest->pressure == 2.0);
    s = ramp(true, 0, &err);
    double step = 15e-3 / 0.5;
    double square = (15 * 2e-3 * 2e-3 + step * step) / 16;
    assert_true(fabs(s.at[2].slope - sqrt(square)) < 1e-15);
}

static void powers_are_found(void **state)
{
    (void)state;
    // Areas and slopes of known powers of r.
    lac_scaling s = {.n = 4};
    for (size_t i = 0; i < 4; i++) {
        double r = exp2(-(double)i);
        s.at[i] = (lac_resolution){
            .cell = r, .area = pow(r, 0.375), .pressure = 1.0, .slope = pow(r, -0.25)};
    }
    lac_scaling_fit(&s, 0);
    assert_true(fabs(s.dimension - 1.625) < 1e-13);
    assert_true(fabs(s.from_slopes - 1.75) < 1e-13);
    assert_false(s.few_cells); // not known
    s.at[0].cells = 100;
    s.at[3].cells = 5;
    lac_scaling_fit(&s, 0);
    assert_false(s.few_cells);
    s.at[0].cells = 99;
    lac_scaling_fit(&s, 0);
    assert_true(s.few_cells);
    s.at[1].slope = 0.0;
    lac_scaling_fit(&s, 0);
    assert_true(isnan(s.from_slopes) && isfinite(s.dimension));
}

// "0.23" or "": NaN
static double number(const char *text) { return text[0] == '\0' ? (double)NAN : atof(text); }

static void same_number(double a, const char *text)
{
    double b = number(text);
    assert_true(isnan(b) ? isnan(a) : a == b);
}

// Splits a line at its commas, but those within quotes, which are taken off.
static size_t split(char *line, char **field, size_t most)
{
    size_t n = 0;
    bool quoted = false;
    char *to = line;
    field[n++] = to;
    for (const char *c = line; *c != '\0' && *c != '\n'; c++) {
        if (*c == '"') {
            quoted = !quoted;
        } else if (*c == ',' && !quoted && n < most) {
            *to++ = '\0';
            field[n++] = to;
        } else {
            *to++ = *c;
        }
    }
    *to = '\0';
    return n;
}

// The table in the library is the table that is shipped.
static void published_exponents_are_those_of_the_file(void **state)
{
    (void)state;
    char line[1024];
    size_t rows = 0;
    FILE *file = fopen(LACUNA_SOURCE_DIR "/cases/data/size_effect.csv", "r");
    assert_non_null(file);
    for (bool header = true; fgets(line, sizeof line, file) != NULL;) {
        char *field[9];
        if (line[0] == '#' || header) {
            header = header && line[0] == '#';
            continue;
        }
        assert_int_equal(split(line, field, 9), 9);
        const lac_size_exponent *x = lac_size_exponent_get(rows++);
        assert_non_null(x);
        assert_string_equal(x->quantity, field[0]);
        same_number(x->low, field[1]);
        same_number(x->high, field[2]);
        same_number(x->shortest_m, field[5]);
        same_number(x->longest_m, field[6]);
        assert_int_equal(x->stated, field[7][0] == 'S');
        assert_string_equal(x->source, field[8]);
        if (field[3][0] != '\0') { // Delta_S = 2 - x
            assert_true(fabs(2.0 - x->low - number(field[3])) < 1e-12);
        }
    }
    (void)fclose(file);
    assert_int_equal(rows, 8);
    assert_null(lac_size_exponent_get(rows));
    assert_null(lac_size_exponent_get(SIZE_MAX));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clusters_are_summed_up),
        cmocka_unit_test(one_cell_and_all_cells),
        cmocka_unit_test(resolutions_are_observed),
        cmocka_unit_test(powers_are_found),
        cmocka_unit_test(published_exponents_are_those_of_the_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
