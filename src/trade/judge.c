// SPDX-License-Identifier: GPL-3.0-or-later
// Errors, the Pareto front, and what to recommend.
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "trade/trade.h"

double lac_richardson_error(double coarse, double middle, double fine, double ratio)
{
    const double least = 0.05; // of the change before: two that agree may do so by chance
    const double last = fabs(middle - fine), before = fabs(coarse - middle);
    if (!(before > 1.5 * last)) {
        return last; // also where coarse is none
    }
    // Errors fall by r a rung: what is left is last/(r - 1).
    return fmax(last / (fmin(before / last, ratio) - 1.0), least * before);
}

void lac_pareto_front(size_t n, const double *cost, const double *error, double floor,
                      bool *on_front)
{
    for (size_t i = 0; i < n; i++) {
        const double e = fmax(error[i], floor);
        on_front[i] = !isnan(cost[i]) && !isnan(error[i]);
        for (size_t j = 0; j < n && on_front[i]; j++) {
            const double f = fmax(error[j], floor);
            const bool known = !isnan(cost[j]) && !isnan(error[j]);
            const bool better = cost[j] < cost[i] || f < e;
            on_front[i] = !(known && cost[j] <= cost[i] && f <= e && better);
        }
    }
}

static double value_of(const lac_trade_measure *measure, size_t run, int quantity)
{
    return run != SIZE_MAX && measure[run].end == LAC_TRADE_DONE ? measure[run].value[quantity]
                                                                 : NAN;
}

// The reference, or where that could not be run, what is one or two rungs coarser.
static size_t find_reference(const lac_trade_plan *plan, const lac_trade_measure *measure)
{
    if (measure[plan->reference].end == LAC_TRADE_DONE) {
        return plan->reference;
    }
    for (size_t d = 0; d < plan->settings; d++) {
        const size_t coarser = plan->coarser[d], coarsest = plan->coarsest[d];
        if (coarser != SIZE_MAX && measure[coarser].end == LAC_TRADE_DONE) {
            return coarser;
        }
        if (coarsest != SIZE_MAX && measure[coarsest].end == LAC_TRADE_DONE) {
            return coarsest;
        }
    }
    return SIZE_MAX;
}

// Errors of the ladders add up. Of a reference that is not the finest one nothing is known but what
// the next rung changed.
static double uncertainty(const lac_trade_plan *plan, const lac_trade_measure *measure,
                          const lac_trade_result *v)
{
    const double scale = v->value != 0.0 ? fabs(v->value) : 1.0;
    double sum = 0.0;
    bool known = false;
    for (size_t d = 0; d < plan->settings; d++) {
        double fine = v->value, middle = value_of(measure, plan->coarser[d], v->quantity);
        double coarse = value_of(measure, plan->coarsest[d], v->quantity);
        if (v->reference == plan->coarser[d]) {
            middle = coarse;
            coarse = NAN;
        }
        if (v->reference == plan->coarsest[d] || isnan(middle)) {
            continue;
        }
        sum += lac_richardson_error(coarse, middle, fine, plan->setting[d].setting->ratio);
        known = true;
    }
    // Counts jump by ones: that two are alike says no more.
    const double least = v->quantity == LAC_QUANTITY_EVENTS ? 1.0 : DBL_EPSILON * scale;
    return known ? fmax(sum, least) / scale : NAN;
}

static int choose_quantity(const lac_trade_plan *plan, const lac_trade_request *ask,
                           const double *value)
{
    if (ask->quantity >= 0) {
        return ask->quantity;
    }
    if (plan->of != LAC_OF_RUN) {
        return plan->of == LAC_OF_CASCADE ? LAC_QUANTITY_CRITICAL : LAC_QUANTITY_FRACTION;
    }
    if (!isnan(value[LAC_QUANTITY_FAILURE])) {
        return LAC_QUANTITY_FAILURE;
    }
    return isnan(value[LAC_QUANTITY_LIMIT]) ? LAC_QUANTITY_SLIP : LAC_QUANTITY_LIMIT;
}

static lac_status no_quantity(int quantity, lac_error *err)
{
    switch (quantity) {
    case LAC_QUANTITY_FAILURE:
        return lac_fail(err, LAC_EINPUT,
                        "--quantity failure: the reference does not fail by its end; slip or rate "
                        "can be asked for");
    case LAC_QUANTITY_EVENTS:
        return lac_fail(
            err, LAC_EINPUT,
            "--quantity events: the case keeps no catalogue; name it, analysis: {events: {...}}");
    case LAC_QUANTITY_DIMENSION:
        return lac_fail(err, LAC_EINPUT,
                        "--quantity dimension: boxes of the contact cannot be counted; "
                        "contact-fraction can be asked for");
    case LAC_QUANTITY_WORK:
        return lac_fail(err, LAC_EINPUT, "--quantity work: the case has no load.history to do any");
    default:
        return lac_fail(err, LAC_EINPUT, "--quantity %s: the reference has none",
                        lac_quantity_about_of(quantity)->name);
    }
}

static lac_status other_unit(int quantity, const char *unit, lac_error *err)
{
    const lac_quantity_about *info = lac_quantity_about_of(quantity);
    return lac_fail(err, LAC_EINPUT,
                    "--reach: is in %s, but what is traded is the %s, in %s (--quantity %s)", unit,
                    info->doc, info->unit, info->name);
}

// Whether a run may be recommended, and what it costs.
static bool is_tried(const lac_trade_plan *plan, const lac_trade_measure *measure,
                     const lac_trade_result *v, size_t i)
{
    return (plan->run[i].why & LAC_TRADE_TRIED) != 0 && measure[i].end == LAC_TRADE_DONE &&
           !isnan(v->error[i]);
}

// Error that a run is sure to keep.
static double bound(const lac_trade_result *v, size_t i)
{
    return v->error[i] + (isnan(v->uncertainty) ? 0.0 : v->uncertainty);
}

// Relative error to be reached: a hundredth where nothing is asked for.
static double reach_of(const lac_trade_request *ask, const lac_trade_result *v)
{
    if (!isnan(ask->within)) {
        return v->value != 0.0 ? ask->within / fabs(v->value) : ask->within;
    }
    return !isnan(ask->reach) ? ask->reach : isnan(ask->budget) ? 0.01 : INFINITY;
}

// The cheapest that reaches the error, or the best that takes no longer than asked.
static void recommend(const lac_trade_plan *plan, const lac_trade_measure *measure,
                      const lac_trade_request *ask, lac_trade_result *v)
{
    const bool by_time = !isnan(ask->budget);
    const double reach = reach_of(ask, v);
    const bool by_time_only = by_time && isinf(reach);
    v->recommended = v->closest = SIZE_MAX;
    for (size_t i = 0; i < plan->runs; i++) {
        if (!is_tried(plan, measure, v, i)) {
            continue;
        }
        const double cost = measure[i].cpu_time, error = fmax(bound(v, i), DBL_EPSILON);
        const bool quick = !by_time || cost <= ask->budget, good = error <= reach;
        const size_t best = v->recommended;
        bool better = best == SIZE_MAX;
        if (!better && by_time_only) {
            better = bound(v, i) < bound(v, best) ||
                     (bound(v, i) == bound(v, best) && cost < measure[best].cpu_time);
        } else if (!better) {
            better = cost < measure[best].cpu_time;
        }
        v->recommended = quick && good && better ? i : best;
        const bool nearer =
            v->closest == SIZE_MAX ||
            (by_time_only ? cost < measure[v->closest].cpu_time : error < bound(v, v->closest));
        v->closest = nearer ? i : v->closest;
    }
}

static lac_status mark(const lac_trade_plan *plan, const lac_trade_measure *measure,
                       lac_trade_result *v, lac_error *err)
{
    const size_t n = plan->runs;
    const double scale = v->value != 0.0 ? fabs(v->value) : 1.0;
    double *cost = malloc(n * sizeof *cost);
    v->error = calloc(n, sizeof *v->error);
    v->on_front = calloc(n, sizeof *v->on_front);
    if (cost == NULL || v->error == NULL || v->on_front == NULL) {
        free(cost);
        return lac_fail_memory(err);
    }
    for (size_t i = 0; i < n; i++) {
        v->error[i] = fabs(value_of(measure, i, v->quantity) - v->value) / scale;
        cost[i] = is_tried(plan, measure, v, i) ? measure[i].cpu_time : NAN;
    }
    lac_pareto_front(n, cost, v->error, isnan(v->uncertainty) ? 0.0 : v->uncertainty, v->on_front);
    free(cost);
    return LAC_OK;
}

lac_status lac_trade_judge(const lac_trade_plan *plan, const lac_trade_measure *measure,
                           const lac_trade_request *ask, lac_trade_result *out, lac_error *err)
{
    *out = (lac_trade_result){.reference = find_reference(plan, measure)};
    LAC_FAIL_IF(out->reference == SIZE_MAX, err, LAC_ENUMERIC,
                "no run that could be the reference was done: %s",
                measure[plan->reference].message);
    const double *value = measure[out->reference].value;
    out->quantity = choose_quantity(plan, ask, value);
    out->value = value[out->quantity];
    if (isnan(out->value)) {
        return no_quantity(out->quantity, err);
    }
    const char *unit = lac_quantity_about_of(out->quantity)->unit;
    if (!isnan(ask->within) && ask->unit != NULL && strcmp(ask->unit, unit) != 0) {
        return other_unit(out->quantity, ask->unit, err);
    }
    out->uncertainty = uncertainty(plan, measure, out);
    lac_status status = mark(plan, measure, out, err);
    if (status == LAC_OK) {
        recommend(plan, measure, ask, out);
    }
    return status;
}

void lac_trade_result_clear(lac_trade_result *verdict)
{
    free(verdict->error);
    free(verdict->on_front);
    *verdict = (lac_trade_result){0};
}
