// SPDX-License-Identifier: GPL-3.0-or-later
// Readings made ready for forecasts: cleaned, turned so that they rise, and differentiated, all
// with the past alone: whoever passes readings up to the present gets what could be known then.
#include "series/motion.h"
#include "base/noise.h"
#include "base/statistics.h"

// In noises, unless said.
static const double gap = 5.0; // median intervals
static const double step_counts = 5.0, error_counts = 3.0, walk_counts = 2.0;

static double find_noise(const lac_motion *m, double *work)
{
    size_t n = 0;
    for (size_t i = 0; i < m->n; i++) {
        if (!isnan(m->sigma[i])) {
            work[n++] = m->sigma[i];
        }
    }
    return n > 0           ? lac_median(n, work)
           : m->integrated ? (double)NAN
                           : lac_noise_of(m->n, m->time, m->displacement, work);
}

// Noise, intervals and gaps of the readings.
static void measure(lac_motion *m, double *work)
{
    m->noise = find_noise(m, work);
    m->noise = m->noise < m->resolution ? m->resolution : m->noise;
    for (size_t i = 1; i < m->n; i++) {
        work[i - 1] = m->time[i] - m->time[i - 1];
    }
    m->interval = m->n > 1 ? lac_median(m->n - 1, work) : NAN;
    m->longest_gap = m->n > 1 ? work[m->n - 2] : NAN;
    for (size_t i = 1; i < m->n; i++) {
        m->gaps += work[i - 1] > gap * m->interval ? 1 : 0;
    }
}

// Whether the readings fall by more than their noise.
// Steps count at most some median ones, so that a reset is no more than a few of them. Errors of
// displacements cancel in their sum but for the first and the last; those of integrated velocities
// add up as a random walk does.
static bool motion_falls(const lac_motion *m, double *work)
{
    size_t n = 0;
    double sum = 0.0, squares = 0.0;
    for (size_t i = 1; i < m->n; i++) {
        const double step = fabs(m->displacement[i] - m->displacement[i - 1]);
        if (step > 0.0) {
            work[n++] = step;
        }
    }
    const double most = n > 0 ? step_counts * lac_median(n, work) : 0.0;
    for (size_t i = 1; i < m->n; i++) {
        const double step = m->displacement[i] - m->displacement[i - 1];
        const double counted = fmin(most, fmax(-most, step));
        sum += counted;
        squares += counted / most * (counted / most);
    }
    return sum < -(m->integrated ? walk_counts * most * sqrt(squares)
                                 : error_counts * sqrt(2.0) * m->noise);
}

static void add(lac_motion *m, double time, double velocity, double rounding, double error)
{
    m->velocity_error[m->velocities] = error;
    m->rounding[m->velocities] = rounding + 4.0 * DBL_EPSILON * fabs(velocity);
    m->velocity_time[m->velocities] = time;
    m->velocity[m->velocities++] = velocity;
}

// Velocities of what falls are turned with it, speeds are not.
static void take_given(const lac_readings *r, lac_motion *m)
{
    double sum = 0.0;
    for (size_t i = 0; i < r->n; i++) {
        sum += isnan(r->velocity[i]) ? 0.0 : r->velocity[i];
    }
    const double sign = m->falling && sum < 0.0 ? -1.0 : 1.0;
    for (size_t i = 0; i < r->n; i++) {
        if (!isnan(r->velocity[i])) {
            add(m, r->time[i], sign * r->velocity[i] + 0.0, r->velocity_digit, NAN); // no -0
        }
    }
    const double noise =
        lac_noise_of(m->velocities, m->velocity_time, m->velocity, m->velocity_error);
    m->velocity_noise = noise < r->velocity_digit ? r->velocity_digit : noise;
    lac_noise_at(m->velocities, m->velocity_time, m->velocity, m->velocity_noise,
                 m->velocity_error);
    for (size_t i = 0; i < m->velocities; i++) {
        m->velocity_error[i] =
            m->velocity_error[i] < r->velocity_digit ? r->velocity_digit : m->velocity_error[i];
    }
}

// How far the last digits of two displacements, and the last bits of their times, move their
// secant.
static double secant_rounding(const lac_motion *m, size_t from, size_t to)
{
    const double *t = m->time;
    const double late = fmax(fabs(t[from]), fabs(t[to]));
    const double step = fabs(m->displacement[to] - m->displacement[from]);
    return (m->resolution + 2.0 * DBL_EPSILON * late * step / (t[to] - t[from])) /
           (t[to] - t[from]);
}

// v = (d_i - d_{i-1})/(t_i - t_{i-1}) at (t_i + t_{i-1})/2
static void take_secants(lac_motion *m)
{
    const double *t = m->time;
    for (size_t i = 1; i < m->n; i++) {
        add(m, t[i - 1] + 0.5 * (t[i] - t[i - 1]),
            (m->displacement[i] - m->displacement[i - 1]) / (t[i] - t[i - 1]),
            secant_rounding(m, i - 1, i), hypot(m->error[i - 1], m->error[i]) / (t[i] - t[i - 1]));
    }
}

// Of the mean of velocities from `first` on. That of a reading which ends a secant and begins the
// next one cancels where both are as long.
static double mean_error(const lac_motion *m, size_t first, size_t points, bool secants)
{
    const double *t = m->time + first;
    double squares = 0.0;
    for (size_t j = 0; j <= points && secants; j++) {
        const double part =
            (j > 0 ? 1.0 / (t[j] - t[j - 1]) : 0.0) - (j < points ? 1.0 / (t[j + 1] - t[j]) : 0.0);
        squares += part * part * m->error[first + j] * m->error[first + j];
    }
    return secants ? sqrt(squares) / (double)points
                   : sqrt(lac_dot(points, m->velocity_error + first, m->velocity_error + first)) /
                         (double)points;
}

// Means of `points` velocities each, in place.
static void average(size_t points, bool secants, lac_motion *m)
{
    const size_t before = points - 1;
    if (m->velocities < points) {
        m->velocities = 0;
        return;
    }
    for (size_t i = 0; i + before < m->velocities; i++) {
        double time = 0.0, sum = 0.0, squares = 0.0;
        for (size_t j = 0; j < points; j++) {
            time += m->velocity_time[i + j] - m->velocity_time[i];
            sum += m->velocity[i + j];
            squares += m->rounding[i + j] * m->rounding[i + j];
        }
        m->velocity_time[i] += time / (double)points;
        m->velocity[i] = sum / (double)points;
        m->rounding[i] = sqrt(squares) / (double)points;
        m->velocity_error[i] = mean_error(m, i, points, secants);
    }
    m->velocities -= before;
}

// Slope of the readings first ... last at the mean of their times.
static void add_slope(lac_motion *m, size_t first, size_t last)
{
    const double *t = m->time + first, *d = m->displacement + first;
    const size_t n = last - first + 1;
    double mean = 0.0, tt = 0.0, td = 0.0, squares = 0.0;
    for (size_t i = 0; i < n; i++) {
        mean += (t[i] - t[0]) / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        const double x = t[i] - t[0] - mean;
        tt += x * x;
        td += x * (d[i] - d[0]);
        squares += x * x * m->error[first + i] * m->error[first + i];
    }
    add(m, t[0] + mean, td / tt, secant_rounding(m, first, last), sqrt(squares) / tt);
}

// Windows reach a whole `window` back, and hold two readings or more.
static void take_windows(double window, lac_motion *m)
{
    size_t first = 0;
    for (size_t i = 1; i < m->n; i++) {
        const double start = m->time[i] - window * (1.0 + 1e-9);
        for (; m->time[first] < start; first++) {
        }
        if (m->time[0] <= m->time[i] - window * (1.0 - 1e-9) && first < i) {
            add_slope(m, first, i);
        }
    }
}

// Powers of the time before the last of `points` readings, in spans of them. @return the span
static double fill_powers(size_t points, size_t k, const double *t, double *columns)
{
    const double span = t[points - 1] - t[0];
    for (size_t i = 0; i < points; i++) {
        double power = 1.0;
        for (size_t j = 0; j < k; j++, power *= (t[i] - t[points - 1]) / span) {
            columns[j * points + i] = power;
        }
    }
    return span;
}

// Slope at its last reading of the polynomial through `points` readings. Its error is that of a
// reading over the part of its column that the others do not explain.
static lac_status take_polynomials(size_t points, size_t order, lac_motion *m, lac_error *err)
{
    const size_t k = order + 1;
    double c[LAC_LEAST_SQUARES_MAX];
    double *columns = malloc((k + 1) * points * sizeof *columns);
    LAC_FAIL_MEMORY_IF(columns == NULL, err);
    double *y = columns + k * points;
    for (size_t last = points - 1; last < m->n; last++) {
        const size_t first = last + 1 - points;
        const double span = fill_powers(points, k, m->time + first, columns);
        memcpy(y, columns + points, points * sizeof *y);
        memmove(columns + points, columns + 2 * points, (k - 2) * points * sizeof *columns);
        const double own = lac_least_squares(points, k - 1, columns, y, c);
        (void)fill_powers(points, k, m->time + first, columns);
        memcpy(y, m->displacement + first, points * sizeof *y);
        (void)lac_least_squares(points, k, columns, y, c);
        // |p'| <= 2 k^2 max|p|/span of a polynomial of order k (Markov)
        add(m, m->time[last], c[1] / span,
            (double)(order * order) * secant_rounding(m, first, last),
            m->error[last] / (sqrt(own) * span));
    }
    free(columns);
    return LAC_OK;
}

// Velocities by secants, means, windows or polynomials; none looks ahead.
static lac_status differentiate(const lac_motion_def *def, const lac_readings *readings,
                                lac_motion *m, lac_error *err)
{
    if (def->smoothing == LAC_SMOOTH_SAVGOL) {
        return take_polynomials(def->points, def->order, m, err);
    }
    if (def->smoothing == LAC_SMOOTH_WINDOW) {
        take_windows(def->window, m);
    } else if (readings->velocity != NULL) {
        take_given(readings, m);
    } else {
        take_secants(m);
    }
    if (def->smoothing == LAC_SMOOTH_AVERAGE) {
        average(def->points, readings->velocity == NULL, m);
    }
    return LAC_OK;
}

lac_readings lac_series_readings(const lac_series *s)
{
    return (lac_readings){.n = s->n,
                          .time = s->time,
                          .displacement = s->displacement,
                          .velocity = s->velocity,
                          .sigma = s->sigma,
                          .displacement_digit = s->displacement_digit,
                          .velocity_digit = s->velocity_digit,
                          .displacement_digits = s->displacement_digits,
                          .velocity_digits = s->velocity_digits};
}

static lac_status check(const lac_motion_def *def, const lac_readings *readings, lac_error *err)
{
    const bool polynomial = def->smoothing == LAC_SMOOTH_SAVGOL;
    LAC_FAIL_IF(readings->displacement == NULL && readings->velocity == NULL, err, LAC_EINPUT,
                "neither displacement nor velocity is given");
    LAC_FAIL_IF(def->smoothing == LAC_SMOOTH_AVERAGE && def->points < 2, err, LAC_EINPUT,
                "a moving average must be of 2 or more velocities");
    LAC_FAIL_IF(polynomial && (def->order < 1 || def->order + 1 >= LAC_LEAST_SQUARES_MAX ||
                               def->points <= def->order),
                err, LAC_EINPUT,
                "a Savitzky-Golay filter must have an order of 1 to %d and more points than that",
                LAC_LEAST_SQUARES_MAX - 2);
    LAC_FAIL_IF(def->smoothing == LAC_SMOOTH_WINDOW &&
                    !(def->window > 0.0 && isfinite(def->window)),
                err, LAC_EINPUT, "the window of velocities must be > 0 s");
    return LAC_OK;
}

static void keep_displacements(const lac_readings *r, lac_motion *m)
{
    double most = 0.0;
    for (size_t i = 0; i < r->n; i++) {
        if (!isnan(r->displacement[i])) {
            m->time[m->n] = r->time[i];
            m->displacement[m->n] = r->displacement[i];
            m->sigma[m->n] = r->sigma != NULL ? r->sigma[i] : NAN;
            most = fmax(most, fabs(r->displacement[i]));
            m->n++;
        }
    }
    m->resolution = fmax(r->displacement_digit, DBL_EPSILON * most);
}

// Where there are velocities only: their integral, by trapezoids.
static void integrate(const lac_readings *r, lac_motion *m)
{
    double sum = 0.0, before = 0.0;
    m->integrated = true;
    for (size_t i = 0; i < r->n; i++) {
        if (isnan(r->velocity[i])) {
            continue;
        }
        if (m->n > 0) {
            sum += 0.5 * (before + r->velocity[i]) * (r->time[i] - m->time[m->n - 1]);
        }
        before = r->velocity[i];
        m->time[m->n] = r->time[i];
        m->displacement[m->n] = sum;
        m->sigma[m->n++] = NAN;
    }
}

static void turn(lac_motion *m)
{
    for (size_t i = 0; i < m->n && m->falling; i++) {
        m->displacement[i] = 0.0 - m->displacement[i]; // no -0
    }
}

static void take(const lac_motion_def *def, const lac_readings *r, lac_motion *m)
{
    double *const work = m->velocity;
    if (r->displacement != NULL) {
        keep_displacements(r, m);
    } else {
        integrate(r, m);
    }
    measure(m, work);
    m->falling = motion_falls(m, work);
    turn(m);
    if (def->raw || m->integrated || lac_motion_clean(m, work)) {
        return;
    }
    m->disbelieved = m->resets;
    m->n = m->resets = m->outliers = 0;
    keep_displacements(r, m);
    turn(m);
}

// Of each displacement; a signal over decades has no more where it is weak than it shows there.
static void find_errors(lac_motion *m)
{
    lac_noise_at(m->n, m->time, m->displacement, m->noise, m->error);
    for (size_t i = 0; i < m->n; i++) {
        const double least = m->integrated ? 0.0 : m->resolution;
        m->error[i] = m->sigma[i] > 0.0 ? m->sigma[i] : m->error[i] < least ? least : m->error[i];
    }
}

lac_status lac_motion_create(const lac_motion_def *def, const lac_readings *readings,
                             lac_motion **out, lac_error *err)
{
    const size_t n = readings->n;
    *out = NULL;
    LAC_TRY_RETURN(check(def, readings, err));
    lac_motion *m = *out = calloc(1, sizeof *m + 8 * n * sizeof *m->time);
    LAC_FAIL_MEMORY_IF(m == NULL, err);
    m->time = (double *)(m + 1);
    m->displacement = m->time + n;
    m->sigma = m->displacement + n;
    m->velocity_time = m->sigma + n;
    m->velocity = m->velocity_time + n;
    m->rounding = m->velocity + n;
    m->velocity_error = m->rounding + n;
    m->error = m->velocity_error + n;
    m->velocity_noise = NAN;
    take(def, readings, m);
    find_errors(m);
    const lac_status status = differentiate(def, readings, m, err);
    LAC_MADE(status, out, lac_motion_free);
}

void lac_motion_free(lac_motion *motion) { free(motion); }
