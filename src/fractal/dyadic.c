// SPDX-License-Identifier: GPL-3.0-or-later
// Blocks of the grid itself, and the normal load at which they count a given dimension.
#include "fractal/fractal.h"

// Cells come in Morton order, so that those of a block follow each other.
static double blocks_at(const lac_domain *domain, size_t level)
{
    double n = 0.0;
    uint64_t last = UINT64_MAX;
    for (size_t i = 0; i < domain->n; i++) {
        uint32_t x = (uint32_t)(domain->index[i] % domain->grid.nx);
        uint32_t y = (uint32_t)(domain->index[i] / domain->grid.nx);
        uint64_t block = lac_morton(x, y) >> 2 * level;
        n += block != last ? 1.0 : 0.0;
        last = block;
    }
    return n;
}

lac_dyadic lac_dyadic_count(const lac_domain *domain)
{
    lac_dyadic d = {.levels = lac_grid_levels(&domain->grid), .dimension = NAN};
    // slope = sum (l - m) log2 N_l / sum (l - m)^2, m the mean level
    const double middle = 0.5 * (double)d.levels;
    double product = 0.0, square = 0.0;
    for (size_t level = 0; level <= d.levels; level++) {
        double from_middle = (double)level - middle;
        d.count[level] = blocks_at(domain, level);
        product += from_middle * log2(d.count[level]);
        square += from_middle * from_middle;
    }
    if (d.levels > 0) {
        d.dimension = fabs(product) / square; // counts never grow with the level
    }
    return d;
}

// A contact that was solved.
typedef struct probe {
    double load; // ln of the mean pressure over `unit`
    double dimension;
    size_t cells;
} probe;

typedef struct search {
    lac_contact_def def;
    double unit; // E* h' [Pa]
    double target;
    double *pressure; // of the last probe
    probe best;
} search;

static const double close_enough = 1e-4, too_far = 0.02;

static double load_of(const search *s, const probe *at) { return s->unit * exp(at->load); }

// Rows, the one before them first.
typedef struct slopes {
    const lac_grid *grid;
    lac_strip rows;
    const double *heights;
} slopes;

static void add_slopes(void *context, double *sum)
{
    const slopes *s = context;
    const lac_grid *grid = s->grid;
    const double *h = s->heights + (s->rows.first > 0 ? grid->nx : 0);
    for (size_t i = 0; i < s->rows.n * grid->nx; i++) {
        double along = i % grid->nx > 0 ? (h[i] - h[i - 1]) / grid->dx : 0.0;
        double across = s->rows.first > 0 || i >= grid->nx
                            ? (h[i] - h[(ptrdiff_t)i - (ptrdiff_t)grid->nx]) / grid->dy
                            : 0.0;
        *sum += along * along + across * across;
    }
}

// rms slope between neighbours
static lac_status find_slope(const lac_contact_def *def, double *slope, lac_error *err)
{
    const lac_grid *grid = &def->grid;
    slopes s = {grid, lac_strip_rows(def->team, grid->ny), NULL};
    const size_t more = s.rows.first > 0 ? 1 : 0;
    void *made;
    double sum = 0.0;
    s.heights = lac_strip_bring(&s.rows, s.rows.first - more, s.rows.n + more,
                                grid->nx * sizeof sum, def->heights, &made);
    LAC_FAIL_MEMORY_IF(s.heights == NULL, err);
    lac_team_relay(def->team, add_slopes, &s, &sum, 1);
    free(made);
    *slope = sqrt(sum / (double)lac_grid_cells(grid));
    return LAC_OK;
}

static lac_status try_load(search *s, double load, probe *out, lac_error *err)
{
    lac_domain *domain = NULL;
    lac_status status;
    out->load = load;
    s->def.mean_pressure = load_of(s, out);
    LAC_TRY(lac_contact_solve(&s->def, s->pressure, NULL, NULL, err));
    s->def.start = s->pressure;
    LAC_TRY(lac_domain_gather(&s->def.grid, s->def.team, s->pressure, &domain, err));
    out->dimension = lac_dyadic_count(domain).dimension;
    out->cells = domain->n;
    if (fabs(out->dimension - s->target) < fabs(s->best.dimension - s->target)) {
        s->best = *out;
    }
out:
    lac_domain_free(domain);
    return status;
}

static lac_status fail_outside(const search *s, const probe *end, bool above, lac_error *err)
{
    return lac_fail(
        err, LAC_EINPUT,
        "no load gives a dimension of %g: it is at %s %.4g, that of %zu cells at %.4g Pa",
        s->target, above ? "most" : "least", end->dimension, end->cells, load_of(s, end));
}

// Loads on both sides of the target, from a light contact on by factors of 4.
static lac_status bracket(search *s, probe *low, probe *high, lac_error *err)
{
    const double step = log(4.0);
    const double lightest = log(1e-12), heaviest = log(1e6);
    probe at;
    LAC_TRY_RETURN(try_load(s, log(0.03), &at, err));
    *low = at;
    *high = at;
    while (high->dimension < s->target) {
        if (high->cells == lac_grid_cells(&s->def.grid) || high->load > heaviest) {
            return fail_outside(s, high, true, err);
        }
        *low = *high;
        LAC_TRY_RETURN(try_load(s, high->load + step, high, err));
    }
    while (low->dimension >= s->target) {
        if (low->load < lightest) {
            return fail_outside(s, low, false, err);
        }
        *high = *low;
        LAC_TRY_RETURN(try_load(s, low->load - step, low, err));
    }
    return LAC_OK;
}

// Halves the interval every third time, else follows the straight line through its ends.
static lac_status narrow(search *s, probe low, probe high, lac_error *err)
{
    const double finest = 1e-8; // of the load: single cells decide
    for (int i = 1;
         high.load - low.load > finest && fabs(s->best.dimension - s->target) > close_enough; i++) {
        double x = (s->target - low.dimension) / (high.dimension - low.dimension);
        x = i % 3 == 0 ? 0.5 : fmin(fmax(x, 0.02), 0.98);
        probe at;
        LAC_TRY_RETURN(try_load(s, low.load + x * (high.load - low.load), &at, err));
        if (at.dimension < s->target) {
            low = at;
        } else {
            high = at;
        }
    }
    LAC_FAIL_IF(fabs(s->best.dimension - s->target) > too_far, err, LAC_EINPUT,
                "no load gives a dimension of %g: it jumps from %.4g (%zu cells) to %.4g (%zu "
                "cells) at %.4g Pa",
                s->target, low.dimension, low.cells, high.dimension, high.cells, load_of(s, &high));
    return LAC_OK;
}

lac_status lac_dimension_solve(const lac_contact_def *def, double dimension, double *pressure,
                               double *gap, lac_contact_stats *report, lac_error *err)
{
    search s = {.def = *def, .target = dimension, .pressure = pressure, .best = {.dimension = -9}};
    probe low, high;
    LAC_FAIL_IF(!(dimension > 0.0 && dimension < 2.0), err, LAC_EINPUT,
                "the dimension must be > 0 and < 2, not %g", dimension);
    s.def.control = LAC_CONTROL_LOAD;
    s.def.start = NULL;
    double slope;
    LAC_TRY_RETURN(find_slope(def, &slope, err));
    s.unit = def->e_star * slope;
    LAC_FAIL_IF(
        s.unit == 0.0 && def->e_star > 0.0, err, LAC_EINPUT,
        "no load gives a dimension of %g: the faces are flat and touch everywhere under any",
        dimension);
    if (!(s.unit > 0.0 && isfinite(s.unit))) {
        s.unit = 1.0; // a wrong height or modulus, which the contact names
    }
    LAC_TRY_RETURN(bracket(&s, &low, &high, err));
    LAC_TRY_RETURN(narrow(&s, low, high, err));
    // afresh, so that the load alone tells the contact
    s.def.start = NULL;
    s.def.mean_pressure = load_of(&s, &s.best);
    LAC_TRY_RETURN(lac_contact_solve(&s.def, pressure, gap, report, err));
    return LAC_OK;
}
