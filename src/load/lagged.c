// SPDX-License-Identifier: GPL-3.0-or-later
// What follows a changing pressure with a time lag: exact where that is made of straight pieces.
#include "load/lagged.h"

#include <math.h>
#include <stdlib.h>

#include "load/table.h"

lac_status lac_lagged_create(size_t n, double lag, lac_lagged *out, lac_error *err)
{
    *out = (lac_lagged){.lag = lag};
    out->t = malloc(4 * n * sizeof *out->t);
    if (out->t == NULL) {
        return lac_fail_memory(err);
    }
    out->drive = out->t + n;
    out->slope = out->drive + n;
    out->u = out->slope + n;
    return LAC_OK;
}

void lac_lagged_add(lac_lagged *lagged, double t, double drive, double slope)
{
    size_t k = lagged->n++;
    lagged->t[k] = t;
    lagged->drive[k] = drive;
    lagged->slope[k] = slope;
}

// Response tau after the beginning of piece k: u -> p with exp(-tau/T), behind a rising p by T.
static lac_signal response(const lac_lagged *l, size_t k, double tau)
{
    if (l->lag == 0.0) {
        return (lac_signal){l->drive[k] + l->slope[k] * tau, l->slope[k]};
    }
    double x = tau / l->lag;
    double gone = -expm1(-x);
    double lack = l->drive[k] - l->u[k];
    double value = l->u[k] + lack * gone + l->slope[k] * l->lag * (x - gone);
    return (lac_signal){value, lack / l->lag * exp(-x) + l->slope[k] * gone};
}

void lac_lagged_settle(lac_lagged *lagged, double first)
{
    lagged->u[0] = first;
    for (size_t k = 1; k < lagged->n; k++) {
        lagged->u[k] = response(lagged, k - 1, lagged->t[k] - lagged->t[k - 1]).value;
    }
}

lac_signal lac_lagged_at(const lac_lagged *lagged, double t)
{
    size_t k = lac_readings_before(lagged->t, lagged->n, t);
    if (k == SIZE_MAX) {
        return (lac_signal){lagged->u[0], 0.0};
    }
    return response(lagged, k, t - lagged->t[k]);
}

void lac_lagged_clear(lac_lagged *lagged)
{
    free(lagged->t);
    *lagged = (lac_lagged){0};
}
