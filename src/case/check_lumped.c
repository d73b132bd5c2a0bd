// SPDX-License-Identifier: GPL-3.0-or-later
// How cells are taken together, and what a lumped run cannot do, in words: classes of cells stand
// for what each cell does by itself only where all slip together. docs/theory/lumped.md.
#include "case/sections.h"

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

bool lac_case_lumps(const lac_case *c) { return c->run.fidelity == LAC_FIDELITY_LUMPED; }

enum { REFUSALS = 8 };
static const struct {
    const char *key, *why;
} refusals[REFUSALS] = {
    {"solver.fidelity",
     "lumped needs transfer: {hierarchy: {...}}: how stiffly cells hold one another, level by "
     "level, says how far they slip apart"},
    {"solver.fidelity", "lumped knows slip along x only: leave out interface.slip: vector"},
    {"solver.fidelity", "lumped knows no inertia: leave one of them out"},
    {"solver.fidelity",
     "lumped knows no weakening, which changes each cell by its own pressure: leave one of them "
     "out"},
    {"analysis",
     "is of cells that slip by themselves, which fidelity lumped does not follow: take ode or "
     "events"},
    {"initial.run",
     "gives each cell a state of its own, which fidelity lumped does not keep: take ode"},
    {"time.stop_when.max_slip_rate",
     "is of single cells, of which fidelity lumped keeps few: take mean_slip, or fidelity ode"},
    {"solver.fidelity",
     "cannot tell how far off it is: the case starts steady with b > a and no load changes, "
     "so rounding decides what it does"},
};

// Which of these the case asks for.
static void ask(const lac_case *c, bool asked[REFUSALS])
{
    const lac_transfer_kind *transfer = (const void *)c->transfer.info;
    const lac_grid grid = lac_interface_grid(&c->interface);
    asked[0] = lac_grid_cells(&grid) > 1 && (transfer == NULL || transfer->blocks == NULL);
    asked[1] = c->slip == LAC_SLIP_VECTOR;
    asked[2] = lac_inertia_mass(c) > 0.0;
    asked[3] = c->weakening.count > 0;
    asked[4] = c->analysis.count > 0;
    asked[5] = c->from.file != NULL;
    asked[6] = !isnan(c->run.stop_rate);
    asked[7] = lac_case_left_to_rounding(c);
}

bool lac_case_admits_lumped(const lac_case *c)
{
    bool asked[REFUSALS], any = false;
    ask(c, asked);
    for (size_t i = 0; i < REFUSALS; i++) {
        any = any || asked[i];
    }
    return !any;
}

void lac_check_lumped(lac_reader *reader, const lac_case *c)
{
    const bool clean = lac_clean(reader, "interface") && lac_clean(reader, "transfer");
    bool asked[REFUSALS] = {false};
    const lac_node *lump = lac_node_at(reader->root, "solver.lump");
    (void)lac_refuse(reader, !lac_case_lumps(c) && lump != NULL && lump->count > 0, "solver.lump",
                     "goes with fidelity lumped");
    if (clean && lac_case_lumps(c)) {
        ask(c, asked);
    }
    for (size_t i = 0; i < REFUSALS; i++) {
        (void)lac_refuse(reader, asked[i], refusals[i].key, "%s", refusals[i].why);
    }
}
