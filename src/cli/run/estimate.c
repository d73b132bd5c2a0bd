// SPDX-License-Identifier: GPL-3.0-or-later
// What a case will cost in time, memory and disk, from constants that were measured on one core.
#include "cli/run/estimate.h"

#include <math.h>
#include <stdlib.h>

#include "cli/common/failure.h"
#include "cli/common/words.h"
#include "cli/run/advice.h"
#include "contact/contact.h"
#include "friction/friction.h"
#include "load/load.h"
#include "scene/scene.h"
#include "surface/surface.h"
#include "transfer/transfer.h"

// Measured on one core: memory of the program with its libraries, of a contact cell while it is
// integrated; time of a step of a contact cell.
static const double base_bytes = 24e6, base_seconds = 0.02, contact_cell_bytes = 550,
                    cell_step_seconds = 0.2e-6;
static const double massive_factor = 3; // on the last where a block has mass

// Of a grid cell: memory while the contact is solved, of which `contact` keeps some more; time of
// that, and of the calibration of one level's elastic stiffness.
static const struct {
    double bytes, kept_bytes, seconds, level_seconds;
} grid_costs[] = {[LAC_PERIODIC] = {55, 20, 2e-6, 1e-6}, [LAC_FREE] = {75, 20, 4e-6, 3e-6}};

// The same of a static history: what it adds while it is followed, and the time of a step.
static const struct {
    double bytes, step_seconds;
} history_costs[] = {[LAC_PERIODIC] = {190, 2.5e-6}, [LAC_FREE] = {460, 11e-6}};

// Of a step of the elastic transfer, for each cell of the grid: where K is a filter, and where gaps
// make it an iteration; four times that where transforms are of twice the sides.
static const double filter_seconds = 0.1e-6, iteration_seconds = 0.6e-6;

// Grids beyond the cache take longer a cell: twice as long at 4096 x 4096, found so.
static double slowdown(double grid_cells) { return fmax(1, pow(grid_cells / 1e6, 0.25)); }

// Of the cascade: a contact along its path, for each cell of the grid; the blocks of one place and
// one beta, for each contact cell. Contact cells where they are not known, as a part of the grid.
static const double path_seconds = 0.4e-6, place_seconds = 3.5e-6, some_contact = 0.2;

// Contacts that a search for a dimension solves, as multiples of one solved afresh.
static const double search_least = 1.5, search_most = 6;

// Steps of a run at rtol = 1e-6 in which the cells move together, under loads that do not change,
// and of one cell that fails alone (docs/theory/creep.md); runs in cases/ took 11 to 490, and up to
// 23 a cell. A cell is taken not to fail alone where its neighbours hold it so many times k_crit
// (where a, b or dc are spread, the second): gaps and pressures leave some much less than G/cell.
enum { FEWEST_STEPS = 10, SMOOTH_STEPS = 500, STEPS_PER_FAILURE = 80 };
static const double safe_ratio = 30, safe_spread_ratio = 300;

// Updates of a cell with steps of its own, as long as none slips and on the way to failure
// (docs/theory/fidelity-events.md).
enum { OWN_FEWEST = 30, OWN_STEPS = 1000 };
static const double own_step_seconds = 2e-6;

// Of what is put out at stated times: bytes and time of a record, time of it and of a value of a
// field for each contact cell.
static const double record_bytes = 110, record_seconds = 2e-6, record_cell_seconds = 12e-9,
                    value_seconds = 20e-9;

static double mean_pressure(const lac_case *c)
{
    const lac_normal_load *normal = (const lac_normal_load *)c->normal.about;
    return normal->pressure(c->normal.params, c->material.density);
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

static double rms_slope(const lac_grid *grid, const double *h)
{
    return sqrt(mean_square_slope(grid, h, true) + mean_square_slope(grid, h, false));
}

// A/A_nom = kappa p/(E* h') at light load, kappa = 2.2 by simulation: Hyun et al. (2004), doi
// 10.1103/PhysRevE.70.026117; taken to full contact by the error function, as Persson (2001).
static double contact_fraction(const lac_case *c, double slope)
{
    const double kappa = 2.2, pi = 3.141592653589793;
    double e_star = c->material.shear_modulus / (1 - c->material.poisson);
    return slope > 0 ? erf(0.5 * sqrt(pi) * kappa * mean_pressure(c) / (e_star * slope)) : 1;
}

static lac_status estimate_surface(const lac_case *c, const lac_grid *grid, cli_estimate *e,
                                   lac_error *err)
{
    double *heights = malloc(lac_grid_cells(grid) * sizeof *heights);
    if (heights == NULL) {
        return lac_fail_memory(err);
    }
    lac_status status = lac_surface_generate(&c->surface, grid, heights, err);
    double fraction =
        status == LAC_OK ? contact_fraction(c, rms_slope(grid, heights)) : (double)NAN;
    if (isfinite(fraction)) {
        e->contact_cells = fmax(1, e->grid_cells * fraction);
    }
    free(heights);
    return status == LAC_OK ? LAC_OK : lac_fail_within(err, status, "interface.surface");
}

static lac_status count_domain(const lac_case *c, cli_estimate *e, lac_error *err)
{
    lac_domain *domain = NULL;
    lac_status status = lac_scene_domain_create(c, &domain, err);
    if (status == LAC_OK) {
        e->contact_cells = (double)domain->n;
        e->exact = true;
    }
    lac_domain_free(domain);
    return status;
}

// Whether the stiffness of cells is that of the rock.
static bool rock_holds(const lac_case *c)
{
    lac_transfer_outline outline;
    return lac_transfer_outline_of(&c->transfer, &outline) && outline.rock != NULL;
}

// What a transfer by transforms adds to a step.
static double elastic_seconds(const lac_case *c, const cli_estimate *e)
{
    const lac_transfer_kind *kind = (const void *)c->transfer.about;
    lac_transfer_outline outline;
    if (!lac_transfer_outline_of(&c->transfer, &outline) || !kind->transforms) {
        return 0;
    }
    bool alone = c->interface.boundary == LAC_FREE;
    bool filter = e->contact_cells == e->grid_cells && (!alone || outline.anchored);
    return (filter ? filter_seconds : iteration_seconds) * (alone ? 4 : 1) * e->grid_cells *
           slowdown(e->grid_cells);
}

// `contact` follows the history of a static case.
static bool follows_history(const lac_case *c, const cli_estimate *e)
{
    return !e->integrated && c->history.count > 0;
}

// Where the joint would slip first takes about as long as a step.
static double history_seconds(const lac_case *c, const cli_estimate *e)
{
    double steps = follows_history(c, e) ? 1 + (double)lac_scene_history_steps(c) : 0;
    return history_costs[c->interface.boundary].step_seconds * steps * e->grid_cells *
           slowdown(e->grid_cells);
}

static void count_memory(const lac_case *c, double cells, cli_estimate *e)
{
    int boundary = c->interface.boundary;
    double grid =
        grid_costs[boundary].bytes + (e->integrated ? 0 : grid_costs[boundary].kept_bytes);
    grid += follows_history(c, e) ? history_costs[boundary].bytes : 0;
    double integration = e->integrated ? 0.5 * e->unknowns * contact_cell_bytes * cells : 0;
    e->memory = base_bytes + fmax(grid * e->grid_cells, integration);
}

static double contact_seconds(const lac_case *c, const cli_estimate *e)
{
    double scaling = e->integrated ? 1 : 4.0 / 3; // `contact` solves coarser grids too
    return grid_costs[c->interface.boundary].seconds * e->grid_cells * scaling *
           slowdown(e->grid_cells);
}

static double calibration_seconds(const lac_case *c, const lac_grid *grid, const cli_estimate *e)
{
    if (!e->integrated || !rock_holds(c)) {
        return 0;
    }
    double levels = ceil(log2((double)(grid->nx > grid->ny ? grid->nx : grid->ny)));
    return grid_costs[c->interface.boundary].level_seconds * levels * e->grid_cells *
           slowdown(e->grid_cells);
}

static double finest_stiffness(const lac_case *c, const lac_grid *grid)
{
    lac_transfer_outline outline;
    if (!lac_transfer_outline_of(&c->transfer, &outline)) {
        return 0;
    }
    return outline.rock != NULL ? c->material.shear_modulus / grid->dx : outline.k0;
}

// Whether the friction of cells differs in what decides how they hold.
static bool spread_stability(const lac_case *c)
{
    return lac_spread_has(&c->friction_spread, "a") || lac_spread_has(&c->friction_spread, "b") ||
           lac_spread_has(&c->friction_spread, "dc");
}

// A cell whose neighbours hold it less than k_crit = p (b - a)/dc fails on its own.
static void judge_stability(const lac_case *c, const lac_grid *grid, cli_estimate *e)
{
    const lac_friction_params *law = c->friction.params;
    e->integrated = law != NULL && !isnan(c->run.end);
    e->stable = true;
    if (!e->integrated) {
        return;
    }
    double real_pressure = mean_pressure(c) * e->grid_cells / e->contact_cells;
    double k_crit = real_pressure * (law->b - law->a) / law->dc;
    e->critical = k_crit;
    bool several = !(e->contact_cells <= 1);
    double safe = spread_stability(c) ? safe_spread_ratio : safe_ratio;
    if (k_crit > 0 && several) {
        e->stiffness_ratio = finest_stiffness(c, grid) / k_crit;
    }
    e->stable = !several || !(e->stiffness_ratio < safe);
}

static void count_steps(const lac_case *c, double cells, cli_estimate *e)
{
    if (!e->integrated) {
        return;
    }
    const lac_load_slots loads = {c->shear.item, c->shear.count, c->pore.item, c->pore.count};
    e->changing = !lac_load_slots_constant(&loads);
    e->steps_least = FEWEST_STEPS;
    e->steps_most = SMOOTH_STEPS * fmax(1, pow(1e-6 / c->run.rtol, 0.2));
    e->steps_most += e->stable ? 0 : STEPS_PER_FAILURE * cells;
    e->steps_most = e->changing ? (double)NAN : e->steps_most;
}

// Of `seeds` interfaces with their blocks at `places` places, for `betas` residual strengths.
static double cascade_of(const lac_case *c, bool elastic, double seeds, double places, double betas,
                         const cli_estimate *e)
{
    double cells = isnan(e->contact_cells) ? some_contact * e->grid_cells : e->contact_cells;
    double path = elastic ? path_seconds * (double)c->rg.contacts * e->grid_cells : 0;
    return seeds * (path + place_seconds * places * betas * cells) * slowdown(e->grid_cells);
}

// The cascade that a run follows is that of its own interface, once.
static const lac_analysis_rg *followed_cascade(const lac_case *c)
{
    for (size_t i = 0; i < c->analysis.count; i++) {
        const lac_analysis_rg *rg = lac_analysis_cascade(&c->analysis.item[i]);
        if (rg != NULL && isnan(rg->critical_fraction)) {
            return rg;
        }
    }
    return NULL;
}

static double cascade_seconds(const lac_case *c, const cli_estimate *e)
{
    const lac_analysis_rg *rg = followed_cascade(c);
    if (e->integrated && rg != NULL) {
        return cascade_of(c, rg->field == LAC_RG_ELASTIC, 1, (double)rg->shifts, 1, e);
    }
    if (e->integrated || !c->rg.named) {
        return NAN;
    }
    double betas = c->rg.betas > 0 ? (double)c->rg.betas : 1, seeds = (double)c->rg.seeds;
    double press = c->surface.about != NULL ? contact_seconds(c, e) * seeds : 0;
    return press +
           cascade_of(c, c->rg.field == LAC_RG_ELASTIC, seeds, (double)c->rg.shifts, betas, e);
}

static void count_time(const lac_case *c, const lac_grid *grid, double cells, cli_estimate *e)
{
    const lac_normal_load *normal = (const lac_normal_load *)c->normal.about;
    bool search = normal->dimension != NULL;
    double contact = c->surface.about != NULL ? contact_seconds(c, e) : 0;
    double once = base_seconds + history_seconds(c, e) + calibration_seconds(c, grid, e);
    double massive = e->unknowns > 2 ? massive_factor : 1;
    double step = e->own_steps ? own_step_seconds
                               : cell_step_seconds * massive * cells + elastic_seconds(c, e);
    e->cascade_time = cascade_seconds(c, e);
    once += e->integrated && !isnan(e->cascade_time) ? e->cascade_time : 0;
    e->cpu_time_least = contact * (search ? search_least : 1) + once + step * e->steps_least;
    e->cpu_time_most = contact * (search ? search_most : 1) + once + step * e->steps_most;
}

static double count_times(double end, double every) { return every > 0 ? floor(end / every) : 0; }

// What is put out at stated times, as if the run went on to its end.
static void count_output(const lac_case *c, double cells, cli_estimate *e)
{
    if (!e->integrated) {
        return;
    }
    double fields = 0, snapshots = count_times(c->run.end, c->run.snapshot.time);
    for (unsigned f = c->fields; f != 0; f >>= 1) {
        fields += f & 1;
    }
    e->records = count_times(c->run.end, c->run.record.time);
    e->file_bytes = record_bytes * e->records + 8 * fields * cells * snapshots;
    e->cpu_time_most += e->records * (record_seconds + record_cell_seconds * cells) +
                        value_seconds * fields * cells * snapshots;
}

static void count_own_steps(const lac_case *c, double cells, cli_estimate *e)
{
    e->own_steps = e->integrated && c->run.fidelity == LAC_FIDELITY_EVENTS;
    if (e->own_steps) {
        e->steps_least = OWN_FEWEST * cells;
        e->steps_most = e->changing ? NAN : OWN_STEPS * cells;
    }
}

lac_status cli_estimate_make(const lac_case *c, cli_estimate *e, lac_error *err)
{
    lac_grid grid = lac_interface_grid(&c->interface);
    lac_status status = LAC_OK;
    *e = (cli_estimate){.grid_cells = (double)lac_grid_cells(&grid),
                        .contact_cells = NAN,
                        .critical = NAN,
                        .stiffness_ratio = NAN};
    if (c->surface.about != NULL) {
        status = estimate_surface(c, &grid, e, err);
    } else if (c->domain.about != NULL) {
        status = count_domain(c, e, err);
    } else {
        e->contact_cells = e->grid_cells;
        e->exact = true;
    }
    e->unknowns = lac_inertia_mass(c) > 0 ? 3 : 2;
    double cells = isnan(e->contact_cells) ? e->grid_cells : e->contact_cells;
    judge_stability(c, &grid, e);
    count_memory(c, cells, e);
    count_steps(c, cells, e);
    count_own_steps(c, cells, e);
    e->faster = e->integrated ? cli_faster_fidelity(c, cells, e) : NULL;
    count_time(c, &grid, cells, e);
    count_output(c, cells, e);
    return status;
}

static double rounded(double x, int digits)
{
    double unit = pow(10, floor(log10(x)) - digits + 1);
    return x > 0 ? round(x / unit) * unit : x;
}

static const char *steps_class(const cli_estimate *e)
{
    return e->own_steps  ? "own"
           : e->changing ? "not estimated"
           : e->stable   ? "hundreds"
                         : "per cell";
}

// One figure where the two are near each other.
static void print_time(const cli_estimate *e)
{
    double least = rounded(e->cpu_time_least, 1), most = rounded(e->cpu_time_most, 1);
    if (isnan(most)) {
        printf("#   time            at least %.10g s on one core\n", least);
    } else if (most < 2.5 * least) {
        printf("#   time            about %.10g s on one core\n", most);
    } else {
        printf("#   time            %.10g to %.10g s on one core\n", least, most);
    }
    if (!isnan(e->cascade_time)) {
        printf("#   cascade         about %.10g s%s\n", rounded(e->cascade_time, 1),
               e->integrated ? " of it" : " (lacuna rg)");
    }
}

void cli_estimate_print(const cli_estimate *e)
{
    puts(e->own_steps    ? "\n# What it will cost with each cell at its own steps, roughly"
         : e->integrated ? "\n# What it will cost with bdf, roughly"
                         : "\n# What it will cost, roughly");
    printf("#   grid            %.0f cells\n", e->grid_cells);
    if (!isnan(e->contact_cells)) {
        char unknowns[40] = "";
        if (e->integrated) {
            (void)snprintf(unknowns, sizeof unknowns, ", %.3g unknowns",
                           e->unknowns * e->contact_cells);
        }
        printf("#   contact         %s%.3g cells%s\n", e->exact ? "" : "about ", e->contact_cells,
               unknowns);
    }
    printf("#   memory          %.10g MB\n", rounded(e->memory / 1e6, 2));
    print_time(e);
    if (e->file_bytes > 1e8) { // else nothing beside the rest
        printf("#   file            up to %.10g MB: %.3g records at stated times\n",
               rounded(e->file_bytes / 1e6, 2), e->records);
    }
    if (!e->integrated) {
        return;
    }
    if (!isnan(e->stiffness_ratio)) {
        printf("#   k_0/k_crit      %.2g\n", e->stiffness_ratio);
    }
    if (e->failure.lowered) {
        printf("#   failure rate    %s\n", cli_amount(e->failure.rate, "m/s").s);
        cli_wrap("#     ", cli_failure_lowered);
    }
    if (e->own_steps) {
        printf("#   steps           of each cell its own, %d to %d\n", OWN_FEWEST, OWN_STEPS);
        cli_wrap("#     ", e->faster != NULL
                               ? "no cell slips by itself: fidelity ode is the faster one"
                               : "a slip costs some hundred, whatever the number of cells");
        return;
    }
    printf("#   steps           %s\n", steps_class(e));
    char apart[80];
    (void)snprintf(apart, sizeof apart, "%d to %.2g: cells may fail one by one, %d steps each",
                   FEWEST_STEPS, e->steps_most, STEPS_PER_FAILURE);
    cli_wrap("#     ", e->changing
                           ? "a load changes in time: how often cells slip under it is not known "
                             "before"
                       : e->stable ? "the cells move together, or there is one"
                                   : apart);
    if (e->faster != NULL) {
        cli_wrap("#     ", "k_0 < k_crit: fidelity events is the faster one (docs/choosing.md)");
    }
}

void cli_estimate_json(lac_json *json, const cli_estimate *e)
{
    if (e == NULL) {
        lac_json_null(json, "estimate");
        return;
    }
    lac_json_open(json, "estimate", '{');
    lac_json_number(json, "grid_cells", e->grid_cells);
    lac_json_number(json, "contact_cells", round(e->contact_cells));
    lac_json_boolean(json, "contact_cells_exact", e->exact);
    lac_json_number(json, "unknowns", e->unknowns * round(e->contact_cells));
    lac_json_number(json, "memory_bytes", round(e->memory));
    lac_json_number(json, "cpu_time_least_s", e->cpu_time_least);
    lac_json_number(json, "cpu_time_most_s", e->cpu_time_most);
    lac_json_number(json, "cascade_time_s", e->cascade_time);
    lac_json_number(json, "records_at_times", e->integrated ? e->records : NAN);
    lac_json_number(json, "file_most_bytes", e->integrated ? e->file_bytes : NAN);
    lac_json_number(json, "stiffness_over_critical", e->stiffness_ratio);
    lac_json_text(json, "faster_fidelity", e->faster);
    lac_json_number(json, "failure_rate_m_s", e->failure.rate > 0.0 ? e->failure.rate : NAN);
    lac_json_boolean(json, "failure_rate_lowered", e->failure.lowered);
    lac_json_text(json, "steps_class", e->integrated ? steps_class(e) : NULL);
    lac_json_number(json, "steps_least", e->integrated ? e->steps_least : NAN);
    lac_json_number(json, "steps_most", e->integrated ? e->steps_most : NAN);
    lac_json_close(json, '}');
}
