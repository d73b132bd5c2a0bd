// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors whose sums wait: the bits of plain loops whatever waits, also through CVODE.
#include <string.h>

#include <cvodes/cvodes.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "base/rng.h"
#include "run/pending.h"
#include "run/vector.h"
#include "support/test.h"

enum { ARRAYS = 8, MOST = 1200, LONG = 16700 }; // LONG: some is made before the rest

static double uniform(uint64_t i, uint64_t what)
{
    return 2.0 * lac_random_uniform(5, LAC_STREAM_TEST, i, what) - 1.0;
}

static size_t choose(uint64_t i, uint64_t what, size_t count)
{
    return (size_t)((0.5 + 0.5 * uniform(i, what)) * (double)count) % count;
}

typedef struct arrays {
    double of[ARRAYS][LONG];
} arrays;

static void fill(arrays *a)
{
    for (size_t j = 0; j < ARRAYS; j++) {
        for (size_t i = 0; i < LONG; i++) {
            a->of[j][i] = uniform(i, 100 + j);
        }
    }
}

// The same by what the words say, an element at a time.
static void combine(size_t n, int count, const double *c, const double *const *x, double *z)
{
    for (size_t i = 0; i < n; i++) {
        double sum = c[0];
        for (int j = 0; j < count; j++) {
            sum = j == 0 ? c[0] * x[0][i] : sum + c[j] * x[j][i];
        }
        z[i] = sum;
    }
}

// One array is looked into and changed while others wait, or its weighted norm asked for. What was
// looked at stays while another one is made.
static void look_at_one(lac_pending *p, size_t n, uint64_t k, arrays *plain, arrays *made)
{
    const size_t which = choose(k, 4, ARRAYS), weight = choose(k, 5, ARRAYS);
    double *is = made->of[which], *should = plain->of[which];
    if (choose(k, 6, 2) == 0) {
        const double *seen = lac_pending_look(p, is);
        lac_pending_finish_one(p, made->of[weight]);
        assert_memory_equal(made->of[weight], plain->of[weight], n * sizeof *is);
        assert_memory_equal(seen, should, n * sizeof *is);
        if (seen != is || choose(k, 8, 2) == 0) {
            lac_pending_finish_one(p, is);
        }
        assert_memory_equal(is, should, n * sizeof *is);
        is[n / 2] = should[n / 2] = uniform(k, 7);
        lac_pending_finish_one(p, is); // before more is added
        return;
    }
    const lac_range whole = lac_range_whole(n);
    lac_pending *none = lac_pending_create(&whole, 1, false);
    assert_non_null(none);
    const double sums[] = {lac_pending_squares(p, is, made->of[weight]),
                           lac_pending_squares(none, should, plain->of[weight])};
    assert_memory_equal(&sums[0], &sums[1], sizeof sums[0]);
    lac_pending_free(none);
}

// An array is 0 or has one value all over, and what it was to become is forgotten.
static void level_one(lac_pending *p, size_t n, uint64_t k, arrays *plain, arrays *made)
{
    const size_t which = choose(k, 4, ARRAYS);
    const double level = choose(k, 6, 2) == 0 ? 0.0 : uniform(k, 7);
    combine(n, 0, &level, NULL, plain->of[which]);
    lac_pending_forget(p, made->of[which]);
    lac_pending_add(p, 0, &level, NULL, made->of[which]);
}

// z = c x + b y, in plain and where it waits.
static void add_two(lac_pending *p, size_t n, arrays *plain, arrays *made, const double *c,
                    const size_t *x, size_t z)
{
    const double *from[2][2] = {{plain->of[x[0]], plain->of[x[1]]},
                                {made->of[x[0]], made->of[x[1]]}};
    combine(n, 2, c, from[0], plain->of[z]);
    lac_pending_add(p, 2, c, from[1], made->of[z]);
}

static void scale(lac_pending *p, size_t n, arrays *plain, arrays *made, double c, size_t x,
                  size_t z)
{
    combine(n, 1, &c, (const double *[]){plain->of[x]}, plain->of[z]);
    lac_pending_add(p, 1, &c, (const double *[]){made->of[x]}, made->of[z]);
}

// What CVODE makes of the history h of order q and the correction a between two steps; some of it
// is scaled instead, as where the step changes.
static void look_ahead(lac_pending *p, size_t n, uint64_t k, arrays *plain, arrays *made,
                       const size_t *h, size_t q, size_t a)
{
    for (size_t j = 0; j <= q; j++) {
        const double c = j == 0 && choose(k, 67, 8) > 0 ? 1.0 : uniform(k, 70 + j);
        const double own = j == 0 && choose(k, 91, 8) == 0 ? uniform(k, 92) : 1.0;
        if (choose(k, 85 + j, 12) == 0) {
            scale(p, n, plain, made, c, h[j], h[j]);
        } else {
            add_two(p, n, plain, made, (double[]){c, own}, (size_t[]){a, h[j]}, h[j]);
        }
    }
    const size_t between = choose(k, 66, 8);
    for (size_t stage = 0; stage < 3 && choose(k, 68, 2) == 0; stage++) {
        if (between == stage) {
            look_at_one(p, n, k, plain, made);
        } else if (choose(k, 80 + stage, 3) > 0) {
            scale(p, n, plain, made, 1.0, h[0], stage == 0 ? 7 : choose(k, 65, ARRAYS));
        }
    }
    for (size_t m = 1; m <= q; m++) {
        for (size_t j = q; j >= m; j--) {
            add_two(p, n, plain, made, (double[]){1.0, 1.0}, (size_t[]){h[j - 1], h[j]}, h[j - 1]);
        }
    }
}

// A step as CVODE takes it: array 6 is the correction and 7 what was tried, or another is; one
// array may be in the history twice, and factors other than 1.
static void step_at_random(lac_pending *p, size_t n, uint64_t k, arrays *plain, arrays *made)
{
    const size_t q = 1 + choose(k, 60, 5);
    const size_t a = choose(k, 61, 3) == 0 ? choose(k, 62, ARRAYS) : 6;
    const size_t y = choose(k, 63, 8) == 0 ? choose(k, 64, ARRAYS) : 7;
    double c[] = {1.0, 1.0};
    if (choose(k, 69, 4) == 0) {
        c[choose(k, 76, 2)] = uniform(k, 77);
    }
    size_t h[] = {0, 1, 2, 3, 4, 5};
    if (choose(k, 78, 4) == 0) {
        h[choose(k, 79, 6)] = choose(k, 83, 6);
    }
    for (size_t j = 0; j < ARRAYS; j++) { // so that none grows without end
        scale(p, n, plain, made, 1.0 / 64.0, j, j);
    }
    add_two(p, n, plain, made, c, (size_t[]){h[0], a}, y);
    look_ahead(p, n, k, plain, made, h, q, choose(k, 93, 8) == 0 ? choose(k, 94, ARRAYS) : a);
    if (choose(k, 84, 2) == 0) {
        look_at_one(p, n, k + 1000, plain, made);
    }
}

// Far more than can wait at once, of all lengths, results among what is added up.
static void many_at_random(size_t n, bool waits)
{
    static arrays plain, made;
    const lac_range whole = lac_range_whole(n);
    lac_pending *p = lac_pending_create(&whole, 1, waits);
    assert_non_null(p);
    fill(&plain);
    fill(&made);
    for (uint64_t k = 0; k < test_some(600); k++) {
        const double *from[2][8];
        double c[8];
        int count = (int)choose(k, 1, 9);
        for (int j = 0; j < 8; j++) {
            size_t which = choose(k, 10 + (uint64_t)j, ARRAYS);
            from[0][j] = plain.of[which];
            from[1][j] = made.of[which];
            c[j] = uniform(k, 40 + (uint64_t)j) / 4.0;
        }
        size_t to = choose(k, 2, ARRAYS);
        for (size_t times = count == 2 ? 2 : 1; times > 0; times--) { // the second may still hold
            combine(n, count, c, from[0], plain.of[to]);
            lac_pending_add(p, count, c, from[1], made.of[to]);
        }
        const size_t next = choose(k, 3, 50);
        if (next == 0) {
            lac_pending_finish(p, NULL);
        } else if (next < 5) {
            level_one(p, n, k, &plain, &made);
        } else if (next < 12) {
            look_at_one(p, n, k, &plain, &made);
        } else if (next < 30) {
            step_at_random(p, n, k, &plain, &made);
        }
    }
    lac_pending_finish(p, NULL);
    for (size_t j = 0; j < ARRAYS; j++) {
        lac_pending_finish_one(p, made.of[j]);
        assert_memory_equal(plain.of[j], made.of[j], sizeof plain.of[j]);
    }
    lac_pending_free(p);
}

static void waiting_changes_no_bit(void **state)
{
    (void)state;
    const size_t lengths[] = {1, 7, 255, 256, 257, 1000, MOST, LONG};
    for (size_t k = 0; k < sizeof lengths / sizeof *lengths; k++) {
        many_at_random(lengths[k], true);
        many_at_random(lengths[k], false);
    }
}

// As many terms as there may be, into an array that is none of them.
static void long_combination(void **state)
{
    (void)state;
    static double x[LAC_PASS_TERMS][MOST], plain[MOST], made[MOST];
    const double *from[LAC_PASS_TERMS];
    double c[LAC_PASS_TERMS];
    for (size_t j = 0; j < LAC_PASS_TERMS; j++) {
        from[j] = x[j];
        c[j] = uniform(j, 7);
        for (size_t i = 0; i < MOST; i++) {
            x[j][i] = uniform(i, 200 + j);
        }
    }
    const lac_range whole = lac_range_whole(MOST);
    lac_pending *p = lac_pending_create(&whole, 1, true);
    for (int count = 1; count <= LAC_PASS_TERMS; count++) {
        combine(MOST, count, c, from, plain);
        lac_pending_add(p, count, c, from, made);
        lac_pending_finish(p, made);
        assert_memory_equal(plain, made, sizeof plain);
    }
    lac_pending_free(p);
}

// The sum of squares sees what waits, and is that of all elements.
static void squares_of_what_waits(void **state)
{
    (void)state;
    static double x[MOST], w[MOST];
    for (size_t n = 1; n <= MOST; n += 61) {
        const lac_range whole = lac_range_whole(n);
        lac_pending *late = lac_pending_create(&whole, 1, true);
        lac_pending *soon = lac_pending_create(&whole, 1, false);
        double sums[2];
        long double exact = 0.0L;
        for (int k = 0; k < 2; k++) {
            lac_pending *p = k == 0 ? late : soon;
            for (size_t i = 0; i < n; i++) {
                x[i] = uniform(i, 1);
                w[i] = uniform(i, 2);
            }
            lac_pending_add(p, 2, (double[]){3.0, 1.0}, (const double *[]){x, w}, x);
            sums[k] = lac_pending_squares(p, x, w);
        }
        for (size_t i = 0; i < n; i++) {
            long double term = (long double)x[i] * w[i];
            exact += term * term;
        }
        assert_memory_equal(&sums[0], &sums[1], sizeof sums[0]);
        assert_true(fabs(sums[0] - (double)exact) <= 1e-14 * (double)exact);
        lac_pending_free(late);
        lac_pending_free(soon);
    }
}

// What CVODE does at the end of a step and at the beginning of the next, as it is seen from here:
// z_j = c_j a + z_j, then z_j-1 = z_j-1 + z_j for j = q ... m, of m = 1 ... q. @param last  factor
// of the last sum: else 1
static void step_history(lac_pending *p, int order, bool corrected, const double *a,
                         double *const *z, const double last[2])
{
    for (int j = 0; corrected && j <= order; j++) {
        lac_pending_add(p, 2, (double[]){0.3 + j, 1.0}, (const double *[]){a, z[j]}, z[j]);
    }
    for (int m = 1; m <= order; m++) {
        for (int j = order; j >= m; j--) {
            lac_pending_add(p, 2, m < order ? (double[]){1.0, 1.0} : last,
                            (const double *[]){z[j - 1], z[j]}, z[j - 1]);
        }
    }
}

// A prediction in registers has the bits of its sums, of every order and length, alone and after
// other sums; with another factor or an array twice it is none.
static void prediction_is_its_sums(void **state)
{
    enum { HIGHEST = 7, WAYS = 7 };
    static double z[2][HIGHEST + 1][LONG], a[LONG];
    const size_t lengths[] = {1, 255, 1000, LONG};
    (void)state;
    for (size_t k = 0; k < (test_few() ? 3 : 4) * (size_t)HIGHEST * WAYS; k++) {
        const size_t n = lengths[k / WAYS / HIGHEST];
        const int order = 1 + (int)(k / WAYS % HIGHEST), way = (int)(k % WAYS);
        const lac_range whole = lac_range_whole(n);
        for (int late = 0; late < 2; late++) {
            lac_pending *p = lac_pending_create(&whole, 1, late != 0);
            for (size_t i = 0; i < n; i++) {
                a[i] = uniform(i, 1);
                for (size_t j = 0; j <= HIGHEST; j++) {
                    z[late][j][i] = uniform(i, 300 + j);
                }
            }
            double *top = z[late][order], *next = z[late][order - 1];
            if (way == 1) {
                lac_pending_add(p, 1, (double[]){0.7}, (const double *[]){top}, top);
            } else if (way == 2) { // z_q is corrected by another
                lac_pending_add(p, 2, (double[]){0.1, 1.0}, (const double *[]){next, top}, top);
            }
            double *at[HIGHEST + 1];
            for (int j = 0; j <= order; j++) {
                at[j] = z[late][way == 5 && j == order ? 0 : j];
            }
            step_history(p, order, way > 0, way == 6 ? at[order / 2] : a, at,
                         (double[]){way == 3 ? 0.5 : 1.0, way == 4 ? 0.5 : 1.0});
            lac_pending_finish(p, z[late][0]);
            lac_pending_free(p);
        }
        for (int j = 0; j <= order; j++) {
            assert_memory_equal(z[0][j], z[1][j], n * sizeof(double));
        }
    }
}

// What a trial, y = z + a, and the state that becomes it, z = a + z, may meet: all of it in turn.
enum { UNSEEN, SCALED, FROM_OTHER, Y_WRITTEN, Y_GIVEN, Z_GIVEN, A_GIVEN, FATES };

enum { Z, A, Y, COPY, OTHER, PLACES };

static void try_and_correct(lac_pending *p, int fate, double of[PLACES][LONG])
{
    const double c[] = {fate == SCALED ? 0.5 : 1.0, 1.0}, two[] = {1.0, 1.0}, by[] = {2.0};
    const double *from = fate == FROM_OTHER ? of[OTHER] : of[Z];
    lac_pending_add(p, 2, c, (const double *[]){from, of[A]}, of[Y]);
    if (fate != UNSEEN) {
        (void)lac_pending_look(p, of[Y]);
    }
    lac_pending_add(p, 2, two, (const double *[]){of[A], of[Z]}, of[Z]);
    lac_pending_add(p, 1, two, (const double *[]){of[Z]}, of[Y]);
    of[OTHER][1] = lac_pending_look(p, of[Z])[LONG / 2];
    if (fate == Y_WRITTEN) {
        lac_pending_finish_one(p, of[Y]);
        of[Y][LONG / 2] = 7.0;
    } else if (fate >= Y_GIVEN) {
        double *given = of[fate == Y_GIVEN ? Y : fate == Z_GIVEN ? Z : A];
        lac_pending_add(p, 1, by, (const double *[]){given}, given);
    }
    of[OTHER][2] = lac_pending_look(p, of[Z])[LONG / 2];
    of[OTHER][3] = lac_pending_squares(p, of[Z], of[OTHER]);
    lac_pending_add(p, 1, two, (const double *[]){of[Z]}, of[COPY]);
    lac_pending_finish(p, of[Z]);
}

// A state corrected by what was added to it for a trial is that trial, until one of them changes.
static void trial_becomes_state(void **state)
{
    static double of[2][PLACES][LONG];
    (void)state;
    for (int fate = 0; fate < FATES; fate++) {
        for (int late = 0; late < 2; late++) {
            const lac_range whole = lac_range_whole(LONG);
            lac_pending *p = lac_pending_create(&whole, 1, late != 0);
            for (size_t k = 0; k < PLACES * (size_t)LONG; k++) {
                of[late][k / LONG][k % LONG] = uniform(k, 1);
            }
            try_and_correct(p, fate, of[late]);
            lac_pending_free(p);
        }
        assert_memory_equal(of[0], of[1], sizeof of[0]);
    }
}

// Coupled oscillators: dx/dt = v, dv/dt = -(2 + sin i) x + mean v^2.
static int swing(sunrealtype t, N_Vector y, N_Vector ydot, void *user)
{
    sunindextype n = N_VGetLength(y) / 2;
    const double *x = N_VGetArrayPointer(y), *v = x + n;
    double *dx = N_VGetArrayPointer(ydot), *dv = dx + n;
    double mean = 0.0;
    (void)t, (void)user;
    for (sunindextype i = 0; i < n; i++) {
        mean += v[i] * v[i] / (double)n;
    }
    for (sunindextype i = 0; i < n; i++) {
        dx[i] = v[i];
        dv[i] = 0.1 * mean - (2.0 + sin((double)i)) * x[i];
    }
    return 0;
}

// A hundred steps with all that CVODE does to vectors; y [n] at the end.
static void follow(N_Vector y, int method, SUNContext sun, double *end)
{
    size_t n = (size_t)N_VGetLength(y);
    double *at = N_VGetArrayPointer(y);
    for (size_t i = 0; i < n; i++) {
        at[i] = uniform(i, 3);
    }
    void *mem = CVodeCreate(method, sun);
    SUNNonlinearSolver solver = SUNNonlinSol_FixedPoint(y, 3, sun);
    sunrealtype t;
    assert_int_equal(CVodeInit(mem, swing, 0.0, y), CV_SUCCESS);
    assert_int_equal(CVodeSStolerances(mem, 1e-7, 1e-9), CV_SUCCESS);
    assert_int_equal(CVodeSetNonlinearSolver(mem, solver), CV_SUCCESS);
    for (double stop = 1.0; stop <= 5.0; stop += 1.0) {
        assert_int_equal(CVode(mem, stop, y, &t, CV_NORMAL), CV_SUCCESS);
    }
    memcpy(end, N_VGetArrayPointer(y), n * sizeof *end);
    CVodeFree(&mem);
    SUNNonlinSolFree(solver);
    N_VDestroy(y);
}

static void cvode_sees_no_difference(void **state)
{
    (void)state;
    static double late[LONG], soon[LONG], theirs[LONG];
    SUNContext sun;
    assert_int_equal(LAC_SUN_CONTEXT_CREATE(&sun), 0);
    for (int k = 0; k < (test_few() ? 2 : 4); k++) {
        const int method = k % 2 == 0 ? CV_ADAMS : CV_BDF;
        const size_t n = k < 2 ? 602 : LONG;
        const lac_range whole = lac_range_whole(n);
        follow(lac_vector_create(&whole, 1, true, sun), method, sun, late);
        follow(lac_vector_create(&whole, 1, false, sun), method, sun, soon);
        follow(N_VNew_Serial((sunindextype)n, sun), method, sun, theirs);
        assert_memory_equal(late, soon, n * sizeof *late);
        for (size_t i = 0; i < n; i++) { // their norms are added up in another order
            assert_true(fabs(late[i] - theirs[i]) <= 1e-9);
        }
    }
    SUNContext_Free(&sun);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(waiting_changes_no_bit), cmocka_unit_test(long_combination),
        cmocka_unit_test(squares_of_what_waits),  cmocka_unit_test(prediction_is_its_sums),
        cmocka_unit_test(trial_becomes_state),    cmocka_unit_test(cvode_sees_no_difference),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
