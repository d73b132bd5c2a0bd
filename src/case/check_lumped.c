// SPDX-License-Identifier: GPL-3.0-or-later
// How cells are taken together, and what a lumped run cannot do, in words: classes of cells stand
// for what each cell does by itself only where all slip together. docs/theory/lumped.md.
#include "case/sections.h"

const lac_param lac_lump_rows[LAC_LUMP_ROWS] = {
    LAC_INTEGER("level", offsetof(lac_case, lump.level), NAN, 0, 31, LAC_OPTIONAL,
                "blocks of 2^level cells a side are taken together; as coarse as the scene allows "
                "if absent"),
    LAC_INTEGER("nodes", offsetof(lac_case, lump.nodes), NAN, 1, 12, LAC_OPTIONAL,
                "of a quadrature over one parameter that varies, over more as exact; what was "
                "measured to be enough if absent"),
    LAC_REAL("error", "1", offsetof(lac_case, lump.error), 0.01, 1e-6, 0.5, 0,
             "relative error of the time of failure, or of the mean slip where nothing fails, that "
             "taking cells together may cause; beyond it the run ends without a result"),
};

bool lac_case_lumps(const lac_case *c) { return c->run.fidelity == LAC_FIDELITY_LUMPED; }

void lac_check_lumped(lac_reader *reader, const lac_case *c)
{
    const bool lumped = lac_case_lumps(c);
    const lac_transfer_kind *transfer = (const void *)c->transfer.info;
    const bool block = c->interface.levels == 0;
    const struct {
        bool wrong;
        const char *key, *why;
    } table[] = {
        {!lumped && HAS("solver.lump"), "solver.lump", "goes with fidelity lumped"},
        {lumped && !block && (transfer == NULL || transfer->blocks == NULL), "solver.fidelity",
         "lumped needs transfer: {hierarchy: {...}}: how stiffly cells hold one another, level by "
         "level, says how far they slip apart"},
        {lumped && c->slip == LAC_SLIP_VECTOR, "solver.fidelity",
         "lumped knows slip along x only: leave out interface.slip: vector"},
        {lumped && HAS("inertia"), "solver.fidelity",
         "lumped knows no inertia: leave one of them out"},
        {lumped && c->weakening.count > 0, "solver.fidelity",
         "lumped knows no weakening, which heats each cell by its own pressure: leave one of them "
         "out"},
        {lumped && c->analysis.count > 0, "analysis",
         "is of cells that slip by themselves, which fidelity lumped does not follow: take ode or "
         "events"},
        {lumped && c->from.file != NULL, "initial.run",
         "gives each cell a state of its own, which fidelity lumped does not keep: take ode"},
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        (void)lac_refuse(reader, table[i].wrong, table[i].key, "%s", table[i].why);
    }
}
