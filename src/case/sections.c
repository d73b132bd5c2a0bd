// SPDX-License-Identifier: GPL-3.0-or-later
// What a case is made of: the rows of its keys and the table of its parts, which all walk.
#include "case/sections.h"

#include <math.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define FIELD(name) offsetof(lac_case, name)

static const char *const shapes[] = {"plane", "line", NULL};
static const char *const boundaries[] = {"periodic", "free", NULL};
static const char *const history_methods[] = {"direct", NULL};
static const char *const precisions[] = {"double", "float", NULL};
static const char *const history_fields[] = {"all", "last", "none", NULL};

const char *const lac_field_names[] = {"slip", "slip_rate", "state", "traction", NULL};

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
    LAC_INTEGER("levels", FIELD(interface.levels), NAN, 0, 12, LAC_OPTIONAL,
                "2^levels cells a side; a single block if 0, or if it and cells_x are absent"),
    LAC_INTEGER("cells_x", FIELD(interface.cells_x), NAN, 1, LAC_MOST_CELLS, LAC_OPTIONAL,
                "cells along x, instead of levels; products of 2, 3 and 5 are fast"),
    LAC_INTEGER("cells_y", FIELD(interface.cells_y), NAN, 1, LAC_MOST_CELLS, LAC_OPTIONAL,
                "cells along y, with cells_x; as many as along x if absent, one on a line"),
    LAC_CHOICE("shape", FIELD(interface.shape), LAC_PLANE, shapes, 0, "of the interface"),
    LAC_CHOICE("boundary", FIELD(interface.boundary), LAC_PERIODIC, boundaries, 0,
               "periodic, or free: the faces end at the border, the rock goes on"),
    LAC_OWN("surface", "{MODEL: {...}}: heights to press"),
    LAC_OWN("domain", "{MODEL: {...}}: contact cells, instead of a surface"),
    LAC_OWN("spread", "{pressure: {MODEL: {...}}}: over the cells of a domain"),
};

const lac_param lac_material_rows[LAC_MATERIAL_ROWS] = {
    LAC_REAL("shear_modulus", "Pa", FIELD(material.shear_modulus), NAN, 0, 1e15,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "of the rock; needed by a surface, by elastic transfer and by radiation damping"),
    LAC_REAL("poisson", "1", FIELD(material.poisson), 0.25, 0, 0.4999, 0, "Poisson's ratio"),
    LAC_REAL("shear_speed", "m/s", FIELD(material.shear_speed), NAN, 0, 1e5,
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
    LAC_OWN("history", "{steps: [...], ...}: a static history for `lacuna contact`"),
};

static const lac_param history_rows[] = {
    LAC_CHOICE("method", FIELD(history.method), 0, history_methods, 0,
               "direct: any history, exact; the only one"),
    LAC_COULOMB_ROW(FIELD(history.friction)),
    LAC_CHOICE("fields", FIELD(history.fields), LAC_HISTORY_ALL, history_fields, 0,
               "steps whose tractions, slips and states are written cell by cell"),
    LAC_OWN("steps", "[{...}, ...]: each goes on from the one before; must be given"),
};

#define STEP(name) offsetof(lac_history_step, name)

static const lac_param step_rows[] = {
    LAC_REAL("pressure", "Pa", STEP(pressure), NAN, 0, 1e15, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "mean normal stress over the nominal area; as before if absent"),
    LAC_REAL("ratio_x", "1", STEP(ratio[0]), NAN, -1, 1, LAC_OPTIONAL,
             "shear load along x as part of f P, what friction holds; of ratio, shear and shift at "
             "most one along each axis"),
    LAC_REAL("ratio_y", "1", STEP(ratio[1]), NAN, -1, 1, LAC_OPTIONAL, "the same along y"),
    LAC_REAL("shear_x", "Pa", STEP(shear[0]), NAN, -1e15, 1e15, LAC_OPTIONAL,
             "mean shear traction along x over the nominal area"),
    LAC_REAL("shear_y", "Pa", STEP(shear[1]), NAN, -1e15, 1e15, LAC_OPTIONAL, "the same along y"),
    LAC_REAL("shift_x", "m", STEP(shift[0]), NAN, -1e9, 1e9, LAC_OPTIONAL,
             "shift of one body against the other along x since the start"),
    LAC_REAL("shift_y", "m", STEP(shift[1]), NAN, -1e9, 1e9, LAC_OPTIONAL, "the same along y"),
    LAC_INTEGER("count", STEP(count), 1, 1, 10000, 0,
                "equal increments from the state before, each a step of the output"),
};

static const lac_param initial_rows[] = {
    LAC_REAL("slip_rate", "m/s", FIELD(initial.slip_rate), NAN, 0, 1e3,
             LAC_OPTIONAL | LAC_ABOVE_MIN, "at the start; follows from load and state if absent"),
    LAC_OWN("state", "steady, a time, or {ratio_to_steady: x}; follows from load and slip rate if "
                     "absent, steady where neither is given"),
    LAC_OWN("spread", "{slip_rate: {MODEL: {...}}, state: {...}}: from cell to cell"),
};

static const lac_param time_rows[] = {
    LAC_OWN("start", "of the run: a date (ISO 8601) or a time; 0 s if absent"),
    LAC_REAL("end", "s", FIELD(run.end), NAN, 1e-9, 1e15, 0, "of the run, since its start"),
    LAC_OWN("failure",
            "{mean_slip_rate: ..., mean_slip: ...}: what counts as failure, the first of them"),
    LAC_OWN("stop_when", "{mean_slip: ..., max_slip_rate: ...}: other limits"),
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
};

static const lac_param output_rows[] = {
    LAC_TEXT("file", FIELD(output_file), LAC_OPTIONAL,
             "to write, from the folder one works in; named after the case if absent"),
    LAC_OWN("every", "how often a line of the time series is kept: a time, {steps: N}, "
                     "{per_decade: N} of the mean slip rate; each step if absent"),
    LAC_OWN("fields", "of every cell to keep: [slip, slip_rate, state, traction]"),
    LAC_OWN("fields_every", "how often the fields are kept, as `every`; once per decade of the "
                            "mean slip rate if absent"),
    LAC_OWN("checkpoint", "how often the run saves what --resume goes on from, as `every`; only "
                          "when a signal ends it if absent"),
    LAC_INTEGER("compression", FIELD(compression), 1, 0, 9, 0, "deflate level of the fields"),
    LAC_CHOICE("precision", FIELD(single), 0, precisions, 0,
               "of records and fields but times; a float has seven digits, takes half the space "
               "and holds nothing below 1e-38"),
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

static const lac_param compare_rows[] = {
    LAC_PATH("file", offsetof(lac_compare_def, path), 0,
             "monitoring series (CSV), from the case's folder"),
    LAC_TEXT("time", offsetof(lac_compare_def, time), 0, "its column of times"),
    LAC_OWN("displacement", "its column of displacements, as \"column:unit\""),
    LAC_OWN("velocity", "its column of velocities, as \"column:unit\""),
    LAC_TEXT("label", offsetof(lac_compare_def, label), LAC_OPTIONAL, "what to call it"),
};

static bool has_inertia(const lac_case *c) { return lac_inertia_mass(c) > 0.0; }

static bool has_history(const lac_case *c) { return c->history.count > 0; }

// A static case names no time, and neither a law nor a start.
static bool has_time(const lac_case *c) { return !isnan(c->run.end); }

static bool has_initial(const lac_case *c)
{
    return c->friction.about != NULL || c->initial.state != LAC_STATE_STEADY ||
           !isnan(c->initial.slip_rate) || c->initial_spread.count > 0;
}

static bool has_stop(const lac_case *c)
{
    return !isnan(c->run.stop_slip) || !isnan(c->run.stop_rate);
}

static bool has_checkpoint(const lac_case *c)
{
    const lac_cadence *save = &c->run.checkpoint;
    return !isnan(save->time) || save->steps > 0 || !isnan(save->per_decade);
}

static bool has_fields(const lac_case *c) { return c->fields != 0; }

static bool has_rg(const lac_case *c) { return c->rg.named; }

static bool has_fit(const lac_case *c) { return c->fit.named; }

#define RECORD(key, text, rows) .about = {key, text, "", rows, COUNT(rows)}
#define ITEMS(key, text, rows) RECORD(key, text, rows), .kind = LAC_PART_ITEMS
#define OWN(key) .about.name = (key), .kind = LAC_PART_OWN
#define PART(what, key, member) .about.name = (key), .kind = LAC_PART_##what, .at = FIELD(member)
#define COLUMN(key, member, si) \
    PART(COLUMN, key, member), .unit_at = FIELD(member##_unit), .such = (si)

static const lac_part parts[] = {
    {RECORD("case", "the case as a whole", case_rows), .read = lac_read_version},
    {RECORD("interface", "the interface and its cells", interface_rows), .fitted = true},
    {PART(SLOT, "interface.surface", surface), .model = LAC_KIND_SURFACE},
    {PART(SLOT, "interface.domain", domain), .model = LAC_KIND_DOMAIN},
    {PART(SPREADS, "interface.spread", interface_spread), .read = lac_read_interface_spread},
    {RECORD("material", "the rock on both sides; no elasticity if absent", lac_material_rows),
     .fitted = true},
    {RECORD("inertia", "mass of the block that slides; none if absent", lac_inertia_rows),
     .given = has_inertia},
    {RECORD("load", "what presses and shears the interface", load_rows), .read = lac_read_load},
    {PART(SLOT, "load.normal", normal), .model = LAC_KIND_NORMAL},
    {PART(SLOTS, "load.shear", shear), .model = LAC_KIND_SHEAR},
    {PART(SLOTS, "load.pore_pressure", pore), .model = LAC_KIND_PORE},
    {RECORD("load.history", "a static history of normal and shear load, for `lacuna contact`",
            history_rows),
     .such = "{steps: [{ratio_x: 0.3}]}", .read = lac_read_history, .given = has_history},
    {OWN("load.history.steps"), .read = lac_read_steps, .put = lac_put_steps},
    {PART(SLOT, "friction", friction), .model = LAC_KIND_FRICTION, .such = "spread",
     .read = lac_read_friction},
    {PART(SPREADS, "friction.spread", friction_spread), .read = lac_read_friction_spread},
    {RECORD("initial", "slip rate and state at the start; steady under the load if absent",
            initial_rows),
     .fitted = true, .after = "transfer", .read = lac_read_initial, .given = has_initial},
    {OWN("initial.state"), .after = "transfer", .read = lac_read_state, .put = lac_put_state},
    {PART(SPREADS, "initial.spread", initial_spread), .after = "transfer",
     .read = lac_read_initial_spread},
    {PART(SLOT, "transfer", transfer), .after = "solver", .model = LAC_KIND_TRANSFER},
    {RECORD("time", "start and end of the run", time_rows), .read = lac_read_time,
     .given = has_time, .put = lac_put_start},
    {OWN("time.start"), .read = lac_read_start},
    {RECORD("time.failure", "what counts as failure, which ends the run", failure_rows)},
    {RECORD("time.stop_when", "other limits that end the run", stop_rows), .given = has_stop},
    {RECORD("solver", "integration in time", lac_solver_rows)},
    {RECORD("output", "what is written", output_rows)},
    {PART(CADENCE, "output.every", run.record), .after = "output.checkpoint"},
    {PART(CADENCE, "output.checkpoint", run.checkpoint), .given = has_checkpoint},
    {OWN("output.fields"), .read = lac_read_fields, .given = has_fields, .put = lac_put_fields},
    {PART(CADENCE, "output.fields_every", run.snapshot), .read = lac_read_fields_every,
     .given = has_fields},
    {RECORD("rg", "the cascade of slip and its renormalization (lacuna rg)", lac_rg_rows),
     .such = "{rule: fix, beta: [0.8, 0.7, 0.6]}", .read = lac_read_rg, .given = has_rg},
    {OWN("rg.beta"), .read = lac_read_betas, .put = lac_put_betas},
    {OWN("analysis"), .read = lac_read_analysis, .put = lac_put_analysis},
    {RECORD("fit", "what lacuna fit estimates, from which columns", lac_fit_rows),
     .such = "{parameters: {...}, time: date, ...}", .read = lac_read_fit, .given = has_fit,
     .put = lac_put_fitted},
    {COLUMN("fit.displacement", fit.displacement, "m")},
    {COLUMN("fit.velocity", fit.velocity, "m/s")},
    {COLUMN("fit.sigma", fit.sigma, "m")},
    {OWN("fit.parameters"), .read = lac_read_fitted},
    {ITEMS("output.every", "how often something is kept; the tightest counts", cadence_rows)},
    {ITEMS("compare", "a list of monitoring series to lay beside the run", compare_rows),
     .read = lac_read_compare, .put = lac_put_compare},
    {ITEMS("load.history.steps", "a list; what a step does not name stays as it was", step_rows)},
};

const lac_part *lac_part_at(size_t index) { return index < COUNT(parts) ? &parts[index] : NULL; }

const lac_section *lac_section_at(size_t index)
{
    for (size_t i = 0; i < COUNT(parts); i++) {
        if (parts[i].about.params != NULL && index-- == 0) {
            return &parts[i].about;
        }
    }
    return NULL;
}

const char *lac_section_key(size_t index)
{
    for (size_t i = 1; i < COUNT(parts); i++) {
        if (strchr(parts[i].about.name, '.') == NULL && index-- == 0) {
            return parts[i].about.name;
        }
    }
    return NULL;
}

lac_table lac_section_table(const char *name)
{
    const lac_section *section = lac_section_at(0);
    for (size_t i = 1; strcmp(section->name, name) != 0; i++) {
        section = lac_section_at(i);
    }
    return lac_part_table(section);
}

lac_table lac_part_table(const lac_section *about)
{
    return (lac_table){
        .params = about->params, .count = about->param_count, .sections = about == &parts[0].about};
}
