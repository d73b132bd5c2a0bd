// SPDX-License-Identifier: GPL-3.0-or-later
// The settings and the quantities: a row each, how a case has the one and a run the other.
#include "trade/probe.h"

lac_setting_value lac_setting_number(double value)
{
    lac_setting_value out;
    (void)snprintf(out.label, sizeof out.label, "%.10g", value);
    memcpy(out.yaml, out.label, sizeof out.label);
    return out;
}

// Names between spaces, which themselves are what the key takes.
static size_t put_names(const char *names, lac_setting_value *out)
{
    size_t n = 0;
    for (; *names != '\0'; names += strspn(names, " ")) {
        const int size = (int)strcspn(names, " ");
        (void)snprintf(out[n].label, sizeof out[n].label, "%.*s", size, names);
        memcpy(out[n].yaml, out[n].label, sizeof out[n].label);
        names += size;
        n++;
    }
    return n;
}

// rtol: decades from 1e-3 to 1e-7, on to the case's own, which is among them.
static size_t rtol_values(const lac_case *c, lac_trade_of of, lac_setting_value *out)
{
    (void)of;
    const double own = c->run.rtol, coarsest = fmax(1e-3, own), finest = fmin(1e-7, own);
    size_t n = 0;
    bool seen = false;
    for (int k = 1; k <= 13 && n + 2 < LAC_SETTING_VALUES; k++) {
        const double decade = pow(10.0, -k);
        if (!seen && own > decade * 1.01) {
            out[n++] = lac_setting_number(own);
            seen = true;
        }
        seen = seen || fabs(own / decade - 1.0) <= 0.01;
        if (decade <= coarsest * 1.01 && decade >= finest * 0.99) {
            out[n++] = lac_setting_number(fabs(own / decade - 1.0) <= 0.01 ? own : decade);
        }
    }
    if (!seen) {
        out[n++] = lac_setting_number(own);
    }
    return n;
}

static size_t method_values(const lac_case *c, lac_trade_of of, lac_setting_value *out)
{
    (void)of;
    return put_names(c->run.fidelity == LAC_FIDELITY_ASYNC ? "" : "bdf adams erk", out);
}

static size_t formulation_values(const lac_case *c, lac_trade_of of, lac_setting_value *out)
{
    (void)of;
    bool fixed = c->run.fidelity == LAC_FIDELITY_ASYNC || lac_inertia_mass(c) > 0.0 ||
                 c->geometry.angles > 0;
    return put_names(fixed ? "" : "rate traction slip", out);
}

static size_t fidelity_values(const lac_case *c, lac_trade_of of, lac_setting_value *out)
{
    if (of == LAC_OF_CASCADE) {
        bool runs = c->friction.info != NULL && !isnan(c->run.end);
        return put_names(runs ? "static lumped events ode" : "", out);
    }
    const lac_transfer_kind *kind = (const void *)c->transfer.info;
    bool both = kind != NULL && kind->blocks != NULL && lac_inertia_mass(c) <= 0.0 &&
                c->geometry.angles == 0;
    return put_names(both && lac_case_admits_lumped(c) ? "lumped events ode"
                     : both                            ? "events ode"
                                                       : "",
                     out);
}

// The grid, halved and halved again.
static size_t levels_values(const lac_case *c, lac_trade_of of, lac_setting_value *out)
{
    (void)of;
    const int64_t own = c->interface.levels;
    size_t n = 0;
    for (int64_t level = own - 2; own > 0 && level <= own; level++) {
        if (level > 0) {
            out[n++] = lac_setting_number((double)level);
        }
    }
    return n;
}

// Where cells take one another's load.
static size_t transfer_values(const lac_case *c, lac_trade_of of, lac_setting_value *out)
{
    lac_transfer_outline ignored;
    (void)of;
    if (!lac_transfer_outline_of(&c->transfer, &ignored) || isnan(c->material.shear_modulus)) {
        return 0;
    }
    out[0] = (lac_setting_value){"hierarchy", "{hierarchy: {stiffness: elastic}}"};
    out[1] = (lac_setting_value){"elastic", "{elastic: {}}"};
    return 2;
}

static size_t planning_values(const lac_case *c, lac_trade_of of, lac_setting_value *out)
{
    (void)of;
    const lac_transfer_kind *kind = (const void *)c->transfer.info;
    return kind != NULL && kind->transforms ? put_names("estimate measure", out) : 0;
}

static size_t precision_values(const lac_case *c, lac_trade_of of, lac_setting_value *out)
{
    (void)c, (void)of;
    return put_names("float double", out);
}

// A whole number from its quarter or half up to the case's own.
static size_t count_values(int64_t own, int64_t factor, int64_t least, lac_setting_value *out)
{
    int64_t value = own;
    size_t n = 0;
    while (value / factor >= least && n < 2) {
        value /= factor;
        n++;
    }
    for (size_t i = 0; i <= n; i++) {
        out[i] = lac_setting_number((double)(i == n ? own : value));
        value *= factor;
    }
    return n + 1;
}

static size_t contacts_values(const lac_case *c, lac_trade_of of, lac_setting_value *out)
{
    (void)of;
    return c->rg.field == LAC_RG_ELASTIC ? count_values(c->rg.contacts, 2, 10, out) : 0;
}

static size_t shifts_values(const lac_case *c, lac_trade_of of, lac_setting_value *out)
{
    (void)of;
    return count_values(c->rg.shifts, 4, 1, out);
}

static size_t field_values(const lac_case *c, lac_trade_of of, lac_setting_value *out)
{
    (void)of;
    const bool pressed = c->surface.info != NULL && !isnan(c->material.shear_modulus);
    return put_names(pressed ? "uniform equal elastic" : "uniform equal", out);
}

enum { RUN = LAC_OF_RUN, CASCADE_TOO = LAC_OF_RUN | LAC_OF_CASCADE, RG = LAC_OF_CASCADE };

#define DIAL(title, where, has, of, ...)                                                  \
    {                                                                                     \
        .name = (title), .key = (where), .values = has##_values, .use = (of), __VA_ARGS__ \
    }

// rtol: tenfold at most, and mostly five- to sevenfold: docs/trade.md
static const lac_setting settings[] = {
    DIAL("rtol", "solver.rtol", rtol, RUN, .falls = true, .ratio = 4, .finer = 0.1,
         .finest = 1e-13),
    DIAL("method", "solver.method", method, RUN),
    DIAL("formulation", "solver.formulation", formulation, RUN),
    DIAL("fidelity", "solver.fidelity", fidelity, CASCADE_TOO, .asked = CASCADE_TOO, .scene = true,
         .cascade = "static", .coarse = "lumped", .coarse_keys = "solver.lump"),
    DIAL("levels", "interface.levels", levels, CASCADE_TOO | LAC_OF_CONTACT, .asked = CASCADE_TOO,
         .scene = true, .ratio = 4),
    DIAL("transfer", "transfer", transfer, RUN, .asked = RUN, .scene = true),
    DIAL("planning", "solver.fft_planning", planning, RUN, .asked = RUN),
    DIAL("precision", "output.precision", precision, RUN, .asked = RUN),
    DIAL("field", "rg.field", field, RG, .asked = RG, .scene = true),
    DIAL("contacts", "rg.contacts", contacts, RG, .ratio = 4, .finer = 2,
         .finest = LAC_RG_MOST_LOADS),
    DIAL("shifts", "rg.shifts", shifts, RG, .ratio = 2, .finer = 4, .finest = 10000),
};

LAC_ROWS_AT(lac_setting, lac_setting_get, settings)

void lac_setting_current(const lac_setting *setting, const lac_case *c,
                         char label[LAC_SETTING_LABEL])
{
    const lac_param *row = lac_case_row(setting->key);
    const void *at = row != NULL ? (const char *)c + row->offset : NULL;
    if (row == NULL) {
        const lac_model_info *info = c->transfer.info;
        (void)snprintf(label, LAC_SETTING_LABEL, "%s", info != NULL ? info->name : "none");
    } else if (!lac_param_given(row, c)) {
        (void)snprintf(label, LAC_SETTING_LABEL, "-");
    } else if (row->type == LAC_CHOICE) {
        (void)snprintf(label, LAC_SETTING_LABEL, "%s", row->choices[*(const int *)at]);
    } else if (row->type == LAC_INTEGER) {
        (void)snprintf(label, LAC_SETTING_LABEL, "%" PRId64, *(const int64_t *)at);
    } else {
        (void)snprintf(label, LAC_SETTING_LABEL, "%.10g", *(const double *)at);
    }
}

const lac_quantity_about lac_quantities[] = {
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
    [LAC_QUANTITIES] = {.name = NULL},
};

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
    const lac_observation *seen = &record->observation;
    const double load = seen->shear_force / (probe->friction * seen->effective_force);
    probe->load = isnan(probe->rate) || load > probe->load ? load : probe->load;
    probe->rate = seen->mean_rate;
    return probe->next.record != NULL ? probe->next.record(probe->next.context, record, err)
                                      : LAC_OK;
}

static lac_status on_event(void *context, const lac_event *event, lac_error *err)
{
    lac_trade_probe *probe = context;
    probe->events++;
    return probe->next.event != NULL ? probe->next.event(probe->next.context, event, err) : LAC_OK;
}

lac_sink lac_trade_probe_start(lac_trade_probe *probe, const lac_case *c, const lac_sink *next)
{
    *probe = (lac_trade_probe){.next = *next, .friction = coulomb(c), .rate = NAN, .load = NAN};
    lac_sink sink = lac_sink_before(&probe->next);
    sink.record = on_record;
    sink.event = on_event;
    sink.checkpoint = NULL; // a run of a trade begins anew
    return sink;
}

void lac_trade_probe_values(const lac_trade_probe *probe, const lac_run_result *result,
                            bool catalogue, double *value)
{
    value[LAC_QUANTITY_FAILURE] =
        result->failed ? result->failure_origin + result->failure_local : NAN;
    value[LAC_QUANTITY_LIMIT] = result->end == LAC_END_STOP ? result->time : NAN;
    value[LAC_QUANTITY_SLIP] = result->mean_slip;
    value[LAC_QUANTITY_RATE] = probe->rate;
    value[LAC_QUANTITY_PEAK] = result->max_slip_rate;
    value[LAC_QUANTITY_CRITICAL] = probe->load;
    value[LAC_QUANTITY_EVENTS] = catalogue ? (double)probe->events : NAN;
}
