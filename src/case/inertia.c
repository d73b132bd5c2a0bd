// SPDX-License-Identifier: GPL-3.0-or-later
// inertia: its keys and what is wrong with them.
#include <math.h>

#include "case/sections.h"

#define FIELD(name) offsetof(lac_case, name)

const lac_param lac_inertia_rows[LAC_INERTIA_ROWS] = {
    LAC_REAL("thickness", "m", FIELD(inertia.thickness), NAN, 0, 1e9, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "of the block that slides, of material.density"),
    LAC_REAL("mass_per_area", "kg/m2", FIELD(inertia.mass_per_area), NAN, 0, 1e30,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "of the block over the nominal area, instead of a thickness"),
    LAC_REAL(
        "columns", "1", FIELD(inertia.columns), 0.01, 1e-6, 1, 0,
        "part of the mass that stands on the cells as columns of their own; the rest moves with "
        "the mean of their slip rates, a rigid block. 1: every cell is free to move by itself"),
};

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
    if (c->friction.about == NULL || c->run.method == LAC_BDF || isnan(c->initial.slip_rate)) {
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
    bool named = lac_present(reader, "inertia");
    bool thick = !isnan(c->inertia.thickness);
    if (!lac_clean(reader, "inertia")) {
        return;
    }
    if (named && thick == !isnan(c->inertia.mass_per_area)) {
        lac_blame_key(reader, "inertia",
                      "needs either thickness (with material.density) or mass_per_area%s",
                      thick ? ", not both" : "");
    } else if (thick && lac_clean(reader, "material") && isnan(c->material.density)) {
        lac_blame_key(reader, "material.density",
                      "is missing: needed by inertia.thickness; must be a density such as "
                      "\"2700 kg/m3\"");
    }
    if (named && c->formulation != LAC_FORMULATION_AUTO &&
        c->formulation != LAC_FORMULATION_INERTIA) {
        lac_blame_key(reader, "solver.formulation",
                      "knows no inertia: leave it out, or leave out inertia");
    } else if (!named && c->formulation == LAC_FORMULATION_INERTIA) {
        lac_blame_key(reader, "solver.formulation",
                      "needs inertia, such as inertia: {mass_per_area: \"5e5 kg/m2\"}");
    }
    if (named) {
        c->formulation = LAC_FORMULATION_INERTIA;
        warn_explicit(reader, c, pressure);
    }
}
