// SPDX-License-Identifier: GPL-3.0-or-later
// rg: its keys, how they are read and what is wrong with them.
#include <math.h>
#include <string.h>

#include "base/rg_rows.h"
#include "case/sections.h"
#include "rg/rg.h"

static const char from_friction[] = "from-friction";

bool lac_read_beta(lac_reader *reader, const lac_node *node, double *beta)
{
    static const lac_param row = LAC_RG_BETA_ROW(0, 0, "");
    char why[80];
    if (!lac_read_number(reader, node, row.unit, beta)) {
        return false;
    }
    bool allowed = lac_param_allows(&row, *beta, why, sizeof why);
    if (!allowed) {
        lac_add_error(reader, node, "must be >= %g and <= %g", row.min, row.max);
    }
    return allowed;
}

static void read_beta(lac_reader *reader, const lac_node *node, lac_rg_def *rg)
{
    double beta = NAN;
    if (rg->betas == LAC_MOST_BETAS) {
        lac_add_error(reader, node, "is one too many: at most %d values", LAC_MOST_BETAS);
    } else if (lac_read_beta(reader, node, &beta)) {
        rg->beta[rg->betas++] = beta;
    }
}

void lac_read_betas(lac_reader *reader, const lac_node *node, lac_case *c)
{
    lac_rg_def *rg = &c->rg;
    rg->betas = 0;
    if (node->kind == LAC_NODE_SCALAR && strcmp(node->text, from_friction) == 0) {
        return;
    }
    if (node->kind == LAC_NODE_SCALAR) {
        read_beta(reader, node, rg);
    } else if (node->kind != LAC_NODE_LIST || node->count == 0) {
        lac_add_error(reader, node, "must be a number, a list such as [0.8, 0.7], or %s",
                      from_friction);
    }
    for (size_t i = 0; node->kind == LAC_NODE_LIST && i < node->count; i++) {
        read_beta(reader, node->child[i], rg);
    }
}

static void check_interface(lac_reader *reader, const lac_case *c)
{
    (void)lac_refuse(
        reader, !HAS("interface.surface") && !HAS("interface.domain"), "interface",
        "is a single block, which has no cells to hand load on: rg needs surface or domain");
    (void)lac_refuse(reader, c->rg.field == LAC_RG_ELASTIC && HAS("interface.domain"), "rg.field",
                     "needs interface.surface to press; a domain goes with equal or uniform");
    bool random = lac_model_seed(&c->surface) != NULL || lac_model_seed(&c->domain) != NULL;
    for (size_t i = 0; i < c->interface_spread.count; i++) {
        random = random || lac_model_seed(&c->interface_spread.item[i].model) != NULL;
    }
    (void)lac_refuse(reader, c->rg.seeds > 1 && !random, "rg.seeds",
                     "must be 1: the interface does not depend on a seed");
}

void lac_warn_nominal_beta(lac_reader *reader, const lac_case *c, const char *key)
{
    for (size_t i = 0; i < c->friction_spread.count; i++) {
        const char *varies = c->friction_spread.item[i].key;
        if (strcmp(varies, "b") == 0 || strcmp(varies, "v0") == 0) {
            lac_warn(reader, key,
                     "takes the nominal %s for every cell; friction.spread.%s has no effect on it",
                     varies, varies);
        }
    }
}

static void check_law(lac_reader *reader, const lac_case *c)
{
    const lac_material_def *m = &c->material;
    if (c->rg.betas > 0) {
        return;
    }
    const lac_friction_params *law = c->friction.params;
    lac_warn_nominal_beta(reader, c, "rg.beta");
    if (!lac_refuse(reader, !HAS("friction"), "rg.beta", "needs a friction law") && law != NULL &&
        (!isnan(law->v1) || !isnan(law->v2))) {
        lac_warn(reader, "rg.beta", "takes the friction law without its cut-offs v1 and v2");
    }
    lac_check_waves(reader, m, "rg.beta");
}

void lac_check_waves(lac_reader *reader, const lac_material_def *m, const char *key)
{
    (void)lac_refuse(reader,
                     isnan(m->shear_modulus) || (isnan(m->shear_speed) && isnan(m->density)), key,
                     "needs material.shear_modulus and shear_speed or density");
}

void lac_check_rg(lac_reader *reader, lac_case *c)
{
    bool asked = HAS("rg");
    const bool on_cells = reader->purpose == LAC_FOR_CELLS;
    if (reader->purpose != LAC_FOR_RG && !on_cells && !asked) {
        return;
    }
    if (!lac_clean(reader, "rg") || !lac_clean(reader, "friction") ||
        !lac_clean(reader, "interface")) {
        return;
    }
    lac_find_coulomb(reader, c, "rg", &c->rg.friction);
    if (!on_cells) {
        check_interface(reader, c);
    }
    check_law(reader, c);
}
