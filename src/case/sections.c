// SPDX-License-Identifier: GPL-3.0-or-later
// What a case is made of: the rows of its keys and the table of its parts, which all walk.
#include "case/sections.h"
#include "store/store.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define FIELD(name) offsetof(lac_case, name)

static const char *const shapes[] = {"plane", "line", NULL};
static const char *const boundaries[] = {"periodic", "free", NULL};
static const char *const precisions[] = {"double", "float", NULL};
static const char *const history_fields[] = {"all", "last", "none", NULL};

static const lac_param case_rows[] = {
    LAC_OWN("lacuna", "version of the format: 1"),
    LAC_TEXT("title", FIELD(title), LAC_OPTIONAL, "what the case is, for the output"),
    LAC_TEXT("references", FIELD(references), LAC_OPTIONAL, "what to cite"),
    LAC_TEXT("institution", FIELD(institution), LAC_OPTIONAL, "who runs it"),
};

static const lac_param interface_rows[] = {
    LAC_REAL("size", "m", FIELD(interface.size), NAN, 0, 1e9, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "length along x, the direction of slip; may be absent (1 m) only for a single block"),
    LAC_REAL("width", "m", FIELD(interface.width), NAN, 0, 1e9, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "length along y; that of square cells if absent"),
    LAC_INTEGER("levels", FIELD(interface.levels), NAN, 0, 15, LAC_OPTIONAL,
                "2^levels cells a side; a single block if 0, or if it and cells_x are absent"),
    LAC_INTEGER("cells_x", FIELD(interface.cells_x), NAN, 1, LAC_MOST_CELLS, LAC_OPTIONAL,
                "cells along x, instead of levels; products of 2, 3 and 5 are fast"),
    LAC_INTEGER("cells_y", FIELD(interface.cells_y), NAN, 1, LAC_MOST_CELLS, LAC_OPTIONAL,
                "cells along y, with cells_x; as many as along x if absent, one on a line"),
    LAC_CHOICE("shape", FIELD(interface.shape), LAC_PLANE, shapes, 0, "of the interface"),
    LAC_CHOICE("boundary", FIELD(interface.boundary), LAC_PERIODIC, boundaries, 0,
               "periodic, or free: the faces end at the border, the rock goes on"),
    LAC_SLIP_ROW(FIELD(slip)),
    LAC_OWN("surface", "{MODEL: {...}}: heights to press"),
    LAC_OWN("domain", "{MODEL: {...}}: contact cells, instead of a surface"),
    LAC_OWN("spread", "{pressure: {MODEL: {...}}}: over the cells of a domain"),
    LAC_OWN("geometry", "{angle: ..., thickness: ..., ...}: a base whose dip follows the slip"),
};

const lac_param lac_material_rows[LAC_MATERIAL_ROWS] = {
    LAC_REAL("shear_modulus", "Pa", FIELD(material.shear_modulus), NAN, 0, 1e15,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "of the rock; needed by a surface, by elastic transfer and by radiation damping"),
    LAC_REAL("poisson", "1", FIELD(material.poisson), 0.25, 0, 0.4999, 0, "Poisson's ratio"),
    LAC_REAL("shear_speed", "m/s", FIELD(material.shear_speed), NAN, 1e-6, 1e5,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "of shear waves, for radiation damping; if absent it follows from the density; no "
             "damping without either"),
    LAC_REAL("density", "kg/m3", FIELD(material.density), NAN, 0, 1e6, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "of the rock; needed by the loads depth and slope"),
};

static const lac_param load_rows[] = {
    LAC_OWN("normal", "{MODEL: {...}}: total normal stress; must be given"),
    LAC_OWN("shear", "[{MODEL: {...}}, ...]: shear loads, which add up"),
    LAC_OWN("pore_pressure", "[{MODEL: {...}}, ...]: pore pressures, which add up"),
    LAC_OWN("normal_stress", "[{MODEL: {...}}, ...]: normal stresses on top of normal, which add "
                             "up"),
    LAC_OWN("history", "{steps: [...], ...}: a static history for `lacuna contact`"),
};

#define COULOMB_ROW(where)                                                       \
    LAC_REAL("friction", "1", where, NAN, 0, 1000, LAC_OPTIONAL | LAC_ABOVE_MIN, \
             "Coulomb's coefficient f; f0 of the friction law if absent")

static const lac_param history_rows[] = {
    COULOMB_ROW(FIELD(history.friction)),
    LAC_CHOICE("fields", FIELD(history.fields), LAC_KEEP_ALL, history_fields, 0,
               "steps whose tractions, slips and states are written cell by cell"),
    LAC_OWN("steps", "[{...}, ...]: each goes on from the one before; must be given"),
};

static const lac_param initial_rows[] = {
    // Slower than exp(LAC_SLOWEST) no cell is followed.
    LAC_REAL("slip_rate", "m/s", FIELD(initial.slip_rate), NAN, 1e-250, 1e3, LAC_OPTIONAL,
             "at the start; follows from load and state if absent"),
    LAC_OWN("state", "steady, a time, or {ratio_to_steady: x}; follows from load and slip rate if "
                     "absent, steady where neither is given"),
    LAC_HEADING_ROW(FIELD(initial_azimuth)),
    LAC_OWN("spread", "{slip_rate: {MODEL: {...}}, state: {...}}: from cell to cell"),
    LAC_OWN("run",
            "{file: RUN.nc, at: \"30 day\"}: go on from a run of the same cells, under these "
            "loads; its start and the rest of initial are those of that run"),
};

static const lac_param from_rows[] = {
    LAC_PATH("file", FIELD(from.file), 0, "of the run, which keeps slip, slip_rate and state"),
    LAC_TEXT(
        "at", FIELD(from.at), LAC_OPTIONAL,
        "when: a time since its start, a date, the number of a snapshot from 0, or last, as if "
        "absent; between snapshots it is run on to there under its own loads"),
};

static const lac_param time_rows[] = {
    LAC_OWN("start", "of the run: a date (ISO 8601) or a time; 0 s if absent"),
    LAC_REAL("end", "s", FIELD(run.end), NAN, 1e-9, 1e15, 0, "of the run, since its start"),
    LAC_OWN("failure",
            "{mean_slip_rate: ..., mean_slip: ...}: what counts as failure, the first of them"),
    LAC_OWN("stop_when",
            "{mean_slip: ..., max_slip_rate: ..., factor_of_safety: ...}: other limits"),
};

static const lac_param failure_rows[] = {
    LAC_REAL("mean_slip_rate", "m/s", FIELD(run.failure_rate), 1, 0, 1e4, LAC_ABOVE_MIN,
             "mean over the contact cells whose first upward crossing is failure; where damping "
             "holds the joint below it, a p/eta counts instead, judged by all cells as one; from 1 "
             "km/s on none does"),
    LAC_REAL("mean_slip", "m", FIELD(run.failure_slip), NAN, 0, 1e9, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "mean slip that is failure; if absent the interface's size, of one block 10 m"),
};

static const lac_param stop_rows[] = {
    LAC_REAL("mean_slip", "m", FIELD(run.stop_slip), NAN, 0, 1e9, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "mean slip at which the run ends"),
    LAC_REAL("max_slip_rate", "m/s", FIELD(run.stop_rate), NAN, 0, 1e4,
             LAC_OPTIONAL | LAC_ABOVE_MIN, "slip rate of any cell at which the run ends"),
    LAC_REAL("factor_of_safety", "1", FIELD(run.stop_safety), NAN, 0, 1e3,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "factor of safety of the joint at which the run ends as it falls; with fidelity ode"),
};

static const lac_param output_rows[] = {
    LAC_TEXT("file", FIELD(output_file), LAC_OPTIONAL,
             "to write, from the folder one works in; named after the case if absent"),
    LAC_OWN("every", "how often a line of the time series is kept: a time, {steps: N}, "
                     "{per_decade: N} of the mean slip rate; each step if absent"),
    LAC_OWN("fields", "of every cell to keep: [slip, slip_rate, state, traction, pore_pressure, "
                      "factor_of_safety, excess_pore_pressure, temperature, broken_cohesion]"),
    LAC_OWN("fields_every", "how often the fields are kept, as `every`; once per decade of the "
                            "mean slip rate if absent"),
    LAC_OWN("points", "[{name: P1, x: 12 m, y: 3 m}, ...]: places whose motion is kept at every "
                      "record"),
    LAC_OWN("checkpoint", "how often the run saves what --resume goes on from, as `every`; only "
                          "when a signal ends it if absent"),
    LAC_OWN("factor_of_safety", "{reference_rate: ...}: strength at a slip rate over what drives; "
                                "written where named, and where a load is the model slope"),
    LAC_INTEGER("compression", FIELD(compression), 1, 0, 9, 0, "deflate level of the fields"),
    LAC_CHOICE("precision", FIELD(single), 0, precisions, 0,
               "of records and fields but times; a float has seven digits, takes half the space "
               "and holds nothing below 1e-38"),
};

static const lac_param safety_rows[] = {
    LAC_REAL("reference_rate", "m/s", FIELD(safety.reference_rate), NAN, 0, 1e4,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "slip rate at which the strength counts; v0 of the friction if absent"),
};

static const lac_param cadence_rows[] = {
    LAC_REAL("time", "s", offsetof(lac_cadence, time), NAN, 0, 1e15, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "between two records"),
    LAC_INTEGER("steps", offsetof(lac_cadence, steps), 0, 0, 1e12, 0,
                "of the integrator between two records, sweeps of four updates a cell with "
                "fidelity events; 0: not by steps"),
    LAC_REAL("per_decade", "1", offsetof(lac_cadence, per_decade), NAN, 0, 1e6,
             LAC_OPTIONAL | LAC_ABOVE_MIN, "records per decade of the mean slip rate"),
};

static const lac_param point_rows[] = {
    LAC_TEXT("name", offsetof(lac_point_def, name), 0, "what to call it"),
    LAC_REAL("x", "m", offsetof(lac_point_def, x), NAN, -1e9, 1e9, LAC_OPTIONAL,
             "its place along x, from 0 at the edge to interface.size; may be absent only for a "
             "single block"),
    LAC_REAL("y", "m", offsetof(lac_point_def, y), NAN, -1e9, 1e9, LAC_OPTIONAL,
             "the same along y; none on a line"),
    LAC_REAL("radius", "m", offsetof(lac_point_def, radius), 0, 0, 1e9, 0,
             "the mean over the contact cells whose centres lie as near is kept; the nearest cell "
             "alone where none does"),
};

static const lac_param compare_rows[] = {
    LAC_PATH("file", offsetof(lac_compare_def, path), 0,
             "monitoring series (CSV), from the case's folder"),
    LAC_TEXT("time", offsetof(lac_compare_def, columns.time), 0, "its column of times"),
    LAC_TIMES_ROWS(offsetof(lac_compare_def, columns)),
    LAC_COLUMN("displacement", offsetof(lac_compare_def, columns.displacement), "m",
               "its column of displacements, as \"column:unit\""),
    LAC_COLUMN("velocity", offsetof(lac_compare_def, columns.velocity), "m/s",
               "its column of velocities, as \"column:unit\""),
    LAC_TEXT("label", offsetof(lac_compare_def, label), LAC_OPTIONAL, "what to call it"),
    LAC_TEXT("point", offsetof(lac_compare_def, point), LAC_OPTIONAL,
             "the name in output.points of the place that it is of; else the mean of the joint"),
};

const lac_param lac_inertia_rows[LAC_INERTIA_ROWS] = {
    LAC_REAL("thickness", "m", FIELD(inertia.thickness), NAN, 0, 1e9, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "of the block that slides, of material.density"),
    LAC_REAL("mass_per_area", "kg/m2", FIELD(inertia.mass_per_area), NAN, 0, 1e30,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "of the block over the nominal area, instead of a thickness"),
    LAC_REAL(
        "columns", "1", FIELD(inertia.columns), 0.01, 1e-6, 1, 0,
        "part of the mass that stands on the cells as columns of their own; the rest moves with "
        "the mean of their slip rates, a rigid block. 1: every cell is free to move by itself"),
};

static const char *const methods[] = {"bdf", "adams", "erk", NULL};
static const char *const fidelities[] = {"ode", "events", "static", "auto", "lumped", NULL};
static const char *const formulations[] = {"auto",    "rate",   "traction", "slip",
                                           "inertia", "vector", NULL};
static const char *const answers[] = {"false", "true", NULL};
static const char *const plannings[] = {"estimate", "measure", NULL};

static const lac_param solver_rows[] = {
    LAC_CHOICE("fidelity", FIELD(run.fidelity), LAC_FIDELITY_AUTO, fidelities, 0,
               "what is resolved in time: ode (all cells at every step), events (each cell at "
               "steps of its own, where cells slip one by one), auto (the faster of them), lumped "
               "(few stand for all, where all slip together); static has no time (lacuna rg)"),
    LAC_OWN("lump", "{level: ..., nodes: ..., error: ...}: with fidelity lumped, how"),
    LAC_CHOICE("method", FIELD(run.method), LAC_BDF, methods, 0,
               "of integration: bdf (implicit), adams, or erk (explicit Runge-Kutta)"),
    LAC_CHOICE("formulation", FIELD(formulation), LAC_FORMULATION_AUTO, formulations, 0,
               "unknown besides ln theta: rate (ln v), traction, slip; inertia (slip and its rate) "
               "goes with the section inertia, vector with interface.slip: vector; auto: what was "
               "measured to be best for the method"),
    LAC_CHOICE("projection", FIELD(run.projection), 0, answers, 0,
               "whether what is written is first moved onto the traction balance, which drifts "
               "where slip is not the unknown"),
    LAC_REAL("rtol", "1", FIELD(run.rtol), 1e-6, 1e-13, 0.1, 0,
             "relative tolerance on slip rate, state and slip"),
    LAC_REAL("contact_tolerance", "1", FIELD(contact_tolerance), 1e-8, 1e-12, 1e-3, 0,
             "of the elastic contact of a surface: complementarity, penetration and load, "
             "relative; of a static history also slip and its traction"),
    LAC_REAL("accuracy", "1", FIELD(accuracy), NAN, 1e-9, 0.5, LAC_OPTIONAL,
             "relative error of the time of failure, or of the mean slip where nothing fails, that "
             "pilot runs pick rtol for, and method and formulation where they are not given"),
    LAC_INTEGER("max_order", FIELD(run.max_order), 0, 0, 12, 0,
                "highest order: bdf at most 5, adams 12, erk from 2 to 8; 0: the method's own"),
    LAC_REAL("first_step", "s", FIELD(run.first_step), NAN, 0, 1e15, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "first step, at most a thousand of the problem's own; that if absent"),
    LAC_INTEGER("max_steps", FIELD(run.max_steps), 1e7, 1, 1e12, 0,
                "of the whole run; more is an error. With fidelity events sweeps are counted, of "
                "four updates a cell at most"),
    LAC_CHOICE("fft_planning", FIELD(fft_planning), 0, plannings, 0,
               "of an elastic transfer's Fourier transforms: estimate is the same to the bit in "
               "every run, measure quicker"),
};

static const char *const rg_paths[] = {"series", "solve", NULL};
static const lac_param rg_rows[] = {
    LAC_CHOICE("rule", FIELD(rg.rule), LAC_RG_FIX, lac_rg_rule_names, 0,
               "what a block that slips sheds: fix, the drop of its strength (the paper); "
               "cons, all above its residual strength; lump, as a point with its sums"),
    LAC_CHOICE("field", FIELD(rg.field), LAC_RG_ELASTIC, lac_rg_field_names, 0,
               "how shear spreads over the cells: elastic contact, equal springs with caps, or the "
               "same stress on all (uniform), as a ramp with share: equal puts it on"),
    LAC_OWN("beta",
            "strength left after slip, as a number, a list, or from-friction; 0.7 if absent"),
    COULOMB_ROW(FIELD(rg.friction)),
    LAC_INTEGER("shifts", FIELD(rg.shifts), 16, 1, 10000, 0,
                "places of the grid of blocks, averaged"),
    LAC_INTEGER("seeds", FIELD(rg.seeds), 1, 1, 10000, 0,
                "interfaces: the case's own seed and those that follow it"),
    LAC_INTEGER("loads", FIELD(rg.loads), 60, 10, 10000, 0,
                "shear forces at which slipping blocks are counted"),
    LAC_INTEGER("contacts", FIELD(rg.contacts), LAC_RG_LOADS, 10, LAC_RG_MOST_LOADS, 0,
                "contacts solved along the path of field elastic, to interpolate between"),
    LAC_CHOICE(
        "path", FIELD(rg.path), LAC_RG_SERIES, rg_paths, 0,
        "the critical force of field elastic from that series, or on contacts solved for it"),
};

#define FIT(name) offsetof(lac_case, fit.name)

static const char *const offsets[] = {"none", "free", NULL};
static const char *const errors_names[] = {"white", "ar1", NULL};

static const lac_param fit_rows[] = {
    LAC_OWN("parameters",
            "{KEY: {range: [low, high], prior: {lognormal: {median, sigma}}}}: what is estimated"),
    LAC_TEXT("time", FIT(columns.time), LAC_OPTIONAL, "column of times"),
    LAC_TIMES_ROWS(FIT(columns)),
    LAC_TEXT("components", FIT(columns.components), LAC_OPTIONAL,
             "instead of displacement, its columns east, north, up: \"e:mm,n:mm,u:mm\""),
    LAC_TEXT("line_of_sight", FIT(columns.line_of_sight), LAC_OPTIONAL,
             "direction \"E,N,U\" that components are projected on; else that of the motion"),
    LAC_COLUMN("displacement", FIT(columns.displacement), "m",
               "column of displacements, as \"column:unit\""),
    LAC_COLUMN("velocity", FIT(columns.velocity), "m/s",
               "column of velocities, as \"column:unit\""),
    LAC_COLUMN("friction", FIT(columns.value), "1",
               "column of friction coefficients, shear over effective normal force, in place of "
               "displacements, as \"column:1\""),
    LAC_COLUMN("sigma", FIT(columns.sigma), "m",
               "column of the displacements' standard errors, as \"column:unit\""),
    LAC_COLUMN("velocity_sigma", FIT(columns.velocity_sigma), "1",
               "column of the standard errors of the velocities' logarithms, as \"column:1\""),
    LAC_COLUMN("velocity_most", FIT(columns.velocity_most), "m/s",
               "column of upper bounds, which the velocity did not exceed, as \"column:unit\""),
    LAC_COLUMN(
        "time_within", FIT(columns.within), "s",
        "column of how far the time of a velocity may be off, evenly to either side; a bound "
        "holds as far, as \"column:unit\""),
    LAC_REAL("until", "s", FIT(until), NAN, 0, 1e15, LAC_OPTIONAL,
             "readings later than this, since the start, are left out: what was known by then"),
    LAC_TEXT("point", FIT(point), LAC_OPTIONAL,
             "the name in output.points of the place that the readings are of; else the mean of "
             "the joint"),
    LAC_REAL("displacement_error", "m", FIT(displacement_error), NAN, 0, 1e6,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "standard error of a displacement; estimated if absent (with sigma: a factor on it)"),
    LAC_REAL("friction_error", "1", FIT(friction_error), NAN, 0, 100, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "standard error of a friction coefficient; estimated if absent"),
    LAC_REAL("velocity_error", "1", FIT(velocity_error), NAN, 0, 100, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "standard error of the logarithm of a velocity; estimated if absent (with "
             "velocity_sigma: a factor on it)"),
    LAC_CHOICE("errors", FIT(errors), LAC_ERRORS_WHITE, errors_names, 0,
               "of displacements, or of friction: white (independent), or ar1 (correlated over a "
               "time that is "
               "estimated)"),
    LAC_CHOICE("offset", FIT(offset), 1, offsets, 0,
               "zero of the displacements: free (unknown), or none (zero where the run starts)"),
    LAC_INTEGER("starts", FIT(starts), 64, 1, 100000, 0,
                "places tried before the least squares begin from the best three: the case itself "
                "and draws from the prior"),
    LAC_INTEGER("walkers", FIT(walkers), 64, 4, 10000, 0,
                "of the ensemble sampler; even, at least twice the number of parameters and 3"),
    LAC_INTEGER("steps", FIT(steps), 600, 0, 1e7, 0, "kept of each walker; 0: least squares only"),
    LAC_INTEGER("burn", FIT(burn), 300, 0, 1e7, 0, "steps before those, dropped"),
    LAC_INTEGER(
        "rounds", FIT(rounds), 3, 0, 20, 0,
        "times that a chain with R-hat above 1.05 is dropped and one of twice its steps made"),
    LAC_SEED(FIT(seed), 1, 0, "of the starts and the sampler"),
};

static bool has_inertia(const lac_case *c) { return lac_inertia_mass(c) > 0.0; }

static bool has_geometry(const lac_case *c) { return c->geometry.angles > 0; }

static bool has_history(const lac_case *c) { return c->history.count > 0; }

// A static case names no time, and neither a law nor a start.
static bool has_time(const lac_case *c) { return !isnan(c->run.end); }

static bool has_initial(const lac_case *c)
{
    return c->friction.info != NULL || c->initial.state != LAC_STATE_STEADY ||
           !isnan(c->initial.slip_rate) || c->initial_spread.count > 0;
}

static bool has_from(const lac_case *c) { return c->from.file != NULL; }

static bool has_stop(const lac_case *c)
{
    return !isnan(c->run.stop_slip) || !isnan(c->run.stop_rate) || !isnan(c->run.stop_safety);
}

static bool has_safety(const lac_case *c)
{
    return c->safety.reference_rate > 0.0 || (c->safety.asked && !lac_case_implies_safety(c));
}

static bool has_checkpoint(const lac_case *c)
{
    const lac_cadence *save = &c->run.checkpoint;
    return !isnan(save->time) || save->steps > 0 || !isnan(save->per_decade);
}

static bool has_fields(const lac_case *c) { return c->fields != 0; }

static bool has_points(const lac_case *c) { return c->points > 0; }

static bool has_rg(const lac_case *c) { return c->rg.named; }

static bool has_fit(const lac_case *c) { return c->fit.named; }

#define RECORD(key, text, rows) .info = {key, text, "", rows, COUNT(rows), 0, NULL, NULL}
#define ITEMS(key, text, rows) RECORD(key, text, rows), .kind = LAC_PART_ITEMS
#define OWN(key) .info.name = (key), .kind = LAC_PART_OWN
#define PART(what, key, member) .info.name = (key), .kind = LAC_PART_##what, .at = FIELD(member)
#define ITS_WEIGHT "interface.geometry.thickness"
#define NO_LOAD "a normal load such as {pressure: \"3 MPa\"}"

static const char *const pressed[] = {"pressure", NULL};
static const char *const started[] = {"slip_rate", "state", NULL};

static const lac_part parts[] = {
    {RECORD("case", "the case as a whole", case_rows), .read = lac_read_version},
    {RECORD("interface", "the interface and its cells", interface_rows), .fitted = true},
    {PART(SLOT, "interface.surface", surface), .model = LAC_KIND_SURFACE},
    {PART(SLOT, "interface.domain", domain), .model = LAC_KIND_DOMAIN},
    {PART(SPREADS, "interface.spread", interface_spread), .varied = pressed},
    {RECORD("interface.geometry", "base whose dip and thickness follow the mean slip",
            lac_geometry_rows),
     .such = "{angle: \"30 degree\", radius: \"500 m\"}", .given = has_geometry,
     .read = lac_read_geometry, .put = lac_put_geometry},
    {RECORD("material", "the rock on both sides; no elasticity if absent", lac_material_rows),
     .fitted = true},
    {RECORD("inertia", "mass of the block that slides; none if absent", lac_inertia_rows),
     .given = has_inertia},
    {RECORD("load", "what presses and shears the interface", load_rows), .missing = NO_LOAD,
     .missing_at = "load.normal", .unless = ITS_WEIGHT, .given = lac_case_has_load},
    {PART(SLOT, "load.normal", normal), .model = LAC_KIND_NORMAL, .missing = NO_LOAD,
     .unless = ITS_WEIGHT},
    {PART(SLOTS, "load.shear", shear), .model = LAC_KIND_SHEAR},
    {PART(SLOTS, "load.pore_pressure", pore), .model = LAC_KIND_PORE},
    {PART(SLOTS, "load.normal_stress", pressing), .model = LAC_KIND_PRESSING},
    {RECORD("load.history", "a static history of normal and shear load, for `lacuna contact`",
            history_rows),
     .such = "{steps: [{ratio_x: 0.3}]}", .given = has_history},
    {OWN("load.history.steps"), .read = lac_read_steps, .put = lac_put_steps,
     .missing = "a list of steps such as [{ratio_x: 0.3}, {ratio_x: 0}]"},
    {PART(SLOT, "friction", friction), .model = LAC_KIND_FRICTION, .such = "spread",
     .missing = "a friction law such as {aging: {...}}", .of_runs = true},
    {PART(SPREADS, "friction.spread", friction_spread)},
    {PART(SLOTS, "weakening", weakening), .model = LAC_KIND_WEAKENING},
    {RECORD("initial", "slip rate and state at the start; steady under the load if absent",
            initial_rows),
     .fitted = true, .after = "transfer", .given = has_initial},
    {OWN("initial.state"), .after = "transfer", .read = lac_read_state, .put = lac_put_state},
    {PART(SPREADS, "initial.spread", initial_spread), .after = "transfer", .varied = started},
    {RECORD("initial.run", "a run to go on from", from_rows), .after = "transfer",
     .such = "{file: RUN.nc, at: \"30 day\"}", .given = has_from},
    {PART(SLOT, "transfer", transfer), .after = "solver", .model = LAC_KIND_TRANSFER},
    {RECORD("time", "start and end of the run", time_rows),
     .missing = "must be a time such as \"1 day\"", .missing_at = "time.end", .of_runs = true,
     .given = has_time, .put = lac_put_start},
    {OWN("time.start"), .read = lac_read_start},
    {RECORD("time.failure", "what counts as failure, which ends the run", failure_rows)},
    {RECORD("time.stop_when", "other limits that end the run", stop_rows), .given = has_stop},
    {RECORD("solver", "integration in time", solver_rows)},
    {RECORD("solver.lump", "with fidelity lumped", lac_lump_rows), .given = lac_case_lumps},
    {RECORD("output", "what is written", output_rows)},
    {PART(CADENCE, "output.every", run.record), .after = "output.checkpoint"},
    {PART(CADENCE, "output.checkpoint", run.checkpoint), .given = has_checkpoint},
    {OWN("output.fields"), .read = lac_read_fields, .given = has_fields, .put = lac_put_fields},
    {PART(CADENCE, "output.fields_every", run.snapshot), .read = lac_read_fields_every,
     .given = has_fields},
    {OWN("output.points"), .read = lac_read_points, .given = has_points, .put = lac_put_points},
    {RECORD("output.factor_of_safety", "strength at a slip rate over what drives", safety_rows),
     .such = "{reference_rate: \"1 um/s\"}", .given = has_safety, .read = lac_read_safety,
     .put = lac_put_safety},
    {RECORD("rg", "the cascade of slip and its renormalization (lacuna rg)", rg_rows),
     .such = "{rule: fix, beta: [0.8, 0.7, 0.6]}", .given = has_rg},
    {OWN("rg.beta"), .read = lac_read_betas, .put = lac_put_betas},
    {OWN("analysis"), .read = lac_read_analysis, .put = lac_put_analysis},
    {RECORD("fit", "what lacuna fit estimates, from which columns", fit_rows),
     .such = "{parameters: {...}, time: date, ...}", .given = has_fit, .put = lac_put_fitted},
    {OWN("fit.parameters"), .read = lac_read_fitted},
    {ITEMS("output.every", "how often something is kept; the tightest counts", cadence_rows)},
    {ITEMS("output.points", "a list of places at which the run is watched", point_rows)},
    {ITEMS("compare", "a list of monitoring series to lay beside the run", compare_rows),
     .read = lac_read_compare, .put = lac_put_compare},
    {ITEMS("load.history.steps", "a list; what a step does not name stays as it was",
           lac_step_rows)},
};

LAC_ROWS_AT(lac_part, lac_part_get, parts)

const lac_section *lac_section_get(size_t index)
{
    for (size_t i = 0; i < COUNT(parts); i++) {
        if (parts[i].info.params != NULL && index-- == 0) {
            return &parts[i].info;
        }
    }
    return NULL;
}

const char *lac_section_key(const lac_section *table, size_t index)
{
    for (size_t i = 1; table == &parts[0].info && i < COUNT(parts); i++) {
        if (strchr(parts[i].info.name, '.') == NULL && index-- == 0) {
            return parts[i].info.name;
        }
    }
    return NULL;
}

const lac_section *lac_section_find(const char *name)
{
    const lac_section *section = lac_section_get(0);
    for (size_t i = 1; strcmp(section->name, name) != 0; i++) {
        section = lac_section_get(i);
    }
    return section;
}

const lac_param *lac_case_row(const char *key)
{
    const lac_param *row = NULL;
    for (size_t i = 0; row == NULL && i < COUNT(parts); i++) {
        const lac_section *info = &parts[i].info;
        const char *rest =
            parts[i].kind == LAC_PART_RECORD ? lac_key_behind(key, info->name) : NULL;
        row = rest != NULL ? lac_param_find(info->params, info->param_count, rest) : NULL;
    }
    return row;
}
