// SPDX-License-Identifier: GPL-3.0-or-later
// The dials: a row each.
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "trade/trade.h"

static void put(lac_dial_value *out, const char *label, const char *yaml)
{
    (void)snprintf(out->label, sizeof out->label, "%s", label);
    (void)snprintf(out->yaml, sizeof out->yaml, "%s", yaml);
}

static void put_number(lac_dial_value *out, double value)
{
    (void)snprintf(out->label, sizeof out->label, "%.10g", value);
    memcpy(out->yaml, out->label, sizeof out->label);
}

// The names themselves are what the key takes.
static size_t put_names(const char *const *names, size_t n, lac_dial_value *out)
{
    for (size_t i = 0; i < n; i++) {
        put(&out[i], names[i], names[i]);
    }
    return n;
}

// rtol: decades from 1e-3 to 1e-7, on to the case's own, which is among them.
static size_t rtol_values(const lac_case *c, lac_trade_of of, lac_dial_value *out)
{
    (void)of;
    const double own = c->run.rtol, coarsest = fmax(1e-3, own), finest = fmin(1e-7, own);
    size_t n = 0;
    bool seen = false;
    for (int k = 1; k <= 13 && n + 2 < LAC_DIAL_VALUES; k++) {
        const double decade = pow(10.0, -k);
        if (!seen && own > decade * 1.01) {
            put_number(&out[n++], own);
            seen = true;
        }
        seen = seen || fabs(own / decade - 1.0) <= 0.01;
        if (decade <= coarsest * 1.01 && decade >= finest * 0.99) {
            put_number(&out[n++], fabs(own / decade - 1.0) <= 0.01 ? own : decade);
        }
    }
    if (!seen) {
        put_number(&out[n++], own);
    }
    return n;
}

static void rtol_tighter(const lac_dial_value *last, lac_dial_value *out)
{
    put_number(out, fmax(strtod(last->yaml, NULL) / 10.0, 1e-13));
}

static void rtol_current(const lac_case *c, char label[LAC_DIAL_LABEL])
{
    (void)snprintf(label, LAC_DIAL_LABEL, "%.10g", c->run.rtol);
}

static const char *const methods[] = {[LAC_BDF] = "bdf", [LAC_ADAMS] = "adams", [LAC_ERK] = "erk"};

static size_t method_values(const lac_case *c, lac_trade_of of, lac_dial_value *out)
{
    (void)of;
    return c->run.fidelity == LAC_FIDELITY_EVENTS ? 0 : put_names(methods, 3, out);
}

static void method_current(const lac_case *c, char label[LAC_DIAL_LABEL])
{
    (void)snprintf(label, LAC_DIAL_LABEL, "%s", methods[c->run.method]);
}

static size_t formulation_values(const lac_case *c, lac_trade_of of, lac_dial_value *out)
{
    static const char *const names[] = {"rate", "traction", "slip"};
    (void)of;
    bool fixed = c->run.fidelity == LAC_FIDELITY_EVENTS || lac_inertia_mass(c) > 0.0;
    return fixed ? 0 : put_names(names, 3, out);
}

static void formulation_current(const lac_case *c, char label[LAC_DIAL_LABEL])
{
    (void)snprintf(label, LAC_DIAL_LABEL, "%s",
                   lac_formulation_name((lac_formulation)c->formulation));
}

// Whether cells take one another's load.
static bool is_coupled(const lac_case *c)
{
    lac_transfer_outline ignored;
    return lac_transfer_outline_of(&c->transfer, &ignored);
}

#define CASCADE "static"

static size_t fidelity_values(const lac_case *c, lac_trade_of of, lac_dial_value *out)
{
    static const char *const names[] = {CASCADE, "events", "ode"};
    if (of == LAC_OF_CASCADE) {
        bool runs = c->friction.about != NULL && !isnan(c->run.end);
        return put_names(names, runs ? 3 : 0, out);
    }
    const lac_transfer_kind *kind = (const void *)c->transfer.about;
    return kind != NULL && kind->blocks != NULL && lac_inertia_mass(c) <= 0.0
               ? put_names(names + 1, 2, out)
               : 0;
}

static void fidelity_current(const lac_case *c, char label[LAC_DIAL_LABEL])
{
    (void)snprintf(label, LAC_DIAL_LABEL, "%s", lac_fidelity_name(c->run.fidelity));
}

// The grid, halved and halved again.
static size_t levels_values(const lac_case *c, lac_trade_of of, lac_dial_value *out)
{
    (void)of;
    const int64_t own = c->interface.levels;
    size_t n = 0;
    for (int64_t level = own - 2; own > 0 && level <= own; level++) {
        if (level > 0) {
            put_number(&out[n++], (double)level);
        }
    }
    return n;
}

static void levels_current(const lac_case *c, char label[LAC_DIAL_LABEL])
{
    if (c->interface.levels == INT64_MIN) {
        (void)snprintf(label, LAC_DIAL_LABEL, "-");
    } else {
        (void)snprintf(label, LAC_DIAL_LABEL, "%" PRId64, c->interface.levels);
    }
}

static size_t transfer_values(const lac_case *c, lac_trade_of of, lac_dial_value *out)
{
    (void)of;
    if (!is_coupled(c) || isnan(c->material.shear_modulus)) {
        return 0;
    }
    put(&out[0], "hierarchy", "{hierarchy: {stiffness: elastic}}");
    put(&out[1], "elastic", "{elastic: {}}");
    return 2;
}

static void transfer_current(const lac_case *c, char label[LAC_DIAL_LABEL])
{
    (void)snprintf(label, LAC_DIAL_LABEL, "%s",
                   c->transfer.about != NULL ? c->transfer.about->name : "none");
}

static const char *const plannings[] = {"estimate", "measure"};

static size_t planning_values(const lac_case *c, lac_trade_of of, lac_dial_value *out)
{
    (void)of;
    const lac_transfer_kind *kind = (const void *)c->transfer.about;
    return kind != NULL && kind->transforms ? put_names(plannings, 2, out) : 0;
}

static void planning_current(const lac_case *c, char label[LAC_DIAL_LABEL])
{
    (void)snprintf(label, LAC_DIAL_LABEL, "%s", plannings[c->fft_planning]);
}

static const char *const precisions[] = {"float", "double"};

static size_t precision_values(const lac_case *c, lac_trade_of of, lac_dial_value *out)
{
    (void)c, (void)of;
    return put_names(precisions, 2, out);
}

static void precision_current(const lac_case *c, char label[LAC_DIAL_LABEL])
{
    (void)snprintf(label, LAC_DIAL_LABEL, "%s", precisions[c->single ? 0 : 1]);
}

// A whole number from its quarter or half up to the case's own.
static size_t count_values(int64_t own, int64_t factor, int64_t least, lac_dial_value *out)
{
    int64_t value = own;
    size_t n = 0;
    while (value / factor >= least && n < 2) {
        value /= factor;
        n++;
    }
    for (size_t i = 0; i <= n; i++) {
        put_number(&out[i], (double)(i == n ? own : value));
        value *= factor;
    }
    return n + 1;
}

static size_t contacts_values(const lac_case *c, lac_trade_of of, lac_dial_value *out)
{
    (void)of;
    return c->rg.field == LAC_RG_ELASTIC ? count_values(c->rg.contacts, 2, 10, out) : 0;
}

static void contacts_tighter(const lac_dial_value *last, lac_dial_value *out)
{
    put_number(out, fmin(2.0 * strtod(last->yaml, NULL), LAC_RG_MOST_LOADS));
}

static void contacts_current(const lac_case *c, char label[LAC_DIAL_LABEL])
{
    (void)snprintf(label, LAC_DIAL_LABEL, "%" PRId64, c->rg.contacts);
}

static size_t shifts_values(const lac_case *c, lac_trade_of of, lac_dial_value *out)
{
    (void)of;
    return count_values(c->rg.shifts, 4, 1, out);
}

static void shifts_tighter(const lac_dial_value *last, lac_dial_value *out)
{
    put_number(out, fmin(4.0 * strtod(last->yaml, NULL), 10000.0));
}

static void shifts_current(const lac_case *c, char label[LAC_DIAL_LABEL])
{
    (void)snprintf(label, LAC_DIAL_LABEL, "%" PRId64, c->rg.shifts);
}

static const char *const fields[] = {
    [LAC_RG_ELASTIC] = "elastic", [LAC_RG_EQUAL] = "equal", [LAC_RG_UNIFORM] = "uniform"};

static size_t field_values(const lac_case *c, lac_trade_of of, lac_dial_value *out)
{
    (void)of;
    const bool pressed = c->surface.about != NULL && !isnan(c->material.shear_modulus);
    put(&out[0], fields[LAC_RG_UNIFORM], fields[LAC_RG_UNIFORM]);
    put(&out[1], fields[LAC_RG_EQUAL], fields[LAC_RG_EQUAL]);
    put(&out[2], fields[LAC_RG_ELASTIC], fields[LAC_RG_ELASTIC]);
    return pressed ? 3 : 2;
}

static void field_current(const lac_case *c, char label[LAC_DIAL_LABEL])
{
    (void)snprintf(label, LAC_DIAL_LABEL, "%s", fields[c->rg.field]);
}

static const lac_dial dials[] = {
    {.name = "rtol",
     .key = "solver.rtol",
     .doc = "tolerance, in decades",
     .use = LAC_OF_RUN,
     .falls = true,
     .ratio = 4, // tenfold at most, and mostly five- to sevenfold: docs/trade.md
     .values = rtol_values,
     .tighter = rtol_tighter,
     .current = rtol_current},
    {.name = "method",
     .key = "solver.method",
     .doc = "of integration: bdf, adams, erk",
     .use = LAC_OF_RUN,
     .values = method_values,
     .current = method_current},
    {.name = "formulation",
     .key = "solver.formulation",
     .doc = "unknown besides the state: rate, traction, slip",
     .use = LAC_OF_RUN,
     .values = formulation_values,
     .current = formulation_current},
    {.name = "fidelity",
     .key = "solver.fidelity",
     .doc = "events, ode; of Q_crit also static, the cascade",
     .use = LAC_OF_RUN | LAC_OF_CASCADE,
     .asked = LAC_OF_RUN | LAC_OF_CASCADE,
     .scene = true,
     .cascade = CASCADE,
     .values = fidelity_values,
     .current = fidelity_current},
    {.name = "levels",
     .key = "interface.levels",
     .doc = "2^levels cells a side, halved twice",
     .use = LAC_OF_RUN | LAC_OF_CASCADE | LAC_OF_CONTACT,
     .asked = LAC_OF_RUN | LAC_OF_CASCADE,
     .scene = true,
     .ratio = 4,
     .values = levels_values,
     .current = levels_current},
    {.name = "transfer",
     .key = "transfer",
     .doc = "of stress: hierarchy, elastic",
     .use = LAC_OF_RUN,
     .asked = LAC_OF_RUN,
     .scene = true,
     .values = transfer_values,
     .current = transfer_current},
    {.name = "planning",
     .key = "solver.fft_planning",
     .doc = "of Fourier transforms: estimate, measure",
     .use = LAC_OF_RUN,
     .asked = LAC_OF_RUN,
     .values = planning_values,
     .current = planning_current},
    {.name = "precision",
     .key = "output.precision",
     .doc = "of what is written: float, double",
     .use = LAC_OF_RUN,
     .asked = LAC_OF_RUN,
     .values = precision_values,
     .current = precision_current},
    {.name = "field",
     .key = "rg.field",
     .doc = "of the cascade: uniform, equal, elastic",
     .use = LAC_OF_CASCADE,
     .asked = LAC_OF_CASCADE,
     .scene = true,
     .values = field_values,
     .current = field_current},
    {.name = "contacts",
     .key = "rg.contacts",
     .doc = "solved along the cascade's path",
     .use = LAC_OF_CASCADE,
     .ratio = 4,
     .values = contacts_values,
     .tighter = contacts_tighter,
     .current = contacts_current},
    {.name = "shifts",
     .key = "rg.shifts",
     .doc = "places of the cascade's blocks",
     .use = LAC_OF_CASCADE,
     .ratio = 2,
     .values = shifts_values,
     .tighter = shifts_tighter,
     .current = shifts_current},
};

const lac_dial *lac_dial_at(size_t index)
{
    return index < sizeof dials / sizeof dials[0] ? &dials[index] : NULL;
}
