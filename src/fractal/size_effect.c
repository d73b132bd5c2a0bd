// SPDX-License-Identifier: GPL-3.0-or-later
// Strength of specimens of another size, by the fractal dimension of the contact that was measured.
#include <math.h>

#include "fractal/fractal.h"

static lac_status check(const lac_size_def *def, lac_error *err)
{
    if (!(def->dimension > 0 && def->dimension <= 2)) {
        return lac_fail(err, LAC_EINPUT,
                        "size effect: a dimension of %g: it must be > 0 and at most 2",
                        def->dimension);
    }
    if (!(isfinite(def->error) && def->error >= 0)) {
        return lac_fail(err, LAC_EINPUT, "size effect: an error of the dimension of %g",
                        def->error);
    }
    if (!(isfinite(def->size) && def->size > 0 && isfinite(def->pressure) && def->pressure > 0)) {
        return lac_fail(err, LAC_EINPUT,
                        "size effect: an interface of %g m under %g Pa: both must be > 0",
                        def->size, def->pressure);
    }
    return LAC_OK;
}

lac_status lac_size_effect(const lac_size_def *def, size_t n, const double *size,
                           lac_size_strength *rows, lac_error *err)
{
    lac_status status = check(def, err);
    for (size_t i = 0; i < n && status == LAC_OK; i++) {
        if (!(isfinite(size[i]) && size[i] > 0)) {
            return lac_fail(err, LAC_EINPUT, "size effect: a specimen of %g m: it must be > 0",
                            size[i]);
        }
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
