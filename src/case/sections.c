// SPDX-License-Identifier: GPL-3.0-or-later
#include "case/sections.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define FIELD(name) offsetof(lac_case, name)

// Rows that are only described here: the reader has a function for them.
#define OWN .type = LAC_TEXT, .flags = LAC_OPTIONAL, .fallback = NAN, .unit = "1"
#define TEXT .type = LAC_TEXT, .flags = LAC_OPTIONAL, .fallback = NAN, .unit = "1"

static const char *const shapes[] = {"plane", "line", NULL};
static const char *const boundaries[] = {"periodic", "free", NULL};
static const char *const precisions[] = {"double", "float", NULL};
static const char *const history_fields[] = {"all", "last", "none", NULL};

const char *const lac_field_names[] = {"slip", "slip_rate", "state", "traction", NULL};

static const lac_param case_rows[] = {
    {.key = "lacuna", .doc = "version of the format: 1", OWN},
    {.key = "title", .doc = "what the case is, for the output", .offset = FIELD(title), TEXT},
    {.key = "references", .doc = "what to cite", .offset = FIELD(references), TEXT},
    {.key = "institution", .doc = "who runs it", .offset = FIELD(institution), TEXT},
};

static const char *const case_own[] = {
    "lacuna", "interface", "material", "inertia", "load",     "friction", "initial", "transfer",
    "time",   "solver",    "output",   "rg",      "analysis", "fit",      "compare", NULL};

static const lac_param interface_rows[] = {
    {.key = "size",
     .unit = "m",
     .fallback = NAN,
     .min = 0,
     .max = 1e9,
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN,
     .offset = FIELD(interface.size),
     .doc = "length along x, the direction of slip; may be absent (1 m) only for a single block"},
    {.key = "width",
     .unit = "m",
     .fallback = NAN,
     .min = 0,
     .max = 1e9,
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN,
     .offset = FIELD(interface.width),
     .doc = "length along y; that of square cells if absent"},
    {.key = "levels",
     .unit = "1",
     .fallback = NAN,
     .min = 0,
     .max = 12,
     .type = LAC_INTEGER,
     .flags = LAC_OPTIONAL,
     .offset = FIELD(interface.levels),
     .doc = "2^levels cells a side; a single block if 0, or if it and cells_x are absent"},
    {.key = "cells_x",
     .unit = "1",
     .fallback = NAN,
     .min = 1,
     .max = 16777216,
     .type = LAC_INTEGER,
     .flags = LAC_OPTIONAL,
     .offset = FIELD(interface.cells_x),
     .doc = "cells along x, instead of levels; products of 2, 3 and 5 are fast"},
    {.key = "cells_y",
     .unit = "1",
     .fallback = NAN,
     .min = 1,
     .max = 16777216,
     .type = LAC_INTEGER,
     .flags = LAC_OPTIONAL,
     .offset = FIELD(interface.cells_y),
     .doc = "cells along y, with cells_x; as many as along x if absent, one on a line"},
    {.key = "shape",
     .unit = "1",
     .fallback = LAC_PLANE,
     .type = LAC_CHOICE,
     .choices = shapes,
     .offset = FIELD(interface.shape),
     .doc = "of the interface"},
    {.key = "boundary",
     .unit = "1",
     .fallback = LAC_PERIODIC,
     .type = LAC_CHOICE,
     .choices = boundaries,
     .offset = FIELD(interface.boundary),
     .doc = "periodic, or free: the faces end at the border, the rock goes on"},
    {.key = "surface", .doc = "{MODEL: {...}}: heights to press", OWN},
    {.key = "domain", .doc = "{MODEL: {...}}: contact cells, instead of a surface", OWN},
    {.key = "spread", .doc = "{pressure: {MODEL: {...}}}: over the cells of a domain", OWN},
};

static const char *const interface_own[] = {"surface", "domain", "spread", NULL};

const lac_param lac_material_rows[] = {
    {.key = "shear_modulus",
     .unit = "Pa",
     .fallback = NAN,
     .min = 0,
     .max = 1e15,
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN,
     .offset = FIELD(material.shear_modulus),
     .doc = "of the rock; needed by a surface, by elastic transfer and by radiation damping"},
    {.key = "poisson",
     .unit = "1",
     .fallback = 0.25,
     .min = 0,
     .max = 0.4999,
     .offset = FIELD(material.poisson),
     .doc = "Poisson's ratio"},
    {.key = "shear_speed",
     .unit = "m/s",
     .fallback = NAN,
     .min = 0,
     .max = 1e5,
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN,
     .offset = FIELD(material.shear_speed),
     .doc = "of shear waves, for radiation damping; if absent it follows from the density; no "
            "damping without either"},
    {.key = "density",
     .unit = "kg/m3",
     .fallback = NAN,
     .min = 0,
     .max = 1e6,
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN,
     .offset = FIELD(material.density),
     .doc = "of the rock; needed by the loads depth and slope"},
};

static const lac_param load_rows[] = {
    {.key = "normal", .doc = "{MODEL: {...}}: total normal stress; must be given", OWN},
    {.key = "shear", .doc = "[{MODEL: {...}}, ...]: shear loads, which add up", OWN},
    {.key = "pore_pressure", .doc = "[{MODEL: {...}}, ...]: pore pressures, which add up", OWN},
    {.key = "history", .doc = "{steps: [...], ...}: a static history for `lacuna contact`", OWN},
};

static const char *const load_own[] = {"normal", "shear", "pore_pressure", "history", NULL};

static const lac_param history_rows[] = {
    {.key = "friction",
     .unit = "1",
     .fallback = NAN,
     .min = 0,
     .max = 1000,
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN,
     .offset = FIELD(history.friction),
     .doc = "Coulomb's coefficient f; f0 of the friction law if absent"},
    {.key = "fields",
     .unit = "1",
     .fallback = LAC_HISTORY_ALL,
     .type = LAC_CHOICE,
     .choices = history_fields,
     .offset = FIELD(history.fields),
     .doc = "steps whose tractions, slips and states are written cell by cell"},
    {.key = "steps", .doc = "[{...}, ...]: each goes on from the one before; must be given", OWN},
};

static const char *const history_own[] = {"steps", NULL};

#define STEP(name) offsetof(lac_history_step, name)
#define KEPT .fallback = NAN, .flags = LAC_OPTIONAL

static const lac_param step_rows[] = {
    {.key = "pressure",
     .unit = "Pa",
     .min = 0,
     .max = 1e15,
     .fallback = NAN,
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN,
     .offset = STEP(pressure),
     .doc = "mean normal stress over the nominal area; as before if absent"},
    {.key = "ratio_x",
     .unit = "1",
     .min = -1,
     .max = 1,
     .offset = STEP(ratio[0]),
     .doc = "shear load along x as part of f P, what friction holds; of ratio, shear and shift "
            "at most one along each axis",
     KEPT},
    {.key = "ratio_y",
     .unit = "1",
     .min = -1,
     .max = 1,
     .offset = STEP(ratio[1]),
     .doc = "the same along y",
     KEPT},
    {.key = "shear_x",
     .unit = "Pa",
     .min = -1e15,
     .max = 1e15,
     .offset = STEP(shear[0]),
     .doc = "mean shear traction along x over the nominal area",
     KEPT},
    {.key = "shear_y",
     .unit = "Pa",
     .min = -1e15,
     .max = 1e15,
     .offset = STEP(shear[1]),
     .doc = "the same along y",
     KEPT},
    {.key = "shift_x",
     .unit = "m",
     .min = -1e9,
     .max = 1e9,
     .offset = STEP(shift[0]),
     .doc = "shift of one body against the other along x since the start",
     KEPT},
    {.key = "shift_y",
     .unit = "m",
     .min = -1e9,
     .max = 1e9,
     .offset = STEP(shift[1]),
     .doc = "the same along y",
     KEPT},
    {.key = "count",
     .unit = "1",
     .fallback = 1,
     .min = 1,
     .max = 10000,
     .type = LAC_INTEGER,
     .offset = STEP(count),
     .doc = "equal increments from the state before, each a step of the output"},
};

static const lac_param initial_rows[] = {
    {.key = "slip_rate",
     .unit = "m/s",
     .fallback = NAN,
     .min = 0,
     .max = 1e3,
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN,
     .offset = FIELD(initial.slip_rate),
     .doc = "at the start; follows from load and state if absent"},
    {.key = "state",
     .doc = "steady, a time, or {ratio_to_steady: x}; follows from load and slip rate if absent, "
            "steady where neither is given",
     OWN},
    {.key = "spread", .doc = "{slip_rate: {MODEL: {...}}, state: {...}}: from cell to cell", OWN},
};

static const char *const initial_own[] = {"state", "spread", NULL};

static const lac_param time_rows[] = {
    {.key = "start", .doc = "of the run: a date (ISO 8601) or a time; 0 s if absent", OWN},
    {.key = "end",
     .unit = "s",
     .fallback = NAN,
     .min = 1e-9,
     .max = 1e15,
     .offset = FIELD(run.end),
     .doc = "of the run, since its start"},
    {.key = "failure",
     .doc = "{mean_slip_rate: ..., mean_slip: ...}: what counts as failure, the first of them",
     OWN},
    {.key = "stop_when", .doc = "{mean_slip: ..., max_slip_rate: ...}: other limits", OWN},
};

static const char *const time_own[] = {"start", "failure", "stop_when", NULL};

static const lac_param failure_rows[] = {
    {.key = "mean_slip_rate",
     .unit = "m/s",
     .fallback = 1.0,
     .min = 0,
     .max = 1e4,
     .flags = LAC_ABOVE_MIN,
     .offset = FIELD(run.failure_rate),
     .doc = "mean over the contact cells whose first upward crossing is failure; where damping "
            "holds the joint below it, a p/eta counts instead, judged by all cells as one; "
            "from 1 km/s on none does"},
    {.key = "mean_slip",
     .unit = "m",
     .fallback = NAN,
     .min = 0,
     .max = 1e9,
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN,
     .offset = FIELD(run.failure_slip),
     .doc = "mean slip that is failure; if absent the interface's size, of one block 10 m"},
};

static const lac_param stop_rows[] = {
    {.key = "mean_slip",
     .unit = "m",
     .fallback = NAN,
     .min = 0,
     .max = 1e9,
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN,
     .offset = FIELD(run.stop_slip),
     .doc = "mean slip at which the run ends"},
    {.key = "max_slip_rate",
     .unit = "m/s",
     .fallback = NAN,
     .min = 0,
     .max = 1e4,
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN,
     .offset = FIELD(run.stop_rate),
     .doc = "slip rate of any cell at which the run ends"},
};

static const lac_param output_rows[] = {
    {.key = "file",
     .doc = "to write, from the folder one works in; named after the case if absent",
     .offset = FIELD(output_file),
     TEXT},
    {.key = "every",
     .doc = "how often a line of the time series is kept: a time, {steps: N}, {per_decade: N} of "
            "the mean slip rate; each step if absent",
     OWN},
    {.key = "fields", .doc = "of every cell to keep: [slip, slip_rate, state, traction]", OWN},
    {.key = "fields_every",
     .doc = "how often the fields are kept, as `every`; once per decade of the mean slip rate if "
            "absent",
     OWN},
    {.key = "checkpoint",
     .doc = "how often the run saves what --resume goes on from, as `every`; only when a signal "
            "ends it if absent",
     OWN},
    {.key = "compression",
     .unit = "1",
     .fallback = 1,
     .min = 0,
     .max = 9,
     .type = LAC_INTEGER,
     .offset = FIELD(compression),
     .doc = "deflate level of the fields"},
    {.key = "precision",
     .unit = "1",
     .fallback = 0,
     .type = LAC_CHOICE,
     .choices = precisions,
     .offset = FIELD(single),
     .doc = "of records and fields but times; a float has seven digits, takes half the space and "
            "holds nothing below 1e-38"},
};

static const char *const output_own[] = {"every", "fields", "fields_every", "checkpoint", NULL};

static const lac_param cadence_rows[] = {
    {.key = "time",
     .unit = "s",
     .fallback = NAN,
     .min = 0,
     .max = 1e15,
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN,
     .offset = offsetof(lac_cadence, time),
     .doc = "between two records"},
    {.key = "steps",
     .unit = "1",
     .fallback = 0,
     .min = 0,
     .max = 1e12,
     .type = LAC_INTEGER,
     .offset = offsetof(lac_cadence, steps),
     .doc = "of the integrator between two records, sweeps of four updates a cell with fidelity "
            "events; 0: not by steps"},
    {.key = "per_decade",
     .unit = "1",
     .fallback = NAN,
     .min = 0,
     .max = 1e6,
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN,
     .offset = offsetof(lac_cadence, per_decade),
     .doc = "records per decade of the mean slip rate"},
};

static const lac_param compare_rows[] = {
    {.key = "file",
     .unit = "1",
     .fallback = NAN,
     .type = LAC_PATH,
     .offset = offsetof(lac_compare_def, path),
     .doc = "monitoring series (CSV), from the case's folder"},
    {.key = "time",
     .unit = "1",
     .fallback = NAN,
     .type = LAC_TEXT,
     .offset = offsetof(lac_compare_def, time),
     .doc = "its column of times"},
    {.key = "displacement", .doc = "its column of displacements, as \"column:unit\"", OWN},
    {.key = "velocity", .doc = "its column of velocities, as \"column:unit\"", OWN},
    {.key = "label", .doc = "what to call it", .offset = offsetof(lac_compare_def, label), TEXT},
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
