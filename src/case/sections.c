// SPDX-License-Identifier: GPL-3.0-or-later
#include "case/sections.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define FIELD(name) offsetof(lac_case, name)

static const char *const shapes[] = {"plane", "line", NULL};
static const char *const boundaries[] = {"periodic", "free", NULL};
static const char *const history_methods[] = {"direct", "superposed", NULL};
static const char *const precisions[] = {"double", "float", NULL};
static const char *const history_fields[] = {"all", "last", "none", NULL};

const char *const lac_field_names[] = {"slip", "slip_rate", "state", "traction", NULL};

static const lac_param case_rows[] = {
    LAC_OWN("lacuna", "version of the format: 1"),
    LAC_TEXT("title", FIELD(title), LAC_OPTIONAL, "what the case is, for the output"),
    LAC_TEXT("references", FIELD(references), LAC_OPTIONAL, "what to cite"),
    LAC_TEXT("institution", FIELD(institution), LAC_OPTIONAL, "who runs it"),
};

static const char *const case_own[] = {
    "lacuna", "interface", "material", "inertia", "load",     "friction", "initial", "transfer",
    "time",   "solver",    "output",   "rg",      "analysis", "fit",      "compare", NULL};

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

static const char *const interface_own[] = {"surface", "domain", "spread", NULL};

const lac_param lac_material_rows[] = {
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

static const char *const load_own[] = {"normal", "shear", "pore_pressure", "history", NULL};

static const lac_param history_rows[] = {
    LAC_CHOICE("method", FIELD(history.method), LAC_HISTORY_DIRECT, history_methods, 0,
               "direct: any history, exact; superposed: shear that only grows, in one direction, "
               "at constant pressure, by superposition of normal loads"),
    LAC_COULOMB_ROW(FIELD(history.friction)),
    LAC_CHOICE("fields", FIELD(history.fields), LAC_HISTORY_ALL, history_fields, 0,
               "steps whose tractions, slips and states are written cell by cell"),
    LAC_OWN("steps", "[{...}, ...]: each goes on from the one before; must be given"),
};

static const char *const history_own[] = {"steps", NULL};

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

static const char *const initial_own[] = {"state", "spread", NULL};

static const lac_param time_rows[] = {
    LAC_OWN("start", "of the run: a date (ISO 8601) or a time; 0 s if absent"),
    LAC_REAL("end", "s", FIELD(run.end), NAN, 1e-9, 1e15, 0, "of the run, since its start"),
    LAC_OWN("failure",
            "{mean_slip_rate: ..., mean_slip: ...}: what counts as failure, the first of them"),
    LAC_OWN("stop_when", "{mean_slip: ..., max_slip_rate: ...}: other limits"),
};

static const char *const time_own[] = {"start", "failure", "stop_when", NULL};

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

static const char *const output_own[] = {"every", "fields", "fields_every", "checkpoint", NULL};

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

static const char *const compare_own[] = {"displacement", "velocity", NULL};

static const struct {
    lac_section about;
    const char *const *own;
} sections[] = {
    [LAC_SECTION_CASE] = {{"case", "the case as a whole", case_rows, COUNT(case_rows)}, case_own},
    [LAC_SECTION_INTERFACE] = {{"interface", "the interface and its cells", interface_rows,
                                COUNT(interface_rows)},
                               interface_own},
    [LAC_SECTION_MATERIAL] = {{"material", "the rock on both sides; no elasticity if absent",
                               lac_material_rows, COUNT(lac_material_rows)},
                              NULL},
    [LAC_SECTION_INERTIA] = {{"inertia", "mass of the block that slides; none if absent",
                              lac_inertia_rows, LAC_INERTIA_ROWS},
                             NULL},
    [LAC_SECTION_LOAD] = {{"load", "what presses and shears the interface", load_rows,
                           COUNT(load_rows)},
                          load_own},
    [LAC_SECTION_HISTORY] = {{"load.history",
                              "a static history of normal and shear load, for `lacuna contact`",
                              history_rows, COUNT(history_rows)},
                             history_own},
    [LAC_SECTION_INITIAL] = {{"initial",
                              "slip rate and state at the start; steady under the load "
                              "if absent",
                              initial_rows, COUNT(initial_rows)},
                             initial_own},
    [LAC_SECTION_TIME] = {{"time", "start and end of the run", time_rows, COUNT(time_rows)},
                          time_own},
    [LAC_SECTION_FAILURE] = {{"time.failure", "what counts as failure, which ends the run",
                              failure_rows, COUNT(failure_rows)},
                             NULL},
    [LAC_SECTION_STOP] = {{"time.stop_when", "other limits that end the run", stop_rows,
                           COUNT(stop_rows)},
                          NULL},
    [LAC_SECTION_SOLVER] = {{"solver", "integration in time", lac_solver_rows, LAC_SOLVER_ROWS},
                            NULL},
    [LAC_SECTION_OUTPUT] = {{"output", "what is written", output_rows, COUNT(output_rows)},
                            output_own},
    [LAC_SECTION_RG] = {{"rg", "the cascade of slip and its renormalization (lacuna rg)",
                         lac_rg_rows, LAC_RG_ROWS},
                        lac_rg_own},
    [LAC_SECTION_FIT] = {{"fit", "what lacuna fit estimates, from which columns", lac_fit_rows,
                          LAC_FIT_ROWS},
                         lac_fit_own},
    [LAC_SECTION_CADENCE] = {{"output.every", "how often something is kept; the tightest counts",
                              cadence_rows, COUNT(cadence_rows)},
                             NULL},
    [LAC_SECTION_COMPARE] = {{"compare", "a list of monitoring series to lay beside the run",
                              compare_rows, COUNT(compare_rows)},
                             compare_own},
    [LAC_SECTION_STEP] = {{"load.history.steps",
                           "a list; what a step does not name stays as it was", step_rows,
                           COUNT(step_rows)},
                          NULL},
};

const lac_section *lac_section_at(size_t index)
{
    return index < COUNT(sections) ? &sections[index].about : NULL;
}

lac_table lac_section_table(int section)
{
    return (lac_table){.params = sections[section].about.params,
                       .count = sections[section].about.param_count,
                       .own = sections[section].own};
}
