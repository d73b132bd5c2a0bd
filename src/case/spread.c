// SPDX-License-Identifier: GPL-3.0-or-later
// Spreads of a parameter over the cells: which there are and how a case is read.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "case/schema.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define RANDOM(name) offsetof(lac_spread_random, name)
#define MAP(name) offsetof(lac_spread_map, name)
#define SIZE(name) offsetof(lac_spread_size, name)

enum { MOST_KNOWN = 32 };

static const char *const uses[] = {"value", "factor", NULL};
static const char *const sizes[] = {"patch", "block", NULL};

#define RANDOM_ROWS                                                                           \
    LAC_SEED(RANDOM(seed), 1, 0, "of the random numbers"),                                    \
        LAC_REAL("lowest", "1", RANDOM(lowest), NAN, 0, 1e12, LAC_OPTIONAL,                   \
                 "factors below are drawn again; no limit if absent"),                        \
        LAC_REAL("highest", "1", RANDOM(highest), NAN, 0, 1e12, LAC_OPTIONAL | LAC_ABOVE_MIN, \
                 "factors above are drawn again; no limit if absent")

static double standard_normal(const lac_spread_random *p, uint64_t place, uint64_t stream)
{
    double normal[2];
    lac_random_normal((uint64_t)p->seed, LAC_STREAM_SPREAD, place, stream, normal);
    return normal[0];
}

static double uniform(const lac_spread_random *p, uint64_t place, uint64_t stream)
{
    return lac_random_uniform((uint64_t)p->seed, LAC_STREAM_SPREAD, place, stream);
}

static double draw_lognormal(const void *params, uint64_t place, uint64_t stream)
{
    const lac_spread_random *p = params;
    return exp(p->width * standard_normal(p, place, stream));
}

static double draw_normal(const void *params, uint64_t place, uint64_t stream)
{
    const lac_spread_random *p = params;
    return 1.0 + p->width * standard_normal(p, place, stream);
}

static double draw_uniform(const void *params, uint64_t place, uint64_t stream)
{
    const lac_spread_random *p = params;
    return 1.0 + p->width * (2.0 * uniform(p, place, stream) - 1.0);
}

static double draw_weibull(const void *params, uint64_t place, uint64_t stream)
{
    const lac_spread_random *p = params;
    return pow(-log(uniform(p, place, stream)), 1.0 / p->width);
}

static double draw_exponential(const void *params, uint64_t place, uint64_t stream)
{
    const lac_spread_random *p = params;
    return -log(uniform(p, place, stream));
}

static double draw_pareto(const void *params, uint64_t place, uint64_t stream)
{
    const lac_spread_random *p = params;
    return pow(uniform(p, place, stream), -1.0 / p->width);
}

static const char *random_fault(const void *params)
{
    const lac_spread_random *p = params;
    return p->highest <= p->lowest ? "highest must be above lowest" : NULL;
}

static const lac_param lognormal_rows[] = {
    LAC_REAL("sigma", "1", RANDOM(width), NAN, 0, 20, 0, "standard deviation of the logarithm"),
    RANDOM_ROWS,
};

static const lac_param normal_rows[] = {
    LAC_REAL("sigma", "1", RANDOM(width), NAN, 0, 1, 0,
             "standard deviation relative to the nominal value"),
    RANDOM_ROWS,
};

static const lac_param uniform_rows[] = {
    LAC_REAL("half_width", "1", RANDOM(width), NAN, 0, 1, 0,
             "largest deviation relative to the nominal value"),
    RANDOM_ROWS,
};

static const lac_param weibull_rows[] = {
    LAC_REAL("shape", "1", RANDOM(width), NAN, 0.05, 1e3, 0,
             "Weibull's modulus k: the larger, the narrower"),
    RANDOM_ROWS,
};

static const lac_param exponential_rows[] = {RANDOM_ROWS};

static const lac_param pareto_rows[] = {
    LAC_REAL("exponent", "1", RANDOM(width), NAN, 0.05, 1e3, 0,
             "P(factor > x) = x^-exponent, x >= 1"),
    RANDOM_ROWS,
};

static const lac_param map_rows[] = {
    LAC_PATH("file", MAP(path), 0,
             "netCDF, from the case's folder: a field over the grid (y, x), or over the contact "
             "cells in the order of the output"),
    LAC_TEXT("variable", MAP(variable), LAC_OPTIONAL, "its name; the only one that fits if absent"),
    LAC_CHOICE("as", MAP(as), LAC_MAP_VALUE, uses, 0,
               "value: in a unit of the parameter's dimension, in the place of the nominal value; "
               "factor: multiplies it"),
};

static const lac_param size_rows[] = {
    LAC_REAL("reference", "m", SIZE(reference), NAN, 0, 1e9, LAC_ABOVE_MIN,
             "size at which the parameter has its nominal value"),
    LAC_REAL("exponent", "1", SIZE(exponent), 1, -10, 10, 0,
             "value = nominal (size/reference)^exponent"),
    LAC_CHOICE("of", SIZE(of), LAC_SIZE_PATCH, sizes, 0,
               "whose size: the contact patch's of the cell, square root of its area; or the side "
               "of the largest block around the cell that touches everywhere"),
};

#define ABOUT(title, text, source, rows, type)                                           \
    {                                                                                    \
        .name = (title), .summary = (text), .reference = (source), LAC_ROWS(rows, type), \
        .fault = sizeof(type) == sizeof(lac_spread_random) ? random_fault : NULL         \
    }

static const lac_spread_kind lognormal = {
    ABOUT("lognormal", "the nominal value times exp(sigma z), z standard normal",
          "Johnson, Kotz & Balakrishnan (1994) Continuous Univariate Distributions 1, ch. 14",
          lognormal_rows, lac_spread_random),
    draw_lognormal};
static const lac_spread_kind normal = {
    ABOUT("normal", "the nominal value times 1 + sigma z, z standard normal",
          "Johnson, Kotz & Balakrishnan (1994) Continuous Univariate Distributions 1, ch. 13",
          normal_rows, lac_spread_random),
    draw_normal};
static const lac_spread_kind flat = {
    ABOUT("uniform", "the nominal value times 1 + half_width z, z uniform between -1 and 1",
          "Johnson, Kotz & Balakrishnan (1995) Continuous Univariate Distributions 2, ch. 26",
          uniform_rows, lac_spread_random),
    draw_uniform};
static const lac_spread_kind weibull = {
    ABOUT("weibull", "the nominal value, as the scale, times (-ln z)^(1/shape), z uniform",
          "Weibull (1951) J. Appl. Mech. 18, 293, doi 10.1115/1.4010337", weibull_rows,
          lac_spread_random),
    draw_weibull};
static const lac_spread_kind exponential = {
    ABOUT("exponential", "the nominal value, as the mean, times -ln z, z uniform",
          "Johnson, Kotz & Balakrishnan (1994) Continuous Univariate Distributions 1, ch. 19",
          exponential_rows, lac_spread_random),
    draw_exponential};
static const lac_spread_kind pareto = {
    ABOUT("pareto", "the nominal value, as the least, times z^(-1/exponent), z uniform",
          "Johnson, Kotz & Balakrishnan (1994) Continuous Univariate Distributions 1, ch. 20",
          pareto_rows, lac_spread_random),
    draw_pareto};

const lac_spread_kind lac_spread_map_kind = {ABOUT("map", "a field from a netCDF file",
                                                   "docs/theory/friction.md, \"From cell to cell\"",
                                                   map_rows, lac_spread_map),
                                             NULL};
const lac_spread_kind lac_spread_size_kind = {
    ABOUT("size", "the nominal value times a power of the size of the cell's patch or block",
          "after Carpinteri & Paggi (2009) Chaos Solitons Fractals 39, 540 (the slip that weakens "
          "a joint grows with its size)",
          size_rows, lac_spread_size),
    NULL};

static const lac_spread_kind *const spreads[] = {
    &lognormal,           &normal, &flat, &weibull, &exponential, &pareto, &lac_spread_map_kind,
    &lac_spread_size_kind};

const lac_spread_kind *lac_spread_kind_at(size_t index)
{
    return index < COUNT(spreads) ? spreads[index] : NULL;
}

bool lac_spread_is_value(const lac_spread *spread)
{
    const lac_spread_map *map = spread->slot.params;
    return spread->slot.about == &lac_spread_map_kind.about && map->as == LAC_MAP_VALUE;
}

bool lac_spread_has(const lac_spread_list *list, const char *key)
{
    for (size_t i = 0; i < list->count; i++) {
        if (strcmp(list->item[i].key, key) == 0) {
            return true;
        }
    }
    return false;
}

void lac_spreads_clear(lac_spread_list *list)
{
    for (size_t i = 0; i < list->count; i++) {
        free(list->item[i].key);
        lac_slot_clear(&list->item[i].slot);
    }
    free(list->item);
    *list = (lac_spread_list){0};
}

// @param node  `{MODEL: ...}`, below the key or in its list
static void read_spread(lac_reader *reader, const lac_node *node, const char *key,
                        lac_spread_list *list)
{
    lac_spread spread = {.line = node->line};
    lac_read_slot(reader, node, LAC_KIND_SPREAD, NULL, &spread.slot);
    if (spread.slot.about == NULL) {
        return;
    }
    if (lac_spread_is_value(&spread)) {
        for (size_t i = 0; i < list->count; i++) {
            if (strcmp(list->item[i].key, key) == 0 && lac_spread_is_value(&list->item[i])) {
                lac_blame(reader, node, "is a second map of values; more maps must be as factor");
            }
        }
    }
    spread.key = lac_reader_copy(reader, key, strlen(key));
    if (spread.key == NULL) {
        lac_slot_clear(&spread.slot);
        return;
    }
    list->item[list->count++] = spread;
}

static void read_parameter(lac_reader *reader, const lac_node *node, bool given,
                           lac_spread_list *list)
{
    size_t first = list->count;
    size_t errors = reader->report->errors;
    if (node->kind == LAC_NODE_LIST && node->count > 0) {
        for (size_t i = 0; i < node->count; i++) {
            read_spread(reader, node->child[i], node->key, list);
        }
    } else {
        read_spread(reader, node, node->key, list);
    }
    bool value = given;
    for (size_t i = first; i < list->count; i++) {
        value = value || lac_spread_is_value(&list->item[i]);
    }
    if (!value && reader->report->errors == errors) {
        lac_blame(reader, node, "needs a nominal value of %s to vary, or a map of values",
                  node->key);
    }
}

// Spreads that a mapping can come to.
static size_t count_models(const lac_node *node)
{
    size_t count = 1;
    for (size_t i = 0; i < node->count; i++) {
        const lac_node *child = node->child[i];
        count += child->kind == LAC_NODE_LIST ? child->count : 1;
    }
    return count;
}

// What may vary, by key; @return how many
static size_t list_known(const lac_slot *law, const char *const *known,
                         const char *keys[MOST_KNOWN])
{
    size_t n = 0;
    for (size_t i = 0; law != NULL && i < law->about->param_count && n < MOST_KNOWN; i++) {
        const lac_param *param = &law->about->params[i];
        if ((param->flags & LAC_CELLWISE) != 0) {
            keys[n++] = param->key;
        }
    }
    for (; law == NULL && known[n] != NULL; n++) {
        keys[n] = known[n];
    }
    return n;
}

// Whether a parameter has a nominal value to multiply.
static bool is_given(const lac_slot *law, const char *key)
{
    bool given = law == NULL;
    for (size_t i = 0; law != NULL && i < law->about->param_count; i++) {
        const lac_param *param = &law->about->params[i];
        given = given || (strcmp(param->key, key) == 0 && lac_param_given(param, law->params));
    }
    return given;
}

void lac_read_spreads(lac_reader *reader, const lac_node *node, const lac_slot *law,
                      const char *const *known, lac_spread_list *list)
{
    const char *keys[MOST_KNOWN];
    const size_t count = list_known(law, known, keys);
    if (!lac_expect_map(reader, node, "a mapping such as {PARAMETER: {lognormal: {sigma: 0.5}}}")) {
        return;
    }
    list->item = calloc(count_models(node), sizeof *list->item);
    if (list->item == NULL) {
        reader->no_memory = true;
        return;
    }
    for (size_t i = 0; i < node->count; i++) {
        const lac_node *child = node->child[i];
        size_t k = 0;
        while (k < count && strcmp(keys[k], child->key) != 0) {
            k++;
        }
        if (k < count && !child->ignored) {
            read_parameter(reader, child, is_given(law, child->key), list);
        } else if (!child->ignored) {
            lac_blame_unknown(reader, child, "parameter that can vary", keys, count);
        }
    }
}
