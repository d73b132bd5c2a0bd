// SPDX-License-Identifier: GPL-3.0-or-later
// Rate and state of every cell at the start, from what the case gives of them and from the loads.
#include "base/range.h"
#include "base/roots.h"
#include "model/internal.h"

// One cell at the start.
typedef struct start_cell {
    const lac_friction *friction;
    size_t cell;
    double pressure; // effective [Pa]
    double traction; // from the loads [Pa]
    double eta;
} start_cell;

// Whether steady sliding at ln v = u takes more (1) or less (-1) traction than the loads give; 0
// where rounding would decide, as it does everywhere for b = a and a load of f0.
static int steady_excess(const start_cell *c, double u)
{
    double w = lac_friction_steady_state(c->friction, c->cell, u);
    double f = lac_friction_coefficient(c->friction, c->cell, u, w);
    double excess = c->pressure * f + c->eta * exp(u) - c->traction;
    double noise = 1e-14 * fabs(c->traction);
    return (excess > noise) - (excess < -noise);
}

// The slowest steady ln v under the load: b > a with damping has a second, fast one. NaN if none.
static double steady_rate(const start_cell *c)
{
    const double slowest = -100.0; // 1e-43 m/s ...
    const double fastest = 30.0;   // ... to 1e13 m/s
    const double stride = 0.5;
    double low = slowest;
    int at_low = steady_excess(c, low);
    for (double high = low + stride; high <= fastest; high += stride) {
        int at_high = steady_excess(c, high);
        if (at_low * at_high < 0) {
            for (int i = 0; i < 100; i++) {
                lac_halve(&low, &high, steady_excess(c, 0.5 * (low + high)) == at_low);
            }
            return 0.5 * (low + high);
        }
        if (at_high != 0) {
            low = high;
            at_low = at_high;
        }
    }
    return NAN;
}

static double rate_in_state(const start_cell *c, double w)
{
    return lac_friction_rate_for(c->friction, c->cell, w, c->traction, c->pressure, c->eta);
}

static void state_from_rate(const start_cell *c, lac_initial_state how, double u, double value,
                            double *w)
{
    double f = (c->traction - c->eta * exp(u)) / c->pressure;
    switch (how) {
    case LAC_STATE_FROM_LOAD:
        *w = lac_friction_state_for(c->friction, c->cell, u, f);
        break;
    case LAC_STATE_STEADY:
        *w = lac_friction_steady_state(c->friction, c->cell, u);
        break;
    case LAC_STATE_TIME:
        *w = log(value);
        break;
    case LAC_STATE_RATIO:
        *w = lac_friction_state_at_ratio(c->friction, c->cell, u, value);
        break;
    }
}

static void rate_from_load(const start_cell *c, lac_initial_state how, double value, double *u,
                           double *w)
{
    if (how == LAC_STATE_TIME) {
        *w = log(value);
        *u = rate_in_state(c, *w);
        return;
    }
    *u = steady_rate(c);
    *w = lac_friction_steady_state(c->friction, c->cell, *u);
    if (how == LAC_STATE_RATIO && value != 1.0) {
        *w += log(value);
        *u = rate_in_state(c, *w);
    }
}

static lac_status cannot_start(const start_cell *c, double rate, double value, double w,
                               lac_error *err)
{
    double a = lac_cellwise_of(&c->friction->column[LAC_A], c->cell);
    double b = lac_cellwise_of(&c->friction->column[LAC_B], c->cell);
    LAC_FAIL_IF(rate <= 0.0 || value <= 0.0, err, LAC_EINPUT, "%s of cell %zu is %g: must be > 0",
                rate <= 0.0 ? "slip rate" : "state", c->cell, rate <= 0.0 ? rate : value);
    LAC_FAIL_IF(a <= 0.0 || b <= 0.0, err, LAC_EINPUT,
                "a = %g and b = %g of cell %zu leave its rate or state undetermined", a, b,
                c->cell);
    LAC_FAIL_IF(!isfinite(exp(w)) && w > 0.0 && isfinite(w), err, LAC_EINPUT,
                "the state of cell %zu that carries its load, e^%.4g s, is beyond numbers", c->cell,
                w);
    return lac_fail(err, LAC_EINPUT,
                    "no rate and state of cell %zu carry its load: traction %g Pa%s, effective "
                    "normal pressure %g Pa, ratio %g",
                    c->cell, c->traction, c->friction->cohesion > 0.0 ? " beyond cohesion" : "",
                    c->pressure, c->traction / c->pressure);
}

// What the loads at t = 0 put on the cells.
typedef struct start_load {
    double ratio;        // q_i = p_i ratio + spring + shape_i elastic, less cohesion
    double spring;       // [Pa]
    double elastic;      // [Pa]
    const double *shape; // [n]; NULL: 0
    double share;        // effective over total normal pressure
    double *shares;      // [n] of each cell, owned; NULL: all have the same
} start_load;

// The share of each cell where the loads differ between them.
static lac_status shares_at_start(const lac_load_set *loads, const lac_load_state *load,
                                  double mean, start_load *at, lac_error *err)
{
    const size_t n = loads->places.n;
    at->shares = malloc(2 * n * sizeof *at->shares);
    LAC_FAIL_MEMORY_IF(at->shares == NULL, err);
    lac_load_evaluate_cells(loads, 0.0, load, at->shares, at->shares + n);
    for (size_t i = 0; i < n; i++) {
        const double taken = at->shares[i];
        at->shares[i] = 1.0 - taken / mean;
        if (!(at->shares[i] > 0.0)) {
            return lac_load_blame_cell(loads, i, taken, mean, 0.0, LAC_EINPUT, err);
        }
    }
    return LAC_OK;
}

static lac_status load_at_start(const lac_initial_def *initial, const lac_load_set *loads,
                                const lac_domain *domain, double cohesion, start_load *at,
                                lac_error *err)
{
    const lac_range whole = lac_range_whole(domain->n);
    double sum = lac_range_sum(&whole, domain->pressure);
    double area = lac_grid_area(&domain->grid);
    double cell = lac_grid_cell_area(&domain->grid);
    double mean = sum * cell / area;
    lac_load_state load;
    lac_load_evaluate(loads, 0.0, &load);
    at->ratio = load.ratio + (load.stress - cohesion) / mean;
    if (loads->geometry != NULL) {
        at->ratio += lac_geometry_at(loads->geometry, 0.0).pull;
    }
    if (loads->geometry != NULL && load.lake.unit_weight > 0.0) {
        const lac_buoyancy b = lac_geometry_float(loads->geometry, 0.0, loads->length, &load.lake);
        at->ratio -= b.back / mean;
        load.pore += b.lift;
    }
    double to_cells = area / ((double)domain->n * cell);
    at->spring = (load.spring_stress + load.equal_ratio * mean) * to_cells;
    at->elastic = (load.elastic + load.elastic_ratio * mean) * to_cells;
    at->shape = loads->shape;
    at->share = 1.0 - lac_load_taken(&load) / mean;
    const bool varies = loads->varies;
    LAC_TRY_RETURN(varies ? shares_at_start(loads, &load, mean, at, err) : LAC_OK);
    LAC_FAIL_IF(!varies && !(at->share > 0.0), err, LAC_EINPUT,
                "pore pressure %g Pa is not below the normal pressure %g Pa at the start",
                load.pore, mean + load.normal);
    const bool by_load = initial->state == LAC_STATE_FROM_LOAD ||
                         (initial->rates == NULL && isnan(initial->slip_rate));
    const double left = at->ratio * mean + (at->spring + at->elastic) / to_cells;
    LAC_FAIL_IF(cohesion > 0.0 && by_load && !(left > 0.0), err, LAC_EINPUT,
                "cohesion %g Pa holds the shear load of %g Pa over the nominal area at the start: "
                "nothing slides",
                cohesion, left + cohesion);
    return LAC_OK;
}

// What the cells start from, all together.
typedef struct start_cells {
    const lac_initial_def *initial;
    const lac_domain *domain;
    const lac_friction *friction;
    start_load load;
    lac_damping damping;
    double *log_rate, *log_state; // [n]
} start_cells;

static double given_rate(const start_cells *s, size_t i)
{
    return s->initial->rates != NULL ? s->initial->rates[i] : s->initial->slip_rate;
}

static double given_state(const start_cells *s, size_t i)
{
    return s->initial->states != NULL ? s->initial->states[i] : s->initial->state_value;
}

// A cell that the mean rate `mean` damps.
static start_cell cell_at(const start_cells *s, size_t i, double mean)
{
    const start_load *load = &s->load;
    double p = s->domain->pressure[i];
    double shaped = load->shape == NULL ? 0.0 : load->shape[i] * load->elastic;
    double q = p * load->ratio + load->spring + shaped;
    double drag = (s->damping.mean + s->damping.shared * p) * mean;
    double share = load->shares != NULL ? load->shares[i] : load->share;
    return (start_cell){s->friction, i, p * share, q - drag, s->damping.cell};
}

// Every cell's rate and state; gives back the mean rate.
static double start_all(const start_cells *s, double mean)
{
    double total = 0.0;
    for (size_t i = 0; i < s->domain->n; i++) {
        start_cell c = cell_at(s, i, mean);
        double rate = given_rate(s, i);
        double value = given_state(s, i);
        if (isnan(rate)) {
            rate_from_load(&c, s->initial->state, value, &s->log_rate[i], &s->log_state[i]);
        } else {
            s->log_rate[i] = log(rate);
            state_from_rate(&c, s->initial->state, s->log_rate[i], value, &s->log_state[i]);
        }
        total += exp(s->log_rate[i]);
    }
    return total / (double)s->domain->n;
}

// The mean rate that damps the cells is the one that they have then: secants from none, as the slow
// steady rate that is wanted rises with drag, and others fall. Where cells find none there was too
// much.
static double start_together(const start_cells *s)
{
    bool damped = s->damping.mean != 0.0 || s->damping.shared != 0.0;
    double mean = 0.0;
    double found = start_all(s, mean);
    double slope = 0.0;
    for (int k = 0; damped && isfinite(found) && k < 200; k++) {
        double next = mean + (found - mean) / (1.0 - fmin(slope, 0.5));
        double then = start_all(s, next);
        for (int j = 0; !isfinite(then) && j < 60; j++) {
            next = 0.5 * (mean + next);
            then = start_all(s, next);
        }
        slope = (then - found) / (next - mean);
        slope = isfinite(slope) ? slope : 0.0;
        mean = next;
        found = then;
        if (fabs(found - mean) <= 4.0 * DBL_EPSILON * fabs(found)) {
            break;
        }
    }
    return damped ? found - mean : 0.0;
}

static lac_status start_cells_of(start_cells *s, lac_error *err)
{
    const double *log_rate = s->log_rate;
    const double *log_state = s->log_state;
    double off = start_together(s);
    double fastest = 0.0;
    for (size_t i = 0; i < s->domain->n; i++) {
        if (!isfinite(log_rate[i]) || !isfinite(log_state[i]) || !isfinite(exp(log_state[i]))) {
            start_cell c = cell_at(s, i, 0.0);
            return cannot_start(&c, given_rate(s, i), given_state(s, i), log_state[i], err);
        }
        fastest = fmax(fastest, exp(log_rate[i]));
    }
    LAC_FAIL_IF(!(fabs(off) <= 1e-9 * fastest), err, LAC_EINPUT,
                "no slip rate of the cells carries the load with the damping of their mean: it "
                "would be above %g m/s",
                fastest);
    return LAC_OK;
}

lac_status lac_initial_solve(const lac_initial_def *initial, const lac_domain *domain,
                             const lac_friction *friction, const lac_load_set *loads,
                             lac_damping damping, double *log_rate, double *log_state,
                             lac_error *err)
{
    start_cells s = {.initial = initial,
                     .domain = domain,
                     .friction = friction,
                     .damping = damping,
                     .log_rate = log_rate,
                     .log_state = log_state};
    lac_status status = load_at_start(initial, loads, domain, friction->cohesion, &s.load, err);
    if (status == LAC_OK) {
        status = start_cells_of(&s, err);
    }
    free(s.load.shares);
    return status;
}
