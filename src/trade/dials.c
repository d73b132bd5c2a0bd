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

#define VALUES(name, count)                                                              \
    static size_t name##_values(const lac_case *c, lac_trade_of of, lac_dial_value *out) \
    {                                                                                    \
        (void)c, (void)of;                                                               \
        return (count);                                                                  \
    }
#define CURRENT(name, format, value)                                          \
    static void name##_current(const lac_case *c, char label[LAC_DIAL_LABEL]) \
    {                                                                         \
        (void)snprintf(label, LAC_DIAL_LABEL, format, value);                 \
    }
#define TIGHTER(name, value)                                                    \
    static void name##_tighter(const lac_dial_value *last, lac_dial_value *out) \
    {                                                                           \
        const double finest = strtod(last->yaml, NULL);                         \
        put_number(out, value);                                                 \
    }

TIGHTER(rtol, fmax(finest / 10.0, 1e-13))
CURRENT(rtol, "%.10g", c->run.rtol)

static const char *const methods[] = {[LAC_BDF] = "bdf", [LAC_ADAMS] = "adams", [LAC_ERK] = "erk"};
VALUES(method, c->run.fidelity == LAC_FIDELITY_EVENTS ? 0 : put_names(methods, 3, out))
CURRENT(method, "%s", methods[c->run.method])

static const char *const formulations[] = {"rate", "traction", "slip"};
VALUES(formulation, c->run.fidelity == LAC_FIDELITY_EVENTS || lac_inertia_mass(c) > 0.0
                        ? 0
                        : put_names(formulations, 3, out))
CURRENT(formulation, "%s", lac_formulation_name((lac_formulation)c->formulation))

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

CURRENT(fidelity, "%s", lac_fidelity_name(c->run.fidelity))

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

CURRENT(transfer, "%s", c->transfer.about != NULL ? c->transfer.about->name : "none")

static bool transforms(const lac_case *c)
{
    const lac_transfer_kind *kind = (const void *)c->transfer.about;
    return kind != NULL && kind->transforms;
}

static const char *const plannings[] = {"estimate", "measure"};
VALUES(planning, transforms(c) ? put_names(plannings, 2, out) : 0)
CURRENT(planning, "%s", plannings[c->fft_planning])

static const char *const precisions[] = {"float", "double"};
VALUES(precision, put_names(precisions, 2, out))
CURRENT(precision, "%s", precisions[c->single ? 0 : 1])

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

VALUES(contacts, c->rg.field == LAC_RG_ELASTIC ? count_values(c->rg.contacts, 2, 10, out) : 0)
TIGHTER(contacts, fmin(2.0 * finest, LAC_RG_MOST_LOADS))
CURRENT(contacts, "%" PRId64, c->rg.contacts)

VALUES(shifts, count_values(c->rg.shifts, 4, 1, out))
TIGHTER(shifts, fmin(4.0 * finest, 10000.0))
CURRENT(shifts, "%" PRId64, c->rg.shifts)

static const char *const fields[] = {"uniform", "equal", "elastic"}; // the coarsest first
static const int field_at[] = {[LAC_RG_UNIFORM] = 0, [LAC_RG_EQUAL] = 1, [LAC_RG_ELASTIC] = 2};
VALUES(field, put_names(fields,
                        c->surface.about != NULL && !isnan(c->material.shear_modulus) ? 3 : 2, out))
CURRENT(field, "%s", fields[field_at[c->rg.field]])

#define DIAL(name_, key_, doc_, ...)                                            \
    {                                                                           \
        .name = #name_, .key = (key_), .doc = (doc_), .values = name_##_values, \
        .current = name_##_current, __VA_ARGS__                                 \
    }
#define ASKED(of) .use = (of), .asked = (of)

static const lac_dial dials[] = {
    // Its errors fall tenfold at most a rung, and mostly five- to sevenfold: docs/trade.md.
    DIAL(rtol, "solver.rtol", "tolerance, in decades", .use = LAC_OF_RUN, .falls = true, .ratio = 4,
         .tighter = rtol_tighter),
    DIAL(method, "solver.method", "of integration: bdf, adams, erk", .use = LAC_OF_RUN),
    DIAL(formulation, "solver.formulation", "unknown besides the state: rate, traction, slip",
         .use = LAC_OF_RUN),
    DIAL(fidelity, "solver.fidelity", "events, ode; of Q_crit also static, the cascade",
         ASKED(LAC_OF_RUN | LAC_OF_CASCADE), .scene = true, .cascade = CASCADE),
    DIAL(levels, "interface.levels", "2^levels cells a side, halved twice",
         .use = LAC_OF_RUN | LAC_OF_CASCADE | LAC_OF_CONTACT, .asked = LAC_OF_RUN | LAC_OF_CASCADE,
         .scene = true, .ratio = 4),
    DIAL(transfer, "transfer", "of stress: hierarchy, elastic", ASKED(LAC_OF_RUN), .scene = true),
    DIAL(planning, "solver.fft_planning", "of Fourier transforms: estimate, measure",
         ASKED(LAC_OF_RUN)),
    DIAL(precision, "output.precision", "of what is written: float, double", ASKED(LAC_OF_RUN)),
    DIAL(field, "rg.field", "of the cascade: uniform, equal, elastic", ASKED(LAC_OF_CASCADE),
         .scene = true),
    DIAL(contacts, "rg.contacts", "solved along the cascade's path", .use = LAC_OF_CASCADE,
         .ratio = 4, .tighter = contacts_tighter),
    DIAL(shifts, "rg.shifts", "places of the cascade's blocks", .use = LAC_OF_CASCADE, .ratio = 2,
         .tighter = shifts_tighter),
};

const lac_dial *lac_dial_at(size_t index)
{
    return index < sizeof dials / sizeof dials[0] ? &dials[index] : NULL;
}
