// SPDX-License-Identifier: GPL-3.0-or-later
// A block with mass over many cells: against dense matrices and another integrator (GSL), its
// energy, and the limits in which it is one block, or none.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_linalg.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>

#include "lacuna/simulation.h"
#include "support/test.h"
#include "support/tree.h"

enum { MOST = 64 };

static const double ratio_rate = 0.5;       // of the load [1/s]
static const double spring_stiffness = 1e9; // over the nominal area [Pa/m]

static void pull(const lac_load *load, double t, lac_load_state *sum)
{
    (void)load;
    sum->ratio += ratio_rate * t;
    sum->ratio_rate += ratio_rate;
    sum->spring_stiffness += spring_stiffness;
}

static const lac_load_kind pull_row = {.info = {.name = "pull"}, .add = pull};
static const lac_load pulled = {.kind = &pull_row};

// Cells that slide at about 1 mm/s and are pulled faster, under a mass that matters to them.
static tree_def sliding(double columns)
{
    tree_def def = tree_default(2, 3);
    def.k0 = 1e11;
    def.slip_rate = 1e-3;
    def.state = 1e-2;
    def.mass = 1e5;
    def.columns = columns;
    def.loads = (lac_load_set){.load = (lac_load *)&pulled, .count = 1, .shear = 1};
    return def;
}

// The equations again, in dense matrices.
typedef struct dense {
    const tree_def *def;
    size_t n;
    double p[MOST], share[MOST], traction0[MOST];
    double k[MOST][MOST], m[MOST][MOST], inverse[MOST][MOST];
} dense;

static bool together(const lac_domain *domain, size_t i, size_t j, size_t level)
{
    size_t nx = domain->grid.nx;
    size_t a = domain->index[i];
    size_t b = domain->index[j];
    return (a % nx) >> level == (b % nx) >> level && (a / nx) >> level == (b / nx) >> level;
}

// Mean over the cells of i's block of a level, as an element of its projection.
static double projection(const lac_domain *domain, size_t i, size_t j, size_t level)
{
    size_t cells = 0;
    for (size_t c = 0; c < domain->n; c++) {
        cells += together(domain, i, c, level);
    }
    return together(domain, i, j, level) ? 1.0 / (double)cells : 0.0;
}

static void invert(dense *d)
{
    gsl_matrix *a = gsl_matrix_alloc(d->n, d->n);
    gsl_matrix *b = gsl_matrix_alloc(d->n, d->n);
    gsl_permutation *p = gsl_permutation_alloc(d->n);
    int sign;
    for (size_t i = 0; i < d->n * d->n; i++) {
        gsl_matrix_set(a, i / d->n, i % d->n, d->m[i / d->n][i % d->n]);
    }
    gsl_linalg_LU_decomp(a, p, &sign);
    gsl_linalg_LU_invert(a, p, b);
    for (size_t i = 0; i < d->n * d->n; i++) {
        d->inverse[i / d->n][i % d->n] = gsl_matrix_get(b, i / d->n, i % d->n);
    }
    gsl_permutation_free(p);
    gsl_matrix_free(b);
    gsl_matrix_free(a);
}

static double friction(const dense *d, double v, double w)
{
    const tree_def *def = d->def;
    return def->f0 + def->a * log(v / def->v0) + def->b * (log(def->v0 / def->dc) + w);
}

// Waves take off a cell what its rate is besides the mean: a block gives none of its own away.
static double damped(const dense *d, const double *v, size_t i)
{
    double mean = 0.0;
    for (size_t j = 0; j < d->n; j++) {
        mean += v[j] / (double)d->n;
    }
    return d->def->damping * (v[i] - mean);
}

static void make_dense(const tree_def *def, const tree *t, dense *d)
{
    const lac_domain *domain = t->domain;
    double sum = 0.0;
    double v[MOST];
    double y[3 * MOST];
    double *work = calloc(lac_problem_work(t->problem), sizeof *work);
    *d = (dense){.def = def, .n = domain->n};
    assert_true(d->n <= MOST);
    lac_problem_initial(t->problem, y);
    lac_problem_rates(t->problem, 0.0, y, v, work);
    free(work);
    for (size_t i = 0; i < d->n; i++) {
        d->p[i] = domain->pressure[i];
        sum += d->p[i];
        d->traction0[i] = d->p[i] * friction(d, v[i], log(def->state)) + damped(d, v, i);
    }
    double area = (double)(domain->grid.nx * domain->grid.ny) / (double)d->n;
    for (size_t i = 0; i < d->n; i++) {
        d->share[i] = d->p[i] * (double)d->n / sum;
    }
    for (size_t i = 0; i < d->n * d->n; i++) {
        size_t r = i / d->n;
        size_t c = i % d->n;
        double m = def->mass * area;
        d->m[r][c] = (1.0 - def->columns) * m * d->share[r] * d->share[c] / (double)d->n;
        d->m[r][c] += r == c ? def->columns * m * d->share[r] : 0.0;
        d->k[r][c] = spring_stiffness * area / (double)d->n;
        double stiffness = def->k0;
        for (size_t l = 0; l < (size_t)def->levels; l++, stiffness *= def->ratio) {
            d->k[r][c] +=
                stiffness * (projection(domain, r, c, l) - projection(domain, r, c, l + 1));
        }
    }
    invert(d);
}

// y = (v, ln theta, slip).
static int rates(double t, const double y[], double ydot[], void *params)
{
    const dense *d = params;
    size_t n = d->n;
    double force[MOST];
    for (size_t i = 0; i < n; i++) {
        force[i] = d->traction0[i] + d->p[i] * ratio_rate * t - damped(d, y, i) -
                   d->p[i] * friction(d, y[i], y[n + i]);
        for (size_t j = 0; j < n; j++) {
            force[i] -= d->k[i][j] * y[2 * n + j];
        }
    }
    for (size_t i = 0; i < n; i++) {
        ydot[i] = 0.0;
        for (size_t j = 0; j < n; j++) {
            ydot[i] += d->inverse[i][j] * force[j];
        }
        ydot[n + i] = exp(-y[n + i]) - y[i] / d->def->dc;
        ydot[2 * n + i] = y[i];
    }
    return 0;
}

// What a run shows of its cells: the last snapshot, and the work done on their mass.
typedef struct observation {
    size_t n;
    const dense *d;
    double slip[MOST], rate[MOST], state[MOST];
    double time, power, work;
    double kinetic, first_kinetic; // energy over r^2 [J/m2]
    bool begun;
} observation;

static lac_status look(void *context, const lac_snapshot *now, lac_error *err)
{
    observation *s = context;
    const dense *d = s->d;
    (void)err;
    double power = 0.0;
    s->kinetic = 0.0;
    for (size_t i = 0; i < s->n; i++) {
        double v = now->slip_rate[i];
        s->slip[i] = now->slip[i];
        s->rate[i] = v;
        s->state[i] = now->state[i];
        power += v * (now->traction[i] - damped(d, now->slip_rate, i) -
                      d->p[i] * friction(d, v, log(now->state[i])));
        for (size_t j = 0; j < s->n; j++) {
            s->kinetic += 0.5 * v * d->m[i][j] * now->slip_rate[j];
        }
    }
    if (!s->begun) {
        s->first_kinetic = s->kinetic;
        s->begun = true;
    } else {
        s->work += 0.5 * (power + s->power) * (now->time - s->time);
    }
    s->time = now->time;
    s->power = power;
    return LAC_OK;
}

static lac_run_result run_tree(const tree *t, const lac_run_def *how, observation *s)
{
    lac_run_result result;
    lac_error err = {""};
    lac_sink sink = {.context = s, .snapshot = look};
    if (lac_run(t->problem, how, &sink, &result, &err) != LAC_OK) {
        fail_msg("run: %s", err.message);
    }
    return result;
}

static const double end = 0.05; // [s]

static lac_run_def to_the_end(lac_method method)
{
    lac_run_def how = lac_run_default();
    how.method = method;
    how.rtol = 1e-10;
    how.end = end;
    how.failure_rate = 1e6;
    how.snapshots = true;
    how.snapshot = (lac_cadence){.time = end / 2000, .per_decade = NAN};
    return how;
}

// Every method, mass in columns and as a block: cells as by a dense computation, to 1e-6.
static void cells_as_by_dense_matrices(void **state)
{
    (void)state;
    const double parts[] = {1.0, 0.05};
    for (size_t c = 0; c < 2; c++) {
        tree_def def = sliding(parts[c]);
        tree t;
        static dense d;
        double y[3 * MOST];
        tree_create(&def, &t);
        make_dense(&def, &t, &d);
        size_t n = d.n;
        double *work = calloc(lac_problem_work(t.problem), sizeof *work);
        lac_problem_initial(t.problem, y);
        lac_problem_rates(t.problem, 0.0, y, y, work);
        free(work);
        gsl_odeiv2_system system = {rates, NULL, 3 * n, &d};
        gsl_odeiv2_driver *driver =
            gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-7, 1e-16, 1e-12);
        double time = 0.0;
        assert_int_equal(gsl_odeiv2_driver_apply(driver, &time, end, y), 0);
        gsl_odeiv2_driver_free(driver);
        for (int method = LAC_BDF; method <= LAC_ERK; method++) {
            observation s = {.n = n, .d = &d};
            lac_run_def how = to_the_end((lac_method)method);
            lac_run_result result = run_tree(&t, &how, &s);
            double worst = 0.0;
            for (size_t i = 0; i < n; i++) {
                worst = fmax(worst, fabs(s.rate[i] / y[i] - 1.0));
                worst = fmax(worst, fabs(log(s.state[i]) - y[n + i]));
                worst = fmax(worst, fabs(s.slip[i] / y[2 * n + i] - 1.0));
            }
            double gained = s.kinetic - s.first_kinetic;
            printf("%zu cells, columns %g, method %d: %lld steps, v %.3g m/s, worst %.2g, energy "
                   "%.2g off\n",
                   n, def.columns, method, (long long)result.steps, s.rate[0], worst,
                   s.work / gained - 1.0);
            assert_true(worst < 1e-6);
            assert_true(fabs(s.work / gained - 1.0) < 1e-4);
            assert_true(result.balance_residual < 1e-12);
        }
        tree_clear(&t);
    }
}

// Time at which a tree that creeps to failure reaches 1 mm/s.
static double failure_time(const tree_def *def)
{
    tree t;
    tree_create(def, &t);
    lac_run_def how = lac_run_default();
    how.rtol = 1e-7;
    how.end = 1e9;
    how.failure_rate = 1e-3;
    lac_run_result result = run_tree(&t, &how, &(observation){0});
    assert_true(result.failed);
    tree_clear(&t);
    return result.failure_origin + result.failure_local;
}

// A mass that is none to speak of leaves a run where it was, whatever its part in columns.
static void the_limit_without_mass(void **state)
{
    (void)state;
    tree_def def = tree_default(3, 1);
    def.state = 3e4;
    double without = failure_time(&def);
    const double parts[] = {1.0, 0.01, 1e-6};
    for (size_t i = 0; i < 3; i++) {
        def.mass = 1e-6;
        def.columns = parts[i];
        double with = failure_time(&def);
        printf("columns %g: failure %.2g late\n", parts[i], with / without - 1.0);
        assert_true(fabs(with / without - 1.0) < 1e-5);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_as_by_dense_matrices),
        cmocka_unit_test(the_limit_without_mass),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
