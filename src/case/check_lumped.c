// SPDX-License-Identifier: GPL-3.0-or-later
// What a lumped run cannot do, in words: classes of cells stand for what each cell does by itself
// only where all slip together. docs/theory/lumped.md.
#include "case/sections.h"

void lac_check_lumped(lac_reader *reader, const lac_case *c)
{
    const bool lumped = c->run.fidelity == LAC_FIDELITY_LUMPED;
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
