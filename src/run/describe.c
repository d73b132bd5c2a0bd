// SPDX-License-Identifier: GPL-3.0-or-later
// What a run puts out, as tables: its records, snapshots and events, the cells and levels that they
// are of, and how it ended. A variable more is a row more.
#include "run/describe.h"

#include "base/date.h"
#include "base/rows.h"
#include "data/describe.h"

#define PLACE const lac_run_place *p = of
#define GRID const lac_grid *g = &((const lac_run_place *)of)->of.domain->grid
#define P(kind, field) LAC_HELD(kind, lac_run_place, field)

LAC_GETTER(double, time_of_record, PLACE, p->record.time_origin + p->record.time_local)
LAC_GETTER(double, time_of_event, PLACE, p->event.time_origin + p->event.time_local)
LAC_GETTER(double, effective_ratio, PLACE,
           p->record.observation.shear_force / p->record.observation.effective_force)
// That of the total force which the effective one lacks, over the nominal area: so also where the
// pressure differs from cell to cell.
LAC_GETTER(double, pore_pressure, PLACE,
           (p->record.observation.normal_force - p->record.observation.effective_force) /
               lac_grid_area(&p->of.domain->grid))
#define WEAKENS(how) (p->of.weakening != NULL && p->of.weakening->how)
LAC_GETTER(bool, has_pore_pressure, PLACE,
           (p->of.loads != NULL && p->of.loads->pore > 0) || WEAKENS(pore))
LAC_GETTER(bool, has_excess, PLACE, WEAKENS(pore))
LAC_GETTER(bool, is_warm, PLACE, WEAKENS(warm))
LAC_GETTER(bool, has_bridges, PLACE, WEAKENS(bridges))
LAC_GETTER(bool, has_safety, PLACE, p->of.safety.asked)
static lac_slab slab_at(const lac_run_place *p)
{
    const lac_geometry *g = p->of.loads != NULL ? p->of.loads->geometry : NULL;
    return g != NULL ? lac_geometry_at(g, p->record.observation.mean_slip)
                     : (lac_slab){.angle = NAN, .thickness = NAN};
}
LAC_GETTER(bool, bends, PLACE, !isnan(slab_at(p).angle))
LAC_GETTER(bool, has_thickness, PLACE, !isnan(slab_at(p).thickness))
LAC_GETTER(double, angle, PLACE, slab_at(p).angle *(180.0 / M_PI))
LAC_GETTER(double, thickness, PLACE, slab_at(p).thickness)
LAC_GETTER(double, order, PLACE, p->record.order != 0 ? (double)p->record.order : NAN)

#define MEAN .cell_methods = "time: point area: mean"
#define POINT .cell_methods = "time: point"
// Held, though never missing in fact.
#define SEEN(field) P(REAL, record.observation.field), .flags = LAC_FILLED | LAC_ROUGH
#define WHOLE .flags = (LAC_WHOLE | LAC_LONG)

static const lac_variable of_record[] = {
    LAC_ROW("time", NULL, "s", "time since the start of the run", G(time_of_record),
            .flags = LAC_TIME,
            .comment = "time_origin + time_local rounded to a double: never decreasing, but two "
                       "steps may share a value where they are shorter than a double resolves"),
    LAC_ROW("time_origin", NULL, "s", "origin of the local time, since the start of the run",
            P(REAL, record.time_origin),
            .comment =
                "t = time_origin + time_local; the pair is strictly increasing at full precision"),
    LAC_ROW("time_local", NULL, "s", "time since time_origin", P(REAL, record.time_local),
            .comment = "keeps the steps of a failure, milliseconds after years of creep, apart"),
    LAC_ROW("slip", NULL, "m", "mean slip since the start", SEEN(mean_slip), MEAN,
            .comment = "mean over the contact cells"),
    LAC_ROW("slip_rate", NULL, "m s-1", "mean slip rate", SEEN(mean_rate), MEAN,
            .comment =
                "mean over the contact cells; failure is its upward crossing of the case's limit"),
    LAC_ROW("max_slip_rate", NULL, "m s-1", "largest slip rate of any contact cell", SEEN(max_rate),
            .cell_methods = "time: point area: maximum"),
    LAC_ROW("shear_force", NULL, "N", "shear force Q on the interface", SEEN(shear_force), POINT,
            .comment = "applied load, along x"),
    LAC_ROW("normal_force", NULL, "N", "total normal force P on the interface", SEEN(normal_force),
            POINT, .comment = "compression is positive; pore pressure not subtracted"),
    LAC_ROW("effective_normal_force", NULL, "N", "normal force less the force of the pore pressure",
            SEEN(effective_force), POINT,
            .comment = "P - u A, with u the pore pressure and A the nominal area"),
    LAC_ROW("apparent_friction", NULL, "1", "apparent friction coefficient Q/P",
            P(REAL, apparent_friction), POINT, .flags = LAC_FILLED | LAC_ROUGH,
            .comment = "shear_force / normal_force, with the total normal force"),
    LAC_ROW("effective_ratio", NULL, "1", "effective ratio of shear to normal force, Q/(P - U)",
            G(effective_ratio), POINT, .flags = LAC_FILLED | LAC_ROUGH, .has = has_pore_pressure,
            .comment = "shear_force / effective_normal_force"),
    LAC_ROW("pore_pressure", NULL, "Pa", "pore pressure in the interface", G(pore_pressure), POINT,
            .flags = LAC_FILLED | LAC_ROUGH, .has = has_pore_pressure,
            .comment = "(normal_force - effective_normal_force) / A: that of all cells, or their "
                       "mean by the normal force that each carries"),
    LAC_ROW("factor_of_safety", NULL, "1", "factor of safety at the reference slip rate",
            P(REAL, record.observation.factor_of_safety), POINT, .flags = LAC_MISSING | LAC_ROUGH,
            .has = has_safety,
            .comment =
                "what friction would hold if all cells slid at the reference rate in their "
                "present states, sum of (p f(v_ref, theta) + cohesion) r^2, p effective, over "
                "shear_force; missing where nothing drives. v_ref is v0 of the friction, "
                "or factor_of_safety_reference_rate_m_s"),
    LAC_ROW("angle", NULL, "degree", "dip of the base at the mean slip", G(angle), POINT,
            .flags = LAC_FILLED | LAC_ROUGH, .has = bends),
    LAC_ROW("thickness", NULL, "m", "vertical thickness of the sliding mass", G(thickness), POINT,
            .flags = LAC_FILLED | LAC_ROUGH, .has = has_thickness),
    LAC_ROW("excess_pore_pressure", NULL, "Pa", "pore pressure in excess of that of the loads",
            P(REAL, record.observation.excess_pore), POINT, .flags = LAC_MISSING | LAC_ROUGH,
            .has = has_excess,
            .comment = "what slip has made of it (weakening), part of pore_pressure; mean over the "
                       "contact cells by the normal force that each carries"),
    LAC_ROW("temperature_rise", NULL, "K", "largest rise of the temperature of any contact cell",
            P(REAL, record.observation.temperature), .cell_methods = "time: point area: maximum",
            .flags = LAC_MISSING | LAC_ROUGH, .has = is_warm,
            .comment = "in the middle of the layer that is sheared"),
    LAC_ROW("broken_cohesion", NULL, "1", "part of the cohesion that is broken",
            P(REAL, record.observation.broken), POINT, .flags = LAC_MISSING | LAC_ROUGH,
            .has = has_bridges,
            .comment = "0: none, 1: all; mean over the contact cells by the cohesion of each"),
    LAC_ROW("balance_residual", NULL, "1", "worst relative error of the traction balance",
            SEEN(balance_residual), POINT,
            .comment = "max over cells of |q - K slip - p f - eta v| / (f0 p): how far integration "
                       "has drifted from the balance it solves"),
    LAC_ROW("step_size", NULL, "s", "step of the integrator that ended here",
            P(REAL, record.step_size), POINT, .flags = LAC_MISSING | LAC_ROUGH,
            .comment = "missing at the start, where no step has been made"),
    LAC_ROW("order", NULL, "1", "order of the integrator's method in that step", G(order), POINT,
            .flags = LAC_MISSING | LAC_WHOLE,
            .comment = "missing at the start, where no step has been made"),
    LAC_ROW("rhs_evaluations", NULL, "1", "evaluations of the right-hand side since the start",
            P(INT64, record.rhs_evaluations), POINT, WHOLE),
};

static const lac_variable of_snapshot[] = {
    LAC_ROW("snapshot_time", NULL, "s", "time of the snapshot since the start of the run",
            P(REAL, snapshot.time), .flags = LAC_TIME)};

#define CELLS(field)                                                                  \
    P(REALS, snapshot.field), .coordinates = "snapshot_time x y",                     \
                              .flags = LAC_FILLED | LAC_ROUGH | LAC_CELLS | LAC_LATE, \
                              .cell_measures = "area: cell_area"

// The i-th is asked for by the bit 1 << i.
static const lac_variable of_fields[] = {
    LAC_ROW("cell_slip", NULL, "m", "slip of each contact cell since the start", CELLS(slip)),
    LAC_ROW("cell_slip_rate", NULL, "m s-1", "slip rate v of each contact cell", CELLS(slip_rate)),
    LAC_ROW("cell_state", NULL, "s", "frictional state theta of each contact cell", CELLS(state),
            .comment = "rate-and-state friction: the age of the contacts"),
    LAC_ROW("cell_traction", NULL, "Pa", "shear traction on each contact cell", CELLS(traction),
            .comment = "the elastic side of the balance, q - K slip"),
    LAC_ROW("cell_pore_pressure", NULL, "Pa", "pore pressure of each contact cell", CELLS(pore),
            .comment =
                "over the nominal area: takes the part u A/P off the cell's normal pressure"),
    LAC_ROW("cell_factor_of_safety", NULL, "1", "factor of safety of each contact cell by itself",
            CELLS(factor_of_safety),
            .comment = "(p f(v_ref, theta) + cohesion) / |traction|, p the effective pressure; "
                       "missing where it carries nothing"),
    LAC_ROW("cell_excess_pore_pressure", NULL, "Pa",
            "pore pressure of each contact cell in excess of that of the loads", CELLS(excess_pore),
            .comment = "what slip has made of it (weakening), beside cell_pore_pressure"),
    LAC_ROW("cell_temperature", NULL, "K", "rise of the temperature of each contact cell",
            CELLS(temperature), .comment = "in the middle of the layer that is sheared"),
    LAC_ROW("cell_broken_cohesion", NULL, "1",
            "part of the cohesion of each contact cell that is broken", CELLS(broken)),
};

#define E(kind, field) P(kind, event.field), .coordinates = "event_time event_x event_y"
static const lac_variable of_event[] = {
    LAC_ROW("event_time", NULL, "s", "start of the event since the start of the run",
            G(time_of_event), .flags = LAC_TIME,
            .comment = "its first cell comes to the slip rate of analysis.events; lines are in the "
                       "order in which events end"),
    LAC_ROW("event_duration", NULL, "s",
            "time from the start of the event to the fall of its last cell", E(REAL, duration)),
    LAC_ROW("event_cells", NULL, "1", "different cells that moved in the event", E(INT64, cells),
            WHOLE),
    LAC_ROW("event_potency", NULL, "m3",
            "sum over the event's cells of area times slip while moving", E(REAL, potency)),
    LAC_ROW("event_moment", NULL, "N m", "shear modulus times potency of the event",
            E(REAL, moment), .flags = LAC_MISSING,
            .comment = "missing where the case gives no material.shear_modulus"),
    LAC_ROW("event_size", NULL, "m", "longest side of the cells that moved in the event",
            E(REAL, size), .comment = "along x or y, round periodic edges; of a line along it"),
    LAC_ROW("event_x", NULL, "m", "position along x of the first cell that moved",
            P(REAL, event.x)),
    LAC_ROW("event_y", NULL, "m", "position along y of the first cell that moved",
            P(REAL, event.y)),
    LAC_ROW("event_max_slip_rate", NULL, "m s-1",
            "largest slip rate of a cell of the event, between steps too", E(REAL, max_rate)),
    LAC_ROW("event_cut", NULL, "1", "ends of the event that lie outside the run", E(INT64, cut),
            WHOLE, .meanings = "whole begun_before unended both",
            .comment = "where any do, duration, cells, moment and size are at least what is given"),
};

LAC_GETTER(double, start, (void)of, 0.0)
LAC_GETTER(double, reference_rate, PLACE,
           p->of.safety.asked && p->of.safety.reference_rate > 0.0 ? p->of.safety.reference_rate
                                                                   : NAN)
static const lac_variable of_start[] = {
    {.name = "time_coverage_start", G(start), .flags = LAC_DATE},
    {.name = "factor_of_safety_reference_rate_m_s", .unit = "m s-1", G(reference_rate)}};

static const char *const boundaries[] = {"free", "periodic"};
#define OF_GRID(kind, field) LAC_HELD(kind, lac_grid, field)
static const lac_variable of_grid[] = {
    {.name = "grid_nx", OF_GRID(COUNT, nx), .flags = LAC_WHOLE},
    {.name = "grid_ny", OF_GRID(COUNT, ny), .flags = LAC_WHOLE},
    {.name = "grid_dx_m", .unit = "m", OF_GRID(REAL, dx)},
    {.name = "grid_dy_m", .unit = "m", OF_GRID(REAL, dy)},
    {.name = "boundary", OF_GRID(BOOL, periodic), .names = boundaries},
};

LAC_GETTER(double, cell_x, PLACE, lac_grid_x(&p->of.domain->grid, p->of.domain->index[at[0]]))
LAC_GETTER(double, cell_y, PLACE, lac_grid_y(&p->of.domain->grid, p->of.domain->index[at[0]]))
LAC_GETTER(double, cell_pressure, PLACE, p->of.domain->pressure[at[0]])
LAC_GETTER(double, cell_area, GRID, lac_grid_cell_area(g))
static const lac_variable of_cells[] = {
    LAC_ROW("x", NULL, "m", "position of the cell's centre along x", G(cell_x), .flags = LAC_CELLS,
            .comment = "slip is along x; contact cells stand in hierarchy (Morton) order"),
    LAC_ROW("y", NULL, "m", "position of the cell's centre along y", G(cell_y), .flags = LAC_CELLS),
    LAC_ROW("pressure", NULL, "Pa", "normal pressure on each contact cell", G(cell_pressure),
            .flags = LAC_CELLS, .coordinates = "x y",
            .comment = "of the contact before pore pressure"),
    LAC_ROW("cell_area", NULL, "m2", "area of each contact cell", G(cell_area), .flags = LAC_CELLS,
            .coordinates = "x y", .standard_name = "cell_area"),
};

// One block holds all: there is nothing that it could resist.
static double stiffness_of(const lac_run_output *of, size_t level)
{
    return level < lac_hierarchy_levels(of->hierarchy)
               ? of->transfer->kind->stiffness(of->transfer->state, level)
               : NAN;
}
LAC_GETTER(bool, has_stiffness, PLACE,
           p->of.transfer != NULL && p->of.transfer->kind->blocks != NULL)
LAC_GETTER(double, level, (void)of, (double)at[0])
LAC_GETTER(double, block_size, GRID, ldexp(g->dx, (int)at[0]))
// Blocks of a line or a single row are as wide as the row.
LAC_GETTER(double, block_width, GRID, g->ny > 1 ? ldexp(g->dy, (int)at[0]) : g->dy)
LAC_GETTER(double, blocks, PLACE, (double)lac_hierarchy_blocks(p->of.hierarchy, at[0]))
LAC_GETTER(double, stiffness, PLACE, stiffness_of(&p->of, at[0]))
static const lac_variable of_levels[] = {
    LAC_ROW("level", NULL, "1", "level of the hierarchy", G(level), .flags = LAC_WHOLE,
            .comment = "0: the contact cells; each level up doubles the side of a block; the last "
                       "one holds everything"),
    LAC_ROW("block_size", NULL, "m", "side of a block of this level along x", G(block_size)),
    LAC_ROW("block_width", NULL, "m", "side of a block of this level along y", G(block_width)),
    LAC_ROW("n_tot", NULL, "1", "blocks of this level that hold a contact cell", G(blocks), WHOLE,
            .coordinates = "block_size"),
    LAC_ROW("hierarchy_stiffness", NULL, "Pa m-1", "stiffness k_l of the hierarchy at this level",
            G(stiffness), .has = has_stiffness, .flags = LAC_MISSING, .coordinates = "block_size",
            .comment =
                "what slip takes off a cell: sum over l of k_l (P_l - P_l+1) slip, P_l the mean "
                "over the contact cells of a block; missing for the block that holds all"),
};

// Where a run is watched, and what is seen there: each value in its part of the record's.
#define AT_POINT const lac_point *p = &((const lac_run_place *)of)->of.points->point[at[0]]
static double at_point(const lac_run_place *p, lac_point_value which, size_t point)
{
    const double *values = p->record.observation.points;
    return values != NULL ? values[point * LAC_POINT_VALUES + which] : NAN;
}
LAC_TEXT_GETTER(point_name, AT_POINT, p->name)
LAC_GETTER(double, point_x, AT_POINT, p->x)
LAC_GETTER(double, point_y, AT_POINT, p->y)
LAC_GETTER(double, point_cell_x, AT_POINT, p->cell_x)
LAC_GETTER(double, point_cell_y, AT_POINT, p->cell_y)
LAC_GETTER(double, point_distance, AT_POINT, p->distance)
LAC_GETTER(double, point_cells, AT_POINT, (double)p->cells)
LAC_GETTER(double, point_slip, PLACE, at_point(p, LAC_POINT_SLIP, at[1]))
LAC_GETTER(double, point_rate, PLACE, at_point(p, LAC_POINT_RATE, at[1]))
LAC_GETTER(double, point_traction, PLACE, at_point(p, LAC_POINT_TRACTION, at[1]))
LAC_GETTER(double, point_state, PLACE, at_point(p, LAC_POINT_STATE, at[1]))
static const lac_variable of_points[] = {
    LAC_ROW("point_name", NULL, "1", "name of the point in the case", T(point_name),
            .flags = LAC_CHARS),
    LAC_ROW("point_x", NULL, "m", "position of the point along x", G(point_x)),
    LAC_ROW("point_y", NULL, "m", "position of the point along y", G(point_y)),
    LAC_ROW("point_cell_x", NULL, "m", "position along x of the nearest contact cell's centre",
            G(point_cell_x)),
    LAC_ROW("point_cell_y", NULL, "m", "position along y of the nearest contact cell's centre",
            G(point_cell_y)),
    LAC_ROW("point_distance", NULL, "m", "distance from the point to the nearest contact cell",
            G(point_distance), .comment = "to its edge: 0 where the point itself is in contact"),
    LAC_ROW("point_cells", NULL, "1", "contact cells that the values of the point are means over",
            G(point_cells), WHOLE,
            .comment = "those with their centre within the point's radius, or the nearest one"),
};
#define WATCHED(getter)                                                                    \
    G(getter), .coordinates = "point_name point_x point_y", .cell_methods = "time: point", \
               .flags = LAC_FILLED | LAC_ROUGH
static const lac_variable of_watched[] = {
    LAC_ROW("point_slip", "time point", "m", "slip at the point since the start",
            WATCHED(point_slip)),
    LAC_ROW("point_slip_rate", "time point", "m s-1", "slip rate v at the point",
            WATCHED(point_rate)),
    LAC_ROW("point_traction", "time point", "Pa", "shear traction at the point",
            WATCHED(point_traction), .comment = "the elastic side of the balance, q - K slip"),
    LAC_ROW("point_state", "time point", "s", "frictional state theta at the point",
            WATCHED(point_state)),
};

// What an analysis adds: `which` is the place of its first value among those of its kind.
LAC_GETTER(double, once, PLACE, p->once != NULL ? p->once[at[0]] : NAN)
LAC_GETTER(double, in_time, PLACE, p->record.extra != NULL ? p->record.extra[at[1]] : NAN)
LAC_GETTER(double, of_level, PLACE, p->record.extra != NULL ? p->record.extra[at[2] + at[1]] : NAN)

#define OVER(dims_, getter, more, ...)                                                       \
    {                                                                                        \
        {.dims = (dims_), G(getter), .flags = LAC_MISSING | (more), __VA_ARGS__},            \
        {                                                                                    \
            .dims = (dims_), G(getter), .flags = LAC_WHOLE | LAC_LONG | (more), __VA_ARGS__, \
        }                                                                                    \
    }
static const lac_variable of_extra[][2] = {
    [LAC_OVER_NOTHING] = OVER("", once, LAC_SINGLE | LAC_LATE, .has = NULL),
    [LAC_OVER_TIME] = OVER("time", in_time, 0, .has = NULL),
    [LAC_OVER_LEVELS] = OVER("time level", of_level, 0, .coordinates = "block_size"),
};

static lac_status add_extras(lac_dataset *d, const lac_run_place *p, size_t levels, lac_error *err)
{
    lac_status status = LAC_OK;
    size_t next[2] = {0, 0}; // of one value, of records
    for (size_t i = 0; i < p->of.extras && status == LAC_OK; i++) {
        const lac_extra *e = &p->of.extra[i];
        size_t *which = &next[e->over != LAC_OVER_NOTHING];
        const lac_named named = {e->name,    e->long_name, e->unit,
                                 e->comment, *which,       e->cell_methods};
        *which += e->over == LAC_OVER_LEVELS ? levels : 1;
        status = lac_dataset_add_named(d, &of_extra[e->over][e->count], &named, p, err);
    }
    return status;
}

LAC_GETTER(double, driver, PLACE,
           lac_load_set_driver_at(p->of.loads, at[1], p->record.time_origin + p->record.time_local))
static const lac_variable of_driver = {.dims = "time", G(driver), POINT, .flags = LAC_MISSING};

// What the loads read; a second one of a kind is numbered.
static lac_status add_drivers(lac_dataset *d, const lac_run_place *p, lac_error *err)
{
    const lac_load_driver *driver;
    lac_status status = LAC_OK;
    for (size_t i = 0; (driver = lac_load_set_driver(p->of.loads, i)) != NULL && status == LAC_OK;
         i++) {
        char name[64];
        size_t alike = 1;
        for (size_t j = 0; j < i; j++) {
            alike += lac_load_set_driver(p->of.loads, j) == driver ? 1 : 0;
        }
        (void)snprintf(name, sizeof name, alike > 1 ? "%s_%zu" : "%s", driver->name, alike);
        const lac_named named = {name, driver->long_name, driver->unit, driver->comment,
                                 i,    "time: point"};
        status = lac_dataset_add_named(d, &of_driver, &named, p, err);
    }
    return status;
}

static lac_status add_fields(lac_dataset *d, const lac_run_place *p, lac_error *err)
{
    const lac_laid time = {LAC_VARIABLES(of_snapshot, "snapshot", 0), p};
    lac_status status = p->of.fields != 0 ? lac_dataset_add(d, &time, 1, err) : LAC_OK;
    for (size_t i = 0; i < sizeof of_fields / sizeof *of_fields && status == LAC_OK; i++) {
        const lac_laid field = {{.row = &of_fields[i], .rows = 1, .over = "snapshot cell"}, p};
        status = (p->of.fields >> i & 1) != 0 ? lac_dataset_add(d, &field, 1, err) : LAC_OK;
    }
    return status;
}

static lac_status add_all(lac_dataset *d, const lac_run_place *p, lac_error *err)
{
    const lac_run_output *of = &p->of;
    const bool has_levels = of->hierarchy != NULL && of->domain != NULL;
    const size_t levels = of->hierarchy != NULL ? lac_hierarchy_levels(of->hierarchy) + 1 : 0;
    const lac_extent dims[] = {
        {"time", LAC_GROWS},     {"cell", of->domain != NULL ? of->domain->n : 0},
        {"snapshot", LAC_GROWS}, {"level", levels},
        {"event", LAC_GROWS},    {"point", of->points != NULL ? of->points->n : 0}};
    const lac_laid start[] = {{LAC_VARIABLES(of_start, "", 0), p},
                              {LAC_VARIABLES(of_record, "time", 0), p}};
    const lac_laid cells[] = {
        {LAC_VARIABLES(of_grid, "", 0), of->domain != NULL ? &of->domain->grid : NULL},
        {LAC_VARIABLES(of_cells, "cell", 0), p}};
    const lac_laid points[] = {{LAC_VARIABLES(of_points, "point", 0), p},
                               {LAC_VARIABLES(of_watched, "", 0), p}};
    const lac_laid level = {LAC_VARIABLES(of_levels, "level", 0), p};
    const lac_laid events = {LAC_VARIABLES(of_event, "event", 0), p};
    d->clock = of->dated ? LAC_CLOCK_DATE : LAC_CLOCK_NONE;
    d->start = of->start_date;
    LAC_TRY_RETURN(lac_dataset_dims(d, dims, sizeof dims / sizeof *dims, err));
    LAC_TRY_RETURN(lac_dataset_add(d, start, 2, err));
    LAC_TRY_RETURN(of->domain != NULL ? lac_dataset_add(d, cells, 2, err) : LAC_OK);
    LAC_TRY_RETURN(of->domain != NULL ? add_fields(d, p, err) : LAC_OK);
    LAC_TRY_RETURN(has_levels ? lac_dataset_add(d, &level, 1, err) : LAC_OK);
    LAC_TRY_RETURN(of->points != NULL ? lac_dataset_add(d, points, 2, err) : LAC_OK);
    LAC_TRY_RETURN(of->loads != NULL ? add_drivers(d, p, err) : LAC_OK);
    LAC_TRY_RETURN(lac_run_describe_components(d, p, err));
    LAC_TRY_RETURN(add_extras(d, p, levels, err));
    return of->events ? lac_dataset_add(d, &events, 1, err) : LAC_OK;
}

lac_status lac_run_describe(const lac_run_place *place, lac_dataset **out, lac_error *err)
{
    lac_status status;
    LAC_TRY(lac_dataset_create(
        "Creep of a rough rock joint under rate-and-state friction: means over its contact cells "
        "against time, one record per line of the time series; fields of every cell where "
        "snapshots were asked for. The attribute `case` is the whole input; `status` says whether "
        "the file is whole.",
        out, err));
    LAC_TRY(add_all(*out, place, err));
out:
    LAC_MADE(status, out, lac_dataset_free);
}

void lac_run_place_record(lac_run_place *place, const lac_record *record)
{
    place->record = *record;
    place->apparent_friction = record->observation.shear_force / record->observation.normal_force;
}

LAC_ROWS_AT(lac_variable, lac_run_column, of_record)

const char *lac_run_field(size_t index)
{
    return index < sizeof of_fields / sizeof *of_fields ? of_fields[index].name + strlen("cell_")
                                                        : NULL;
}

#define ENDING const lac_run_ending *e = of
#define RESULT const lac_run_result *r = of
#define R(kind, field) LAC_HELD(kind, lac_run_result, field)

// After an error nobody knows.
LAC_GETTER(double, failed, RESULT, r->end != LAC_END_ERROR ? r->failed : NAN)
LAC_GETTER(double, failure_rate, RESULT, r->end != LAC_END_ERROR ? r->failure.rate : NAN)
LAC_GETTER(double, failure_slip, RESULT, r->end != LAC_END_ERROR ? r->failure.slip : NAN)
LAC_GETTER(double, failed_at, RESULT,
           r->failed && r->end != LAC_END_ERROR ? r->failure_origin + r->failure_local : NAN)
LAC_TEXT_GETTER(lowered, RESULT,
                r->end != LAC_END_ERROR && r->failure.lowered
                    ? "a p/eta at the start: radiation damping holds the joint below "
                      "time.failure.mean_slip_rate; judged by all cells as one"
                    : NULL)
LAC_GETTER(double, lumped, RESULT, r->lump_error_estimated > 0.0 ? r->lump_error_estimated : NAN)
LAC_TEXT_GETTER(ended_by, RESULT, lac_end_name(r->end))
LAC_TEXT_GETTER(arrested, RESULT,
                isnan(r->arrest.largest) ? NULL
                : r->arrest.arrested     ? "arrested: the mean slip rate at the end is below a "
                                           "tenth of the largest"
                                         : "not arrested")
LAC_TEXT_GETTER(modified, ENDING,
                lac_date_format(e->now + (isnan(e->wall_time) ? 0.0 : e->wall_time), room,
                                LAC_TEXT_ROOM))

#define SUM(name_, field)                                    \
    {                                                        \
        .name = (name_), R(INT64, field), .flags = LAC_WHOLE \
    }
static const lac_variable of_result[] = {
    {.name = "failed", G(failed), .flags = LAC_WHOLE},
    {.name = "failure_rate_m_s", .unit = "m s-1", G(failure_rate)},
    {.name = "failure_rate_comment", T(lowered)},
    {.name = "failure_slip_m", .unit = "m", G(failure_slip)},
    {.name = "failure_time_s", .unit = "s", G(failed_at)},
    {.name = "failure_date", G(failed_at), .flags = LAC_DATE},
    {.name = "ended_by", T(ended_by)},
    {.name = "time_reached_s", .unit = "s", R(REAL, time)},
    {.name = "max_slip_rate_m_s", .unit = "m s-1", R(REAL, max_slip_rate)},
    {.name = "mean_slip_m", .unit = "m", R(REAL, mean_slip)},
    {.name = "balance_residual_max", R(REAL, balance_residual)},
    {.name = "factor_of_safety_start", R(REAL, safety.start)},
    {.name = "factor_of_safety_least", R(REAL, safety.least)},
    {.name = "factor_of_safety_end", R(REAL, safety.end)},
    {.name = "factor_of_safety_below_1_time_s", .unit = "s", R(REAL, safety.below_time)},
    {.name = "largest_mean_slip_rate_m_s", .unit = "m s-1", R(REAL, arrest.largest)},
    {.name = "largest_mean_slip_rate_time_s", .unit = "s", R(REAL, arrest.largest_time)},
    {.name = "arrest", T(arrested)},
    {.name = "lump_error_estimated", G(lumped)},
    SUM("steps", steps),
    SUM("rhs_evaluations", rhs_evaluations),
    SUM("newton_iterations", newton_iterations),
    SUM("linear_solves", linear_solves),
    SUM("error_test_fails", error_test_fails),
    SUM("nonlinear_fails", nonlinear_fails),
    SUM("restarts", restarts),
    {.name = "time_coverage_end", R(REAL, time), .flags = LAC_DATE},
};
static const lac_variable of_end[] = {
    {.name = "wall_time_s", .unit = "s", LAC_HELD(REAL, lac_run_ending, wall_time)},
    {.name = "date_modified", T(modified)},
    {.name = "status", LAC_HELD(TEXT, lac_run_ending, status)},
};

lac_status lac_run_ending_describe(const lac_run_ending *ending, lac_dataset **out, lac_error *err)
{
    const lac_laid laid[] = {{LAC_VARIABLES(of_result, "", 0), ending->result},
                             {LAC_VARIABLES(of_end, "", 0), ending}};
    lac_status status;
    LAC_TRY(lac_dataset_create("", out, err));
    (*out)->clock = ending->dated ? LAC_CLOCK_DATE : LAC_CLOCK_NONE;
    (*out)->start = ending->start_date;
    LAC_TRY(lac_dataset_add(*out, laid, sizeof laid / sizeof *laid, err));
out:
    LAC_MADE(status, out, lac_dataset_free);
}
