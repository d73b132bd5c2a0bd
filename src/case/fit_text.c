// SPDX-License-Identifier: GPL-3.0-or-later
// fit.parameters as text that reads back to the same.
#include <stdio.h>

#include "case/sections.h"
#include "case/writer.h"

// A value in double quotes, with its unit.
static const char *quoted(double value, const char *unit, char *text, size_t size)
{
    char plain[80];
    (void)snprintf(text, size, "\"%s\"", lac_units_exact(value, unit, plain, sizeof plain));
    return text;
}

static void put_parameter(lac_writer *w, const lac_fit_parameter *p)
{
    char low[90], high[90];
    lac_put(w, "    %s: {", p->key);
    if (p->ranged) {
        lac_put(w, "range: [%s, %s], ", quoted(p->low, p->unit, low, sizeof low),
                quoted(p->high, p->unit, high, sizeof high));
    }
    if (p->prior == LAC_PRIOR_FLAT) {
        lac_put(w, "prior: {%s: {}}}\n", p->log ? "log-uniform" : "uniform");
    } else {
        lac_put(w, "prior: {%s: {%s: %s, sigma: %s}}}\n", p->log ? "lognormal" : "normal",
                p->log ? "median" : "mean", quoted(p->centre, p->unit, low, sizeof low),
                quoted(p->sigma, p->log ? "1" : p->unit, high, sizeof high));
    }
}

void lac_put_fitted(lac_writer *w, const lac_case *c)
{
    lac_put(w, "  parameters:%s\n", c->fit.count == 0 ? " {}" : "");
    for (size_t i = 0; i < c->fit.count; i++) {
        put_parameter(w, &c->fit.parameter[i]);
    }
}
