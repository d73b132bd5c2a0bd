// SPDX-License-Identifier: GPL-3.0-or-later
// Radiation damping of a case's rock, G/(2 cs), cs from the density where it is not given.
#include <math.h>

#include "scene/internal.h"

double lac_damping_of(const lac_material_def *material)
{
    double g = material->shear_modulus;
    double cs = material->shear_speed;
    if (isnan(cs) && !isnan(material->density)) {
        cs = sqrt(g / material->density);
    }
    return isnan(g) || isnan(cs) ? 0.0 : 0.5 * g / cs;
}
