// SPDX-License-Identifier: GPL-3.0-or-later
// Sums and the hierarchy of ranks against those of one, to the bit. The ranks are threads here, so
// that this needs no MPI.
#include "base/range.h"
#include "base/strip.h"
#include "hierarchy/hierarchy.h"
#include "support/ranks.h"
#include "support/test.h"

enum { SIDE = 512, MOST_RANKS = 8, LEVELS = 9 };

// One joint, and what is asked of it.
typedef struct joint {
    lac_domain *domain;
    lac_hierarchy *whole;
    double k[LEVELS];
    double *x, *diagonal; // [n]
} joint;

// What comes out, of all cells.
typedef struct answer {
    double sum;
    bool good;
    double *force, *solution; // [n]
} answer;

static double uniform(size_t i, uint64_t seed)
{
    uint64_t z = (i + 1) * UINT64_C(0x9e3779b97f4a7c15) + seed;
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static void make(joint *j)
{
    static double pressure[SIDE * SIDE];
    const lac_grid grid = {.nx = SIDE, .ny = SIDE, .dx = 1.0, .dy = 1.0};
    for (size_t i = 0; i < SIDE * SIDE; i++) { // gaps of all sizes
        const bool gap = uniform(i / 977, 3) < 0.3;
        pressure[i] = !gap && uniform(i, 1) < 0.7 ? 1e6 : 0.0;
    }
    assert_int_equal(lac_domain_create(&grid, pressure, &j->domain, NULL), LAC_OK);
    assert_int_equal(lac_hierarchy_create(j->domain, &j->whole, NULL), LAC_OK);
    assert_true(j->domain->n > LAC_RANGE_ALONE);
    j->x = malloc(2 * j->domain->n * sizeof *j->x);
    j->diagonal = j->x + j->domain->n;
    for (size_t i = 0; i < j->domain->n; i++) {
        j->x[i] = uniform(i, 5) - 0.5;
        j->diagonal[i] = exp(20.0 * uniform(i, 6));
    }
    for (size_t l = 0; l < LEVELS; l++) {
        j->k[l] = 1e6 * pow(0.5, (double)l);
    }
}

static void clear(joint *j)
{
    lac_hierarchy_free(j->whole);
    lac_domain_free(j->domain);
    free(j->x);
}

// What one rank finds, put where its cells are.
typedef struct question {
    const joint *j;
    answer *out;
} question;

static void find(lac_team *team, void *context)
{
    const joint *j = ((const question *)context)->j;
    answer *out = ((const question *)context)->out;
    const int rank = team != NULL ? team->rank : 0;
    const lac_range range = lac_range_of(team, rank, j->domain->n);
    const size_t first = range.first;
    lac_hierarchy *part = NULL;
    const lac_hierarchy *h = j->whole;
    if (team != NULL) {
        assert_int_equal(lac_hierarchy_split(j->whole, &range, &part, NULL), LAC_OK);
        h = part;
    }
    double *work = malloc((lac_hierarchy_work(h) + 1) * sizeof *work);
    const double sum = lac_range_sum(&range, j->x + first);
    lac_hierarchy_apply(h, j->k, j->x + first, out->force + first, work);
    const bool good = lac_hierarchy_solve(h, j->k, 3.0, j->diagonal + first, j->x + first,
                                          out->solution + first, work);
    free(work);
    lac_hierarchy_free(part);
    if (rank == 0) {
        out->sum = sum;
        out->good = good;
    }
    assert_true(lac_team_all(team, good) == good);
}

static answer answer_of(const joint *j, int ranks)
{
    answer out = {.force = calloc(2 * j->domain->n, sizeof(double))};
    out.solution = out.force + j->domain->n;
    (void)ranks_do(ranks, find, &(question){j, &out});
    return out;
}

// All numbers of ranks. @return whether there is a solution
static bool compare(const joint *j)
{
    const size_t n = j->domain->n;
    const answer one = answer_of(j, 0);
    for (int ranks = 1; ranks <= MOST_RANKS; ranks++) {
        const answer many = answer_of(j, ranks);
        assert_true(many.good == one.good);
        assert_memory_equal(&many.sum, &one.sum, sizeof one.sum);
        assert_memory_equal(many.force, one.force, n * sizeof(double));
        if (one.good) {
            assert_memory_equal(many.solution, one.solution, n * sizeof(double));
        }
        free(many.force);
    }
    free(one.force);
    return one.good;
}

static void ranks_give_the_bits_of_one(void **state)
{
    (void)state;
    joint j;
    make(&j);
    assert_true(compare(&j));
    clear(&j);
}

// One cell whose pivot is none is known to all.
static void ranks_refuse_together(void **state)
{
    (void)state;
    joint j;
    make(&j);
    const size_t n = j.domain->n, bad[] = {0, n / 2, n - 1};
    int refused = 0;
    for (size_t b = 0; b < sizeof bad / sizeof *bad; b++) {
        const double before = j.diagonal[bad[b]];
        j.diagonal[bad[b]] = -1e9;
        refused += compare(&j) ? 0 : 1;
        j.diagonal[bad[b]] = before;
    }
    assert_true(refused > 0);
    clear(&j);
}

// Where the part of a block that a rank has could not stand alone, the whole block can.
static void borders_cut_what_holds_together(void **state)
{
    (void)state;
    joint j;
    make(&j);
    const uint32_t *first = lac_hierarchy_offsets(j.whole, 1);
    int cut = 0;
    for (size_t b = 0; b < lac_hierarchy_blocks(j.whole, 1); b++) {
        const size_t border = (first[b + 1] - 1) / LAC_RANGE_BLOCK_LEAST * LAC_RANGE_BLOCK_LEAST;
        if (first[b] < border) {
            cut++;
            j.diagonal[border] = -0.51e6;
            for (size_t i = first[b]; i < border; i++) {
                j.diagonal[i] = 1e9;
            }
        }
    }
    assert_true(cut > 0);
    assert_true(compare(&j));
    clear(&j);
}

// What is handed over, and what came at the rank that leads.
typedef struct handed {
    size_t all, come;
    double *x, *seen; // [2][all]
} handed;

static void take(void *context, double *x, size_t n)
{
    handed *h = context;
    assert_true(h->come % h->all + n <= h->all);
    memcpy(h->seen + h->come, x, n * sizeof *x);
    h->come += n;
}

static void hand(lac_team *team, void *context)
{
    handed *h = context;
    const lac_range range = lac_range_of(team, team != NULL ? team->rank : 0, h->all);
    double *here = malloc(2 * range.n * sizeof *here + 1);
    memcpy(here, h->x + range.first, range.n * sizeof *here);
    memcpy(here + range.n, h->x + h->all + range.first, range.n * sizeof *here);
    assert_true(lac_range_hand(&range, here, 2, take, h));
    free(here);
}

// Also of cells that are more than one piece, or fewer than there are ranks.
static void arrays_come_whole_piece_by_piece(void **state)
{
    (void)state;
    const size_t all[] = {5, LAC_RANGE_ALONE + 1, LAC_RANGE_PIECE, 2 * LAC_RANGE_PIECE + 4097};
    for (size_t c = 0; c < sizeof all / sizeof *all; c++) {
        handed h = {.all = all[c], .x = malloc(4 * all[c] * sizeof(double))};
        h.seen = h.x + 2 * h.all;
        for (size_t i = 0; i < 2 * h.all; i++) {
            h.x[i] = uniform(i, 8);
        }
        for (int ranks = 0; ranks <= 5; ranks += ranks < 3 ? 1 : 2) {
            h.come = 0;
            memset(h.seen, 0, 2 * h.all * sizeof *h.seen);
            (void)ranks_do(ranks, hand, &h);
            assert_int_equal(h.come, 2 * h.all);
            assert_memory_equal(h.seen, h.x, 2 * h.all * sizeof *h.x);
        }
        free(h.x);
    }
}

static const size_t counts[] = {1,
                                4096,
                                4097,
                                1 << 20,
                                (1 << 20) + 1,
                                (size_t)1 << 31,
                                UINT32_MAX,
                                (size_t)1 << 32,
                                ((size_t)1 << 32) + 1};
enum { COUNTS = sizeof counts / sizeof *counts };

// The blocks of a case, whatever its cells: no rank has a part of one, and together they have all.
static void blocks_are_shared_whole(void **state)
{
    (void)state;
    const size_t *all = counts;
    for (size_t i = 0; i < COUNTS; i++) {
        lac_team team = {.ranks = 7};
        size_t next = 0;
        for (int r = 0; r < team.ranks; r++) {
            const lac_range range = lac_range_of(&team, r, all[i]);
            assert_int_equal(range.first, next);
            assert_true(range.n == 0 || range.first % range.block == 0);
            assert_true((all[i] + range.block - 1) / range.block <= LAC_RANGE_BLOCKS);
            next = range.first + range.n;
        }
        assert_int_equal(next, all[i]);
    }
}

// Likewise rows.
static void rows_are_shared_whole(void **state)
{
    const size_t grains[] = {1, 2, 16};
    (void)state;
    for (size_t i = 0; i < 3 * COUNTS; i++) {
        const size_t all = counts[i / 3], grain = grains[i % 3];
        lac_team team = {.ranks = 7};
        const lac_strip rows = lac_strip_of(&team, all, grain);
        size_t next = 0;
        for (int r = 0; r < team.ranks; r++) {
            const lac_strip at = lac_strip_at(&rows, r);
            assert_int_equal(at.first, next);
            assert_true(at.n <= (rows.grains / 7 + 1) * grain);
            next += at.n;
        }
        assert_int_equal(next, all);
        assert_int_equal(lac_grid_cells(&(lac_grid){.nx = all, .ny = grain}), all * grain);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ranks_give_the_bits_of_one),
        cmocka_unit_test(ranks_refuse_together),
        cmocka_unit_test(borders_cut_what_holds_together),
        cmocka_unit_test(arrays_come_whole_piece_by_piece),
        cmocka_unit_test(blocks_are_shared_whole),
        cmocka_unit_test(rows_are_shared_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
