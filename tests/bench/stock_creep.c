// SPDX-License-Identifier: GPL-3.0-or-later
#include "stock_creep.h"

#include <cvodes/cvodes.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_config.h>
#include <sunlinsol/sunlinsol_spgmr.h>

#include "support/cost.h"

enum { MOST_LEVELS = 16 };

typedef struct stock {
    const tree_def *def;
    size_t n;
    const double *pressure;
    int levels;
    size_t count[MOST_LEVELS + 1];  // blocks of every level
    uint32_t *parent[MOST_LEVELS];  // [count] block of the next level
    double *size[MOST_LEVELS + 1];  // [count] cells of each block
    double *mean[MOST_LEVELS + 1];  // [count] mean of x over its cells
    double *force[MOST_LEVELS + 1]; // [count] stress from above
    double k[MOST_LEVELS];
    double rtol;
    int64_t rhs;
} stock;

static void must(bool good, const char *what)
{
    if (!good) {
        (void)fprintf(stderr, "stock_creep: %s\n", what);
        exit(1);
    }
}

static void *array(size_t n, size_t each)
{
    void *p = calloc(n, each);
    must(p != NULL, "memory");
    return p;
}

// Blocks from the cells' places in the grid; cells are in Morton order, so blocks are runs.
static void make_blocks(const tree *t, stock *s)
{
    const lac_domain *domain = t->domain;
    uint64_t *code = array(s->n, sizeof *code);
    for (size_t i = 0; i < s->n; i++) {
        size_t at = domain->index[i];
        code[i] = lac_morton((uint32_t)(at % domain->grid.nx), (uint32_t)(at / domain->grid.nx));
    }
    size_t count = s->n;
    for (int l = 0; l <= s->levels; l++) {
        s->count[l] = count;
        s->size[l] = array(count, sizeof(double));
        s->mean[l] = array(count, sizeof(double));
        s->force[l] = array(count, sizeof(double));
        for (size_t i = 0; l == 0 && i < count; i++) {
            s->size[0][i] = 1;
        }
        if (l > 0) {
            for (size_t i = 0; i < s->count[l - 1]; i++) {
                s->size[l][s->parent[l - 1][i]] += s->size[l - 1][i];
            }
        }
        if (l == s->levels) {
            break;
        }
        s->k[l] = s->def->k0 * pow(s->def->ratio, l);
        s->parent[l] = array(count, sizeof(uint32_t));
        size_t next = 0;
        for (size_t i = 0; i < count; i++) {
            next += i > 0 && code[i] >> 2 != code[i - 1] >> 2;
            s->parent[l][i] = (uint32_t)next;
        }
        for (size_t i = 0; i < count; i++) {
            code[s->parent[l][i]] = code[i] >> 2;
        }
        count = next + 1;
    }
    free(code);
}

static void free_blocks(stock *s)
{
    for (int l = 0; l <= s->levels; l++) {
        free(s->size[l]), free(s->mean[l]), free(s->force[l]);
        if (l < s->levels) {
            free(s->parent[l]);
        }
    }
}

// force[0] = K mean[0] = sum of k_l (P_l - P_l+1) x
static void couple(stock *s)
{
    for (int l = 0; l < s->levels; l++) {
        memset(s->mean[l + 1], 0, s->count[l + 1] * sizeof(double));
        for (size_t i = 0; i < s->count[l]; i++) {
            s->mean[l + 1][s->parent[l][i]] += s->mean[l][i] * s->size[l][i];
        }
        for (size_t i = 0; i < s->count[l + 1]; i++) {
            s->mean[l + 1][i] /= s->size[l + 1][i];
        }
    }
    s->force[s->levels][0] = 0;
    for (int l = s->levels - 1; l >= 0; l--) {
        for (size_t i = 0; i < s->count[l]; i++) {
            uint32_t b = s->parent[l][i];
            s->force[l][i] = s->force[l + 1][b] + s->k[l] * (s->mean[l][i] - s->mean[l + 1][b]);
        }
    }
}

static int rates(sunrealtype t, N_Vector y, N_Vector ydot, void *user)
{
    stock *s = user;
    const tree_def *d = s->def;
    const double *u = NV_DATA_S(y), *w = u + s->n;
    double *du = NV_DATA_S(ydot), *dw = du + s->n;
    (void)t;
    s->rhs++;
    for (size_t i = 0; i < s->n; i++) {
        s->mean[0][i] = exp(u[i]);
    }
    memcpy(du, s->mean[0], s->n * sizeof *du);
    couple(s);
    for (size_t i = 0; i < s->n; i++) {
        double v = du[i], p = s->pressure[i];
        dw[i] = exp(-w[i]) - v / d->dc;
        du[i] = (-s->force[0][i] - p * d->b * dw[i]) / (p * d->a + d->damping * v);
        if (!isfinite(du[i]) || !isfinite(dw[i])) {
            return 1;
        }
    }
    return 0;
}

static int slip_rates(sunrealtype t, N_Vector y, N_Vector v, void *user)
{
    const stock *s = user;
    (void)t;
    for (size_t i = 0; i < s->n; i++) {
        NV_DATA_S(v)[i] = exp(NV_DATA_S(y)[i]);
    }
    return 0;
}

static double fastest(const stock *s, N_Vector y)
{
    double most = -INFINITY;
    for (size_t i = 0; i < s->n; i++) {
        most = fmax(most, NV_DATA_S(y)[i]);
    }
    return exp(most);
}

static void integrate(stock *s, void *mem, N_Vector y, double stop_rate, double most_cpu,
                      stock_outcome *out)
{
    double begin = cpu_seconds();
    sunrealtype at = 0;
    while (out->cpu < most_cpu && out->max_rate < stop_rate) {
        int flag = CVode(mem, 1e10, y, &at, CV_ONE_STEP);
        must(flag >= 0, "the integrator gave up");
        out->max_rate = fastest(s, y);
        out->cpu = cpu_seconds() - begin;
    }
    long steps, iterations;
    (void)CVodeGetNumSteps(mem, &steps);
    (void)CVodeGetNumLinIters(mem, &iterations);
    out->steps = steps;
    out->linear_iterations = iterations;
    out->rhs = s->rhs;
    out->time = at;
    out->done = out->max_rate >= stop_rate;
}

stock_outcome stock_creep(const tree *t, const tree_def *def, double rtol, double stop_rate,
                          double most_cpu)
{
    stock s = {.def = def,
               .n = t->domain->n,
               .pressure = t->domain->pressure,
               .levels = def->levels,
               .rtol = rtol};
    stock_outcome out = {0};
    SUNContext sun;
#if SUNDIALS_VERSION_MAJOR >= 7
    must(SUNContext_Create(SUN_COMM_NULL, &sun) == 0, "context");
#else
    must(SUNContext_Create(NULL, &sun) == 0, "context");
#endif
    make_blocks(t, &s);
    N_Vector y = N_VNew_Serial((sunindextype)(2 * s.n), sun);
    N_Vector slip = N_VNew_Serial((sunindextype)s.n, sun);
    must(y != NULL && slip != NULL, "memory");
    N_VConst(0, slip);
    lac_problem_initial(t->problem, NV_DATA_S(y));
    void *mem = CVodeCreate(CV_BDF, sun);
    SUNLinearSolver solver = SUNLinSol_SPGMR(y, SUN_PREC_NONE, 0, sun);
    // an absolute error of ln v and ln theta is a relative one of v and theta
    must(mem != NULL && solver != NULL && CVodeInit(mem, rates, 0, y) == CV_SUCCESS &&
             CVodeSStolerances(mem, 0, rtol) == CV_SUCCESS &&
             CVodeSetUserData(mem, &s) == CV_SUCCESS &&
             CVodeSetLinearSolver(mem, solver, NULL) == CV_SUCCESS &&
             CVodeQuadInit(mem, slip_rates, slip) == CV_SUCCESS &&
             CVodeSetMaxNumSteps(mem, -1) == CV_SUCCESS,
         "the integrator cannot be set up");
    integrate(&s, mem, y, stop_rate, most_cpu, &out);
    CVodeFree(&mem);
    (void)SUNLinSolFree(solver);
    N_VDestroy(y);
    N_VDestroy(slip);
    free_blocks(&s);
    (void)SUNContext_Free(&sun);
    return out;
}
