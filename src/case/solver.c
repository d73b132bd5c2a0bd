// SPDX-License-Identifier: GPL-3.0-or-later
// solver: its keys and what is wrong with them.
#include <math.h>

#include "case/sections.h"

#define FIELD(name) offsetof(lac_case, name)

static const char *const methods[] = {"bdf", "adams", "erk", NULL};
static const char *const fidelities[] = {"ode", "events", "static", NULL};
static const char *const formulations[] = {"auto", "rate", "traction", "slip", "inertia", NULL};
static const char *const answers[] = {"false", "true", NULL};
static const char *const plannings[] = {"estimate", "measure", NULL};

const lac_param lac_solver_rows[LAC_SOLVER_ROWS] = {
    LAC_CHOICE("fidelity", FIELD(run.fidelity), LAC_FIDELITY_ODE, fidelities, 0,
               "what is resolved in time: ode (all cells at every step), events (each cell at "
               "steps of its own, for cells that slip one by one); static has no time (lacuna rg)"),
    LAC_REAL("wake", "1", FIELD(run.wake), 1, 0, 100, LAC_ABOVE_MIN,
             "with fidelity events: error that an unforeseen change of traction may cause before a "
             "cell is looked at, over the error of its step"),
    LAC_CHOICE("method", FIELD(run.method), LAC_BDF, methods, 0,
               "of integration: bdf (implicit), adams, or erk (explicit Runge-Kutta)"),
    LAC_CHOICE("formulation", FIELD(formulation), LAC_FORMULATION_AUTO, formulations, 0,
               "unknown besides ln theta: rate (ln v), traction, slip; inertia (slip and its rate) "
               "goes with the section inertia; auto: what was measured to be best for the method"),
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

static bool asks_inertia(const lac_case *c) { return lac_inertia_mass(c) > 0; }

static bool asks_formulation(const lac_case *c)
{
    return c->formulation_given && c->formulation != LAC_FORMULATION_RATE;
}

static bool asks_method(const lac_case *c) { return c->run.method != LAC_BDF; }

static bool asks_order(const lac_case *c) { return c->run.max_order != 0; }

static bool asks_first_step(const lac_case *c) { return !isnan(c->run.first_step); }

// Cells at steps of their own have one formulation and no method to choose.
static const struct {
    const char *key, *why;
    bool (*asked)(const lac_case *c);
} events_refuse[] = {
    {"solver.fidelity", "knows no inertia: leave one of them out", asks_inertia},
    {"solver.formulation", "must be auto or rate with fidelity events", asks_formulation},
    {"solver.method", "goes with fidelity ode, not with events", asks_method},
    {"solver.max_order", "goes with fidelity ode, not with events", asks_order},
    {"solver.first_step", "goes with fidelity ode, not with events", asks_first_step},
};

enum { EVENTS_REFUSE = sizeof events_refuse / sizeof *events_refuse };

bool lac_case_admits_events(const lac_case *c)
{
    bool admits = true;
    for (size_t i = 0; i < EVENTS_REFUSE; i++) {
        admits = admits && !events_refuse[i].asked(c);
    }
    return admits;
}

static void check_events(lac_reader *reader, lac_case *c)
{
    const bool clean = lac_clean(reader, "solver");
    for (size_t i = 0; clean && i < EVENTS_REFUSE; i++) {
        if (events_refuse[i].asked(c)) {
            lac_blame_key(reader, events_refuse[i].key, "%s", events_refuse[i].why);
        }
    }
    c->formulation = LAC_FORMULATION_RATE;
}

void lac_check_solver(lac_reader *reader, lac_case *c)
{
    c->method_given = lac_present(reader, "solver.method");
    c->formulation_given = c->formulation != LAC_FORMULATION_AUTO;
    static const struct {
        const char *name;
        int lowest, highest;
    } orders[] = {
        [LAC_BDF] = {"bdf", 1, 5}, [LAC_ADAMS] = {"adams", 1, 12}, [LAC_ERK] = {"erk", 2, 8}};
    const lac_friction_params *friction = c->friction.params;
    lac_friction_form form = c->friction.about == NULL || friction->form == LAC_FORM_PLAIN
                                 ? LAC_FORM_PLAIN
                                 : LAC_FORM_REGULARISED;
    if (!isnan(c->accuracy) && reader->purpose == LAC_FOR_FIT) {
        lac_blame_key(reader, "solver.accuracy", "is picked for by lacuna run; here rtol counts");
    }
    if (c->run.fidelity == LAC_FIDELITY_EVENTS) {
        check_events(reader, c);
        return;
    }
    c->formulation = (int)lac_formulation_choose(c->formulation, c->run.method, form);
    int64_t order = c->run.max_order;
    if (!lac_clean(reader, "solver") || order == 0) {
        return;
    }
    if (order < orders[c->run.method].lowest || order > orders[c->run.method].highest) {
        lac_blame_key(reader, "solver.max_order", "must be from %d to %d with method %s",
                      orders[c->run.method].lowest, orders[c->run.method].highest,
                      orders[c->run.method].name);
    }
}
