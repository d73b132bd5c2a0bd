// SPDX-License-Identifier: GPL-3.0-or-later
// What cells that are to be taken together differ in, and what that does to them.
#include "scene/lump_parts.h"

// Adds a variable unless the cells are alike in it. @param size  what a difference is beside
static void add_variable(lac_lump_cells *f, const double *x, double size)
{
    double least = INFINITY, most = -INFINITY;
    for (size_t i = 0; i < f->n; i++) {
        least = fmin(least, x[i]);
        most = fmax(most, x[i]);
    }
    if (most - least > 1e-7 * size && f->variables < MOST_VARIABLES) {
        lac_lump_variable *v = &f->of[f->variables];
        v->value = f->memory + f->variables++ * f->n;
        v->scale = size;
        memcpy(v->value, x, f->n * sizeof *x);
    }
}

static void add_column(lac_lump_cells *f, const lac_cellwise *column, double *room)
{
    double size = 0.0;
    for (size_t i = 0; column->value != NULL && column->mask != 0 && i < f->n; i++) {
        room[i] = lac_cellwise_of(column, i);
        size = fmax(size, fabs(room[i]));
    }
    if (size > 0.0) {
        add_variable(f, room, size);
    }
}

// A state x of the steady one at the start leaves it at a rate that 1 - 1/x sets: there what is
// wrong of x counts 1/(x - 1) times.
static double gain_of(const lac_lump_source *s, const lac_lump_cells *f)
{
    const double most = 100.0;
    double sum = 0.0, pressure = 0.0;
    for (size_t i = 0; i < f->n; i++) {
        const double dc = lac_cellwise_of(&s->whole.friction->column[LAC_DC], i);
        const double p = s->whole.domain->pressure[i];
        sum += p * (s->whole.log_state[i] + log(f->rate / dc));
        pressure += p;
    }
    const double x = exp(sum / pressure);
    const double gain = x / fabs(x - 1.0);
    return gain > 1.0 ? fmin(gain, most) : 1.0;
}

// What friction may leave a cell apart by, in parts of its pressure: by the renewal of its state
// over some slip, its state and rate at the start, what it weakens by, and its friction where water
// takes off its pressure.
static void fill_patterns(const lac_lump_source *s, lac_lump_cells *f)
{
    const lac_problem_parts parts = lac_problem_parts_of(s->problem);
    const lac_friction *friction = s->whole.friction;
    double dc = 0.0;
    for (size_t i = 0; i < f->n; i++) {
        dc += 1.0 / lac_cellwise_of(&friction->column[LAC_DC], i) / (double)f->n;
    }
    f->per_dc = dc;
    f->rate = 0.0;
    for (size_t i = 0; i < f->n; i++) {
        f->rate += exp(s->whole.log_rate[i]) / (double)f->n;
    }
    f->gain = gain_of(s, f);
    for (size_t i = 0; i < f->n; i++) {
        const double a = lac_cellwise_of(&friction->column[LAC_A], i);
        const double b = lac_cellwise_of(&friction->column[LAC_B], i);
        double *at = f->pattern + i;
        at[0] = b / lac_cellwise_of(&friction->column[LAC_DC], i) / dc;
        at[f->n] = b * s->whole.log_state[i];
        at[2 * f->n] = b * lac_cellwise_of(&friction->ln_dc, i);
        at[3 * f->n] = a * s->whole.log_rate[i];
        at[4 * f->n] = 5.0 * (b - a);
        at[5 * f->n] = 0.05 * (parts.traction[i] / parts.pressure[i]);
    }
}

// Takes the states of cells through slip at the joint's rate at the start, by steps so short that
// they go where the law takes them: what it makes of the cells is what a quadrature has to know.
static void fill_held(const lac_lump_source *s, lac_lump_cells *f)
{
    enum { STEPS = 8 };
    const double step = 0.15 / f->per_dc / f->rate; // [s]
    const lac_friction *friction = s->whole.friction;
    double w[LAC_FRICTION_BLOCK], u[LAC_FRICTION_BLOCK], v[LAC_FRICTION_BLOCK];
    double g[LAC_FRICTION_BLOCK];
    for (size_t i = 0; i < LAC_FRICTION_BLOCK; i++) {
        v[i] = f->rate;
        u[i] = log(f->rate);
    }
    for (size_t first = 0; first < f->n; first += LAC_FRICTION_BLOCK) {
        const size_t left = f->n - first, n = left < LAC_FRICTION_BLOCK ? left : LAC_FRICTION_BLOCK;
        const lac_friction_cells cells = {.first = first, .n = n, .u = u, .w = w, .v = v};
        memcpy(w, s->whole.log_state + first, n * sizeof *w);
        for (size_t k = 1; k <= STEPS; k++) {
            lac_friction_evaluate(friction, &cells, &(lac_friction_values){.g = g}, NULL);
            for (size_t i = 0; i < n; i++) {
                w[i] += step * g[i];
            }
            for (size_t i = 0; k % 3 == 2 && i < n; i++) {
                const double b = lac_cellwise_of(&friction->column[LAC_B], first + i);
                f->held[k / 3 * f->n + first + i] = b * w[i];
            }
        }
    }
}

// What moves the cells: their parameters, but f0, of which only the friction at the start counts;
// rate and state at the start; what loads do to each.
lac_status lac_lump_look(const lac_lump_source *s, lac_lump_cells *f, lac_error *err)
{
    const lac_friction *friction = s->whole.friction;
    const lac_problem_parts parts = lac_problem_parts_of(s->problem);
    const size_t n = s->whole.domain->n;
    *f = (lac_lump_cells){.n = n};
    f->memory = malloc((MOST_VARIABLES + 2 * PATTERNS + STAGES) * (n + 1) * sizeof *f->memory);
    LAC_FAIL_MEMORY_IF(f->memory == NULL, err);
    f->pattern = f->memory + MOST_VARIABLES * n;
    f->held = f->pattern + PATTERNS * n;
    f->force = f->held + STAGES * n;
    add_column(f, &friction->ln_dc, f->pattern);
    add_variable(f, s->whole.log_state, 1.0);
    add_variable(f, s->whole.log_rate, 1.0);
    for (size_t c = LAC_A; c < friction->columns; c++) {
        if (c != LAC_DC) {
            add_column(f, &friction->column[c], f->pattern);
        }
    }
    for (size_t i = 0; i < n; i++) {
        f->pattern[i] = parts.traction[i] / parts.pressure[i];
    }
    add_variable(f, f->pattern, 1.0);
    if (s->whole.loads.shape != NULL) {
        add_variable(f, s->whole.loads.shape, 1.0);
    }
    for (size_t i = 0; i < s->whole.loads.count; i++) {
        const lac_load *load = &s->whole.loads.load[i];
        f->apart = f->apart || load->share != LAC_SHARE_PRESSURE || load->kind->stiffness != NULL;
    }
    for (size_t i = 0; f->apart && i < n; i++) {
        f->pattern[i] = log(parts.pressure[i]);
    }
    if (f->apart) {
        add_variable(f, f->pattern, 1.0);
    }
    fill_patterns(s, f);
    fill_held(s, f);
    return LAC_OK;
}
