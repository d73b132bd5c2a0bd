// SPDX-License-Identifier: GPL-3.0-or-later
// What has been published of the size effect on rock joints: statements of texts, not results.
#include <math.h>

#include "base/rows.h"
#include "fractal/fractal.h"

#define BORRI_BRUNETTO "Borri-Brunetto, Carpinteri and Chiaia 2004, fig. 4: Bandis et al. 1981, "
#define CARPINTERI_PAGGI "Carpinteri and Paggi 2009, Chaos Solitons Fractals 39:540"

static const lac_size_exponent table[] = {
    {"shear strength", 0.23, 0.23, NAN, NAN, true, BORRI_BRUNETTO "first set"},
    {"shear strength", 0.39, 0.39, NAN, NAN, true, BORRI_BRUNETTO "second set"},
    {"shear strength", 0.34, 0.34, 0.05, 0.4, true, CARPINTERI_PAGGI ": replicas of Bandis"},
    {"friction coefficient", 0.28, 0.28, 0.05, 1000, true,
     CARPINTERI_PAGGI "; the longest length is about 1 km"},
    {"shear strength", 0.49, 0.66, 0.035, 0.19, false,
     "Korean granite at 0.29 to 2.65 MPa, abstract JAKO200614364641643; exponent derived"},
    {"shear strength", 0.03, 0.05, 0.05, 0.4, false,
     "Barton-Bandis scaling, JRC 5: JRC_n = JRC_0 (L/L_0)^(-0.02 JRC_0), JCS with 0.03, L_0 = "
     "0.1 m"},
    {"shear strength", 0.13, 0.17, 0.05, 0.4, false, "Barton-Bandis scaling, JRC 10"},
    {"shear strength", 0.28, 0.44, 0.05, 0.4, false, "Barton-Bandis scaling, JRC 15"},
};

LAC_ROWS_AT(lac_size_exponent, lac_size_exponent_at, table)
