// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/block.h"
#include "lacuna/simulation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/slot.h"

static void must(lac_status status, const lac_error *err)
{
    if (status != LAC_OK) {
        fprintf(stderr, "fixture: %s\n", err->message);
        abort();
    }
}

lac_formulation block_formulations[3] = {LAC_FORMULATION_RATE, LAC_FORMULATION_TRACTION,
                                         LAC_FORMULATION_SLIP};

block_def block_default(double m, double x)
{
    return (block_def){.law = "aging",
                       .f0 = 0.6,
                       .a = 0.01,
                       .b = 0.01 * m,
                       .dc = 1.0,
                       .v0 = 1.0,
                       .pressure = 1e6,
                       .columns = 1.0,
                       .slip_rate = pow(x, -m),
                       .x = x};
}

static lac_model friction_slot(const block_def *def)
{
    lac_error err;
    lac_model model = {0};
    const lac_friction_law *law = NULL;
    for (size_t i = 0; (law = lac_friction_law_get(i)) != NULL; i++) {
        if (strcmp(law->info.name, def->law) == 0) {
            break;
        }
    }
    must(law != NULL ? LAC_OK : LAC_EINPUT, &(lac_error){"no such law"});
    must(lac_model_create(&law->info, &model, &err), &err);
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
    if (def->vc > 0) {
        test_slot_set(&model, "vc", def->vc);
    }
    test_slot_fill(&model);
    return model;
}

void block_create(const block_def *def, block *out)
{
    lac_error err;
    *out = (block){0};
    lac_grid grid = {.nx = 1, .ny = 1, .dx = 1.0, .dy = 1.0, .periodic = true};
    must(lac_domain_create(&grid, &def->pressure, &out->domain, &err), &err);
    must(lac_hierarchy_create(out->domain, &out->hierarchy, &err), &err);
    lac_transfer_scene scene = {
        .domain = out->domain, .hierarchy = out->hierarchy, .shear_modulus = NAN, .poisson = NAN};
    must(lac_transfer_create(&(lac_model){0}, &scene, &out->transfer, &err), &err);
    lac_model model = friction_slot(def);
    must(lac_friction_create(&model, 1, &out->friction, &err), &err);
    lac_model_clear(&model);

    out->loads = test_load_set(&(lac_load_models){.shear = def->shear,
                                                  .shear_count = def->shear_count,
                                                  .pore = def->pore,
                                                  .pore_count = def->pore_count});
    bool aged = def->theta > 0;
    lac_initial_def initial = {.slip_rate = def->slip_rate,
                               .state = aged ? LAC_STATE_TIME : LAC_STATE_RATIO,
                               .state_value = aged ? def->theta : def->x};
    double u;
    double w;
    must(lac_initial_solve(&initial, out->domain, out->friction, &out->loads,
                           lac_damping_over(out->domain, def->damping, def->mass > 0.0), &u, &w,
                           &err),
         &err);
    lac_problem_def problem = {.domain = out->domain,
                               .friction = out->friction,
                               .transfer = &out->transfer,
                               .loads = out->loads,
                               .damping = def->damping,
                               .mass = def->mass,
                               .columns = def->columns,
                               .log_rate = &u,
                               .log_state = &w,
                               .formulation = def->formulation};
    must(lac_problem_create(&problem, &out->problem, &err), &err);
}

void block_clear(block *b)
{
    lac_problem_free(b->problem);
    lac_load_set_clear(&b->loads);
    lac_friction_free(b->friction);
    lac_transfer_clear(&b->transfer);
    lac_hierarchy_free(b->hierarchy);
    lac_domain_free(b->domain);
}

double block_steady_rate(const block_def *def)
{
    return def->slip_rate * pow(def->x, def->b / def->a);
}

double block_steady_state(const block_def *def) { return def->dc / block_steady_rate(def); }

static lac_status keep(void *context, const lac_record *line, lac_error *err)
{
    history *h = context;
    if (h->n == h->room) {
        size_t room = h->room == 0 ? 256 : 2 * h->room;
        lac_record *more = realloc(h->line, room * sizeof *more);
        if (more == NULL) {
            return lac_fail_memory(err);
        }
        h->line = more;
        h->room = room;
    }
    h->line[h->n++] = *line;
    return LAC_OK;
}

lac_sink history_sink(history *h) { return (lac_sink){.context = h, .record = keep}; }

void history_clear(history *h)
{
    free(h->line);
    *h = (history){0};
}

double history_time(const history *h, size_t i)
{
    return h->line[i].time_origin + h->line[i].time_local;
}
