// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include <math.h>
#include <stdio.h>

#include "base/rng.h"
#include "fractal/fractal.h"
#include "support/sets.h"
#include "support/test.h"

enum { MOST = 64 * 64 };

static lac_clusters *clusters_of(lac_grid grid, const uint8_t *occupied)
{
    lac_error err = {""};
    lac_clusters *clusters = NULL;
    lac_domain *domain = set_domain(&grid, occupied);
    assert_non_null(domain);
    assert_int_equal(lac_clusters_create(domain, &clusters, &err), LAC_OK);
    assert_int_equal(clusters->cells, domain->n);
    set_domain_free(domain);
    return clusters;
}

// The map as a picture: '#' is a contact cell.
static lac_grid picture(const char *rows, bool periodic, uint8_t *occupied)
{
    size_t nx = strcspn(rows, "\n");
    size_t ny = (strlen(rows) + 1) / (nx + 1);
    for (size_t y = 0; y < ny; y++) {
        for (size_t x = 0; x < nx; x++) {
            occupied[y * nx + x] = rows[y * (nx + 1) + x] == '#';
        }
    }
    return (lac_grid){nx, ny, 0.5, 0.25, periodic};
}

// size, width, depth of each cluster in order.
static void expect(const char *rows, bool periodic, size_t n, const uint32_t (*want)[3])
{
    uint8_t occupied[MOST];
    lac_grid grid = picture(rows, periodic, occupied);
    lac_clusters *c = clusters_of(grid, occupied);
    assert_int_equal(c->n, n);
    for (size_t k = 0; k < n; k++) {
        assert_int_equal(c->size[k], want[k][0]);
        assert_int_equal(c->width[k], want[k][1]);
        assert_int_equal(c->depth[k], want[k][2]);
        double extent = fmax(want[k][1] * 0.5, want[k][2] * 0.25);
        assert_true(lac_cluster_extent(c, &grid, k) == extent);
    }
    lac_clusters_free(c);
}

static void known_shapes(void **state)
{
    (void)state;
    static const char shapes[] = "##....#\n"
                                 "#...#..\n"
                                 "..#..#.\n"
                                 ".......\n"
                                 "#.....#";
    // Free: the corner, the diagonal with the two at its ends, three single cells.
    expect(shapes, false, 6,
           (const uint32_t[][3]){{3, 2, 2}, {2, 2, 2}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}});
    // Round the edges the four corners of the map are one.
    expect(shapes, true, 3, (const uint32_t[][3]){{6, 3, 3}, {2, 2, 2}, {1, 1, 1}});
    static const char ring[] = "######\n"
                               "#....#\n"
                               "#.##.#\n"
                               "#....#\n"
                               "######";
    expect(ring, false, 2, (const uint32_t[][3]){{18, 6, 5}, {2, 2, 1}});
    // A diagonal that goes round the map once in each direction.
    expect("#...\n.#..\n..#.\n...#", true, 1, (const uint32_t[][3]){{4, 4, 4}});
    expect("#.##.#", false, 3, (const uint32_t[][3]){{2, 2, 1}, {1, 1, 1}, {1, 1, 1}});
    expect("#.##.#", true, 2, (const uint32_t[][3]){{2, 2, 1}, {2, 2, 1}});
    expect("#", true, 1, (const uint32_t[][3]){{1, 1, 1}});
}

// The width of a line is no extent, however long against its cells.
static void clusters_of_a_line(void **state)
{
    (void)state;
    const lac_grid grid = {.nx = 6, .ny = 1, .dx = 0.01, .dy = 1.0, .periodic = true};
    lac_clusters *c = clusters_of(grid, (const uint8_t[]){1, 0, 1, 1, 1, 0});
    assert_int_equal(c->n, 2);
    assert_true(lac_cluster_extent(c, &grid, 0) == 3 * 0.01);
    assert_true(lac_cluster_extent(c, &grid, 1) == 0.01);
    lac_clusters_free(c);
}

// Spreads the least label to neighbours until nothing changes: slow and plain.
static void flood(const lac_grid *g, const uint8_t *occupied, uint32_t *label)
{
    for (size_t i = 0; i < lac_grid_cells(g); i++) {
        label[i] = (uint32_t)i;
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t i = 0; i < lac_grid_cells(g) * 9; i++) {
            size_t c = i / 9;
            size_t x = c % g->nx + g->nx + i % 3 - 1;
            size_t y = c / g->nx + g->ny + i % 9 / 3 - 1;
            bool outside = x < g->nx || x >= 2 * g->nx || y < g->ny || y >= 2 * g->ny;
            size_t other = y % g->ny * g->nx + x % g->nx;
            if ((g->periodic || !outside) && occupied[c] && occupied[other] &&
                label[other] < label[c]) {
                label[c] = label[other];
                changed = true;
            }
        }
    }
}

// Cells, columns and rows that carry a label.
static void flooded_extent(const lac_grid *g, const uint8_t *occupied, const uint32_t *label,
                           uint32_t of, uint32_t extent[3])
{
    uint8_t column[64] = {0};
    uint8_t row[64] = {0};
    memset(extent, 0, 3 * sizeof *extent);
    for (size_t i = 0; i < lac_grid_cells(g); i++) {
        if (occupied[i] && label[i] == of) {
            extent[0]++;
            column[i % g->nx] = 1;
            row[i / g->nx] = 1;
        }
    }
    for (size_t k = 0; k < 64; k++) {
        extent[1] += column[k];
        extent[2] += row[k];
    }
}

static void compare_with_flood(lac_grid grid, const uint8_t *occupied)
{
    static uint32_t label[MOST];
    flood(&grid, occupied, label);
    lac_clusters *c = clusters_of(grid, occupied);
    size_t roots = 0;
    for (size_t i = 0, k = 0; i < lac_grid_cells(&grid); i++) {
        if (!occupied[i]) {
            continue;
        }
        uint32_t extent[3];
        uint32_t mine = c->label[k++];
        roots += label[i] == i;
        assert_true(mine < c->n);
        flooded_extent(&grid, occupied, label, label[i], extent);
        assert_int_equal(c->size[mine], extent[0]);
        assert_int_equal(c->width[mine], extent[1]);
        assert_int_equal(c->depth[mine], extent[2]);
    }
    assert_int_equal(c->n, roots);
    for (size_t k = 1; k < c->n; k++) {
        assert_true(c->size[k] <= c->size[k - 1]);
    }
    lac_clusters_free(c);
}

static void random_maps_agree_with_a_flood(void **state)
{
    (void)state;
    static const size_t sides[][2] = {{1, 1},  {2, 2},  {3, 17}, {16, 16},
                                      {1, 40}, {31, 7}, {24, 24}};
    for (uint64_t seed = 0; seed < 84; seed++) {
        uint8_t occupied[MOST];
        const size_t *side = sides[seed % 7];
        lac_grid grid = {side[0], side[1], 1.0, 1.0, seed / 7 % 2 == 0};
        double density = 0.08 + 0.09 * (double)(seed / 14);
        for (size_t i = 0; i < lac_grid_cells(&grid); i++) {
            occupied[i] = lac_random_uniform(seed, LAC_STREAM_TEST, i, 0) < density;
        }
        occupied[0] = 1;
        compare_with_flood(grid, occupied);
    }
}

// Site percolation with eight neighbours sets in at 0.407: a map well above has one cluster that
// goes round, one well below has none.
static void percolation_sets_in(void **state)
{
    (void)state;
    enum { SIDE = 512 };
    uint8_t *occupied = malloc(SIDE * SIDE);
    assert_non_null(occupied);
    for (int above = 0; above < 2; above++) {
        for (size_t i = 0; i < SIDE * SIDE; i++) {
            occupied[i] = lac_random_uniform(3, LAC_STREAM_TEST, i, 1) < (above ? 0.45 : 0.36);
        }
        lac_clusters *c = clusters_of((lac_grid){SIDE, SIDE, 1.0, 1.0, true}, occupied);
        print_message("density %.2f: %zu clusters, the largest %.3f of the cells, %u x %u\n",
                      above ? 0.45 : 0.36, c->n, (double)c->size[0] / (double)c->cells, c->width[0],
                      c->depth[0]);
        assert_true((c->width[0] == SIDE && c->depth[0] == SIDE) == above);
        assert_true(c->size[0] > 0.9 * (double)c->cells || !above);
        lac_clusters_free(c);
    }
    free(occupied);
}

static void empty_domain_is_refused(void **state)
{
    (void)state;
    uint8_t occupied[16] = {0};
    lac_grid grid = {4, 4, 1.0, 1.0, true};
    lac_error err = {""};
    lac_clusters *clusters = NULL;
    lac_domain *domain = set_domain(&grid, occupied);
    assert_non_null(domain);
    assert_int_equal(lac_clusters_create(domain, &clusters, &err), LAC_EINPUT);
    assert_null(clusters);
    assert_non_null(strstr(err.message, "no cell"));
    set_domain_free(domain);
    lac_clusters_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_shapes),
        cmocka_unit_test(clusters_of_a_line),
        cmocka_unit_test(random_maps_agree_with_a_flood),
        cmocka_unit_test(percolation_sets_in),
        cmocka_unit_test(empty_domain_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
