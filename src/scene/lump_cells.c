// SPDX-License-Identifier: GPL-3.0-or-later
// What moves cells that are to be taken together: the friction of each along some histories of
// slip, which the friction law itself tells. docs/theory/lumped.md.
#include "base/vsum.h"
#include "scene/lump_parts.h"

// A state x of the steady one at the start leaves it at a rate that 1 - 1/x sets: there what is
// wrong of x counts 1/(x - 1) times.
static double gain_of(const lac_lump_source *s, const lac_lump_cells *f)
{
    const double most = 100.0;
    double sum = 0.0;
    for (size_t i = 0; i < f->n; i++) {
        const double dc = lac_cellwise_of(&s->whole.friction->column[LAC_DC], i);
        sum += s->whole.domain->pressure[i] * (s->whole.log_state[i] + log(f->rate / dc));
    }
    const double x = exp(sum / f->pressure / (double)f->n);
    const double gain = x / fabs(x - 1.0);
    return gain > 1.0 ? fmin(gain, most) : 1.0;
}

static void sum_up(const lac_lump_source *s, lac_lump_cells *f)
{
    const lac_friction *friction = s->whole.friction;
    const double part = 1.0 / (double)f->n;
    for (size_t i = 0; i < f->n; i++) {
        const double p = s->whole.domain->pressure[i];
        f->pressure += part * p;
        f->direct += part * p * lac_cellwise_of(&friction->column[LAC_A], i);
        f->per_dc += part / lac_cellwise_of(&friction->column[LAC_DC], i);
        f->mean_rate += part * exp(s->whole.log_rate[i]);
    }
    f->direct /= f->pressure;
    f->rate = f->mean_rate;
}

// All cells on their way as one.
typedef struct moving {
    double *w;    // [n] their states
    double rate;  // [m/s]; 0: each its own
    double share; // of the direct effect by which they are loaded more than at the start
} moving;

// Friction of all cells at their rate, in parts of the direct effect, then their states after some
// time. No state goes further than a state may in one step.
// @param row  [n] overwritten; NULL: not asked for
// @return mean friction by pressure less the load
static double move(const lac_lump_source *s, const lac_lump_cells *f, moving *m, double time,
                   double *row)
{
    const double most = 1.0, log_rate = log(m->rate);
    const double *load = f->friction + LAC_LUMP_LOAD * f->n;
    double u[LAC_FRICTION_BLOCK], v[LAC_FRICTION_BLOCK], g[LAC_FRICTION_BLOCK];
    double of[LAC_FRICTION_BLOCK], sum = 0.0;
    for (size_t first = 0, n; first < f->n; first += n) {
        n = f->n - first < LAC_FRICTION_BLOCK ? f->n - first : LAC_FRICTION_BLOCK;
        for (size_t i = 0; i < n; i++) {
            u[i] = m->rate > 0.0 ? log_rate : s->whole.log_rate[first + i];
            v[i] = m->rate > 0.0 ? m->rate : exp(u[i]);
        }
        const lac_friction_cells cells = {
            .first = first, .n = n, .u = u, .w = m->w + first, .v = v};
        lac_friction_evaluate(s->whole.friction, &cells, &(lac_friction_values){.f = of, .g = g},
                              NULL);
        for (size_t i = 0; i < n; i++) {
            of[i] /= f->direct;
            sum += s->whole.domain->pressure[first + i] * (of[i] - load[first + i]);
            const double dc = lac_cellwise_of(&s->whole.friction->column[LAC_DC], first + i);
            const double by = v[i] * time / dc;
            m->w[first + i] += by > 0.0 ? fmin(-expm1(-by) / by * time * g[i], most) : 0.0;
        }
        if (row != NULL) {
            memcpy(row + first, of, n * sizeof *of);
        }
    }
    return sum / f->pressure / (double)f->n;
}

// The rate at which friction holds the load.
static void balance(const lac_lump_source *s, const lac_lump_cells *f, moving *m)
{
    for (size_t k = 0; k < 4; k++) {
        const double off = m->share - move(s, f, m, 0.0, NULL);
        m->rate *= exp(fmax(-5.0, fmin(off, 5.0)));
    }
}

// Takes states through slip of all cells as one under a constant load.
static void walk(const lac_lump_source *s, lac_lump_cells *f, moving *m, size_t history)
{
    enum { EACH = 4 };
    static const double share[LAC_LUMP_HISTORIES] = {0.0, 1.5, -1.5};
    const double first = 0.03, last = 15.0;
    double slip = 0.0;
    double *kept = f->friction + (LAC_LUMP_STAGES + history * LAC_LUMP_EACH) * f->n;
    memcpy(m->w, s->whole.log_state, f->n * sizeof *m->w);
    m->share = share[history];
    m->rate = f->rate;
    balance(s, f, m);
    for (size_t k = 0; k < EACH * LAC_LUMP_EACH; k++) {
        const double to = first * pow(last / first, (double)k / (EACH * LAC_LUMP_EACH - 1));
        double *row = k % EACH == EACH - 1 ? kept + k / EACH * f->n : NULL;
        const double off = m->share - move(s, f, m, (to - slip) / f->per_dc / m->rate, row);
        m->rate *= exp(fmax(-2.0, fmin(off, 2.0)));
        slip = to;
    }
}

static void fill_friction(const lac_lump_source *s, lac_lump_cells *f)
{
    const double fast = 1e3;
    const lac_friction *friction = s->whole.friction;
    double *load = f->friction + LAC_LUMP_LOAD * f->n;
    moving m = {.w = f->scratch, .rate = 0.0};
    for (size_t i = 0; i < f->n; i++) {
        const double b = lac_cellwise_of(&friction->column[LAC_B], i);
        const double dc = lac_cellwise_of(&friction->column[LAC_DC], i);
        f->friction[LAC_LUMP_ANSWER * f->n + i] = b / dc / f->per_dc / f->direct;
    }
    memcpy(m.w, s->whole.log_state, f->n * sizeof *m.w);
    memset(load, 0, f->n * sizeof *load);
    (void)move(s, f, &m, 0.0, load);
    m.rate = f->mean_rate;
    balance(s, f, &m);
    f->rate = m.rate;
    f->gain = gain_of(s, f);
    (void)move(s, f, &m, 0.0, f->friction + LAC_LUMP_START * f->n);
    m.rate *= fast;
    (void)move(s, f, &m, 0.0, f->friction + LAC_LUMP_FAST * f->n);
    for (size_t k = 0; k < 2; k++) {
        m.rate = k == 0 ? fast * f->rate : f->rate;
        for (size_t i = 0; i < f->n; i++) {
            m.w[i] = log(lac_cellwise_of(&friction->column[LAC_DC], i) / m.rate);
        }
        (void)move(s, f, &m, 0.0, f->friction + (LAC_LUMP_STEADY + k) * f->n);
    }
    for (size_t h = 0; h < LAC_LUMP_HISTORIES; h++) {
        walk(s, f, &m, h);
    }
}

// By what cells are left apart: friction less what the load at the start is, at once, after some
// slip, and much faster; and that load, where its share changes with the water.
static void fill_patterns(const lac_lump_source *s, lac_lump_cells *f)
{
    const size_t n = f->n;
    const double water = 0.05;
    const double *load = f->friction + LAC_LUMP_LOAD * n;
    const double *of[LAC_LUMP_PATTERNS] = {
        [1] = f->friction + LAC_LUMP_START * n,
        [2] = f->friction + LAC_LUMP_FAST * n,
        [3] = f->friction + (LAC_LUMP_STAGES + LAC_LUMP_EACH / 4) * n,
        [4] = f->friction + (LAC_LUMP_STAGES + LAC_LUMP_EACH + LAC_LUMP_EACH / 2) * n};
    memcpy(f->pattern, f->friction + LAC_LUMP_ANSWER * n, n * sizeof *f->pattern);
    f->answer = lac_vdot(n, f->pattern, s->whole.domain->pressure) / f->pressure / (double)n;
    for (size_t a = 1; a < LAC_LUMP_PATTERNS; a++) {
        for (size_t i = 0; i < n; i++) {
            f->pattern[a * n + i] = of[a] != NULL ? of[a][i] - load[i] : water * load[i];
        }
        const double mean =
            lac_vdot(n, f->pattern + a * n, s->whole.domain->pressure) / f->pressure / (double)n;
        for (size_t i = 0; i < n; i++) {
            f->pattern[a * n + i] -= mean;
        }
    }
}

lac_status lac_lump_look(const lac_lump_source *s, lac_lump_cells *f, lac_error *err)
{
    const size_t n = s->whole.domain->n;
    *f = (lac_lump_cells){.n = n};
    f->memory =
        malloc(((LAC_LUMP_ROWS + LAC_LUMP_PATTERNS + 3) * n + lac_hierarchy_work(s->blocks)) *
               sizeof *f->memory);
    LAC_FAIL_MEMORY_IF(f->memory == NULL, err);
    f->friction = f->memory;
    f->pattern = f->friction + LAC_LUMP_ROWS * n;
    f->apart = f->pattern + LAC_LUMP_PATTERNS * n;
    f->scratch = f->apart + n;
    sum_up(s, f);
    fill_friction(s, f);
    fill_patterns(s, f);
    return LAC_OK;
}

void lac_lump_apart(const lac_lump_source *s, lac_lump_cells *f, size_t top, const double *by)
{
    const uint32_t *begin = lac_hierarchy_offsets(s->blocks, top);
    const double *p = s->whole.domain->pressure;
    double *force = f->scratch, *moved = force + f->n, *work = moved + f->n;
    memset(f->apart, 0, f->n * sizeof *f->apart);
    for (size_t a = LAC_LUMP_ANSWER + 1; a < LAC_LUMP_PATTERNS; a++) {
        const double *pattern = f->pattern + a * f->n;
        for (size_t b = 0; b < lac_hierarchy_blocks(s->blocks, top); b++) {
            double sum = 0.0, mean = 0.0;
            for (size_t i = begin[b]; i < begin[b + 1]; i++) {
                sum += p[i];
                mean += p[i] * pattern[i];
            }
            for (size_t i = begin[b]; i < begin[b + 1]; i++) {
                force[i] = p[i] * (pattern[i] - mean / sum);
            }
        }
        lac_hierarchy_apply(s->blocks, by, force, moved, work);
        for (size_t i = 0; i < f->n; i++) {
            f->apart[i] += force[i] * moved[i];
        }
    }
}

double lac_lump_stiffness(const lac_lump_source *s, size_t level)
{
    const lac_transfer *transfer = s->whole.transfer;
    return transfer->kind->stiffness(transfer->state, level);
}

size_t lac_lump_choose_level(const lac_lump_source *s, lac_lump_cells *f, double error)
{
    const size_t levels = lac_hierarchy_levels(s->blocks);
    double apart[LAC_LUMP_LEVELS]; // squares of slip over dc by which each may come apart
    for (size_t l = 0; l < levels; l++) {
        const double by = f->direct * f->per_dc / lac_lump_stiffness(s, l);
        double alone[LAC_LUMP_LEVELS] = {0.0};
        alone[l] = by * by / (double)f->n;
        lac_lump_apart(s, f, levels, alone);
        apart[l] = lac_vsum(f->n, f->apart);
    }
    const double least = 0.01; // what a smaller error asks is left to the ties
    size_t level = levels;
    for (size_t l = levels; l-- > 1;) {
        level = apart[l] > fmax(0.1 * fmax(error, least), 2.0 * apart[0]) ? l : level;
    }
    return level;
}
