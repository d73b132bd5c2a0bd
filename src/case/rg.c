// SPDX-License-Identifier: GPL-3.0-or-later
// rg: its keys, how they are read and what is wrong with them.
#include <math.h>
#include <string.h>

#include "base/rg_rows.h"
#include "case/sections.h"
#include "rg/rg.h"

#define FIELD(name) offsetof(lac_case, name)

static const char *const rg_paths[] = {"series", "solve", NULL};
static const char from_friction[] = "from-friction";

const lac_param lac_rg_rows[LAC_RG_ROWS] = {
    LAC_RG_RULE_ROW(
        FIELD(rg.rule), 0, 0,
        "what a block that slips sheds: fix, the drop of its strength (the paper); cons, "
        "all above its residual strength; lump, as a point with its sums"),
    LAC_RG_FIELD_ROW(
        FIELD(rg.field), LAC_RG_ELASTIC, 0,
        "how shear spreads over the cells: elastic contact, equal springs with caps, or the "
        "same stress on all (uniform), as a ramp with share: equal puts it on"),
    LAC_OWN("beta",
            "strength left after slip, as a number, a list, or from-friction; 0.7 if absent"),
    LAC_COULOMB_ROW(FIELD(rg.friction)),
    LAC_RG_SHIFTS_ROW(FIELD(rg.shifts), 16, 0, "places of the grid of blocks, averaged"),
    LAC_INTEGER("seeds", FIELD(rg.seeds), 1, 1, 10000, 0,
                "interfaces: the case's own seed and those that follow it"),
    LAC_RG_LOADS_ROW(FIELD(rg.loads), 60, 0, "shear forces at which slipping blocks are counted"),
    LAC_INTEGER("contacts", FIELD(rg.contacts), LAC_RG_LOADS, 10, LAC_RG_MOST_LOADS, 0,
                "contacts solved along the path of field elastic, to interpolate between"),
    LAC_CHOICE(
        "path", FIELD(rg.path), LAC_RG_SERIES, rg_paths, 0,
        "the critical force of field elastic from that series, or on contacts solved for it"),
};

bool lac_read_beta(lac_reader *reader, const lac_node *node, double *beta)
{
    static const lac_param row = LAC_RG_BETA_ROW(0, 0, "");
    char why[80];
    if (!lac_read_number(reader, node, row.unit, beta)) {
        return false;
    }
    bool allowed = lac_param_allows(&row, *beta, why, sizeof why);
    if (!allowed) {
        lac_blame(reader, node, "must be >= %g and <= %g", row.min, row.max);
    }
    return allowed;
}

static void read_beta(lac_reader *reader, const lac_node *node, lac_rg_def *rg)
{
    double beta = NAN;
    if (rg->betas == LAC_MOST_BETAS) {
        lac_blame(reader, node, "is one too many: at most %d values", LAC_MOST_BETAS);
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
        lac_blame(reader, node, "must be a number, a list such as [0.8, 0.7], or %s",
                  from_friction);
    }
    for (size_t i = 0; node->kind == LAC_NODE_LIST && i < node->count; i++) {
        read_beta(reader, node->child[i], rg);
    }
}

void lac_read_rg(lac_reader *reader, const lac_node *node, lac_case *c)
{
    (void)reader;
    c->rg.named = node != NULL;
}

// Whether a slot's model has a seed.
static bool seeded(const lac_slot *slot)
{
    for (size_t i = 0; slot->about != NULL && i < slot->about->param_count; i++) {
        if (strcmp(slot->about->params[i].key, "seed") == 0) {
            return true;
        }
    }
    return false;
}

static void check_interface(lac_reader *reader, const lac_case *c)
{
    if (!lac_present(reader, "interface.surface") && !lac_present(reader, "interface.domain")) {
        lac_blame_key(reader, "interface",
                      "is a single block, which has no cells to hand load on: rg needs surface or "
                      "domain");
    }
    if (c->rg.field == LAC_RG_ELASTIC && lac_present(reader, "interface.domain")) {
        lac_blame_key(reader, "rg.field",
                      "needs interface.surface to press; a domain goes with equal or uniform");
    }
    bool random = seeded(&c->surface) || seeded(&c->domain);
    for (size_t i = 0; i < c->interface_spread.count; i++) {
        random = random || seeded(&c->interface_spread.item[i].slot);
    }
    if (c->rg.seeds > 1 && !random) {
        lac_blame_key(reader, "rg.seeds", "must be 1: the interface does not depend on a seed");
    }
}

void lac_warn_nominal_beta(lac_reader *reader, const lac_case *c, const char *key)
{
    for (size_t i = 0; i < c->friction_spread.count; i++) {
        const char *varies = c->friction_spread.item[i].key;
        if (strcmp(varies, "b") == 0 || strcmp(varies, "v0") == 0) {
            lac_warn(reader, key,
                     "takes the nominal %s for every cell; friction.spread.%s has no "
                     "effect on it",
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
    if (!lac_present(reader, "friction")) {
        lac_blame_key(reader, "rg.beta", "needs a friction law");
    } else if (law != NULL && (!isnan(law->v1) || !isnan(law->v2))) {
        lac_warn(reader, "rg.beta", "takes the friction law without its cut-offs v1 and v2");
    }
    if (isnan(m->shear_modulus) || (isnan(m->shear_speed) && isnan(m->density))) {
        lac_blame_key(reader, "rg.beta", "needs material.shear_modulus and shear_speed or density");
    }
}

void lac_check_rg(lac_reader *reader, lac_case *c)
{
    bool asked = lac_present(reader, "rg");
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
