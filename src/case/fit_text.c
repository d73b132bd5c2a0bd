// SPDX-License-Identifier: GPL-3.0-or-later
// fit.parameters as text that reads back to the same.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "case/sections.h"

enum { LINE = 700 };

// A value in double quotes, with its unit.
static const char *quoted(double value, const char *unit, char *text, size_t size)
{
    char plain[80];
    (void)snprintf(text, size, "\"%s\"", lac_units_exact(value, unit, plain, sizeof plain));
    return text;
}

static size_t put_parameter(const lac_fit_parameter *p, char *text, size_t size)
{
    char low[90], high[90], centre[90], sigma[90], range[220] = "";
    if (p->ranged) {
        (void)snprintf(range, sizeof range, "range: [%s, %s], ",
                       quoted(p->low, p->unit, low, sizeof low),
                       quoted(p->high, p->unit, high, sizeof high));
    }
    int n;
    if (p->prior == LAC_PRIOR_FLAT) {
        n = snprintf(text, size, "    %s: {%sprior: {%s: {}}}\n", p->key, range,
                     p->log ? "log-uniform" : "uniform");
    } else {
        n = snprintf(text, size, "    %s: {%sprior: {%s: {%s: %s, sigma: %s}}}\n", p->key, range,
                     p->log ? "lognormal" : "normal", p->log ? "median" : "mean",
                     quoted(p->centre, p->unit, centre, sizeof centre),
                     quoted(p->sigma, p->log ? "1" : p->unit, sigma, sizeof sigma));
    }
    return n < 0 ? 0 : (size_t)n < size ? (size_t)n : size - 1;
}

char *lac_fit_text(const lac_fit_def *fit)
{
    size_t size = LINE * (fit->count + 1);
    size_t used;
    char *text = malloc(size);
    if (text == NULL) {
        return NULL;
    }
    used = (size_t)snprintf(text, size, "  parameters:%s\n", fit->count == 0 ? " {}" : "");
    for (size_t i = 0; i < fit->count; i++) {
        used +=
            put_parameter(&fit->parameter[i], text + used, size - used < LINE ? size - used : LINE);
    }
    return text;
}
