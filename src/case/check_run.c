// SPDX-License-Identifier: GPL-3.0-or-later
// What a run by some fidelity, of slip in two directions or with some cadence does not go with.
// Classes of cells stand for what each cell does by itself only where all slip together:
// docs/theory/lumped.md.
#include "case/sections.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define NEEDS "needs interface.slip: vector"
#define ALONG_X "knows slip along x only: leave out interface.slip: vector"
#define OF_ODE "goes with fidelity ode, not with events"

const lac_param lac_lump_rows[LAC_LUMP_ROWS] = {
    LAC_INTEGER("level", offsetof(lac_case, lump.level), NAN, 0, 31, LAC_OPTIONAL | LAC_OPEN,
                "blocks of 2^level cells a side are taken together; auto or absent: as coarse as "
                "the scene allows"),
    LAC_INTEGER("nodes", offsetof(lac_case, lump.nodes), NAN, 2, 40, LAC_OPTIONAL | LAC_OPEN,
                "cells that stay of a block, at most; auto or absent: as many as the error needs"),
    LAC_REAL("error", "1", offsetof(lac_case, lump.error), 0.01, 2e-5, 0.5, 0,
             "relative error of the time of failure, or of the mean slip where nothing fails, that "
             "taking cells together may cause; beyond it the run ends without a result"),
};

const char *const lac_slip_names[] = {"scalar", "vector", NULL};

// What may be wrong: which key is to blame, and why.
typedef struct refusal {
    bool wrong;
    const char *key, *why;
} refusal;

static void refuse_all(lac_reader *reader, size_t count, const refusal *list)
{
    for (size_t i = 0; i < count; i++) {
        (void)lac_refuse(reader, list[i].wrong, list[i].key, "%s", list[i].why);
    }
}

enum { REFUSALS = 9 };

// Cells at steps of their own have one formulation and no method to choose.
// @return which key of the case bars them, the first; NULL: none
static const char *list_events(const lac_case *c, refusal out[REFUSALS])
{
    static const char *const other[REFUSALS] = {"inertia",           NULL, NULL, NULL, NULL, NULL,
                                                "interface.geometry"};
    const refusal list[REFUSALS] = {
        {lac_inertia_mass(c) > 0, "solver.fidelity", "knows no inertia: leave one of them out"},
        {c->formulation_given && c->formulation != LAC_FORMULATION_RATE, "solver.formulation",
         "must be auto or rate with fidelity events"},
        {c->run.method != LAC_BDF, "solver.method", OF_ODE},
        {c->run.max_order != 0, "solver.max_order", OF_ODE},
        {!isnan(c->run.first_step), "solver.first_step", OF_ODE},
        {!isnan(c->run.stop_safety), "time.stop_when.factor_of_safety", OF_ODE},
        {c->geometry.angles > 0, "solver.fidelity",
         "knows no interface.geometry: leave one of them out"},
        {c->weakening.count > 0, "weakening", OF_ODE},
    };
    size_t i = 0;
    memcpy(out, list, sizeof list);
    while (i < REFUSALS && !list[i].wrong) {
        i++;
    }
    return i == REFUSALS ? NULL : other[i] != NULL ? other[i] : list[i].key;
}

const char *lac_case_bars_events(const lac_case *c)
{
    refusal list[REFUSALS];
    return list_events(c, list);
}

void lac_check_events(lac_reader *reader, lac_case *c)
{
    refusal list[REFUSALS];
    (void)list_events(c, list);
    refuse_all(reader, lac_clean(reader, "solver") ? REFUSALS : 0, list);
    c->formulation = LAC_FORMULATION_RATE;
}

bool lac_case_lumps(const lac_case *c) { return c->run.fidelity == LAC_FIDELITY_LUMPED; }

// @return whether the case asks for none of them
static bool list_lumped(const lac_case *c, refusal out[REFUSALS])
{
    const lac_transfer_kind *transfer = (const void *)c->transfer.info;
    const lac_grid grid = lac_interface_grid(&c->interface);
    const refusal list[REFUSALS] = {
        {lac_grid_cells(&grid) > 1 && (transfer == NULL || transfer->blocks == NULL),
         "solver.fidelity",
         "lumped needs transfer: {hierarchy: {...}}: how stiffly cells hold one another, level by "
         "level, says how far they slip apart"},
        {c->slip == LAC_SLIP_VECTOR, "solver.fidelity", "lumped " ALONG_X},
        {lac_inertia_mass(c) > 0.0, "solver.fidelity",
         "lumped knows no inertia: leave one of them out"},
        {c->weakening.count > 0, "solver.fidelity",
         "lumped knows no weakening, which changes each cell by its own pressure: leave one of "
         "them out"},
        {c->analysis.count > 0, "analysis",
         "is of cells that slip by themselves, which fidelity lumped does not follow: take ode or "
         "events"},
        {c->points > 0, "output.points",
         "are single cells, of which fidelity lumped keeps few: leave them out, as all slip by the "
         "mean, or take ode"},
        {c->from.file != NULL, "initial.run",
         "gives each cell a state of its own, which fidelity lumped does not keep: take ode"},
        {!isnan(c->run.stop_rate), "time.stop_when.max_slip_rate",
         "is of single cells, of which fidelity lumped keeps few: take mean_slip, or fidelity ode"},
        {lac_case_left_to_rounding(c), "solver.fidelity",
         "cannot tell how far off it is: the case starts steady with b > a and no load changes, "
         "so rounding decides what it does"},
    };
    bool any = false;
    memcpy(out, list, sizeof list);
    for (size_t i = 0; i < REFUSALS; i++) {
        any = any || list[i].wrong;
    }
    return !any;
}

bool lac_case_admits_lumped(const lac_case *c)
{
    refusal list[REFUSALS];
    return list_lumped(c, list);
}

void lac_check_lumped(lac_reader *reader, const lac_case *c)
{
    const bool clean = lac_clean(reader, "interface") && lac_clean(reader, "transfer");
    const lac_node *lump = lac_node_at(reader->root, "solver.lump");
    refusal list[REFUSALS];
    (void)lac_refuse(reader, !lac_case_lumps(c) && lump != NULL && lump->count > 0, "solver.lump",
                     "goes with fidelity lumped");
    if (clean && lac_case_lumps(c)) {
        (void)list_lumped(c, list);
        refuse_all(reader, REFUSALS, list);
    }
}

static void check_loads(lac_reader *reader, const lac_case *c, bool vector)
{
    char key[100];
    for (size_t i = 0; i < c->shear.count && lac_clean(reader, "load"); i++) {
        const lac_model *model = &c->shear.item[i];
        const lac_load_kind *kind = (const void *)model->info;
        (void)snprintf(key, sizeof key, "load.shear.%zu.%s", i, kind->info.name);
        (void)lac_refuse(reader, vector && kind->needs_anchor, key, ALONG_X);
        (void)lac_refuse(reader, vector && lac_load_models_share(model) == LAC_SHARE_ELASTIC, key,
                         "with share: elastic " ALONG_X);
        (void)snprintf(key, sizeof key, "load.shear.%zu.%s.azimuth", i, kind->info.name);
        (void)lac_refuse(reader, !vector && !isnan(lac_load_model_azimuth(model)), key, NEEDS);
    }
}

void lac_check_vector(lac_reader *reader, lac_case *c)
{
    const bool vector = c->slip == LAC_SLIP_VECTOR;
    const bool chosen = c->formulation == LAC_FORMULATION_VECTOR;
    const bool turned = !isnan(c->initial_azimuth);
    const lac_friction_params *law = c->friction.params;
    const lac_transfer_kind *transfer = (const void *)c->transfer.info;
    const lac_domain_source *domain = (const void *)c->domain.info;
    const bool full = c->surface.info == NULL && (domain == NULL || domain->full);
    const bool repeats = full && c->interface.boundary == LAC_PERIODIC;
    const refusal list[] = {
        {!vector && turned, "initial.azimuth", NEEDS},
        {!vector && chosen, "solver.formulation", NEEDS},
        {vector && turned && !(HAS("initial.slip_rate") && HAS("initial.state")), "initial.azimuth",
         "goes with slip_rate and state both given; else slip starts where the loads pull"},
        {vector && !chosen && c->formulation != LAC_FORMULATION_AUTO, "solver.formulation",
         "knows slip along x only: leave it out, or leave out interface.slip: vector"},
        {vector && c->run.fidelity == LAC_FIDELITY_ASYNC, "solver.fidelity", ALONG_X},
        {vector && HAS("inertia"), "inertia", ALONG_X},
        {vector && c->fit.named, "fit", ALONG_X},
        {vector && c->weakening.count > 0, "weakening", ALONG_X},
        {vector && transfer != NULL && transfer->transforms && !repeats, "transfer",
         "with interface.slip: vector needs interface.boundary: periodic and every cell in "
         "contact, or must be hierarchy"},
        {vector && c->friction.info != NULL && law->cohesion > 0.0, "friction",
         "has cohesion, which " ALONG_X},
    };
    check_loads(reader, c, vector);
    refuse_all(reader, COUNT(list), list);
    c->formulation = vector ? LAC_FORMULATION_VECTOR : c->formulation;
}

// Outputs closer in time than numbers near the end of the run are would all be at one time. At a
// checkpoint the integrator begins anew, with short steps of the lowest order.
void lac_check_cadences(lac_reader *reader, const lac_case *c)
{
    const struct {
        const char *key;
        double time;
    } cadences[] = {{"output.every", c->run.record.time},
                    {"output.fields_every", c->run.snapshot.time},
                    {"output.checkpoint", c->run.checkpoint.time}};
    const double least = c->run.end * 0x1p-52;
    const int64_t steps = c->run.checkpoint.steps;
    const double times = c->run.end / c->run.checkpoint.time, many = 1e4; // NaN: not by time
    char text[64];
    for (size_t i = 0; i < COUNT(cadences) && lac_clean(reader, "time"); i++) {
        (void)lac_refuse(reader, cadences[i].time < least && lac_clean(reader, "output"),
                         cadences[i].key,
                         "is finer than times are told apart by time.end: must be >= %s",
                         lac_units_format(least, "s", text, sizeof text));
    }
    if (!lac_clean(reader, "output") || !lac_clean(reader, "time")) {
        return;
    }
    if (steps > 0 && steps < LAC_CLOSE_STEPS) {
        lac_warn(reader, "output.checkpoint.steps",
                 "the integrator begins anew at each checkpoint, and some ten steps or more go by "
                 "until its steps are as long as before: a run can take 10 times the steps with "
                 "10, 40 times with 1; %d or more cost little",
                 5 * LAC_CLOSE_STEPS);
    } else if (times > many) {
        lac_warn(reader, "output.checkpoint.time",
                 "names %.2g checkpoints up to time.end: the integrator begins anew at each, so "
                 "that no step is longer than this time, and many are far shorter",
                 times);
    }
}
