// SPDX-License-Identifier: GPL-3.0-or-later
// The last of some readings, as if nothing had been read before: also how fine their numbers are is
// told from them alone.
#include "series/motion.h"
#include "series/text.h"

static const double *from(const double *values, size_t first)
{
    return values != NULL ? values + first : NULL;
}

// The least last digit of the values that are there.
static double finest(size_t n, const double *value, const double *digits)
{
    double least = INFINITY;
    for (size_t i = 0; i < n; i++) {
        least = isnan(value[i]) ? least : fmin(least, digits[i]);
    }
    return isfinite(least) ? least : 0.0;
}

static lac_status tell(const lac_readings *r, const double *value, const double *digits,
                       double *digit, lac_error *err)
{
    if (value == NULL || digits == NULL) {
        return LAC_OK;
    }
    *digit = finest(r->n, value, digits);
    return lac_series_resolve(r->n, r->time, value, digit, err);
}

lac_status lac_readings_recent(const lac_readings *all, size_t count, double time,
                               lac_readings *out, lac_error *err)
{
    size_t first = count > 0 && all->n > count ? all->n - count : 0;
    while (first < all->n && all->time[first] < all->time[all->n - 1] - time) {
        first++;
    }
    *out = *all;
    out->n = all->n - first;
    out->time = from(all->time, first);
    out->displacement = from(all->displacement, first);
    out->velocity = from(all->velocity, first);
    out->sigma = from(all->sigma, first);
    out->displacement_digits = from(all->displacement_digits, first);
    out->velocity_digits = from(all->velocity_digits, first);
    LAC_TRY_RETURN(
        tell(out, out->displacement, out->displacement_digits, &out->displacement_digit, err));
    return tell(out, out->velocity, out->velocity_digits, &out->velocity_digit, err);
}
