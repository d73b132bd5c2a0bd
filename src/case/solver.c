// SPDX-License-Identifier: GPL-3.0-or-later
// solver: its keys and what is wrong with them.
#include <math.h>

#include "case/sections.h"

// Cells at steps of their own have one formulation and no method to choose.
enum { EVENTS_REFUSE = 5 };
static const struct {
    const char *key, *why;
} events_refuse[EVENTS_REFUSE] = {
    {"solver.fidelity", "knows no inertia: leave one of them out"},
    {"solver.formulation", "must be auto or rate with fidelity events"},
    {"solver.method", "goes with fidelity ode, not with events"},
    {"solver.max_order", "goes with fidelity ode, not with events"},
    {"solver.first_step", "goes with fidelity ode, not with events"},
};

// Which of these the case asks for.
static void ask_events(const lac_case *c, bool asked[EVENTS_REFUSE])
{
    asked[0] = lac_inertia_mass(c) > 0;
    asked[1] = c->formulation_given && c->formulation != LAC_FORMULATION_RATE;
    asked[2] = c->run.method != LAC_BDF;
    asked[3] = c->run.max_order != 0;
    asked[4] = !isnan(c->run.first_step);
}

bool lac_case_admits_events(const lac_case *c)
{
    bool asked[EVENTS_REFUSE];
    ask_events(c, asked);
    return !(asked[0] || asked[1] || asked[2] || asked[3] || asked[4]);
}

static void check_events(lac_reader *reader, lac_case *c)
{
    const bool clean = lac_clean(reader, "solver");
    bool asked[EVENTS_REFUSE];
    ask_events(c, asked);
    for (size_t i = 0; i < EVENTS_REFUSE; i++) {
        (void)lac_refuse(reader, clean && asked[i], events_refuse[i].key, "%s",
                         events_refuse[i].why);
    }
    c->formulation = LAC_FORMULATION_RATE;
}

void lac_check_solver(lac_reader *reader, lac_case *c)
{
    c->method_given = HAS("solver.method");
    c->formulation_given = c->formulation != LAC_FORMULATION_AUTO;
    static const struct {
        const char *name;
        int lowest, highest;
    } orders[] = {
        [LAC_BDF] = {"bdf", 1, 5}, [LAC_ADAMS] = {"adams", 1, 12}, [LAC_ERK] = {"erk", 2, 8}};
    const lac_friction_params *friction = c->friction.params;
    lac_friction_form form = c->friction.info == NULL || friction->form == LAC_FORM_PLAIN
                                 ? LAC_FORM_PLAIN
                                 : LAC_FORM_REGULARISED;
    (void)lac_refuse(reader, !isnan(c->accuracy) && reader->purpose == LAC_FOR_FIT,
                     "solver.accuracy", "is picked for by lacuna run; here rtol counts");
    if (c->run.fidelity == LAC_FIDELITY_ASYNC) {
        check_events(reader, c);
        return;
    }
    c->formulation = (int)lac_formulation_choose(c->formulation, c->run.method, form);
    int64_t order = c->run.max_order;
    const int low = orders[c->run.method].lowest, high = orders[c->run.method].highest;
    (void)lac_refuse(reader,
                     lac_clean(reader, "solver") && order != 0 && (order < low || order > high),
                     "solver.max_order", "must be from %d to %d with method %s", low, high,
                     orders[c->run.method].name);
}
