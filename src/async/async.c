// SPDX-License-Identifier: GPL-3.0-or-later
// Cells with steps of their own: what is due first goes on alone; docs/theory/fidelity-events.md.
#include "async/async.h"

#include "async/tree.h"

struct lac_async {
    lac_async_rules rules;
    lac_async_tree tree;
    lac_async_load load;
    double damping;    // eta [Pa s/m]
    double drag;       // of the mean slip rate, per pressure of a cell [s/m]
    double even;       // what that is of the mean cell [Pa s/m]
    double t, age;     // time reached, and that of the last shift [s]
    double step, peak; // the last step of any cell [s]; the largest rate [m/s]
    bool at_limit;     // of rate or slip
    lac_async_counts counts;
};

lac_status lac_async_follows(const lac_model_info *law, bool cut_off, lac_error *err)
{
    LAC_FAIL_IF(((const lac_friction_law *)(const void *)law)->lone == NULL, err, LAC_EINPUT,
                "fidelity events follows the aging and the slip law, not \"%s\"", law->name);
    return !cut_off
               ? LAC_OK
               : lac_fail(err, LAC_EINPUT,
                          "fidelity events follows no cut-off slip rates (v1, v2) and no alpha");
}

lac_status lac_async_supports(const lac_friction *friction, lac_error *err)
{
    const bool cut_off = friction->ln_v1.value != NULL || friction->ln_cut.value != NULL ||
                         friction->response.value != NULL;
    LAC_TRY_RETURN(lac_async_follows(&friction->law->info, cut_off, err));
    for (size_t i = 0; i < friction->n; i++) {
        LAC_FAIL_IF(!(lac_cellwise_of(&friction->column[LAC_A], i) > 0.0), err, LAC_EINPUT,
                    "fidelity events needs a > 0; cell %zu has %g", i,
                    lac_cellwise_of(&friction->column[LAC_A], i));
    }
    return LAC_OK;
}

// What the mean slip rate takes off a cell [Pa s/m].
static double drag_of(const lac_async *m, const lac_async_cell *c) { return m->drag * c->pressure; }

// The part of it that the cell's own rate makes.
static double own_drag(const lac_async *m, const lac_async_cell *c)
{
    return drag_of(m, c) / (double)m->tree.n;
}

static void fill_cells(lac_async *m, const lac_async_def *def)
{
    const lac_friction *f = def->friction;
    for (uint32_t i = 0; i < m->tree.n; i++) {
        lac_async_cell *c = &m->tree.cell[i];
        c->a = lac_cellwise_of(&f->column[LAC_A], i);
        c->b = lac_cellwise_of(&f->column[LAC_B], i);
        c->constant = lac_cellwise_of(&f->constant, i);
        c->dc = lac_cellwise_of(&f->column[LAC_DC], i);
        c->ln_dc = lac_cellwise_of(&f->ln_dc, i);
        c->pressure = def->pressure[i];
        c->damping = m->damping + own_drag(m, c);
        m->even += own_drag(m, c);
    }
}

lac_status lac_async_create(const lac_async_def *def, lac_async **out, lac_error *err)
{
    *out = NULL;
    LAC_TRY_RETURN(lac_async_supports(def->friction, err));
    lac_async *m = *out = calloc(1, sizeof *m);
    LAC_FAIL_MEMORY_IF(m == NULL, err);
    m->damping = def->damping;
    m->drag = def->drag;
    m->rules = (lac_async_rules){.law = def->friction->law->lone,
                                 .regularised = def->friction->form == LAC_FORM_REGULARISED,
                                 .tolerance = def->tolerance};
    lac_status status = lac_async_tree_create(def->hierarchy, def->k, &m->tree, err);
    if (status == LAC_OK) {
        fill_cells(m, def);
    }
    LAC_MADE(status, out, lac_async_free);
}

void lac_async_free(lac_async *m)
{
    if (m != NULL) {
        lac_async_tree_clear(&m->tree);
        free(m);
    }
}

double lac_async_time(const lac_async *m) { return m->t; }

lac_async_counts lac_async_count(const lac_async *m)
{
    lac_async_counts counts = m->counts;
    counts.openings = m->tree.openings;
    return counts;
}

bool lac_async_at_limit(const lac_async *m) { return m->at_limit; }

double lac_async_told(const lac_async *m)
{
    const lac_async_node *root = &m->tree.node[m->tree.nodes - 1];
    return root->rate * root->share;
}

double lac_async_peak(lac_async *m)
{
    double peak = m->peak;
    m->peak = 0.0;
    return peak;
}

// Traction that the loads put on a cell, and its effective normal pressure.
static double traction_at(const lac_async *m, const lac_async_cell *c, double t)
{
    const lac_async_load *load = &m->load;
    return c->traction + c->pressure * (load->ratio + load->ratio_rate * t) + load->common +
           load->common_rate * t;
}

static double pressure_at(const lac_async_cell *c, double t)
{
    return c->pressure * (c->share + c->share_rate * t);
}

// Plans a cell's next step from time t; E changes at `rate`, the cell's own part left out.
static void plan(const lac_async *m, lac_async_cell *c, double rate, double self)
{
    const lac_async_push push = {.pull_rate =
                                     c->pressure * m->load.ratio_rate + m->load.common_rate + rate,
                                 .pressure = pressure_at(c, c->t),
                                 .pressure_rate = c->pressure * c->share_rate,
                                 .own = c->stiffness - self};
    double h = lac_async_cell_plan(&m->rules, &push, c);
    c->due = c->t + h;
    // What is foreseen, the cell's own part included, wakes nobody.
    double foreseen = self * c->told * h;
    if (isfinite(foreseen)) {
        c->high += fmax(foreseen, 0.0);
        c->low += fmin(foreseen, 0.0);
    }
}

// What the others do to a cell at time t: the blocks, and damping of the mean.
static lac_async_view view_of(const lac_async *m, const lac_async_cell *c, double t)
{
    lac_async_view view = lac_async_tree_view(&m->tree, c->parent, t);
    double drag = drag_of(m, c);
    view.outer -= drag * view.mean;
    view.area -= drag * view.gone;
    return view;
}

// What acts on a cell from its own time to t. E holds what the cell has told; its own part of that
// is taken off, so that what is left of the balance is K_ii slip and all that its own rate damps.
static lac_async_span span_to(const lac_async *m, const lac_async_cell *c,
                              const lac_async_view *view, double t)
{
    double outer = view->outer;
    double self = m->tree.node[c->parent].self;
    double shown = c->slip + c->ahead;
    double h = t - c->t;
    double even = 0.5 * (c->outer + outer);
    double damped = own_drag(m, c) * c->told;
    bool told_apart = h > 1e-9 * (m->age + t);
    return (lac_async_span){.length = h,
                            .skew = told_apart ? (view->area - c->area) / h - even : 0.0,
                            .pull0 = traction_at(m, c, c->t) + c->outer - self * shown + damped,
                            .pull1 = traction_at(m, c, t) + outer - self * (shown + c->told * h) +
                                     damped,
                            .pressure0 = pressure_at(c, c->t),
                            .pressure1 = pressure_at(c, t),
                            .own = c->stiffness - self};
}

static lac_status cannot(const lac_async *m, uint32_t i, double t, lac_error *err)
{
    const lac_async_cell *c = &m->tree.cell[i];
    return lac_fail(err, LAC_ENUMERIC,
                    "cell %u finds no slip rate that balances its traction within the step of %.3g "
                    "s, ln v = %g, ln theta = %g",
                    (unsigned)i, t - c->t, c->u, c->w);
}

void lac_async_start(lac_async *m, const lac_async_load *load, const double *traction,
                     const lac_async_state *state)
{
    lac_async_tree *tree = &m->tree;
    m->load = *load;
    m->t = m->step = m->age = m->peak = 0.0;
    m->counts = (lac_async_counts){0};
    tree->openings = 0;
    lac_async_tree_anchor(tree, load->k_mean, m->even);
    for (uint32_t i = 0; i < tree->n; i++) {
        lac_async_cell *c = &tree->cell[i];
        c->traction = traction[i];
        c->share = load->shares != NULL ? load->shares[i] : load->share;
        c->share_rate = load->shares != NULL ? load->share_rates[i] : load->share_rate;
        c->u = state->log_rate[i];
        c->w = state->log_state[i];
        c->v = c->told = exp(c->u);
        c->slip = state->slip[i];
        c->t = c->pending = c->ahead = 0.0;
        c->z = 0.1 * m->rules.tolerance;
        c->reach = INFINITY;
        m->peak = fmax(m->peak, c->v);
    }
    lac_async_tree_fill(tree);
    for (uint32_t i = 0; i < tree->n; i++) {
        lac_async_cell *c = &tree->cell[i];
        lac_async_view view = view_of(m, c, 0.0);
        double self = tree->node[c->parent].self;
        c->area = 0.0;
        c->outer = view.outer;
        plan(m, c, view.rate - self * c->v, self);
    }
    lac_async_tree_fill(tree);
    for (uint32_t i = 0; i < tree->n; i++) {
        tree->cell[i].outer = view_of(m, &tree->cell[i], 0.0).outer;
    }
    lac_async_tree_propagate(tree, 0.0);
}

// Takes a cell to time t and plans its next step.
static lac_status update(lac_async *m, uint32_t i, double t, lac_error *err)
{
    lac_async_tree *tree = &m->tree;
    lac_async_cell *c = &tree->cell[i];
    lac_async_view view = view_of(m, c, t);
    double self = tree->node[c->parent].self;
    const lac_async_span span = span_to(m, c, &view, t);
    double told = c->slip + c->ahead + c->told * span.length;
    double rate = c->told;
    if (!lac_async_cell_advance(&m->rules, &span, c, &m->counts.steps)) {
        return cannot(m, i, t, err);
    }
    bool woken = c->pending > LAC_ASYNC_WAKES * c->high || c->pending < LAC_ASYNC_WAKES * c->low;
    m->counts.updates++;
    m->counts.wakings += woken;
    m->step = span.length;
    m->peak = fmax(m->peak, c->v);
    c->t = t;
    c->area = view.area;
    c->reach =
        woken ? fmax(4.0 * span.length, 0.01 * m->rules.tolerance * c->dc / c->v) : 4.0 * c->reach;
    plan(m, c, view.rate - self * rate, self);
    double jump = c->slip + c->ahead - told;
    c->outer = view.outer + self * jump;
    // What the cell's own rate does to E wakes others, not the cell; blocks hand it down as of the
    // mean cell.
    double eased = rate - c->told;
    double heard = m->even / (double)tree->n * eased;
    c->outer += own_drag(m, c) * eased;
    c->high += fmax(heard, 0.0);
    c->low += fmin(heard, 0.0);
    lac_async_tree_add(tree, i, t, jump, c->told - rate);
    return LAC_OK;
}

// Until when the mean slip stays below its limit.
static double time_of_slip(const lac_async *m, double limit)
{
    const lac_async_node *root = &m->tree.node[m->tree.nodes - 1];
    double rate = root->rate * root->share;
    return rate > 0.0 ? root->t + fmax(limit - root->sum * root->share, 0.0) / rate : INFINITY;
}

static lac_status tell(const lac_async *m, const lac_async_limits *limits, uint32_t i, double step,
                       lac_error *err)
{
    const lac_async_cell *c = &m->tree.cell[i];
    const lac_async_update observation = {
        .cell = i, .t = m->t, .step = step, .rate = c->v, .slip = c->slip};
    return limits->observation != NULL ? limits->observation(limits->context, &observation, err)
                                       : LAC_OK;
}

// Opens or updates whichever is due next, where that is before `stop`; else time is there.
static lac_status proceed(lac_async *m, const lac_async_limits *limits, double stop, lac_error *err)
{
    const lac_async_node *root = &m->tree.node[m->tree.nodes - 1];
    double next = fmax(root->due, m->t);
    uint32_t who = root->who;
    if (!(next < stop)) {
        m->t = stop;
        return LAC_OK;
    }
    m->t = next;
    if (who >= m->tree.n) {
        lac_async_tree_open(&m->tree, who - m->tree.n, next);
        return LAC_OK;
    }
    lac_status status = update(m, who, next, err);
    const lac_async_cell *c = &m->tree.cell[who];
    m->at_limit = c->v >= limits->max_rate || lac_async_told(m) >= limits->mean_rate ||
                  lac_async_cell_let_go(&m->rules, c);
    return status == LAC_OK ? tell(m, limits, who, m->step, err) : status;
}

lac_status lac_async_advance(lac_async *m, const lac_async_limits *limits, lac_error *err)
{
    int64_t last = m->counts.updates + m->tree.openings + limits->updates;
    m->at_limit = false;
    while (m->counts.updates + m->tree.openings < last && !m->at_limit && m->t < limits->stop &&
           !lac_async_wants_shift(m)) {
        double slipped =
            isnan(limits->mean_slip) ? INFINITY : fmax(time_of_slip(m, limits->mean_slip), m->t);
        LAC_TRY_RETURN(proceed(m, limits, fmin(limits->stop, slipped), err));
        m->at_limit = m->at_limit || m->t >= slipped;
    }
    return LAC_OK;
}

bool lac_async_wants_shift(const lac_async *m)
{
    const double digits = 1e-11;
    return m->step > 0.0 && m->step < digits * m->t;
}

double lac_async_shift(lac_async *m)
{
    double by = m->t;
    lac_async_load *load = &m->load;
    load->ratio += load->ratio_rate * by;
    load->common += load->common_rate * by;
    for (uint32_t i = 0; i < m->tree.n; i++) {
        m->tree.cell[i].share += m->tree.cell[i].share_rate * by;
    }
    lac_async_tree_shift(&m->tree, by);
    m->age += by;
    m->t = 0.0;
    return by;
}

lac_status lac_async_evaluate(const lac_async *m, const lac_async_state *state, lac_error *err)
{
    int64_t steps = 0;
    for (uint32_t i = 0; i < m->tree.n; i++) {
        lac_async_cell c = m->tree.cell[i];
        lac_async_view view = view_of(m, &c, m->t);
        const lac_async_span span = span_to(m, &c, &view, m->t);
        if (!lac_async_cell_advance(&m->rules, &span, &c, &steps)) {
            return cannot(m, i, m->t, err);
        }
        state->log_rate[i] = c.u;
        state->log_state[i] = c.w;
        state->slip[i] = c.slip;
    }
    return LAC_OK;
}
