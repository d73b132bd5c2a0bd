// SPDX-License-Identifier: GPL-3.0-or-later
// Monitoring files, text or netCDF as their first bytes say; how fine their numbers are, and how
// far a modelled motion is from them.
#include <gsl/gsl_interp.h>
#include <gsl/gsl_sort.h>

#include "base/ask.h"
#include "base/statistics.h"
#include "base/units.h"
#include "base/vsum.h"
#include "series/motion.h"
#include "series/text.h"

// A sensor counts in steps of its own, which may be coarser than the last digit written.

enum {
    TELLING = 10, // readings that no smooth curve explains, and as many that are whole steps apart
    DIGITS = 2,   // columns of which the digits are kept
    SKIPPED = 20, // of so many gaps one may be too long to tell anything
};
static const double bits = 4.0;  // errors of a value, in last bits
static const double clear = 8.0; // a step over the error of what is divided by it
static const double coarser = 1.5;

// The gaps between the distinct values, in their order, and how many values come again.
static size_t find_gaps(size_t n, const double *x, double error, double *gap, size_t *again)
{
    size_t count = 0, gaps = 0;
    *again = 0;
    for (size_t i = 0; i < n; i++) {
        if (!isnan(x[i])) {
            gap[count++] = x[i];
        }
    }
    gsl_sort(gap, 1, count);
    for (size_t i = 1; i < count; i++) { // a gap is written where its values are no longer needed
        const double step = gap[i] - gap[i - 1];
        *again += step > error ? 0 : 1;
        if (step > error) {
            gap[gaps++] = step;
        }
    }
    gsl_sort(gap, 1, gaps);
    return gaps;
}

// What a gap divided by the step may be off; infinite where that says nothing.
static double may_be_off(double gap, double step, double error)
{
    const double off = (gap / step + 1.0) * error;
    return clear * off > step ? INFINITY : off;
}

// The greatest step of which all gaps are whole multiples: Euclid's algorithm with errors. By
// chance a gap is one with less than one in four.
static double divide(size_t n, const double *gap, double error, size_t again)
{
    double step = n > 0 ? gap[0] : 0.0;
    double way = 0.0, steps = 0.0;
    size_t told = 0;
    for (size_t i = 0; i < n && step > 2.0 * clear * error; i++) {
        const double left = fabs(remainder(gap[i], step));
        const double off = may_be_off(gap[i], step, error);
        if (left > off) { // begins anew with a step at most half as long
            step = left;
            way = steps = 0.0;
            told = 0;
            i = (size_t)-1;
        } else if (isfinite(off)) {
            told++;
            way += gap[i];
            steps += rint(gap[i] / step);
        }
    }
    const bool believed = told + again > TELLING && n - told <= n / SKIPPED;
    return step > 2.0 * clear * error && believed && steps > 0.0 ? way / steps : 0.0;
}

// Readings off the parabola through two before and one after by more than half a step.
static size_t count_rough(size_t n, const double *t, const double *x, double step)
{
    size_t count = 0;
    for (size_t i = 2; i + 1 < n; i++) {
        const double *const s = t + i;
        const double before =
            x[i - 2] * (s[0] - s[-1]) * (s[0] - s[1]) / ((s[-2] - s[-1]) * (s[-2] - s[1]));
        const double last =
            x[i - 1] * (s[0] - s[-2]) * (s[0] - s[1]) / ((s[-1] - s[-2]) * (s[-1] - s[1]));
        const double after =
            x[i + 1] * (s[0] - s[-2]) * (s[0] - s[-1]) / ((s[1] - s[-2]) * (s[1] - s[-1]));
        count += fabs(x[i] - before - last - after) > 0.5 * step ? 1 : 0;
    }
    return count;
}

// What a column can tell apart: the greatest step of which all its differences are whole
// multiples, within the rounding of doubles, or of single precision. A sensor that counts in 0.5
// mm and writes "12.5" has that step, and so have 0.1f and what was written of it. Believed only
// of readings of which ten or more are off a parabola through their neighbours by more than half
// of it, as a line of equal steps has them too. The digit is never made less.
static lac_status resolve(size_t n, const double *time, const double *x, double *digit,
                          lac_error *err)
{
    static const double type[] = {DBL_EPSILON, FLT_EPSILON};
    if (x == NULL) {
        return LAC_OK;
    }
    const double most = lac_vmost(n, x);
    double *gap = malloc(n * sizeof *gap);
    LAC_FAIL_MEMORY_IF(gap == NULL, err);
    for (size_t k = 0; k < sizeof type / sizeof *type; k++) {
        const double error = bits * type[k] * most;
        size_t again;
        const size_t gaps = find_gaps(n, x, error, gap, &again);
        const double step = divide(gaps, gap, error, again);
        if (step > coarser * *digit && count_rough(n, time, x, step) >= TELLING) {
            *digit = *digit > 0.0 ? *digit * rint(step / *digit) : step;
            break;
        }
    }
    free(gap);
    return LAC_OK;
}

static lac_status check(const lac_series_def *def, lac_error *err)
{
    LAC_FAIL_IF(def->displacement == NULL && def->velocity == NULL && def->value == NULL &&
                    def->components == NULL,
                err, LAC_EINPUT, "%s: no column of values was named", def->path);
    return LAC_OK;
}

lac_status lac_series_read(const lac_series_def *def, const struct lac_units *units,
                           lac_series **out, lac_error *err)
{
    *out = NULL;
    FILE *stream = fopen(def->path, "rbe");
    LAC_FAIL_IF(stream == NULL, err, LAC_EIO, "%s: %s", def->path, strerror(errno));
    bool is_netcdf = lac_series_is_netcdf(stream);
    lac_status status = check(def, err);
    if (status == LAC_OK) {
        status = is_netcdf ? lac_series_read_netcdf(def, units, out, err)
                           : lac_series_read_stream(stream, def, units, out, err);
    }
    (void)fclose(stream);
    LAC_TRY(status);
    if ((*out)->component[0] != NULL) {
        lac_series_project(*out, (*out)->n);
    }
    const lac_series *s = *out;
    LAC_TRY(resolve(s->n, s->time, s->displacement, &(*out)->displacement_digit, err));
    LAC_TRY(resolve(s->n, s->time, s->velocity, &(*out)->velocity_digit, err));
out:
    LAC_MADE(status, out, lac_series_free);
}

lac_status lac_series_create(const lac_series_def *def, lac_series **out, lac_error *err)
{
    lac_series_def own = lac_series_def_default();
    lac_units *units = NULL;
    lac_status status;
    LAC_TRY(LAC_NEED(err, def, out));
    *out = NULL;
    LAC_TRY(lac_take_options("lac_series_def", def, &own, sizeof own, err));
    LAC_TRY(own.path != NULL ? LAC_OK : lac_fail(err, LAC_EINPUT, "a series without a path"));
    LAC_TRY(check(&own, err));
    LAC_TRY(own.value == NULL || own.value_si != NULL
                ? LAC_OK
                : lac_fail(err, LAC_EINPUT, "%s: value_si must say the unit of %s", own.path,
                           own.value));
    LAC_TRY(lac_units_create(&units, err));
    status = lac_series_read(&own, units, out, err);
out:
    lac_units_free(units);
    return status;
}

lac_status lac_series_new(const lac_series_def *def, const lac_components *components, size_t n,
                          const char *attribution, lac_series **out, lac_error *err)
{
    const char *const *const axis = components->name;
    const char *const name[LAC_SERIES_VALUES] = {components->count > 0 ? axis[0]
                                                                       : def->displacement,
                                                 def->velocity,
                                                 def->value,
                                                 def->sigma,
                                                 axis[0],
                                                 axis[1],
                                                 axis[2],
                                                 def->velocity_sigma,
                                                 def->velocity_most,
                                                 def->within};
    const size_t length = strlen(attribution) + 1;
    size_t columns = 1;
    for (size_t c = 0; c < LAC_SERIES_VALUES; c++) {
        columns += name[c] == NULL ? 0 : c < DIGITS ? 2 : 1; // two of which have digits
    }
    lac_series *s =
        calloc(1, sizeof *s + n * (columns * sizeof *s->time + sizeof *s->line) + length);
    LAC_FAIL_MEMORY_IF(s == NULL, err);
    double **const column[LAC_SERIES_VALUES] = {
        &s->displacement, &s->velocity,     &s->value,          &s->sigma,         &s->component[0],
        &s->component[1], &s->component[2], &s->velocity_sigma, &s->velocity_most, &s->within};
    double *at = s->time = (double *)(s + 1);
    for (size_t c = 0; c < LAC_SERIES_VALUES; c++) {
        *column[c] = name[c] != NULL ? at += n : NULL;
    }
    double **const digits[DIGITS] = {&s->displacement_digits, &s->velocity_digits};
    for (size_t c = 0; c < DIGITS; c++) {
        *digits[c] = name[c] != NULL ? at += n : NULL;
    }
    s->n = n;
    s->sighted = components->sighted;
    memcpy(s->direction, components->direction, sizeof s->direction);
    s->line = (size_t *)(at + n);
    s->attribution = memcpy(s->line + n, attribution, length);
    *out = s;
    return LAC_OK;
}

void lac_series_free(lac_series *series) { free(series); }

// v = v0^(1-w) v1^w, or linear where a rate is not positive.
static double between_rates(double v0, double v1, double w)
{
    if (v0 > 0 && v1 > 0) {
        return exp((1.0 - w) * log(v0) + w * log(v1));
    }
    return (1.0 - w) * v0 + w * v1;
}

bool lac_history_eval(const lac_history *h, double t, double *slip, double *rate)
{
    if (h->n == 0 || !(t >= h->time[0] && t <= h->time[h->n - 1])) {
        return false;
    }
    size_t i = gsl_interp_bsearch(h->time, t, 0, h->n);
    *slip = h->slip[i];
    *rate = h->rate[i];
    if (t > h->time[i]) {
        double w = (t - h->time[i]) / (h->time[i + 1] - h->time[i]);
        *slip = (1.0 - w) * h->slip[i] + w * h->slip[i + 1];
        *rate = between_rates(h->rate[i], h->rate[i + 1], w);
    }
    return true;
}

void lac_series_compare(const lac_series *series, const lac_history *history, lac_misfit *misfit)
{
    lac_line offset = {0}; // level
    size_t rates = 0;
    double squares = 0.0;
    *misfit = (lac_misfit){0};
    for (size_t i = 0; i < series->n; i++) {
        double slip = 0.0, rate = 0.0;
        double d = series->displacement != NULL ? series->displacement[i] : NAN;
        double v = series->velocity != NULL ? series->velocity[i] : NAN;
        if (isnan(d) && isnan(v)) {
            continue;
        }
        if (!lac_history_eval(history, series->time[i], &slip, &rate)) {
            misfit->outside++;
            continue;
        }
        if (!isnan(d)) {
            lac_line_add(&offset, 0.0, d - slip);
        }
        if (v > 0 && rate > 0) {
            double decades = log10(v / rate);
            squares += decades * decades;
            rates++;
        }
    }
    misfit->displacement_count = (size_t)offset.n;
    misfit->velocity_count = rates;
    misfit->displacement_offset = offset.n > 0 ? lac_line_at(&offset, 0.0) : NAN;
    misfit->displacement_rms = sqrt(offset.rest / offset.n);
    misfit->log_rate_rms = rates > 0 ? sqrt(squares / (double)rates) : NAN;
}

// The last of some readings, as if nothing had been read before: also how fine their numbers are is
// told from them alone.

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
    return resolve(r->n, r->time, value, digit, err);
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
