// SPDX-License-Identifier: GPL-3.0-or-later
// What a case will cost in time, memory and disk, from constants that were measured on one core;
// and what holds of it before it is run: how its cells hold one another, what the loads come to at
// the start and what counts as failure.
#include "scene/estimate.h"

#include "base/range.h"
#include "scene/internal.h"

// Of the program with its libraries: memory and time. Of a contact cell: memory while it is
// integrated, time of a step.
static const double base_bytes = 24e6, base_seconds = 0.02, contact_cell_bytes = 550,
                    cell_step_seconds = 0.2e-6;
static const double massive_factor = 3; // on the last where a block has mass

// Of a grid cell: memory while the contact is solved, of which `contact` keeps some more; time of
// that; of the calibration of one level's elastic stiffness on a small grid, and of all levels
// where the grid is larger; of a static history what it adds to the memory, and the time of a step.
static const struct {
    double bytes, kept_bytes, seconds, level_seconds, large_seconds, history_bytes, history_seconds;
} costs[] = {[LAC_PERIODIC] = {45, 20, 2e-6, 1e-6, 0.35e-6, 190, 2.5e-6},
             [LAC_FREE] = {45, 20, 4e-6, 3e-6, 1.4e-6, 460, 11e-6}};
static const double one_by_one_cells = 4096;

// Of a grid cell where no surface is pressed. Of ranks: what a free contact takes more; of a cell
// of a surface, and of a contact cell, what each has of all, and who writes, also of parts; MPI.
static const double domain_bytes = 13, unfolded_bytes[] = {[LAC_FREE] = 4}, whole_source_bytes = 24,
                    whole_cell_bytes = 130, write_bytes = 16, part_bytes = 56, mpi_bytes = 20e6;

// Of a grid cell: the transforms of the elastic rock while they are made, which ranks share.
static const double rock_bytes[] = {[LAC_PERIODIC] = 24, [LAC_FREE] = 110};

// Cells of a grid whose contact is counted or estimated on it: a check takes at most 2 GB.
static const size_t most_counted = (size_t)1 << 26;

// Of a step of the elastic transfer, for each cell of the grid: where K is a filter, and where gaps
// make it an iteration; four times that where transforms are of twice the sides.
static const double filter_seconds = 0.1e-6, iteration_seconds = 0.6e-6;

// Of the cascade: a contact along its path, for each cell of the grid; the blocks of one place and
// one beta, for each contact cell. Contact cells where they are not known, as a part of the grid.
static const double path_seconds = 0.4e-6, place_seconds = 3.5e-6, some_contact = 0.2;

// Contacts that a search for a dimension solves, as multiples of one solved afresh.
static const double search_least = 1.5, search_most = 6;

// Steps of a run at rtol = 1e-6 in which the cells move together, under loads that do not change:
// runs in cases/ took 11 to 490, and up to 23 a cell that fails alone. Time of an update of a cell
// with steps of its own.
enum { SMOOTH_STEPS = 500 };
static const double own_step_seconds = 2e-6;

// Of what is put out at stated times: bytes and time of a record, time of it and of a value of a
// field for each contact cell.
static const double record_bytes = 110, record_seconds = 2e-6, record_cell_seconds = 12e-9,
                    value_seconds = 20e-9;

// Grids beyond the cache take longer a cell: twice as long at 4096 x 4096, found so.
static double slowdown(const lac_estimate *e) { return fmax(1, pow(e->grid_cells / 1e6, 0.25)); }

// Of what takes so long for a cell of the grid.
static double over_grid(const lac_estimate *e, double seconds)
{
    return seconds * e->grid_cells * slowdown(e);
}

// Mean square slope to the next cell along one direction, round the edges where periodic.
static double mean_square_slope(const lac_grid *grid, const double *h, bool along_x)
{
    size_t n = along_x ? grid->nx : grid->ny, rows = lac_grid_cells(grid) / n;
    size_t step = along_x ? 1 : grid->nx, next_row = along_x ? grid->nx : 1;
    size_t pairs = grid->periodic ? n : n - 1;
    double sum = 0, side = along_x ? grid->dx : grid->dy;
    for (size_t j = 0; j < rows; j++) {
        for (size_t i = 0; i < pairs; i++) {
            const double *row = h + j * next_row;
            double slope = (row[(i + 1) % n * step] - row[i * step]) / side;
            sum += slope * slope;
        }
    }
    return pairs > 0 ? sum / ((double)pairs * (double)rows) : 0;
}

// A/A_nom = kappa p/(E* h') at light load, kappa = 2.2 by simulation: Hyun et al. (2004), doi
// 10.1103/PhysRevE.70.026117; taken to full contact by the error function, as Persson (2001).
// @param slope  h', rms
static double contact_fraction(const lac_case *c, double pressure, double slope)
{
    const double kappa = 2.2;
    double e_star = c->material.shear_modulus / (1 - c->material.poisson);
    return slope > 0 ? erf(0.5 * sqrt(M_PI) * kappa * pressure / (e_star * slope)) : 1;
}

static lac_status estimate_surface(const lac_case *c, lac_estimate *e, lac_error *err)
{
    lac_grid grid = e->grid;
    while (lac_grid_cells(&grid) > most_counted && grid.nx % 2 == 0 && grid.ny % 2 == 0) {
        grid = (lac_grid){grid.nx / 2, grid.ny / 2, 2 * grid.dx, 2 * grid.dy, grid.periodic};
    }
    double *heights = malloc(lac_grid_cells(&grid) * sizeof *heights);
    LAC_FAIL_MEMORY_IF(heights == NULL, err);
    lac_status status = lac_surface_generate(&c->surface, &grid, heights, NULL, err);
    if (status == LAC_OK) {
        double slope = sqrt(mean_square_slope(&grid, heights, true) +
                            mean_square_slope(&grid, heights, false));
        double fraction = contact_fraction(c, e->pressure, slope);
        e->contact_cells = isfinite(fraction) ? fmax(1, e->grid_cells * fraction) : (double)NAN;
    }
    free(heights);
    return lac_fail_within(err, status, "interface.surface");
}

static lac_status count_cells(const lac_case *c, lac_estimate *e, lac_error *err)
{
    if (c->surface.info != NULL) {
        return estimate_surface(c, e, err);
    }
    if (c->domain.info != NULL && e->grid_cells > (double)most_counted) {
        return LAC_OK; // all of them, at most
    }
    lac_domain *domain = NULL;
    lac_status status = c->domain.info != NULL ? lac_scene_domain_create(c, &domain, err) : LAC_OK;
    e->contact_cells = domain != NULL ? (double)domain->n : e->grid_cells;
    e->exact = true;
    lac_domain_free(domain);
    return status;
}

// `contact` follows the history of a static case.
static bool follows_history(const lac_case *c, const lac_estimate *e)
{
    return !e->integrated && c->history.count > 0;
}

// The table of a free surface beside a plane (transfer/compliance.c).
static double table_bytes(const lac_case *c)
{
    const lac_grid grid = lac_interface_grid(&c->interface);
    const double waves = (double)grid.nx + 1, rows = (double)grid.ny;
    lac_transfer_outline held = {0};
    (void)lac_transfer_outline_of(&c->transfer, &held);
    return held.surface && grid.ny > 1 ? 8 * waves * rows * rows : 0;
}

double lac_estimate_least_memory(const lac_case *c)
{
    const lac_grid grid = lac_interface_grid(&c->interface);
    return base_bytes + table_bytes(c) +
           (double)lac_grid_cells(&grid) *
               (c->surface.info != NULL ? costs[c->interface.boundary].bytes : domain_bytes);
}

static void count_memory(const lac_case *c, lac_estimate *e)
{
    int boundary = c->interface.boundary;
    double grid = costs[boundary].bytes + (e->integrated ? 0 : costs[boundary].kept_bytes);
    grid += follows_history(c, e) ? costs[boundary].history_bytes : 0;
    double integration = e->integrated ? 0.5 * e->unknowns * contact_cell_bytes * e->cells : 0;
    e->memory = base_bytes + table_bytes(c) + fmax(grid * e->grid_cells, integration);
}

// Of the rock: of the calibration, and of a transfer that is the rock itself.
static double rock_memory(const lac_case *c, const lac_estimate *e, double ranks)
{
    const lac_transfer_kind *kind = (const void *)c->transfer.info;
    lac_transfer_outline held;
    if (!lac_transfer_outline_of(&c->transfer, &held) || held.rock == NULL) {
        return 0;
    }
    const double bytes = rock_bytes[c->interface.boundary] * (kind->transforms ? 2 : 1);
    return bytes * e->grid_cells / (e->grid_cells < LAC_RANGE_ALONE ? 1 : ranks);
}

// Of the first of so many ranks: its rows of what is pressed, Love's kernel not folded; the heights
// of a source that does not share, and a domain, as a whole; of the cells what is whole.
static double rank_memory(const lac_case *c, const lac_estimate *e, double ranks)
{
    const lac_surface_source *source = (const void *)c->surface.info;
    double rows = costs[c->interface.boundary].bytes + unfolded_bytes[c->interface.boundary];
    double grid = rows / ranks + (source != NULL && !source->shared ? whole_source_bytes : 0);
    grid = source != NULL ? grid : domain_bytes;
    const double cell = 0.5 * e->unknowns * contact_cell_bytes;
    const double integration = (cell - whole_cell_bytes) / ranks * e->cells;
    const double made = fmax(rock_memory(c, e, ranks), integration) +
                        (whole_cell_bytes + write_bytes) * e->cells +
                        c->run.snapshots * part_bytes * fmin(e->cells, LAC_RANGE_PIECE);
    return base_bytes + mpi_bytes + table_bytes(c) + fmax(grid * e->grid_cells, made);
}

// As many as have a block of cells each, where ranks share the run at all (scene.c).
static void count_ranks(const lac_case *c, lac_estimate *e)
{
    const bool shared = e->integrated && e->choice.fidelity == LAC_FIDELITY_ODE &&
                        isnan(c->accuracy) && c->from.file == NULL;
    const lac_range all = lac_range_whole((size_t)e->cells);
    e->ranks = shared ? (double)lac_range_blocks(&all) : 1;
    e->memory_rank = e->ranks > 1 ? rank_memory(c, e, ceil(e->ranks / 4)) : e->memory;
}

static void count_steps(const lac_case *c, lac_estimate *e)
{
    const lac_load_models loads = lac_case_loads(c);
    if (!e->integrated) {
        return;
    }
    e->changing = !lac_load_models_traits(&loads).constant;
    e->steps_least = e->own_steps ? LAC_OWN_FEWEST * e->cells : LAC_FEWEST_STEPS;
    e->steps_most = SMOOTH_STEPS * fmax(1, pow(1e-6 / c->run.rtol, 0.2));
    e->steps_most += e->stable ? 0 : LAC_STEPS_PER_FAILURE * e->cells;
    // Cells that are held together, or next to not at all, take hundreds of thousands each.
    const bool seen = e->stiffness_ratio > 0.002 && e->stiffness_ratio < 20.0;
    e->steps_most = e->changing || (e->own_steps && !seen) ? (double)NAN
                    : e->own_steps                         ? LAC_OWN_STEPS * e->cells
                                                           : e->steps_most;
}

static double contact_seconds(const lac_case *c, const lac_estimate *e)
{
    double scaling = e->integrated ? 1 : 4.0 / 3; // `contact` solves coarser grids too
    double finest = c->surface.info != NULL ? costs[c->interface.boundary].seconds : 0;
    return finest * e->grid_cells * scaling * slowdown(e);
}

// Where the joint would slip first takes about as long as a step.
static double history_seconds(const lac_case *c, const lac_estimate *e)
{
    double steps = follows_history(c, e) ? 1 + (double)lac_scene_history_steps(c) : 0;
    return over_grid(e, costs[c->interface.boundary].history_seconds * steps);
}

static double calibration_seconds(const lac_case *c, const lac_transfer_outline *held,
                                  const lac_estimate *e)
{
    size_t side = e->grid.nx > e->grid.ny ? e->grid.nx : e->grid.ny;
    if (!e->integrated || held->rock == NULL) {
        return 0;
    }
    double levels = ceil(log2((double)side));
    double small =
        costs[c->interface.boundary].level_seconds * levels * fmin(e->grid_cells, one_by_one_cells);
    bool large = e->grid_cells > one_by_one_cells;
    return small + (large ? over_grid(e, costs[c->interface.boundary].large_seconds) : 0);
}

// What a transfer by transforms adds to a step.
static double elastic_seconds(const lac_case *c, const lac_transfer_outline *held,
                              const lac_estimate *e)
{
    const lac_transfer_kind *kind = (const void *)c->transfer.info;
    if (kind == NULL || !kind->transforms) {
        return 0;
    }
    bool alone = c->interface.boundary == LAC_FREE;
    bool filter = e->contact_cells == e->grid_cells && (!alone || held->anchored);
    return over_grid(e, (filter ? filter_seconds : iteration_seconds) * (alone ? 4 : 1));
}

// The cascade that a run follows is that of its own interface, once.
static bool follows_cascade(const lac_case *c)
{
    bool does = false;
    for (size_t i = 0; i < c->analysis.count; i++) {
        const lac_analysis_rg *rg = lac_analysis_cascade(&c->analysis.item[i]);
        does = does || (rg != NULL && isnan(rg->critical_fraction));
    }
    return does;
}

// Of `seeds` interfaces with their blocks at `places` places, for `betas` residual strengths.
static double cascade_seconds(const lac_case *c, const lac_estimate *e)
{
    const bool followed = e->integrated && follows_cascade(c);
    if (!followed && (e->integrated || !c->rg.named)) {
        return NAN;
    }
    const bool elastic = c->rg.field == LAC_RG_ELASTIC;
    const double seeds = followed ? 1 : (double)c->rg.seeds;
    const double places = (double)c->rg.shifts;
    const double betas = !followed && c->rg.betas > 0 ? (double)c->rg.betas : 1;
    double cells = isnan(e->contact_cells) ? some_contact * e->grid_cells : e->contact_cells;
    double path = elastic ? path_seconds * (double)c->rg.contacts * e->grid_cells : 0;
    return (followed ? 0 : contact_seconds(c, e) * seeds) +
           seeds * (path + place_seconds * places * betas * cells) * slowdown(e);
}

static void count_time(const lac_case *c, lac_estimate *e)
{
    const lac_normal_load *normal = (const lac_normal_load *)c->normal.info;
    const bool search = normal != NULL && normal->dimension != NULL;
    const double contact = contact_seconds(c, e),
                 massive = lac_inertia_mass(c) > 0 ? massive_factor : 1;
    lac_transfer_outline held;
    (void)lac_transfer_outline_of(&c->transfer, &held);
    double once = base_seconds + history_seconds(c, e) + calibration_seconds(c, &held, e);
    double step = e->own_steps
                      ? own_step_seconds
                      : cell_step_seconds * massive * e->cells + elastic_seconds(c, &held, e);
    e->cascade_time = cascade_seconds(c, e);
    once += e->integrated && !isnan(e->cascade_time) ? e->cascade_time : 0;
    e->cpu_time_least = contact * (search ? search_least : 1) + once + step * e->steps_least;
    e->cpu_time_most = contact * (search ? search_most : 1) + once + step * e->steps_most;
}

static double count_times(double end, double every) { return every > 0 ? floor(end / every) : 0; }

// What is put out at stated times, as if the run went on to its end.
static void count_output(const lac_case *c, lac_estimate *e)
{
    if (!e->integrated) {
        return;
    }
    double fields = 0, snapshots = count_times(c->run.end, c->run.snapshot.time);
    for (unsigned f = c->fields; f != 0; f >>= 1) {
        fields += f & 1;
    }
    e->records = count_times(c->run.end, c->run.record.time);
    e->file_bytes = record_bytes * e->records + 8 * fields * e->cells * snapshots;
    e->cpu_time_most += e->records * (record_seconds + record_cell_seconds * e->cells) +
                        value_seconds * fields * e->cells * snapshots;
}

// Of either fidelity, the one that the case has last.
static void count_costs(const lac_case *c, lac_estimate *e)
{
    const bool own = e->own_steps;
    for (int turn = 0; turn < 2; turn++) {
        e->own_steps = (turn == 1) == own;
        count_steps(c, e);
        count_time(c, e);
        count_output(c, e);
        e->cost[e->own_steps] = (lac_fidelity_cost){e->cpu_time_least, e->cpu_time_most};
    }
}

// A cell is taken not to fail alone where its neighbours hold it so many times k_crit (where a, b
// or dc are spread, the second): gaps and pressures leave some much less than G/cell.
static const double safe_ratio = 30, safe_spread_ratio = 300;

// A scene of up to this many grid cells is built whole: quick, and the surest check.
static const double small_grid = 4096;

// k_0/k_crit, k_0 of the finest level, and from which width on a patch slips by itself: the rock's
// stiffness falls by half as the width doubles.
static void compare_stiffness(const lac_case *c, lac_estimate *e)
{
    lac_transfer_outline outline;
    (void)lac_transfer_outline_of(&c->transfer, &outline);
    const double k0 = outline.rock != NULL ? c->material.shear_modulus / e->grid.dx : outline.k0;
    const double finer = isnan(outline.ratio) ? 2.0 : 1.0 / outline.ratio;
    e->stiffness_ratio = k0 / e->critical;
    e->patch = e->stiffness_ratio <= 1.0 ? e->grid.dx
               : finer <= 1.0            ? INFINITY
                                         : e->grid.dx * exp2(log(e->stiffness_ratio) / log(finer));
}

void lac_estimate_stability(const lac_case *c, lac_estimate *e)
{
    static const char *const holding[] = {"a", "b", "dc", NULL};
    const lac_friction_params *law = c->friction.params;
    const bool several = !(e->contact_cells <= 1);
    e->integrated = law != NULL && !isnan(c->run.end);
    e->stable = true;
    e->critical = e->patch = e->stiffness_ratio = NAN;
    if (!e->integrated) {
        return;
    }
    double real_pressure = e->pressure * e->grid_cells / e->contact_cells;
    e->critical = real_pressure * (law->b - law->a) / law->dc;
    if (e->critical > 0 && several) {
        compare_stiffness(c, e);
    }
    double safe = lac_case_spreads(c, holding) ? safe_spread_ratio : safe_ratio;
    e->stable = !several || !(e->stiffness_ratio < safe);
}

// What counts as failure of a joint whose cells are not known: of one that slips evenly, by the
// case's own values.
static lac_failure failure_about(const lac_case *c, const lac_load_state *start,
                                 const lac_estimate *e)
{
    const lac_friction_params *law = c->friction.params;
    const double force = e->pressure - lac_load_taken(start);
    lac_transfer_outline outline;
    (void)lac_transfer_outline_of(&c->transfer, &outline);
    const lac_failure_start at = {.rate = c->initial.slip_rate,
                                  .direct = law->a * force,
                                  .excess = (law->b - law->a) * force,
                                  .eta = lac_inertia_mass(c) > 0.0 ? 0.0
                                                                   : lac_damping_of(&c->material),
                                  .held = start->spring_stiffness > 0.0 || outline.anchored,
                                  .length = e->length};
    return lac_failure_from(&at, c->run.failure_rate, c->run.failure_slip);
}

// Takes the least that is taken off at the grid's corners, which stand for the cells where loads
// differ between them; an error where such a load does not cover them.
static lac_status add_corners(const lac_grid *grid, lac_load_set *loads, lac_load_state *sum,
                              lac_error *err)
{
    const uint32_t last = (uint32_t)(lac_grid_cells(grid) - 1);
    const uint32_t row = (uint32_t)(grid->nx - 1);
    const uint32_t corners[] = {0, row, last - row, last};
    const lac_load_places places = {grid, corners, 4};
    double value[4], rate[4];
    if (!loads->varies) {
        return LAC_OK;
    }
    LAC_TRY_RETURN(lac_load_set_place(loads, &places, err));
    lac_load_evaluate_cells(loads, 0.0, sum, value, rate);
    sum->pore = sum->normal + fmin(fmin(value[0], value[1]), fmin(value[2], value[3]));
    return LAC_OK;
}

// What the loads come to at the start of a run whose scene is too large to be built.
static lac_status try_start(const lac_case *c, lac_load_files *files, lac_estimate *e,
                            lac_error *err)
{
    const bool by_load = lac_scene_load_given(c);
    lac_load_set loads;
    lac_load_state sum;
    LAC_TRY_RETURN(lac_scene_loads_create(c, files, &loads, err));
    lac_load_evaluate(&loads, 0.0, &sum);
    lac_status status = add_corners(&e->grid, &loads, &sum, err);
    lac_load_set_clear(&loads);
    LAC_TRY_RETURN(status);
    LAC_FAIL_IF(!(lac_load_taken(&sum) < e->pressure), err, LAC_EINPUT,
                "initial: pore pressure %g Pa is not below the normal pressure %g Pa at the start",
                sum.pore, e->pressure + sum.normal);
    LAC_FAIL_IF(by_load && !(lac_load_shear(&sum, e->pressure) > 0.0), err, LAC_EINPUT,
                "load.shear: comes to %g Pa at the start; must be > 0",
                lac_load_shear(&sum, e->pressure));
    if (!isnan(c->initial.slip_rate)) {
        e->failure = failure_about(c, &sum, e);
    }
    return LAC_OK;
}

// Sees whether the scene can be made, and what counts as its failure.
static lac_status try_scene(const lac_case *c, lac_load_files *files, lac_estimate *e,
                            lac_error *err)
{
    lac_scene_contact contact = {0};
    lac_scene *scene = NULL;
    lac_status status;
    if (e->grid_cells > small_grid) {
        return e->integrated ? try_start(c, files, e, err) : LAC_OK;
    }
    if (!e->integrated) {
        status = lac_scene_contact_solve(c, LAC_SCENE_DOMAIN, &contact, err);
        lac_scene_contact_clear(&contact);
        return status;
    }
    status = lac_scene_create(c, files, &scene, err);
    if (status == LAC_OK) {
        status = lac_run_check(lac_scene_problem(scene), &c->run, err);
        e->failure = lac_problem_failure(scene->problem, c->run.failure_rate, c->run.failure_slip);
    }
    lac_scene_free(scene);
    return status;
}

lac_status lac_estimate_make(const lac_case *c, lac_load_files *files, lac_estimate *e,
                             lac_error *err)
{
    const lac_grid grid = lac_interface_grid(&c->interface);
    lac_case settled = *c;
    *e = (lac_estimate){.grid = grid,
                        .pressure = lac_case_pressure(c),
                        .grid_cells = (double)lac_grid_cells(&grid),
                        .contact_cells = NAN,
                        .length = fmax((double)grid.nx * grid.dx, (double)grid.ny * grid.dy),
                        .choice = {.fidelity = c->run.fidelity},
                        .unknowns = lac_inertia_mass(c) > 0 ? 3 : 2};
    char why[LAC_FIDELITY_ROOM];
    lac_weakening_set weakening;
    LAC_TRY_RETURN(
        lac_weakening_set_create(c->weakening.item, c->weakening.count, &weakening, err));
    e->unknowns += (double)weakening.modes;
    LAC_TRY_RETURN(count_cells(c, e, err));
    e->cells = isnan(e->contact_cells) ? e->grid_cells : e->contact_cells;
    lac_estimate_stability(c, e);
    count_memory(c, e);
    settled.use = NULL; // no more than a look: what it points to stays the case's
    if (e->integrated) {
        e->choice = lac_fidelity_choose(c, e);
        settled.run.fidelity = e->choice.fidelity;
    }
    count_ranks(c, e);
    e->own_steps = e->integrated && settled.run.fidelity == LAC_FIDELITY_ASYNC;
    if (e->own_steps && lac_fidelity_refused(c, why)) { // of a large grid no scene is made
        return lac_fail(err, LAC_EINPUT, "%s", why);
    }
    settled.formulation = e->own_steps ? LAC_FORMULATION_RATE : c->formulation;
    e->faster = e->integrated ? lac_fidelity_faster(c, e) : NULL;
    count_costs(c, e);
    return try_scene(&settled, files, e, err);
}
