// SPDX-License-Identifier: GPL-3.0-or-later
// fit: its keys, how they are read and what is wrong with them.
#include "case/sections.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

// A number of a mapping that must be there.
static bool read_of(lac_reader *reader, const lac_node *map, const char *key, const char *unit,
                    double *value)
{
    const lac_node *node = lac_node_child(map, key);
    if (node == NULL) {
        lac_add_error(reader, map, "needs %s", key);
        return false;
    }
    return lac_read_number(reader, node, unit, value);
}

// Every key of a mapping that takes but two.
static void blame_others(lac_reader *reader, const lac_node *map, const char *const known[2])
{
    for (size_t i = 0; i < map->count; i++) {
        const lac_node *child = map->child[i];
        if (strcmp(child->key, known[0]) != 0 && strcmp(child->key, known[1]) != 0) {
            lac_add_error_unknown(reader, child, "key", known, 2);
        }
    }
}

static void read_normal(lac_reader *reader, const lac_node *node, bool log, lac_fit_parameter *p)
{
    const char *centre = log ? "median" : "mean";
    const char *known[] = {centre, "sigma"};
    p->log = log;
    p->prior = LAC_PRIOR_NORMAL;
    if (!lac_expect_map(reader, node,
                        log ? "{median: VALUE, sigma: NUMBER}" : "{mean: VALUE, sigma: VALUE}")) {
        return;
    }
    blame_others(reader, node, known);
    bool read = read_of(reader, node, centre, p->unit, &p->centre);
    read = read_of(reader, node, "sigma", log ? "1" : p->unit, &p->sigma) && read;
    if (read && !(p->sigma > 0.0 && isfinite(p->sigma))) {
        lac_add_error(reader, node, "needs sigma > 0");
    } else if (read && log && !(p->centre > 0.0)) {
        lac_add_error(reader, node, "needs median > 0");
    }
}

static void read_prior(lac_reader *reader, const lac_node *node, lac_fit_parameter *p)
{
    static const char *const known[] = {"lognormal", "normal", "uniform", "log-uniform"};
    const char *allowed =
        "{lognormal: {median, sigma}}, {normal: {mean, sigma}}, {uniform: {}} or {log-uniform: {}}";
    if (!lac_expect_map(reader, node, allowed)) {
        return;
    }
    if (node->count != 1) {
        lac_add_error(reader, node, "must be one of %s", allowed);
        return;
    }
    const lac_node *child = node->child[0];
    size_t kind = 0;
    while (kind < COUNT(known) && strcmp(child->key, known[kind]) != 0) {
        kind++;
    }
    if (kind == COUNT(known)) {
        lac_add_error_unknown(reader, child, "prior", known, COUNT(known));
    } else if (kind < 2) {
        read_normal(reader, child, kind == 0, p);
    } else {
        p->log = kind == 3;
        if (!lac_node_is_null(child) && !(child->kind == LAC_NODE_MAP && child->count == 0)) {
            lac_add_error(reader, child, "takes nothing: the range is beside it");
        }
    }
}

static void read_range(lac_reader *reader, const lac_node *node, const lac_param *param,
                       lac_fit_parameter *p)
{
    double *ends[] = {&p->low, &p->high};
    if (node->kind != LAC_NODE_LIST || node->count != 2) {
        lac_add_error(reader, node, "must be a list of two values such as [low, high]");
        return;
    }
    bool read = true;
    for (size_t i = 0; i < 2; i++) {
        const lac_node *end = node->child[i];
        read = lac_read_number(reader, end, param->unit, ends[i]) &&
               lac_in_range(reader, end, param, *ends[i]) && read;
    }
    p->ranged = true;
    if (read && !(p->low < p->high)) {
        lac_add_error(reader, node, "must rise: low < high");
    }
}

// Whether prior and range say enough, and agree.
static void check_parameter(lac_reader *reader, const lac_node *node, const lac_fit_parameter *p,
                            double value)
{
    char text[64];
    bool bounded = isfinite(p->low) && isfinite(p->high);
    if (p->prior == LAC_PRIOR_FLAT && !bounded) {
        lac_add_error(reader, node,
                      "needs a range such as [low, high], or a prior such as {lognormal: {median: "
                      "..., sigma: 1}}");
    } else if (p->log && p->low < 0.0) {
        lac_add_error(reader, node, "needs a range above 0 for a prior of its logarithm");
    } else if (p->log && p->prior == LAC_PRIOR_FLAT && !(p->low > 0.0)) {
        lac_add_error(reader, node, "needs a range whose low end is > 0, or prior: {uniform: {}}");
    } else if (value < p->low || value > p->high) {
        lac_add_error(reader, node, "has a range that leaves out the case's own value, %s",
                      lac_units_exact(value, p->unit, text, sizeof text));
    }
}

static void read_parameter(lac_reader *reader, const lac_node *node, lac_case *c,
                           lac_fit_parameter *p)
{
    static const char *const known[] = {"range", "prior"};
    lac_case_value value;
    size_t before = reader->report->errors;
    if (!lac_case_find(c, node->key, &value)) {
        lac_add_error(reader, node,
                      "is not the full path of a number of this case, such as friction.aging.dc, "
                      "initial.slip_rate or load.shear.0.ratio.value");
        return;
    }
    if (!lac_expect_map(reader, node, "a mapping such as {range: [low, high]}")) {
        return;
    }
    const lac_param *param = value.param;
    *p = (lac_fit_parameter){.key = lac_reader_copy(reader, node->key, strlen(node->key)),
                             .unit = param->unit,
                             .low = param->min,
                             .high = param->max,
                             .centre = NAN,
                             .sigma = NAN};
    blame_others(reader, node, known);
    if (lac_node_child(node, "range") != NULL) {
        read_range(reader, lac_node_child(node, "range"), param, p);
    }
    p->log = p->low > 0.0; // unless the prior says
    if (lac_node_child(node, "prior") != NULL) {
        read_prior(reader, lac_node_child(node, "prior"), p);
    }
    if (reader->report->errors == before) {
        check_parameter(reader, node, p, *value.at);
    }
}

// Whether what the keys of parameters name was read without errors: else they cannot be found.
static bool rest_is_clean(const lac_reader *reader)
{
    static const char *const needed[] = {"friction", "initial",  "load",
                                         "transfer", "material", "interface"};
    bool clean = true;
    for (size_t i = 0; i < COUNT(needed); i++) {
        clean = clean && lac_clean(reader, needed[i]);
    }
    return clean;
}

void lac_read_fitted(lac_reader *reader, const lac_node *node, lac_case *c)
{
    if (!rest_is_clean(reader)) {
        return;
    }
    if (!lac_expect_map(reader, node, "a mapping such as {friction.aging.dc: {range: [...]}}")) {
        return;
    }
    if (node->count > LAC_MOST_FITTED) {
        lac_add_error(reader, node, "has %zu parameters; at most %d", node->count, LAC_MOST_FITTED);
        return;
    }
    c->fit.parameter = lac_reader_array(reader, node->count, sizeof *c->fit.parameter);
    for (size_t i = 0; c->fit.parameter != NULL && i < node->count; i++) {
        lac_fit_parameter *p = &c->fit.parameter[c->fit.count];
        if (!node->child[i]->ignored && !node->child[i]->bad) {
            read_parameter(reader, node->child[i], c, p);
            c->fit.count += p->key != NULL ? 1 : 0;
        }
    }
}

void lac_check_fit(lac_reader *reader, lac_case *c)
{
    const lac_fit_def *fit = &c->fit;
    const size_t least = 2 * (fit->count + 3);
    const bool slides = fit->columns.displacement != NULL || fit->columns.components != NULL ||
                        fit->columns.within != NULL;
    const bool block = // one cell, whose slip is the mean slip
        c->surface.info == NULL && c->domain.info == NULL && c->slip != LAC_SLIP_VECTOR;
    (void)lac_refuse(reader, reader->purpose == LAC_FOR_FIT && c->from.file != NULL, "initial.run",
                     "a fit begins at the start of its case");
    if (lac_refuse(reader, !HAS("fit") && reader->purpose == LAC_FOR_FIT, "fit",
                   "is missing: what to estimate, such as {parameters: {friction.aging.dc: {range: "
                   "[\"0.1 mm\", \"1 m\"]}}, ...}") ||
        !fit->named || !lac_clean(reader, "fit") || !rest_is_clean(reader)) {
        return;
    }
    (void)lac_refuse(reader, fit->count == 0, "fit.parameters",
                     "must name at least one number of the case");
    (void)lac_refuse(reader,
                     fit->columns.displacement == NULL && fit->columns.velocity == NULL &&
                         fit->columns.components == NULL && fit->columns.velocity_most == NULL &&
                         fit->columns.value == NULL,
                     "fit",
                     "needs displacement, velocity or friction, such as displacement: \"disp:mm\"");
    (void)lac_refuse(reader, fit->columns.value != NULL && (slides || !block), "fit.friction",
                     slides ? "stands in place of displacement, components and time_within"
                            : "is read for one block: give no interface, and slip along x");
    (void)lac_refuse(reader, fit->columns.time == NULL, "fit", "needs time, the column of times");
    (void)lac_refuse(reader,
                     fit->columns.sigma != NULL && fit->columns.displacement == NULL &&
                         fit->columns.components == NULL,
                     "fit.sigma", "goes with displacement");
    (void)lac_refuse(reader,
                     fit->columns.velocity_sigma != NULL && fit->columns.velocity == NULL &&
                         fit->columns.velocity_most == NULL,
                     "fit.velocity_sigma", "goes with velocity or velocity_most");
    (void)lac_refuse(
        reader,
        fit->columns.within != NULL &&
            (fit->columns.displacement != NULL || fit->columns.components != NULL),
        "fit.time_within",
        "is for velocities alone: a displacement needs its time; leave out one of them");
    (void)lac_refuse(
        reader, fit->steps > 0 && (fit->walkers % 2 != 0 || (size_t)fit->walkers < least),
        "fit.walkers", "must be even and at least %zu for %zu parameters", least, fit->count);
    (void)lac_refuse(reader, fit->steps > 0 && fit->steps < 8, "fit.steps",
                     "must be 0 (least squares only) or at least 8");
}
