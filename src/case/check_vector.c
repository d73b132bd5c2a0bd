// SPDX-License-Identifier: GPL-3.0-or-later
// What goes with slip in two directions, and what knows slip along x only.
#include "case/sections.h"

#define NEEDS "needs interface.slip: vector"
#define ALONG_X "knows slip along x only: leave out interface.slip: vector"

const char *const lac_slip_names[] = {"scalar", "vector", NULL};

static void check_loads(lac_reader *reader, const lac_case *c, bool vector)
{
    char key[100];
    for (size_t i = 0; i < c->shear.count && lac_clean(reader, "load"); i++) {
        const lac_model *model = &c->shear.item[i];
        const lac_load_kind *kind = (const void *)model->info;
        (void)snprintf(key, sizeof key, "load.shear.%zu.%s", i, kind->info.name);
        (void)lac_refuse(reader, vector && kind->needs_anchor, key, ALONG_X);
        (void)lac_refuse(reader, vector && lac_load_models_share(model) == LAC_SHARE_ELASTIC, key,
                         "with share: elastic " ALONG_X);
        (void)snprintf(key, sizeof key, "load.shear.%zu.%s.azimuth", i, kind->info.name);
        (void)lac_refuse(reader, !vector && !isnan(lac_load_model_azimuth(model)), key, NEEDS);
    }
}

void lac_check_vector(lac_reader *reader, lac_case *c)
{
    const bool vector = c->slip == LAC_SLIP_VECTOR;
    const bool chosen = c->formulation == LAC_FORMULATION_VECTOR;
    const bool turned = !isnan(c->initial_azimuth);
    const lac_friction_params *law = c->friction.params;
    const lac_transfer_kind *transfer = (const void *)c->transfer.info;
    const lac_domain_source *domain = (const void *)c->domain.info;
    const bool full = c->surface.info == NULL && (domain == NULL || domain->full);
    const bool repeats = full && c->interface.boundary == LAC_PERIODIC;
    const struct {
        bool wrong;
        const char *key, *why;
    } table[] = {
        {!vector && turned, "initial.azimuth", NEEDS},
        {!vector && chosen, "solver.formulation", NEEDS},
        {vector && turned && !(HAS("initial.slip_rate") && HAS("initial.state")), "initial.azimuth",
         "goes with slip_rate and state both given; else slip starts where the loads pull"},
        {vector && !chosen && c->formulation != LAC_FORMULATION_AUTO, "solver.formulation",
         "knows slip along x only: leave it out, or leave out interface.slip: vector"},
        {vector && c->run.fidelity == LAC_FIDELITY_ASYNC, "solver.fidelity", ALONG_X},
        {vector && HAS("inertia"), "inertia", ALONG_X},
        {vector && c->fit.named, "fit", ALONG_X},
        {vector && c->weakening.count > 0, "weakening", ALONG_X},
        {vector && transfer != NULL && transfer->transforms && !repeats, "transfer",
         "with interface.slip: vector needs interface.boundary: periodic and every cell in "
         "contact, or must be hierarchy"},
        {vector && c->friction.info != NULL && law->cohesion > 0.0, "friction",
         "has cohesion, which " ALONG_X},
    };
    check_loads(reader, c, vector);
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        (void)lac_refuse(reader, table[i].wrong, table[i].key, "%s", table[i].why);
    }
    c->formulation = vector ? LAC_FORMULATION_VECTOR : c->formulation;
}
