// SPDX-License-Identifier: GPL-3.0-or-later
// What is read off a run.
#include <math.h>
#include <stdio.h>

#include "lacuna/simulation.h"
#include "trade/trade.h"

static const lac_quantity_about quantities[] = {
    [LAC_QUANTITY_FAILURE] = {"failure", "s", "time of failure", false},
    [LAC_QUANTITY_LIMIT] = {"limit", "s", "time of the limit", false},
    [LAC_QUANTITY_SLIP] = {"slip", "m", "mean slip at the end", false},
    [LAC_QUANTITY_RATE] = {"rate", "m/s", "mean slip rate at the end", false},
    [LAC_QUANTITY_PEAK] = {"peak-rate", "m/s", "largest slip rate of a cell", false},
    [LAC_QUANTITY_CRITICAL] = {"q-crit", "1", "critical shear force over f P", false},
    [LAC_QUANTITY_EVENTS] = {"events", "1", "events of the catalogue", false},
    [LAC_QUANTITY_FRACTION] = {"contact-fraction", "1", "fraction in contact", true},
    [LAC_QUANTITY_PRESSURE] = {"pressure", "Pa", "mean normal pressure", true},
    [LAC_QUANTITY_DIMENSION] = {"dimension", "1", "box dimension", true},
    [LAC_QUANTITY_WORK] = {"work", "J", "frictional work", true},
};

const lac_quantity_about *lac_quantity_about_of(int quantity) { return &quantities[quantity]; }

// f0 of the friction law, unless `rg` has its own.
static double coulomb(const lac_case *c)
{
    char key[64];
    lac_case_value found;
    if (c->rg.named && !isnan(c->rg.friction)) {
        return c->rg.friction;
    }
    if (c->friction.info == NULL) {
        return NAN;
    }
    (void)snprintf(key, sizeof key, "friction.%s.f0", c->friction.info->name);
    // Nothing is changed through what is found.
    return lac_case_find((lac_case *)c, key, &found) ? *found.at : NAN;
}

static lac_status on_record(void *context, const lac_record *record, lac_error *err)
{
    lac_trade_probe *probe = context;
    const double load =
        record->observation.shear_force / (probe->friction * record->observation.effective_force);
    probe->load = probe->records == 0 || load > probe->load ? load : probe->load;
    probe->rate = record->observation.mean_rate;
    probe->records++;
    return probe->next->record != NULL ? probe->next->record(probe->next->context, record, err)
                                       : LAC_OK;
}

static lac_status on_snapshot(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    lac_trade_probe *probe = context;
    return probe->next->snapshot != NULL
               ? probe->next->snapshot(probe->next->context, snapshot, err)
               : LAC_OK;
}

static lac_status on_event(void *context, const lac_event *event, lac_error *err)
{
    lac_trade_probe *probe = context;
    probe->events++;
    return probe->next->event != NULL ? probe->next->event(probe->next->context, event, err)
                                      : LAC_OK;
}

static lac_status on_once(void *context, const double *values, lac_error *err)
{
    lac_trade_probe *probe = context;
    return probe->next->once != NULL ? probe->next->once(probe->next->context, values, err)
                                     : LAC_OK;
}

lac_trade_probe lac_trade_probe_create(const lac_case *c, const lac_sink *next)
{
    return (lac_trade_probe){.next = next, .friction = coulomb(c), .rate = NAN, .load = NAN};
}

lac_sink lac_trade_probe_sink(lac_trade_probe *probe)
{
    return (lac_sink){.size = sizeof(lac_sink),
                      .context = probe,
                      .record = on_record,
                      .snapshot = on_snapshot,
                      .event = on_event,
                      .once = on_once};
}

void lac_trade_probe_values(const lac_trade_probe *probe, const lac_run_result *result,
                            bool catalogue, double *value)
{
    for (int q = 0; q < LAC_QUANTITIES; q++) {
        value[q] = NAN;
    }
    value[LAC_QUANTITY_FAILURE] =
        result->failed ? result->failure_origin + result->failure_local : NAN;
    value[LAC_QUANTITY_LIMIT] = result->end == LAC_END_STOP ? result->time : NAN;
    value[LAC_QUANTITY_SLIP] = result->mean_slip;
    value[LAC_QUANTITY_RATE] = probe->rate;
    value[LAC_QUANTITY_PEAK] = result->max_slip_rate;
    value[LAC_QUANTITY_CRITICAL] = probe->load;
    value[LAC_QUANTITY_EVENTS] = catalogue ? (double)probe->events : NAN;
}
