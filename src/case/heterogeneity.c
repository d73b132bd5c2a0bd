// SPDX-License-Identifier: GPL-3.0-or-later
// Spreads of a parameter over the cells: which there are and how a case is read.
#include "base/rng.h"
#include "case/sections.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define RANDOM(name) offsetof(lac_heterogeneity_random, name)
#define MAP(name) offsetof(lac_heterogeneity_map, name)
#define SIZE(name) offsetof(lac_heterogeneity_size, name)

enum { MOST_KNOWN = 32 };

static const char *const uses[] = {"value", "factor", NULL};
static const char *const sizes[] = {"patch", "block", NULL};

#define RANDOM_ROWS                                                                           \
    LAC_SEED(RANDOM(seed), 1, 0, "of the random numbers"),                                    \
        LAC_REAL("lowest", "1", RANDOM(lowest), NAN, 0, 1e12, LAC_OPTIONAL,                   \
                 "factors below are drawn again; no limit if absent"),                        \
        LAC_REAL("highest", "1", RANDOM(highest), NAN, 0, 1e12, LAC_OPTIONAL | LAC_ABOVE_MIN, \
                 "factors above are drawn again; no limit if absent")

static double standard_normal(const lac_heterogeneity_random *p, uint64_t place, uint64_t stream)
{
    double normal[2];
    lac_random_normal((uint64_t)p->seed, LAC_STREAM_SPREAD, place, stream, normal);
    return normal[0];
}

static double uniform(const lac_heterogeneity_random *p, uint64_t place, uint64_t stream)
{
    return lac_random_uniform((uint64_t)p->seed, LAC_STREAM_SPREAD, place, stream);
}

#define DRAW(name, factor)                                                         \
    static double draw_##name(const void *params, uint64_t place, uint64_t stream) \
    {                                                                              \
        const lac_heterogeneity_random *p = params;                                \
        return (factor);                                                           \
    }
DRAW(lognormal, exp(p->width *standard_normal(p, place, stream)))
DRAW(normal, 1.0 + p->width * standard_normal(p, place, stream))
DRAW(flat, 1.0 + p->width * (2.0 * uniform(p, place, stream) - 1.0))
DRAW(weibull, pow(-log(uniform(p, place, stream)), 1.0 / p->width))
DRAW(exponential, -log(uniform(p, place, stream)))

static const char *random_fault(const void *params)
{
    const lac_heterogeneity_random *p = params;
    return p->highest <= p->lowest ? "highest must be above lowest" : NULL;
}

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

// A random kind and its rows, the row of its width before those of all.
#define RANDOM_KIND(kind, title, text, source, ...)                                     \
    static const lac_param kind##_rows[] = {__VA_ARGS__ RANDOM_ROWS};                   \
    static const lac_heterogeneity_kind kind = {                                        \
        LAC_ABOUT(title, text, source, LAC_ROWS(kind##_rows, lac_heterogeneity_random), \
                  .validate = random_fault),                                            \
        draw_##kind};
#define WIDTH(name, low, high, text) LAC_REAL(name, "1", RANDOM(width), NAN, low, high, 0, text),

RANDOM_KIND(lognormal, "lognormal", "the nominal value times exp(sigma z), z standard normal",
            "Johnson, Kotz & Balakrishnan (1994) Continuous Univariate Distributions 1, ch. 14",
            WIDTH("sigma", 0, 20, "standard deviation of the logarithm"))
RANDOM_KIND(normal, "normal", "the nominal value times 1 + sigma z, z standard normal",
            "Johnson, Kotz & Balakrishnan (1994) Continuous Univariate Distributions 1, ch. 13",
            WIDTH("sigma", 0, 1, "standard deviation relative to the nominal value"))
RANDOM_KIND(flat, "uniform", "the nominal value times 1 + half_width z, z uniform between -1 and 1",
            "Johnson, Kotz & Balakrishnan (1995) Continuous Univariate Distributions 2, ch. 26",
            WIDTH("half_width", 0, 1, "largest deviation relative to the nominal value"))
RANDOM_KIND(weibull, "weibull",
            "the nominal value, as the scale, times (-ln z)^(1/shape), z uniform",
            "Weibull (1951) J. Appl. Mech. 18, 293, doi 10.1115/1.4010337",
            WIDTH("shape", 0.05, 1e3, "Weibull's modulus k: the larger, the narrower"))
RANDOM_KIND(exponential, "exponential", "the nominal value, as the mean, times -ln z, z uniform",
            "Johnson, Kotz & Balakrishnan (1994) Continuous Univariate Distributions 1, ch. 19", )

const lac_heterogeneity_kind lac_heterogeneity_map_kind = {
    LAC_ABOUT("map", "a field from a netCDF file", "docs/theory/friction.md, \"From cell to cell\"",
              LAC_ROWS(map_rows, lac_heterogeneity_map)),
    NULL};
const lac_heterogeneity_kind lac_heterogeneity_size_kind = {
    LAC_ABOUT("size", "the nominal value times a power of the size of the cell's patch or block",
              "after Carpinteri & Paggi (2009) Chaos Solitons Fractals 39, 540 (the slip that "
              "weakens a joint grows with its size)",
              LAC_ROWS(size_rows, lac_heterogeneity_size)),
    NULL};

static const lac_heterogeneity_kind *const spreads[] = {&lognormal,
                                                        &normal,
                                                        &flat,
                                                        &weibull,
                                                        &exponential,
                                                        &lac_heterogeneity_map_kind,
                                                        &lac_heterogeneity_size_kind};

LAC_KINDS_AT(lac_heterogeneity_kind, lac_heterogeneity_kind_get, spreads)

bool lac_heterogeneity_is_value(const lac_heterogeneity *spread)
{
    const lac_heterogeneity_map *map = spread->model.params;
    return spread->model.info == &lac_heterogeneity_map_kind.info && map->as == LAC_MAP_VALUE;
}

bool lac_heterogeneity_has(const lac_heterogeneity_list *list, const char *key)
{
    for (size_t i = 0; i < list->count; i++) {
        if (strcmp(list->item[i].key, key) == 0) {
            return true;
        }
    }
    return false;
}

void lac_heterogeneity_clear(lac_heterogeneity_list *list)
{
    for (size_t i = 0; i < list->count; i++) {
        free(list->item[i].key);
        lac_model_clear(&list->item[i].model);
    }
    free(list->item);
    *list = (lac_heterogeneity_list){0};
}

// @param node  `{MODEL: ...}`, below the key or in its list
static void read_spread(lac_reader *reader, const lac_node *node, const char *key,
                        lac_heterogeneity_list *list)
{
    lac_heterogeneity spread = {.line = node->line};
    lac_read_slot(reader, node, LAC_KIND_SPREAD, NULL, &spread.model);
    if (spread.model.info == NULL) {
        return;
    }
    if (lac_heterogeneity_is_value(&spread)) {
        for (size_t i = 0; i < list->count; i++) {
            if (strcmp(list->item[i].key, key) == 0 && lac_heterogeneity_is_value(&list->item[i])) {
                lac_add_error(reader, node,
                              "is a second map of values; more maps must be as factor");
            }
        }
    }
    spread.key = lac_reader_copy(reader, key, strlen(key));
    if (spread.key == NULL) {
        lac_model_clear(&spread.model);
        return;
    }
    list->item[list->count++] = spread;
}

static void read_parameter(lac_reader *reader, const lac_node *node, bool given,
                           lac_heterogeneity_list *list)
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
        value = value || lac_heterogeneity_is_value(&list->item[i]);
    }
    if (!value && reader->report->errors == errors) {
        lac_add_error(reader, node, "needs a nominal value of %s to vary, or a map of values",
                      node->key);
    }
}

// What may vary, by key; @return how many
static size_t list_known(const lac_model *law, const char *const *known,
                         const char *keys[MOST_KNOWN])
{
    size_t n = 0;
    for (size_t i = 0; law != NULL && i < law->info->param_count && n < MOST_KNOWN; i++) {
        const lac_param *param = &law->info->params[i];
        if ((param->flags & LAC_CELLWISE) != 0) {
            keys[n++] = param->key;
        }
    }
    for (; law == NULL && known[n] != NULL; n++) {
        keys[n] = known[n];
    }
    return n;
}

void lac_read_spreads(lac_reader *reader, const lac_node *node, const lac_model *law,
                      const char *const *known, lac_heterogeneity_list *list)
{
    const char *keys[MOST_KNOWN];
    const size_t count = list_known(law, known, keys);
    size_t most = 0; // spreads that the mapping can come to
    if (!lac_expect_map(reader, node, "a mapping such as {PARAMETER: {lognormal: {sigma: 0.5}}}")) {
        return;
    }
    for (size_t i = 0; i < node->count; i++) {
        most += node->child[i]->kind == LAC_NODE_LIST ? node->child[i]->count : 1;
    }
    list->item = lac_reader_array(reader, most, sizeof *list->item);
    for (size_t i = 0; list->item != NULL && i < node->count; i++) {
        const lac_node *child = node->child[i];
        size_t k = 0;
        while (k < count && strcmp(keys[k], child->key) != 0) {
            k++;
        }
        if (k < count && !child->ignored) {
            const lac_param *param =
                law != NULL ? lac_param_find(law->info->params, law->info->param_count, keys[k])
                            : NULL;
            // whether it has a nominal value to multiply
            const bool given = law == NULL || lac_param_given(param, law->params);
            read_parameter(reader, child, given, list);
        } else if (!child->ignored) {
            lac_add_error_unknown(reader, child, "parameter that can vary", keys, count);
        }
    }
}
