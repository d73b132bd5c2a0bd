// SPDX-License-Identifier: GPL-3.0-or-later
// Whether few cells would do for all, found by trying it.
#include "cli/run/check_lumped.h"

#include "cli/common/progress.h"
#include "simulation/simulation.h"

void cli_try_lumped(const lac_case *c, const lac_estimate *e, cli_lumped_try *out)
{
    const double large = 1e5, together = 3.0;
    lac_simulation *simulation = NULL;
    lac_case own = *c;
    *out = (cli_lumped_try){.made = false};
    if (!e->integrated || e->choice.fidelity != LAC_FIDELITY_ODE || e->grid_cells > large ||
        !(e->cells > 1.0) || !(e->stiffness_ratio > together) || !isnan(c->accuracy) ||
        !lac_case_admits_lumped(c)) {
        return;
    }
    own.use = NULL;
    own.purpose = LAC_FOR_RUN;
    own.points = 0;
    own.run.fidelity = LAC_FIDELITY_LUMPED;
    own.lump = (lac_lump_def){.level = -1, .nodes = -1, .error = 0.01};
    if (lac_simulation_create(&own, NULL, &simulation, NULL) == LAC_OK) {
        const double before = cli_cpu_time();
        out->made = lac_simulation_run(simulation, NULL, NULL) == LAC_OK;
        out->time = cli_cpu_time() - before;
        out->cells = lac_simulation_outcome(simulation)->scene->lump->domain->n;
        out->error = lac_simulation_result(simulation)->lump_error_estimated;
    }
    lac_simulation_free(simulation);
}
