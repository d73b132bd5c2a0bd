// SPDX-License-Identifier: GPL-3.0-or-later
// A problem put together and checked: cells, friction, loads, and the traction at t = 0.
#include "model/problem.h"

#include <assert.h>

#include "base/statistics.h"
#include "model/internal.h"
#include "model/weaken.h"

static void fill_geometry(lac_problem *problem, const lac_domain *domain, lac_team *team)
{
    problem->range = lac_range_of(team, team != NULL ? team->rank : 0, domain->n);
    problem->n = problem->range.n;
    problem->pressure = domain->pressure + problem->range.first;
    problem->weight = domain->weight != NULL ? domain->weight + problem->range.first : NULL;
    problem->cell_area =
        lac_grid_cell_area(&domain->grid) * (domain->weight != NULL ? domain->each : 1.0);
    problem->nominal_area = lac_grid_area(&domain->grid);
    const lac_grid *grid = &domain->grid;
    problem->length = lac_grid_cells(grid) == 1
                          ? 10.0
                          : lac_grid_extent(grid, (double)grid->nx, (double)grid->ny);
    problem->sum_pressure = lac_problem_sum(problem, problem->pressure);
    problem->mean_pressure = problem->sum_pressure * problem->cell_area / problem->nominal_area;
    problem->spring_share = problem->nominal_area / ((double)domain->n * problem->cell_area);
}

// What of friction, transfer and loads is of the cells here.
static lac_status take_part(lac_problem *problem, lac_error *err)
{
    const lac_range *range = &problem->range;
    const bool both = problem->kind->id == LAC_FORMULATION_VECTOR;
    if (range->team == NULL) {
        return LAC_OK;
    }
    uint32_t *cell = malloc((range->n + 1) * sizeof *cell);
    LAC_FAIL_MEMORY_IF(cell == NULL, err);
    for (size_t i = 0; i < range->n; i++) {
        cell[i] = (uint32_t)(range->first + i);
    }
    lac_status status = lac_friction_pick(problem->friction, cell, range->n, &problem->part, err);
    free(cell);
    if (status == LAC_OK) {
        problem->friction = problem->part;
        status = lac_transfer_part(&problem->transfer, both, range, &problem->part_transfer, err);
        problem->transfer = problem->part_transfer;
    }
    if (problem->loads.shape != NULL) {
        problem->loads.shape += range->first;
    }
    if (status == LAC_OK && problem->varies) {
        lac_load_places places = problem->loads.places;
        places.index += range->first;
        places.n = range->n;
        status = lac_load_set_place(&problem->loads, &places, err);
    }
    return status;
}

static lac_status check_initial(const lac_problem_def *def, lac_error *err)
{
    for (size_t i = 0; i < def->domain->n; i++) {
        LAC_FAIL_IF(!isfinite(def->log_rate[i]) || !isfinite(def->log_state[i]), err, LAC_EINPUT,
                    "initial ln v = %g, ln theta = %g of cell %zu", def->log_rate[i],
                    def->log_state[i], i);
    }
    return LAC_OK;
}

// The traction that the initial rate and state carry is the load at t = 0, less what cohesion
// carries of it at all times: so neither rates nor Newton's matrix know of cohesion.
static void fill_traction(lac_problem *problem)
{
    for (size_t i = 0; i < problem->n; i++) {
        double u = problem->log_rate0[i];
        double f = lac_friction_coefficient(problem->friction, i, u, problem->log_state0[i]);
        problem->traction0[i] =
            lac_problem_effective(problem, &problem->drive0, i) * f + problem->damping * exp(u);
    }
    const double mean = lac_problem_exp_mean(problem, problem->log_rate0);
    for (size_t i = 0; i < problem->n; i++) {
        problem->traction0[i] += lac_problem_drag(problem, i) * mean;
    }
    problem->sum_traction0 = lac_problem_sum(problem, problem->traction0);
}

static double least_of(const lac_cellwise *column, size_t n)
{
    double least = INFINITY;
    for (size_t i = 0; i < n; i++) {
        least = fmin(least, lac_cellwise_of(column, i));
    }
    return least;
}

// Without direct effect and damping the traction says nothing of the rate.
static lac_status check_solvable(const lac_problem *problem, size_t n, lac_error *err)
{
    const lac_cellwise *column_a = &problem->friction->column[LAC_A];
    for (size_t i = 0; problem->kind->solved && i < n; i++) {
        double a = lac_cellwise_of(column_a, i);
        LAC_FAIL_IF(!(a > 0.0) && !(problem->damping > 0.0), err, LAC_EINPUT,
                    "a = %g of cell %zu without radiation damping: the formulation \"%s\" cannot "
                    "tell its slip rate from its traction; a must be > 0, or give "
                    "material.shear_modulus and shear_speed",
                    a, i, problem->kind->name);
    }
    return LAC_OK;
}

static void add_squares(const void *context, size_t first, size_t end, double *sums)
{
    const double *x = context;
    sums[0] += lac_dot(end - first, x + first, x + first);
}

// How much traction a metre of slip takes off a cell whose neighbours slip the other way.
static lac_status measure_stiffness(lac_problem *problem, lac_error *err)
{
    size_t n = problem->n;
    const lac_transfer *transfer = &problem->transfer;
    double *slip = malloc((2 * n + transfer->kind->work(transfer->state)) * sizeof *slip);
    LAC_FAIL_MEMORY_IF(slip == NULL, err);
    for (size_t i = 0; i < n; i++) {
        slip[i] = (problem->range.first + i) % 2 == 0 ? 1.0 : -1.0;
    }
    transfer->kind->apply(transfer->state, slip, slip + n, slip + 2 * n);
    double squares;
    lac_range_sums(&problem->range, 1, add_squares, slip + n, &squares);
    problem->stiffness = sqrt(squares / lac_problem_all(problem)) +
                         problem->spring_share * problem->at_start.spring_stiffness +
                         problem->slide;
    free(slip);
    return LAC_OK;
}

static lac_status allocate(lac_problem *problem, const lac_problem_def *def, lac_error *err)
{
    size_t bytes = problem->n * sizeof(double);
    problem->traction0 = malloc(3 * bytes + sizeof(double));
    LAC_FAIL_MEMORY_IF(problem->traction0 == NULL, err);
    problem->log_rate0 = problem->traction0 + problem->n;
    problem->log_state0 = problem->log_rate0 + problem->n;
    memcpy(problem->log_rate0, def->log_rate + problem->range.first, bytes);
    memcpy(problem->log_state0, def->log_state + problem->range.first, bytes);
    if (problem->varies) {
        problem->shares0 = malloc(2 * bytes);
        LAC_FAIL_MEMORY_IF(problem->shares0 == NULL, err);
    }
    return LAC_OK;
}

lac_status lac_problem_create(const lac_problem_def *def, lac_problem **out, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_problem *problem = *out = calloc(1, sizeof *problem);
    LAC_FAIL_MEMORY_IF(problem == NULL, err);
    fill_geometry(problem, def->domain, def->team);
    problem->friction = def->friction;
    problem->transfer = *def->transfer;
    problem->loads = def->loads;
    lac_load_set_note(&problem->loads); // of those made without a case, too
    if (def->formulation == LAC_FORMULATION_VECTOR) {
        problem->loads = lac_load_set_along(&def->loads, 1.0, 0.0);
    }
    lac_damping damping = lac_damping_over(def->domain, def->damping, def->mass > 0.0);
    problem->damping = damping.cell;
    problem->mean_damping = damping.mean;
    problem->drag = damping.shared;
    problem->least_direct = least_of(&problem->friction->column[LAC_A], def->domain->n);
    problem->bond = problem->friction->cohesion / problem->mean_pressure;
    problem->kind = lac_formulation_kind_of(def->formulation);
    problem->varies = problem->loads.varies;
    problem->safety = def->safety;
    problem->weak = def->weakening != NULL && def->weakening->count > 0 ? def->weakening : NULL;
    lac_load_evaluate(&problem->loads, 0.0, &problem->at_start);

    LAC_TRY(check_initial(def, err));
    LAC_TRY(lac_inertia_init(problem, def, err));
    LAC_TRY(check_solvable(problem, def->domain->n, err));
    LAC_TRY(lac_weaken_check(problem, err));
    // Whoever made the loads knows the contact and its cells.
    assert(!problem->loads.shaped || problem->loads.shape != NULL);
    assert(!problem->varies || problem->loads.places.n == problem->range.all);
    LAC_TRY(lac_problem_geometry_init(problem, err));
    status = take_part(problem, err);
    LAC_TRY(
        lac_team_agree(def->team, status == LAC_OK ? allocate(problem, def, err) : status, err));
    lac_problem_lay_out(problem);
    LAC_TRY(lac_problem_anchor(problem, err));
    if (!lac_problem_drive_into(problem, 0.0, (lac_gone){0}, problem->shares0, &problem->drive0)) {
        status =
            lac_fail(err, LAC_EINPUT,
                     "pore pressure %g Pa is not below the normal pressure %g Pa at the start",
                     problem->at_start.pore, problem->mean_pressure + problem->at_start.normal);
        goto out;
    }
    problem->still = !problem->varies && problem->loads.geometry == NULL && !problem->loads.changes;
    fill_traction(problem);
    if (problem->kind->has_slip) {
        LAC_TRY(measure_stiffness(problem, err));
    }
    if (def->formulation == LAC_FORMULATION_VECTOR) {
        LAC_TRY(lac_vector_init(problem, def->heading, err));
    }
out:
    LAC_MADE(status, out, lac_problem_free);
}

void lac_problem_free(lac_problem *problem)
{
    if (problem == NULL) {
        return;
    }
    lac_vector_clear(problem);
    free(problem->traction0);
    free(problem->anchor);
    free(problem->shares0);
    lac_friction_free(problem->part);
    lac_transfer_clear(&problem->part_transfer);
    free(problem);
}

bool lac_problem_coheres(const lac_problem *problem) { return problem->bond > 0.0; }

double lac_problem_cohesion(const lac_problem *problem, size_t cell)
{
    return problem->pressure[cell] * problem->bond;
}

size_t lac_problem_cells(const lac_problem *problem) { return problem->n; }

const lac_range *lac_problem_range(const lac_problem *problem) { return &problem->range; }

lac_formulation lac_problem_formulation(const lac_problem *problem) { return problem->kind->id; }

const char *lac_problem_unknown(const lac_problem *problem) { return problem->kind->unknown; }

bool lac_problem_has_slip(const lac_problem *problem) { return problem->kind->has_slip; }

size_t lac_problem_arrays(const lac_problem *problem)
{
    return problem->kind->unknowns + (problem->weak != NULL ? problem->weak->modes : 0);
}

size_t lac_problem_unknowns(const lac_problem *problem)
{
    return lac_problem_arrays(problem) * problem->n;
}

size_t lac_problem_first_cell(const lac_problem *problem, size_t cell)
{
    const double here = cell == SIZE_MAX ? INFINITY : (double)(problem->range.first + cell);
    const double first = lac_team_least(problem->range.team, here);
    return isinf(first) ? SIZE_MAX : (size_t)first;
}

size_t lac_problem_slip_place(const lac_problem *problem)
{
    return (problem->kind->unknowns - 2) * 2 * problem->n;
}

void lac_problem_initial(const lac_problem *problem, double *y)
{
    problem->kind->start(problem, y);
    memcpy(y + problem->n, problem->log_state0, problem->n * sizeof *y);
    for (size_t i = lac_weaken_place(problem); i < lac_problem_unknowns(problem); i++) {
        y[i] = 0.0;
    }
}

double lac_problem_next_break(const lac_problem *problem, double t)
{
    return lac_load_next_break(&problem->loads, t);
}

double lac_problem_longest_step(const lac_problem *problem, double t)
{
    return lac_load_longest_step(&problem->loads, t);
}

typedef struct share_field {
    const lac_problem *problem;
    const double *shares; // [n], then their rates
    double share, rate;   // of the first cell
} share_field;

// What cells have left of their pressures and its rates, by the forces that they carry.
static void add_shares(const void *context, size_t first, size_t end, double *sums)
{
    const share_field *f = context;
    const lac_problem *problem = f->problem;
    const double *shares = f->shares, *rates = shares + problem->n;
    for (size_t i = first; i < end; i++) {
        const double force = lac_problem_weight(problem, i) * problem->pressure[i];
        sums[0] += force * (shares[i] - f->share);
        sums[1] += force * (rates[i] - f->rate);
    }
}

// What each cell has left of its pressure; false where one has nothing left. Together they have
// the mean by the force that they carry, which is that of all where they are alike, to the bit.
static bool find_shares(const lac_problem *problem, double t, const lac_load_state *now,
                        double *shares, lac_problem_loads_at *drive)
{
    size_t n = problem->n;
    double mean = problem->mean_pressure;
    double *rates = shares + n;
    double off[2];
    bool good = true;
    lac_load_evaluate_cells(&problem->loads, t, now, shares, rates);
    drive->least = INFINITY;
    for (size_t i = 0; i < n; i++) {
        shares[i] = drive->normal - shares[i] / mean;
        rates[i] = -rates[i] / mean;
        drive->least = fmin(drive->least, shares[i]);
        good = good && shares[i] > 0.0 && isfinite(shares[i]) && isfinite(rates[i]);
    }
    drive->least = lac_team_least(problem->range.team, drive->least);
    good = lac_problem_agree(problem, good);
    const share_field field = {problem, shares, lac_problem_first(problem, shares),
                               lac_problem_first(problem, rates)};
    lac_range_sums(&problem->range, 2, add_shares, &field, off);
    drive->share = field.share + off[0] / problem->sum_pressure;
    drive->share_rate = field.rate + off[1] / problem->sum_pressure;
    drive->shares = shares;
    drive->share_rates = rates;
    return good;
}

bool lac_problem_drive_into(const lac_problem *problem, double t, lac_gone gone, double *shares,
                            lac_problem_loads_at *drive)
{
    if (problem->still) {
        *drive = problem->drive0;
        return true;
    }
    const lac_load_state *start = &problem->at_start;
    double mean = problem->mean_pressure;
    lac_load_state now;
    lac_load_evaluate(&problem->loads, t, &now);

    drive->ratio = (now.ratio - start->ratio) + (now.stress - start->stress) / mean;
    drive->ratio_rate = now.ratio_rate + now.stress_rate / mean;
    drive->spring = problem->spring_share * (now.spring_stress - start->spring_stress);
    drive->spring_rate = problem->spring_share * now.spring_rate;
    drive->spring_stiffness = problem->spring_share * now.spring_stiffness;
    drive->far.back = now.back_slip - start->back_slip;
    drive->far_rate.back = now.back_rate;
    drive->far.elastic = problem->spring_share * (now.elastic - start->elastic);
    drive->far_rate.elastic = problem->spring_share * now.elastic_rate;
    drive->normal = 1.0;
    drive->ratio_slope = drive->share_slope = drive->share_by_rate = 0.0;
    if (problem->loads.geometry != NULL) {
        lac_problem_bend(problem, gone, &now, drive);
    }
    drive->share = drive->normal - lac_load_taken(&now) / mean;
    drive->share_rate = -(now.pore_rate - now.normal_rate) / mean;
    drive->least = drive->share;
    drive->shares = drive->share_rates = NULL;
    if (problem->varies) {
        return find_shares(problem, t, &now, shares, drive) && isfinite(drive->ratio);
    }
    return drive->share > 0.0 && isfinite(drive->share) && isfinite(drive->ratio);
}

bool lac_problem_drive(const lac_problem *problem, double t, const double *y, double *work,
                       lac_problem_loads_at *drive)
{
    const lac_gone gone = lac_problem_gone_in(problem, y, 0.0);
    return lac_problem_drive_into(problem, t, gone, lac_problem_split(problem, work).shares, drive);
}

lac_status lac_problem_lifted(const lac_problem *problem, double t, const double *y, double near,
                              double *work, lac_error *err)
{
    lac_problem_loads_at at;
    double normal = problem->mean_pressure;
    bool good = lac_problem_drive(problem, t, y, work, &at);
    if (good && at.least > near) {
        return LAC_OK;
    }
    size_t i = 0;
    while (at.shares != NULL && i < problem->n && at.shares[i] > near) {
        i++;
    }
    const size_t here = at.shares != NULL && i < problem->n ? i : SIZE_MAX;
    const size_t first = lac_problem_first_cell(problem, here);
    if (first != SIZE_MAX) {
        const bool blamed = here != SIZE_MAX && first == problem->range.first + here;
        const lac_status status =
            blamed ? lac_load_blame_cell(&problem->loads, i, normal * (at.normal - at.shares[i]),
                                         normal * at.normal, t, LAC_ENUMERIC, err)
                   : LAC_OK;
        return lac_team_agree(problem->range.team, status, err);
    }
    LAC_FAIL_IF(problem->at_start.lake.unit_weight > 0.0, err, LAC_ENUMERIC,
                "the lake at the toe and the pore pressure lift the mass at t = %g s", t);
    return lac_fail(
        err, LAC_ENUMERIC, "the pore pressure%s reaches the normal pressure at t = %g s",
        lac_load_set_presses(&problem->loads) ? " less the added normal stress" : "", t);
}

void lac_problem_pore(const lac_problem *problem, double t, double *pore, double *work)
{
    lac_load_state now;
    lac_load_evaluate(&problem->loads, t, &now);
    for (size_t i = 0; i < problem->n; i++) {
        pore[i] = now.pore;
    }
    if (problem->varies) {
        double *rates = lac_problem_split(problem, work).shares;
        lac_load_evaluate_pore(&problem->loads, t, &now, pore, rates);
    }
}

lac_problem_parts lac_problem_parts_of(const lac_problem *problem)
{
    return (lac_problem_parts){.pressure = problem->pressure,
                               .traction = problem->traction0,
                               .weight = problem->weight,
                               .log_rate = problem->log_rate0,
                               .log_state = problem->log_state0,
                               .friction = problem->friction,
                               .transfer = &problem->transfer,
                               .damping = {.cell = problem->damping,
                                           .mean = problem->mean_damping,
                                           .shared = problem->drag},
                               .linear = !problem->loads.bends};
}
