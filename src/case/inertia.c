// SPDX-License-Identifier: GPL-3.0-or-later
// inertia: its keys and what is wrong with them.
#include <math.h>

#include "case/sections.h"

double lac_inertia_mass(const lac_case *c)
{
    if (!isnan(c->inertia.mass_per_area)) {
        return c->inertia.mass_per_area;
    }
    double mass = c->inertia.thickness * c->material.density;
    return isnan(mass) ? 0.0 : mass;
}

// An explicit method follows the time m v/(a p) in which a massive cell comes into balance.
static void warn_explicit(lac_reader *reader, const lac_case *c, double pressure)
{
    const double many = 1e6;
    const lac_friction_params *law = c->friction.params;
    if (c->friction.info == NULL || c->run.method == LAC_BDF || isnan(c->initial.slip_rate)) {
        return;
    }
    double time = lac_inertia_mass(c) * c->initial.slip_rate / (law->a * pressure);
    if (time > 0.0 && c->run.end > many * time) {
        lac_warn(reader, "solver.method",
                 "takes steps of about m v/(a p) = %.2g s while the block creeps; bdf does not",
                 time);
    }
}

void lac_check_inertia(lac_reader *reader, lac_case *c, double pressure)
{
    bool named = HAS("inertia");
    bool thick = !isnan(c->inertia.thickness), given = !isnan(c->inertia.mass_per_area);
    bool chosen = c->formulation == LAC_FORMULATION_INERTIA;
    if (!lac_clean(reader, "inertia")) {
        return;
    }
    (void)(lac_refuse(reader, named && thick == given, "inertia",
                      "needs either thickness (with material.density) or mass_per_area%s",
                      thick ? ", not both" : "") ||
           lac_refuse(reader, thick && lac_clean(reader, "material") && isnan(c->material.density),
                      "material.density",
                      "is missing: needed by inertia.thickness; must be a density such as \"2700 "
                      "kg/m3\""));
    (void)lac_refuse(reader, named && !chosen && c->formulation != LAC_FORMULATION_AUTO,
                     "solver.formulation", "knows no inertia: leave it out, or leave out inertia");
    (void)lac_refuse(reader, !named && chosen, "solver.formulation",
                     "needs inertia, such as inertia: {mass_per_area: \"5e5 kg/m2\"}");
    if (named) {
        c->formulation = LAC_FORMULATION_INERTIA;
        warn_explicit(reader, c, pressure);
    }
}
