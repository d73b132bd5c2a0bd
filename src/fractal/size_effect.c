// SPDX-License-Identifier: GPL-3.0-or-later
// Strength of specimens of another size, by the fractal dimension of the contact that was measured.
#include <math.h>

#include "fractal/fractal.h"

static lac_status check(const lac_size_def *def, lac_error *err)
{
    LAC_FAIL_IF(!(def->dimension > 0 && def->dimension <= 2), err, LAC_EINPUT,
                "size effect: a dimension of %g: it must be > 0 and at most 2", def->dimension);
    LAC_FAIL_IF(!(isfinite(def->error) && def->error >= 0), err, LAC_EINPUT,
                "size effect: an error of the dimension of %g", def->error);
    LAC_FAIL_IF(
        !(isfinite(def->size) && def->size > 0 && isfinite(def->pressure) && def->pressure > 0),
        err, LAC_EINPUT, "size effect: an interface of %g m under %g Pa: both must be > 0",
        def->size, def->pressure);
    return LAC_OK;
}

lac_status lac_size_effect(const lac_size_def *def, size_t n, const double *size,
                           lac_size_strength *rows, lac_error *err)
{
    lac_status status = check(def, err);
    for (size_t i = 0; i < n && status == LAC_OK; i++) {
        LAC_FAIL_IF(!(isfinite(size[i]) && size[i] > 0), err, LAC_EINPUT,
                    "size effect: a specimen of %g m: it must be > 0", size[i]);
        double ratio = size[i] / def->size;
        double relative = pow(ratio, def->dimension - 2);
        double spread = exp(fabs(def->error * log(ratio)));
        rows[i] = (lac_size_strength){.size = size[i],
                                      .pressure = def->pressure * relative,
                                      .relative = relative,
                                      .low = relative / spread,
                                      .high = relative * spread};
    }
    return status;
}

// What has been published of the size effect on rock joints: statements of texts, not results.
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
     "Barton-Bandis scaling, JRC 5: JRC_n = JRC_0 (L/L_0)^(-0.02 JRC_0), JCS with 0.03, L_0 = 0.1 "
     "m"},
    {"shear strength", 0.13, 0.17, 0.05, 0.4, false, "Barton-Bandis scaling, JRC 10"},
    {"shear strength", 0.28, 0.44, 0.05, 0.4, false, "Barton-Bandis scaling, JRC 15"},
};

const lac_size_exponent *lac_size_exponent_get(size_t index)
{
    return index < sizeof table / sizeof table[0] ? &table[index] : NULL;
}
