// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/tree.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "support/slot.h"

static void must(bool good, const char *what)
{
    if (!good) {
        fprintf(stderr, "fixture: %s\n", what);
        abort();
    }
}

tree_def tree_default(int levels, uint64_t seed)
{
    const double shear_modulus = 1e10;
    const double r = 1e-3;
    return (tree_def){.levels = levels,
                      .keep = 3.3 / 4.0,
                      .seed = seed,
                      .law = "aging",
                      .f0 = 0.6,
                      .a = 0.01,
                      .b = 0.015,
                      .dc = 1e-5,
                      .v0 = 1e-6,
                      .pressure = 50e6,
                      .k0 = shear_modulus / r,
                      .ratio = 0.5,
                      .damping = shear_modulus / 6000.0,
                      .columns = 0.01,
                      .slip_rate = 1e-9,
                      .state = 1e-5 / 1e-9};
}

static double uniform(uint64_t seed, uint64_t place, uint64_t what)
{
    return lac_random_uniform(seed, LAC_STREAM_TEST, place, what);
}

// Marks the cells of one block, child by child.
static void grow(const tree_def *def, uint64_t code, int level, double *pressure)
{
    if (level == 0) {
        size_t ix = 0;
        size_t iy = 0;
        for (int bit = 0; bit < def->levels; bit++) {
            ix |= (size_t)(code >> (2 * bit) & 1) << bit;
            iy |= (size_t)(code >> (2 * bit + 1) & 1) << bit;
        }
        size_t place = (iy << def->levels) + ix;
        pressure[place] = def->pressure * (0.05 - log(uniform(def->seed, code, 1000)));
        return;
    }
    bool any = false;
    uint64_t name = code + ((uint64_t)level << 40);
    for (uint64_t child = 0; child < 4; child++) {
        bool last = child == 3 && !any;
        if (last || uniform(def->seed, name, child) < def->keep) {
            grow(def, 4 * code + child, level - 1, pressure);
            any = true;
        }
    }
}

static void make_domain(const tree_def *def, tree *out)
{
    lac_error err;
    size_t side = (size_t)1 << def->levels;
    lac_grid grid = {.nx = side, .ny = side, .dx = 1e-3, .dy = 1e-3, .periodic = true};
    double *pressure = calloc(side * side, sizeof *pressure);
    must(pressure != NULL, "memory");
    grow(def, 0, def->levels, pressure);
    must(lac_domain_create(&grid, pressure, &out->domain, &err) == LAC_OK, err.message);
    free(pressure);
}

void tree_make_transfer(const tree_def *def, tree *out)
{
    lac_error err;
    lac_model model = {0};
    const lac_transfer_kind *kind;
    size_t i = 0;
    while ((kind = lac_transfer_kind_get(i)) != NULL && strcmp(kind->info.name, "hierarchy") != 0) {
        i++;
    }
    must(kind != NULL, "no hierarchy");
    must(lac_model_create(&kind->info, &model, &err) == LAC_OK, err.message);
    lac_transfer_hierarchy *p = model.params;
    p->k0 = def->k0;
    p->ratio = def->ratio;
    lac_transfer_scene scene = {out->domain, out->hierarchy, NAN, NAN, false, false, NULL};
    must(lac_transfer_create(&model, &scene, &out->transfer, &err) == LAC_OK, err.message);
    lac_model_clear(&model);
}

void tree_make_friction(const tree_def *def, tree *out)
{
    lac_error err;
    lac_model model = {0};
    const lac_friction_law *law;
    size_t i = 0;
    while ((law = lac_friction_law_get(i)) != NULL && strcmp(law->info.name, def->law) != 0) {
        i++;
    }
    must(law != NULL, "no such law");
    must(lac_model_create(&law->info, &model, &err) == LAC_OK, err.message);
    lac_friction_params *p = model.params;
    p->f0 = def->f0;
    p->a = def->a;
    p->b = def->b;
    p->dc = def->dc;
    p->v0 = def->v0;
    p->form = def->form;
    p->v1 = def->v1 > 0 ? def->v1 : NAN;
    p->v2 = def->v2 > 0 ? def->v2 : NAN;
    p->alpha = def->alpha > 0 ? def->alpha : NAN;
    p->cohesion = def->cohesion > 0 ? def->cohesion : NAN;
    test_slot_fill(&model);
    must(lac_friction_create(&model, out->domain->n, &out->friction, &err) == LAC_OK, err.message);
    lac_model_clear(&model);
}

void tree_create(const tree_def *def, tree *out)
{
    lac_error err;
    *out = (tree){0};
    make_domain(def, out);
    must(lac_hierarchy_create(out->domain, &out->hierarchy, &err) == LAC_OK, err.message);
    tree_make_transfer(def, out);
    tree_make_friction(def, out);
    size_t n = out->domain->n;
    double *start = malloc(2 * n * sizeof *start);
    must(start != NULL, "memory");
    for (size_t i = 0; i < n; i++) {
        double off = 2.0 * uniform(def->seed, out->domain->index[i], 2000) - 1.0;
        start[i] = log(def->slip_rate) + off;
        start[n + i] = log(def->state);
    }
    lac_problem_def problem = {.domain = out->domain,
                               .friction = out->friction,
                               .transfer = &out->transfer,
                               .loads = def->loads,
                               .damping = def->damping,
                               .mass = def->mass,
                               .columns = def->columns,
                               .log_rate = start,
                               .log_state = start + n,
                               .heading = def->heading,
                               .formulation = def->formulation,
                               .weakening = def->weakening};
    must(lac_problem_create(&problem, &out->problem, &err) == LAC_OK, err.message);
    free(start);
}

void tree_clear(tree *t)
{
    lac_problem_free(t->problem);
    lac_friction_free(t->friction);
    lac_transfer_clear(&t->transfer);
    lac_hierarchy_free(t->hierarchy);
    lac_domain_free(t->domain);
}
