// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/one_cell.h"

#include <math.h>
#include <stdio.h>

// How ln theta follows ln v from a start under constant load.
typedef struct path {
    long double a, b, dc, damping; // damping: eta/p
    long double u, w;              // at the start
} path;

static long double slowness(const path *c, long double u)
{
    long double v = expl(u);
    long double viscous = c->damping * (v - expl(c->u));
    long double w = c->w - (c->a * (u - c->u) + viscous) / c->b;
    return (c->a + c->damping * v) / c->b / (v / c->dc - expl(-w));
}

// Gauss's rule of five points on each of many pieces.
static long double integral(const path *c, long double from, long double to)
{
    const long double x[] = {0, 0.538469310105683091036314420700L,
                             0.906179845938663992797626878299L};
    const long double weight[] = {0.568888888888888888888888888889L,
                                  0.478628670499366468041291514836L,
                                  0.236926885056189087514264040720L};
    const int pieces = 4000;
    long double half = (to - from) / pieces / 2, sum = 0;
    for (int i = 0; i < pieces; i++) {
        long double middle = from + half * (2 * i + 1);
        sum += weight[0] * slowness(c, middle);
        for (int k = 1; k < 3; k++) {
            sum +=
                weight[k] * (slowness(c, middle - half * x[k]) + slowness(c, middle + half * x[k]));
        }
    }
    return half * sum;
}

double one_cell_time(const block_def *def, double to)
{
    path c = {.a = def->a,
              .b = def->b,
              .dc = def->dc,
              .damping = (long double)def->damping / def->pressure,
              .u = logl(def->slip_rate)};
    long double m = def->a > 0 ? c.b / c.a : 0;
    c.w = def->theta > 0 ? logl(def->theta) : (1 - m) * logl(def->x) + logl(c.dc) - c.u;
    return (double)integral(&c, c.u, logl(to));
}

static bool all_finite(const lac_record *r)
{
    const lac_observation *observation = &r->observation;
    const double numbers[] = {r->time_origin,
                              r->time_local,
                              observation->mean_rate,
                              observation->max_rate,
                              observation->mean_slip,
                              observation->shear_force,
                              observation->normal_force,
                              observation->effective_force,
                              observation->balance_residual};
    bool finite = true;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        finite = finite && isfinite(numbers[i]);
    }
    for (size_t i = 0; i < r->cells.n; i++) {
        finite = finite && isfinite(r->cells.slip_rate[i]) && isfinite(r->cells.log_state[i]);
    }
    return finite;
}

static lac_status watch(void *context, const lac_record *line, lac_error *err)
{
    (void)err;
    one_cell_outcome *observation = context;
    observation->finite = observation->finite && all_finite(line);
    observation->last_rate = line->observation.mean_rate;
    return LAC_OK;
}

one_cell_outcome watched_run(const lac_problem *problem, const lac_run_def *how)
{
    one_cell_outcome out = {.finite = true};
    lac_error err = {""};
    lac_sink sink = {.context = &out, .record = watch};
    out.status = lac_run(problem, how, &sink, &out.result, &err);
    (void)snprintf(out.message, sizeof out.message, "%.255s", err.message);
    return out;
}

one_cell_outcome one_cell_run(const block_def *def, const lac_run_def *how)
{
    block b;
    block_create(def, &b);
    one_cell_outcome out = watched_run(b.problem, how);
    block_clear(&b);
    return out;
}
