// SPDX-License-Identifier: GPL-3.0-or-later
// Readings made ready for forecasts: cleaned, turned so that they rise, and differentiated.
#include "base/fail.h"
#include "series/clean.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "base/least_squares.h"

lac_readings lac_series_readings(const lac_series *s)
{
    return (lac_readings){.n = s->n,
                          .time = s->time,
                          .displacement = s->displacement,
                          .velocity = s->velocity,
                          .sigma = s->sigma,
                          .displacement_digit = s->displacement_digit,
                          .velocity_digit = s->velocity_digit};
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

// The readings that have a displacement.
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
    double sum = 0.0;
    double before = 0.0;
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
        m->displacement[i] = -m->displacement[i];
    }
}

static void take(const lac_motion_def *def, const lac_readings *r, double *work, lac_motion *m)
{
    if (r->displacement != NULL) {
        keep_displacements(r, m);
    } else {
        integrate(r, m);
    }
    lac_motion_measure(m, work);
    m->falling = lac_motion_falls(m, work);
    turn(m);
    if (def->raw || m->integrated || lac_motion_clean(m)) {
        return;
    }
    m->disbelieved = m->resets;
    m->n = m->resets = m->outliers = 0;
    keep_displacements(r, m);
    turn(m);
}

lac_status lac_motion_create(const lac_motion_def *def, const lac_readings *readings,
                             lac_motion **out, lac_error *err)
{
    *out = NULL;
    lac_status status = check(def, readings, err);
    if (status != LAC_OK) {
        return status;
    }
    const size_t size = readings->n > 0 ? readings->n : 1;
    lac_motion *m = calloc(1, sizeof *m);
    double *work = malloc(size * sizeof *work);
    status = m != NULL && work != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    m->time = malloc(size * sizeof *m->time);
    m->displacement = malloc(size * sizeof *m->displacement);
    m->sigma = malloc(size * sizeof *m->sigma);
    if (m->time == NULL || m->displacement == NULL || m->sigma == NULL) {
        LAC_TRY(lac_fail_memory(err));
    }
    take(def, readings, work, m);
    LAC_TRY(lac_motion_differentiate(def, readings, m, err));
    *out = m;
    m = NULL;
out:
    lac_motion_free(m);
    free(work);
    return status;
}

void lac_motion_free(lac_motion *motion)
{
    if (motion == NULL) {
        return;
    }
    free(motion->time);
    free(motion->displacement);
    free(motion->sigma);
    free(motion->velocity_time);
    free(motion->velocity);
    free(motion->rounding);
    free(motion);
}
