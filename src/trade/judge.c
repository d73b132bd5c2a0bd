// SPDX-License-Identifier: GPL-3.0-or-later
// Errors, the Pareto front, and what to recommend.
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

// Whether a run may be recommended.
static bool counts(const lac_trade_run *run)
{
    return (run->why & LAC_TRADE_TRIED) != 0 && run->end == LAC_TRADE_DONE && !isnan(run->error);
}

void lac_pareto_front(size_t n, lac_trade_run *run, double floor)
{
    for (size_t i = 0; i < n; i++) {
        const double e = fmax(run[i].error, floor), cost = run[i].m.cpu_time;
        run[i].on_front = counts(&run[i]);
        for (size_t j = 0; j < n && run[i].on_front; j++) {
            const double f = fmax(run[j].error, floor), other = run[j].m.cpu_time;
            const bool better = other < cost || f < e;
            run[i].on_front = !(counts(&run[j]) && other <= cost && f <= e && better);
        }
    }
}

static double value_of(const lac_trade *trade, size_t run, int quantity)
{
    const bool done = run != SIZE_MAX && trade->run[run].end == LAC_TRADE_DONE;
    return done ? trade->run[run].m.value[quantity] : NAN;
}

// The reference, or where that could not be run, what is one or two rungs coarser.
static const lac_trade_run *find_reference(const lac_trade *trade)
{
    size_t at = trade->finest;
    for (size_t k = 0; k < 2 * trade->settings; k++) {
        if (at != SIZE_MAX && trade->run[at].end == LAC_TRADE_DONE) {
            break;
        }
        at = trade->coarser[k / 2][k % 2];
    }
    return at != SIZE_MAX && trade->run[at].end == LAC_TRADE_DONE ? &trade->run[at] : NULL;
}

// Errors of the ladders add up. Of a reference that is not the finest one nothing is known but what
// the next rung changed.
static double uncertainty(const lac_trade *trade, double fine)
{
    const double scale = fine != 0.0 ? fabs(fine) : 1.0;
    const size_t reference = (size_t)(trade->reference - trade->run);
    double sum = 0.0;
    bool known = false;
    for (size_t d = 0; d < trade->settings; d++) {
        const size_t *rung = trade->coarser[d];
        double middle = value_of(trade, rung[0], trade->quantity);
        double coarse = value_of(trade, rung[1], trade->quantity);
        if (reference == rung[0]) {
            middle = coarse;
            coarse = NAN;
        }
        if (reference == rung[1] || isnan(middle)) {
            continue;
        }
        sum += lac_richardson_error(coarse, middle, fine, trade->setting[d].setting->ratio);
        known = true;
    }
    // Counts jump by ones: that two are alike says no more.
    const double least = trade->quantity == LAC_QUANTITY_EVENTS ? 1.0 : DBL_EPSILON * scale;
    return known ? fmax(sum, least) / scale : NAN;
}

static int choose_quantity(const lac_trade *trade, const lac_trade_request *ask,
                           const double *value)
{
    if (ask->quantity >= 0) {
        return ask->quantity;
    }
    if (trade->of != LAC_OF_RUN) {
        return trade->of == LAC_OF_CASCADE ? LAC_QUANTITY_CRITICAL : LAC_QUANTITY_FRACTION;
    }
    if (!isnan(value[LAC_QUANTITY_FAILURE])) {
        return LAC_QUANTITY_FAILURE;
    }
    return isnan(value[LAC_QUANTITY_LIMIT]) ? LAC_QUANTITY_SLIP : LAC_QUANTITY_LIMIT;
}

static lac_status no_quantity(int quantity, lac_error *err)
{
    static const char *const why[LAC_QUANTITIES] = {
        [LAC_QUANTITY_FAILURE] =
            "the reference does not fail by its end; slip or rate can be asked for",
        [LAC_QUANTITY_EVENTS] = "the case keeps no catalogue; name it, analysis: {events: {...}}",
        [LAC_QUANTITY_DIMENSION] =
            "boxes of the contact cannot be counted; contact-fraction can be asked for",
        [LAC_QUANTITY_WORK] = "the case has no load.history to do any",
    };
    return lac_fail(err, LAC_EINPUT, "--quantity %s: %s", lac_quantities[quantity].name,
                    why[quantity] != NULL ? why[quantity] : "the reference has none");
}

// Error that a run is sure to keep.
static double bound(const lac_trade_run *run)
{
    return run->error + (isnan(run->uncertainty) ? 0.0 : run->uncertainty);
}

// Relative error to be reached: a hundredth where nothing is asked for.
static double reach_of(const lac_trade_request *ask, double value)
{
    if (!isnan(ask->within)) {
        return value != 0.0 ? ask->within / fabs(value) : ask->within;
    }
    return !isnan(ask->reach) ? ask->reach : isnan(ask->budget) ? 0.01 : INFINITY;
}

// The cheapest that reaches the error, or the best that takes no longer than asked.
static void recommend(lac_trade *trade, const lac_trade_request *ask)
{
    const bool by_time = !isnan(ask->budget);
    const double reach = reach_of(ask, trade->reference->value);
    const bool by_time_only = by_time && isinf(reach);
    trade->recommended = trade->closest = NULL;
    for (const lac_trade_run *run = trade->run; run < trade->run + trade->runs; run++) {
        const lac_trade_run *best = trade->recommended, *near = trade->closest;
        if (!counts(run)) {
            continue;
        }
        const double cost = run->m.cpu_time, error = fmax(bound(run), DBL_EPSILON);
        const bool quick = !by_time || cost <= ask->budget, good = error <= reach;
        bool better = best == NULL || cost < best->m.cpu_time;
        if (best != NULL && by_time_only) {
            better =
                bound(run) < bound(best) || (bound(run) == bound(best) && cost < best->m.cpu_time);
        }
        trade->recommended = quick && good && better ? run : best;
        const bool nearer =
            near == NULL || (by_time_only ? cost < near->m.cpu_time : error < bound(near));
        trade->closest = nearer ? run : near;
    }
}

// Numbers by value, from small to large; else by name.
static int compare_labels(const char *a, const char *b)
{
    char *end_a, *end_b;
    const double x = strtod(a, &end_a), y = strtod(b, &end_b);
    const bool numbers = end_a != a && end_b != b && *end_a == '\0' && *end_b == '\0';
    return !numbers ? strcmp(a, b) : (x > y) - (x < y);
}

// The order of a table: what is turned against a rung of the ladder stays together.
static bool stands_before(const lac_trade_run *a, const lac_trade_run *b)
{
    const lac_trade *trade = a->of;
    for (size_t d = 0; d < trade->settings; d++) {
        const int order = compare_labels(a->label[d], b->label[d]);
        if (d != trade->ladder && order != 0) {
            return order < 0;
        }
    }
    return trade->ladder != SIZE_MAX && a->at[trade->ladder] < b->at[trade->ladder];
}

// Lists those tried in the order of a table, behind them those refused.
static lac_status list(lac_trade *trade, lac_error *err)
{
    lac_trade_run *const end = trade->run + trade->runs;
    free(trade->row);
    trade->row = calloc(trade->runs, sizeof *trade->row);
    LAC_FAIL_MEMORY_IF(trade->row == NULL, err);
    trade->rows = trade->refusals = 0;
    for (lac_trade_run *run = trade->run; run < end; run++) {
        run->of = trade;
        if ((run->why & LAC_TRADE_TRIED) != 0 && run->end >= LAC_TRADE_DONE &&
            run->end <= LAC_TRADE_GIVEN_UP) {
            size_t at = trade->rows++;
            for (; at > 0 && stands_before(run, trade->row[at - 1]); at--) {
                trade->row[at] = trade->row[at - 1];
            }
            trade->row[at] = run;
        }
    }
    for (const lac_trade_run *run = trade->run; run < end; run++) {
        if (run->end == LAC_TRADE_REFUSED) {
            trade->row[trade->rows + trade->refusals++] = run;
        }
    }
    return LAC_OK;
}

lac_status lac_trade_judge(lac_trade *trade, const lac_trade_request *ask, lac_error *err)
{
    const lac_trade_run *reference = find_reference(trade);
    LAC_FAIL_IF(reference == NULL, err, LAC_ENUMERIC,
                "no run that could be the reference was done: %s",
                trade->run[trade->finest].message);
    trade->reference = reference;
    trade->quantity = choose_quantity(trade, ask, reference->m.value);
    const lac_quantity_about *info = &lac_quantities[trade->quantity];
    const double value = reference->m.value[trade->quantity];
    if (isnan(value)) {
        return no_quantity(trade->quantity, err);
    }
    LAC_FAIL_IF(!isnan(ask->within) && ask->unit != NULL && strcmp(ask->unit, info->unit) != 0, err,
                LAC_EINPUT, "--reach: is in %s, but the quantity is the %s, in %s (--quantity %s)",
                ask->unit, info->doc, info->unit, info->name);
    const double unsure = uncertainty(trade, value);
    for (size_t i = 0; i < trade->runs; i++) {
        lac_trade_run *run = &trade->run[i];
        run->value = value_of(trade, i, trade->quantity);
        run->error = fabs(run->value - value) / (value != 0.0 ? fabs(value) : 1.0);
        run->uncertainty = unsure;
    }
    lac_pareto_front(trade->runs, trade->run, isnan(unsure) ? 0.0 : unsure);
    LAC_TRY_RETURN(list(trade, err));
    recommend(trade, ask);
    return LAC_OK;
}
