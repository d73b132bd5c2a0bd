// SPDX-License-Identifier: GPL-3.0-or-later
// A rough surface pressed to a given load or approach: full contact by formula, else by iteration.
#include "contact/solve.h"

// The problem in the solver's own units, and what brings it back to SI.
typedef struct problem {
    lac_extent at;
    lac_heights h; // less their mean, over the unit of height
    double h_rms;  // unit of height: the rms height, or what the load dents where that is more [m]
    double unit;   // of pressure: pi E* h_rms / (longest side) [Pa]
} problem;

lac_contact_def lac_contact_default(void)
{
    return (lac_contact_def){.tolerance = 1e-8, .max_iterations = 1000};
}

// What a case cannot see to: a load may vanish in the numbers, an approach is of its boundaries.
static lac_status check(const lac_contact_def *def, lac_error *err)
{
    LAC_FAIL_IF(def->control == LAC_CONTROL_LOAD &&
                    !(def->mean_pressure > 0.0 && isfinite(def->mean_pressure)),
                err, LAC_EINPUT, "the mean pressure must be > 0 Pa, not %g", def->mean_pressure);
    if (def->control == LAC_CONTROL_APPROACH) {
        // Periodic faces without a gap carry any load beyond a certain one.
        double least = def->grid.periodic ? 0.0 : -DBL_MAX;
        LAC_FAIL_IF(!(def->approach > least && isfinite(def->approach)), err, LAC_EINPUT,
                    "the approach must be finite%s, not %g m",
                    def->grid.periodic ? " and > 0 between periodic faces" : "", def->approach);
    }
    return LAC_OK;
}

double lac_contact_peak(const lac_contact_def *def)
{
    const lac_strip rows = lac_strip_rows(def->team, def->grid.ny);
    double most = -INFINITY;
    for (size_t i = 0; i < rows.n * def->grid.nx; i++) {
        most = fmax(most, def->heights[i]);
    }
    most = lac_team_most(def->team, most);
    return most - lac_strip_mean(&rows, def->grid.nx, def->heights);
}

// How far it would stick into the undeformed body; < 0 where they do not touch. [m]
static double depth(const lac_contact_def *def) { return lac_contact_peak(def) - def->approach; }

// Heights in units of the largest.
typedef struct squares {
    lac_heights h;
    size_t n;
    double most;
} squares;

static void add_squares(void *context, double *sum)
{
    const squares *s = context;
    for (size_t i = 0; i < s->n && s->most > 0.0; i++) {
        double x = lac_heights_at(s->h, i) / s->most;
        *sum += x * x;
    }
}

// Heights less their mean, in units of their rms, but at least of `least`.
static lac_status scale_heights(const lac_contact_def *def, double least, problem *p,
                                lac_error *err)
{
    const lac_strip *rows = &p->at.rows;
    const double mean = lac_strip_mean(rows, def->grid.nx, def->heights);
    p->h = (lac_heights){.z = def->heights, .mean = mean, .unit = 1.0};
    double most = 0.0, sum = 0.0;
    for (size_t i = 0; i < lac_extent_cells(&p->at); i++) {
        most = fmax(most, fabs(lac_heights_at(p->h, i)));
    }
    most = lac_team_most(def->team, most);
    squares s = {p->h, lac_extent_cells(&p->at), most};
    lac_team_relay(def->team, add_squares, &s, &sum, 1);
    p->h_rms = fmax(least, most * sqrt(sum / (double)lac_grid_cells(&def->grid)));
    p->h.unit = most > 0.0 ? p->h_rms : 1.0;
    LAC_FAIL_IF(!isfinite(p->h_rms), err, LAC_EINPUT,
                "the heights span more than numbers can hold");
    return LAC_OK;
}

// Free faces are dented by any load, however smooth they are. [m]
static double dent(const lac_contact_def *def, double longest)
{
    if (def->control == LAC_CONTROL_LOAD) {
        return def->mean_pressure / (0.5 * (2.0 * M_PI) * def->e_star) * longest;
    }
    return depth(def);
}

static lac_status scale_problem(const lac_contact_def *def, problem *p, lac_error *err)
{
    const lac_grid *grid = &def->grid;
    double lx = (double)grid->nx * grid->dx;
    double ly = (double)grid->ny * grid->dy;
    double longest = fmax(lx, ly);
    p->at = (lac_extent){grid->nx,     grid->ny,       longest / lx,
                         longest / ly, grid->periodic, lac_strip_rows(def->team, grid->ny)};
    LAC_TRY_RETURN(scale_heights(def, grid->periodic ? 0.0 : dent(def, longest), p, err));
    p->unit = 0.5 * (2.0 * M_PI) * def->e_star * (p->h_rms / longest);
    double load = def->mean_pressure / p->unit;
    bool too_little = def->control == LAC_CONTROL_LOAD && p->h_rms > 0.0 && load == 0.0;
    LAC_FAIL_IF(!isfinite(p->unit) || too_little, err, LAC_EINPUT,
                "a mean pressure of %g Pa is beyond what can be solved for E* = %g Pa and an rms "
                "height of %g m",
                def->mean_pressure, def->e_star, p->h_rms);
    return LAC_OK;
}

// Full contact, row by row
typedef struct full {
    const problem *p;
    double mean_pressure;
    double *pressure; // [ny * nx] or NULL
    bool *positive;   // [ny] all of a row
} full;

static void height_row(void *context, size_t j, void *row)
{
    const problem *p = ((const full *)context)->p;
    double *into = row;
    for (size_t i = 0; i < p->at.nx; i++) {
        into[i] = lac_heights_at(p->h, j * p->at.nx + i);
    }
}

static void full_row(void *context, size_t j, void *row)
{
    const full *f = context;
    const double *stiff = row;
    bool positive = true;
    for (size_t i = 0; i < f->p->at.nx; i++) {
        double pressure = f->mean_pressure + f->p->unit * stiff[i];
        positive = positive && pressure > 0.0;
        if (f->pressure != NULL) {
            f->pressure[j * f->p->at.nx + i] = pressure;
        }
    }
    f->positive[j] = positive;
}

// Full contact, where the load is high enough for it: p = mean p + E* |q| h / 2 >= 0. Pressures
// may hold the first guess until that is sure.
static lac_status full_contact(const lac_contact_def *def, const problem *p, lac_half_space *s,
                               double *pressure, bool *is_full, lac_error *err)
{
    *is_full = false;
    if (!p->at.periodic || def->control != LAC_CONTROL_LOAD) {
        return LAC_OK; // edges have no such closed form
    }
    full f = {p, def->mean_pressure, NULL, lac_team_alloc(def->team, p->at.rows.n * sizeof(bool))};
    LAC_FAIL_MEMORY_IF(f.positive == NULL, err);
    lac_filter_fill(s->filter, LAC_DOUBLE, 0, height_row, &f);
    lac_half_space_unload(s, NULL);
    lac_filter_take(s->filter, full_row, &f);
    *is_full = true;
    for (size_t j = 0; j < p->at.rows.n; j++) {
        *is_full = *is_full && f.positive[j];
    }
    *is_full = lac_team_all(def->team, *is_full);
    if (*is_full) {
        f.pressure = pressure;
        lac_filter_take(s->filter, full_row, &f);
    }
    free(f.positive);
    return LAC_OK;
}

// First guess: the given pressures, brought to the load where that is given; false without any.
static bool warm_guess(const lac_contact_def *def, const problem *p, const lac_descent *d,
                       double *pressure)
{
    const size_t n = lac_extent_cells(&p->at);
    const double all = (double)(p->at.nx * p->at.ny);
    double most = 0.0;
    for (size_t i = 0; i < n && def->start != NULL; i++) {
        most = fmax(most, def->start[i]);
    }
    most = lac_team_most(def->team, most);
    for (size_t i = 0; i < n && most > 0.0; i++) {
        pressure[i] = def->start[i] / most;
    }
    const bool held = d->control == LAC_CONTROL_LOAD && most > 0.0;
    const double sum = held ? lac_strip_sum(&p->at.rows, n, pressure, 1.0) : NAN;
    double scale = held ? d->mean_pressure * all / sum : most / p->unit;
    for (size_t i = 0; i < n && most > 0.0; i++) {
        pressure[i] *= scale;
    }
    return most > 0.0;
}

static bool no_contact(const lac_contact_def *def, double *pressure, double *gap)
{
    if (def->control == LAC_CONTROL_LOAD || depth(def) > 0.0) {
        return false;
    }
    const lac_strip rows = lac_strip_rows(def->team, def->grid.ny);
    const size_t n = rows.n * def->grid.nx;
    double mean = lac_strip_mean(&rows, def->grid.nx, def->heights);
    memset(pressure, 0, n * sizeof *pressure);
    for (size_t i = 0; i < n && gap != NULL; i++) {
        gap[i] = def->approach + mean - def->heights[i];
    }
    return true;
}

// Partial contact, in the solver's units until the end.
static lac_status partial_contact(const lac_contact_def *def, const problem *p, lac_half_space *s,
                                  double *pressure, double *gap, lac_contact_stats *report,
                                  lac_error *err)
{
    size_t n = lac_extent_cells(&p->at);
    const bool load_given = def->control == LAC_CONTROL_LOAD;
    lac_descent d = {.heights = p->h,
                     .control = def->control,
                     .mean_pressure = load_given ? def->mean_pressure / p->unit : 1.0,
                     .approach = load_given ? 0.0 : def->approach / p->h_rms,
                     .tolerance = def->tolerance,
                     .max_iterations = def->max_iterations};
    if (!warm_guess(def, p, &d, pressure)) {
        LAC_TRY_RETURN(lac_coarse_guess(&p->at, p->h, &d, pressure, err));
    }
    LAC_TRY_RETURN(lac_descend(s, &d, pressure, gap, err));
    for (size_t i = 0; i < n; i++) {
        pressure[i] *= p->unit;
    }
    for (size_t i = 0; i < n && gap != NULL; i++) {
        gap[i] *= p->h_rms;
    }
    *report = (lac_contact_stats){.iterations = d.iterations,
                                  .products = d.products,
                                  .complementarity_error = d.residual.complementarity,
                                  .penetration = d.residual.penetration * p->h_rms,
                                  .load_error = d.residual.load,
                                  .approach = d.closest * p->h_rms};
    LAC_FAIL_IF(!lac_residual_holds(&d.residual, def->tolerance), err, LAC_ENUMERIC,
                "no convergence to %g after %lld iterations: complementarity %.3g, penetration "
                "%.3g of the rms height, load %.3g",
                def->tolerance, (long long)d.iterations, d.residual.complementarity,
                d.residual.penetration, d.residual.load);
    return LAC_OK;
}

static void count_contact(const lac_extent *at, const double *pressure, lac_contact_stats *report)
{
    double cells = 0.0, most = 0.0;
    for (size_t i = 0; i < lac_extent_cells(at); i++) {
        cells += pressure[i] > 0.0 ? 1.0 : 0.0;
        most = fmax(most, pressure[i]);
    }
    report->n_cells = (size_t)lac_strip_sum(&at->rows, 1, &cells, 1.0);
    report->max_pressure = lac_team_most(at->rows.team, most);
    report->mean_pressure = lac_strip_mean(&at->rows, at->nx, pressure);
}

lac_status lac_contact_solve(const lac_contact_def *def, double *pressure, double *gap,
                             lac_contact_stats *report, lac_error *err)
{
    lac_half_space *s = NULL;
    problem p = {0};
    lac_contact_stats own_report;
    lac_contact_stats *r = report != NULL ? report : &own_report;
    *r = (lac_contact_stats){0};
    lac_status status;
    LAC_TRY(lac_team_agree(def->team, check(def, err), err));
    LAC_TRY(scale_problem(def, &p, err));
    const size_t n = lac_extent_cells(&p.at);
    LAC_TRY(lac_half_space_create(&p.at, &s, err));
    bool is_full;
    LAC_TRY(full_contact(def, &p, s, pressure, &is_full, err));
    if (no_contact(def, pressure, gap)) {
        r->approach = def->approach;
    } else if (is_full) {
        for (size_t i = 0; i < n && gap != NULL; i++) {
            gap[i] = 0.0;
        }
        r->products = 1;
    } else {
        LAC_TRY(partial_contact(def, &p, s, pressure, gap, r, err));
    }
    count_contact(&p.at, pressure, r);
out:
    lac_half_space_free(s);
    return status;
}
