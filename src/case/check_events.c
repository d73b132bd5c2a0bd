// SPDX-License-Identifier: GPL-3.0-or-later
// What a case may not ask of cells that take steps of their own: solver.fidelity events.
#include "case/sections.h"

// Cells at steps of their own have one formulation and no method to choose.
enum { EVENTS_REFUSE = 8 };
static const struct {
    const char *key, *why, *what;
} events_refuse[EVENTS_REFUSE] = {
    {"solver.fidelity", "knows no inertia: leave one of them out", "inertia"},
    {"solver.formulation", "must be auto or rate with fidelity events", "solver.formulation"},
    {"solver.method", "goes with fidelity ode, not with events", "solver.method"},
    {"solver.max_order", "goes with fidelity ode, not with events", "solver.max_order"},
    {"solver.first_step", "goes with fidelity ode, not with events", "solver.first_step"},
    {"time.stop_when.factor_of_safety", "goes with fidelity ode, not with events",
     "time.stop_when.factor_of_safety"},
    {"solver.fidelity", "knows no interface.geometry: leave one of them out", "interface.geometry"},
    {"weakening", "goes with fidelity ode, not with events", "weakening"},
};

// Which of these the case asks for.
static void ask_events(const lac_case *c, bool asked[EVENTS_REFUSE])
{
    asked[0] = lac_inertia_mass(c) > 0;
    asked[1] = c->formulation_given && c->formulation != LAC_FORMULATION_RATE;
    asked[2] = c->run.method != LAC_BDF;
    asked[3] = c->run.max_order != 0;
    asked[4] = !isnan(c->run.first_step);
    asked[5] = !isnan(c->run.stop_safety);
    asked[6] = c->geometry.angles > 0;
    asked[7] = c->weakening.count > 0;
}

const char *lac_case_bars_events(const lac_case *c)
{
    bool asked[EVENTS_REFUSE];
    ask_events(c, asked);
    size_t i = 0;
    while (i < EVENTS_REFUSE && !asked[i]) {
        i++;
    }
    return i < EVENTS_REFUSE ? events_refuse[i].what : NULL;
}

void lac_check_events(lac_reader *reader, lac_case *c)
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
