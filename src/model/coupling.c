// SPDX-License-Identifier: GPL-3.0-or-later
// What couples the cells: the force that slip puts on them through the rock, less that of far
// motion and far loads; and damping of their mean rate.
#include "base/clones.h"
#include "model/internal.h"

lac_status lac_problem_anchor(lac_problem *problem, lac_error *err)
{
    size_t n = problem->n;
    const lac_transfer *transfer = &problem->transfer;
    double *ones = malloc(n * sizeof *ones);
    double *work = malloc((transfer->kind->work(transfer->state) + 1) * sizeof *work);
    problem->anchor = malloc(n * sizeof *problem->anchor);
    lac_status status = LAC_OK;
    LAC_TRY(ones != NULL && work != NULL && problem->anchor != NULL ? LAC_OK
                                                                    : lac_fail_memory(err));
    for (size_t i = 0; i < n; i++) {
        ones[i] = 1.0;
    }
    transfer->kind->apply(transfer->state, ones, problem->anchor, work);
    bool holds = false;
    for (size_t i = 0; i < n; i++) {
        holds = holds || problem->anchor[i] != 0.0;
    }
    if (!lac_team_any(problem->range.team, holds)) {
        free(problem->anchor);
        problem->anchor = NULL;
    }
out:
    free(ones);
    free(work);
    return status;
}

// An array of the cells of a problem, and what is shared by them.
typedef struct cell_array {
    const lac_problem *problem;
    const double *x, *row;
    double back;
} cell_array;

static void add_weighed(const void *context, size_t first, size_t end, double *sums)
{
    const cell_array *a = context;
    sums[0] += lac_problem_sum_from(a->problem, first, end - first, a->x + first);
}

double lac_problem_sum(const lac_problem *problem, const double *x)
{
    double sum;
    lac_range_sums(&problem->range, 1, add_weighed, &(cell_array){.problem = problem, .x = x},
                   &sum);
    return sum;
}

static void add_exps(const void *context, size_t first, size_t end, double *sums)
{
    const cell_array *a = context;
    for (size_t i = first; i < end; i++) {
        sums[0] += lac_problem_weight(a->problem, i) * exp(a->x[i]);
    }
}

double lac_problem_exp_mean(const lac_problem *problem, const double *u)
{
    double sum;
    lac_range_sums(&problem->range, 1, add_exps, &(cell_array){.problem = problem, .x = u}, &sum);
    return sum / lac_problem_all(problem);
}

// force -= scale shape
LAC_CLONES static void lac_couple_take_off(size_t n, const double *shape, double scale,
                                           double *force)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        force[i] -= scale * shape[i];
    }
}

void lac_problem_couple(const lac_problem *problem, lac_far_field far, const double *x,
                        double *force, double *work)
{
    problem->transfer.kind->apply(problem->transfer.state, x, force, work);
    if (problem->anchor != NULL && far.back != 0.0) {
        lac_couple_take_off(problem->n, problem->anchor, far.back, force);
    }
    if (problem->loads.shape != NULL && far.elastic != 0.0) {
        lac_couple_take_off(problem->n, problem->loads.shape, far.elastic, force);
    }
}

LAC_CLONES static void lac_couple_hold(size_t n, const double *restrict anchor,
                                       const double *restrict gone, double back,
                                       double *restrict held)
{
    for (size_t i = 0; i < n; i++) {
        held[i] = anchor[i] * (gone[i] - back);
    }
}

static void add_held(const void *context, size_t first, size_t end, double *sums)
{
    const cell_array *a = context;
    const lac_problem *problem = a->problem;
    for (size_t at = first; at < end; at += LAC_FRICTION_BLOCK) {
        double held[LAC_FRICTION_BLOCK];
        const size_t length = lac_block_length(end, at);
        lac_couple_hold(length, problem->anchor + at, a->x + at, a->back, held);
        sums[0] += lac_problem_sum_from(problem, at, length, held);
    }
}

double lac_problem_held(const lac_problem *problem, double back, const double *slip)
{
    if (problem->anchor == NULL) {
        return 0.0;
    }
    double total;
    lac_range_sums(&problem->range, 1, add_held,
                   &(cell_array){.problem = problem, .x = slip, .back = back}, &total);
    return total;
}

// What the loads put on the cells less what they hold on each other already; in place.
LAC_CLONES static void lac_couple_loads(const lac_problem *problem, double ratio, double common,
                                        double *restrict traction)
{
    const double *restrict start = problem->traction0, *restrict pressure = problem->pressure;
    const size_t n = problem->n;
    for (size_t i = 0; i < n; i++) {
        double q = start[i] + pressure[i] * ratio + common;
        traction[i] = q - traction[i];
    }
}

void lac_problem_elastic_traction(const lac_look *at, const double *slip, double *traction)
{
    const lac_problem *problem = at->problem;
    const lac_problem_loads_at *drive = &at->drive;
    double mean = lac_problem_mean(problem, slip);
    double common = drive->spring - drive->spring_stiffness * mean;
    lac_problem_couple(problem, drive->far, slip, traction, at->ws.scratch);
    lac_couple_loads(problem, drive->ratio, common, traction);
}

const char *lac_problem_lost_transfer(const lac_problem *problem, const double *slip, double *work)
{
    lac_workspace ws = lac_problem_split(problem, work);
    const lac_transfer *transfer = &problem->transfer;
    double given = 0.0;
    double found = 0.0;
    transfer->kind->apply(transfer->state, slip, ws.kv, ws.scratch);
    for (size_t i = 0; i < problem->n; i++) {
        given += slip[i] * 0.0;
        found += ws.kv[i] * 0.0;
    }
    const lac_team *team = problem->range.team;
    const bool is_given = lac_team_all(team, given == 0.0);
    return lac_team_any(team, found != 0.0) && is_given ? transfer->kind->info.name : NULL;
}

lac_damping lac_damping_over(const lac_domain *domain, double eta, bool massive)
{
    double cells = (double)lac_grid_cells(&domain->grid);
    double n = lac_domain_cells(domain);
    if (massive) {
        return domain->n == 1 ? (lac_damping){0} : (lac_damping){.cell = eta, .mean = -eta};
    }
    double pressure = lac_problem_sum(&(lac_problem){.range = lac_range_whole(domain->n),
                                                     .weight = domain->weight},
                                      domain->pressure) /
                      (double)domain->n;
    return (lac_damping){.cell = eta, .shared = eta * ((cells - n) / n) / pressure};
}

// In between, by digits where the two are of one sign.
static double middle(double low, double high)
{
    if (low > 0.0 && high > 4.0 * low) {
        return sqrt(low) * sqrt(high);
    }
    if (high < 0.0 && low < 4.0 * high) {
        return -sqrt(-low) * sqrt(-high);
    }
    return 0.5 * low + 0.5 * high;
}

// What is found falls as what is taken rises, so the root lies between the two. Newton's method,
// kept there.
double lac_mean_search_on(lac_mean_search *search, double found, double slope)
{
    double from = search->mean;
    search->low = fmax(search->low, fmin(from, found));
    search->high = fmin(search->high, fmax(from, found));
    double next = from + (found - from) / (1.0 + slope);
    if (!(next >= search->low && next <= search->high)) {
        next = middle(search->low, search->high);
    }
    search->mean = next;
    return next - from;
}

void lac_block_ease(const lac_problem *problem, const lac_problem_loads_at *drive,
                    const lac_friction_cells *cells, double *ease)
{
    lac_block s;
    const lac_friction_values values = lac_block_values(&s);
    lac_friction_evaluate(problem->friction, cells, &values, NULL);
    for (size_t i = 0; i < cells->n; i++) {
        double held = lac_problem_effective(problem, drive, cells->first + i) * s.f_u[i];
        double drag = lac_problem_drag(problem, cells->first + i);
        ease[i] = drag * cells->v[i] / (held + problem->damping * cells->v[i]);
    }
}

static void add_row(const void *context, size_t first, size_t end, double *sums)
{
    const cell_array *a = context;
    for (size_t i = first; i < end; i++) {
        const double weight = lac_problem_weight(a->problem, i);
        sums[0] += weight * (a->row[i] * a->x[i]);
        sums[1] += weight * a->x[i];
    }
}

// Means over the cells of row x and of x.
static void weigh(const lac_problem *problem, const double *row, const double *x, double means[2])
{
    lac_range_sums(&problem->range, 2, add_row,
                   &(cell_array){.problem = problem, .x = x, .row = row}, means);
    means[0] /= lac_problem_all(problem);
    means[1] /= lac_problem_all(problem);
}

// Where the row is 1: what s is besides 1 acts on the mean.
static bool share_evenly(const lac_problem *problem, double mean, const double *diagonal,
                         const lac_sharing *on, double *b, double *scratch)
{
    size_t n = problem->n;
    const lac_transfer *transfer = &problem->transfer;
    double *x = on->shares;
    for (size_t i = 0; i < n; i++) {
        x[i] = lac_problem_share(problem, i) - 1.0;
    }
    if (!transfer->kind->solve(transfer->state, mean, diagonal, x, x, scratch)) {
        return false;
    }
    double pivot = 1.0 + on->kappa * lac_problem_mean(problem, x);
    double by = on->kappa * lac_problem_mean(problem, b) / pivot;
    for (size_t i = 0; i < n; i++) {
        b[i] -= by * x[i];
    }
    return pivot > 0.0 && isfinite(pivot);
}

// What a row other than 1 is solved with.
typedef struct row_terms {
    double by_share, by_one; // x loses by_share M^-1 s - by_one M^-1 1
} row_terms;

// By Woodbury's formula. @param r, s, e  means of row x and of x, for b, s and 1
static bool find_terms(double kappa, const double r[2], const double s[2], const double e[2],
                       row_terms *out)
{
    double a00 = 1.0 + kappa * s[0];
    double a01 = -kappa * e[0];
    double a10 = kappa * s[1];
    double a11 = 1.0 - kappa * e[1];
    double pivot = a00 * a11 - a01 * a10;
    out->by_share = kappa * (r[0] * a11 - a01 * r[1]) / pivot;
    out->by_one = kappa * (a00 * r[1] - a10 * r[0]) / pivot;
    return pivot > 0.0 && isfinite(pivot);
}

static void fill_shares(const lac_problem *problem, double *shares)
{
    for (size_t i = 0; i < problem->n; i++) {
        shares[i] = lac_problem_share(problem, i);
    }
}

static bool share_by_row(const lac_problem *problem, double mean, const double *diagonal,
                         const lac_sharing *on, double *b, double *scratch)
{
    size_t n = problem->n;
    const lac_transfer *transfer = &problem->transfer;
    double *shares = on->shares;
    double *ones = on->ones != NULL ? on->ones : shares; // one after the other
    double r[2], s[2], e[2];
    row_terms terms;
    weigh(problem, on->row, b, r);
    fill_shares(problem, shares);
    if (!transfer->kind->solve(transfer->state, mean, diagonal, shares, shares, scratch)) {
        return false;
    }
    weigh(problem, on->row, shares, s);
    for (size_t i = 0; i < n; i++) {
        ones[i] = 1.0;
    }
    if (!transfer->kind->solve(transfer->state, mean, diagonal, ones, ones, scratch)) {
        return false;
    }
    weigh(problem, on->row, ones, e);
    if (!find_terms(on->kappa, r, s, e, &terms)) {
        return false;
    }
    if (on->ones != NULL) {
        for (size_t i = 0; i < n; i++) {
            b[i] += terms.by_one * ones[i] - terms.by_share * shares[i];
        }
        return true;
    }
    for (size_t i = 0; i < n; i++) {
        shares[i] = terms.by_one - terms.by_share * lac_problem_share(problem, i);
    }
    if (!transfer->kind->solve(transfer->state, mean, diagonal, shares, shares, scratch)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        b[i] += shares[i];
    }
    return true;
}

// The transfer's solve takes kappa 11^T/n along as a stiffness of the mean slip, which holds a mean
// that weakens; Woodbury's formula puts right what s and the row are besides 1.
static bool solve_shared(const lac_problem *problem, double mean, const double *diagonal,
                         const lac_sharing *on, double *b, double *scratch)
{
    const lac_transfer *transfer = &problem->transfer;
    if (!transfer->kind->solve(transfer->state, mean, diagonal, b, b, scratch)) {
        return false;
    }
    if (on->kappa == 0.0) {
        return true;
    }
    return on->row == NULL ? share_evenly(problem, mean, diagonal, on, b, scratch)
                           : share_by_row(problem, mean, diagonal, on, b, scratch);
}

// The same with the column, whose mean is a stiffness of the mean slip too. Of what it is besides,
// e, M^-1 e tells:  x = M^-1 b + M^-1 e x_mean,  (1 - mean of M^-1 e) x_mean = mean of M^-1 b
bool lac_problem_solve_sharing(const lac_problem *problem, double mean, const double *diagonal,
                               const lac_sharing *on, double *b, double *scratch)
{
    const size_t n = problem->n;
    double *column = on->column;
    if (column == NULL) {
        return solve_shared(problem, mean, diagonal, on, b, scratch);
    }
    const double alike = lac_problem_mean(problem, column);
    bool differs = false;
    for (size_t i = 0; i < n; i++) {
        column[i] -= alike;
        differs = differs || column[i] != 0.0;
    }
    differs = lac_team_any(problem->range.team, differs);
    if (!solve_shared(problem, mean - alike, diagonal, on, b, scratch) ||
        (differs && !solve_shared(problem, mean - alike, diagonal, on, column, scratch))) {
        return false;
    }
    const double pivot = differs ? 1.0 - lac_problem_mean(problem, column) : 1.0;
    const double by = differs ? lac_problem_mean(problem, b) / pivot : 0.0;
    for (size_t i = 0; differs && i < n; i++) {
        b[i] += by * column[i];
    }
    return pivot > 0.0 && isfinite(pivot);
}
