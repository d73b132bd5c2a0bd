// SPDX-License-Identifier: GPL-3.0-or-later
// rg, and analysis, the indicators that a run follows: how they are read and what is wrong with
// them.
#include "case/sections.h"

static const char from_friction[] = "from-friction";

// A strength left after slip; false where it is wrong, which is then reported.
static bool read_residual(lac_reader *reader, const lac_node *node, double *beta)
{
    static const lac_param row = LAC_REAL("beta", "1", 0, NAN, 0, 1, 0, "");
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
    } else if (read_residual(reader, node, &beta)) {
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

// Warns that a beta from the friction law is that of the nominal b and v0 where these vary.
static void warn_nominal_beta(lac_reader *reader, const lac_case *c)
{
    for (size_t i = 0; i < c->friction_spread.count; i++) {
        const char *varies = c->friction_spread.item[i].key;
        if (strcmp(varies, "b") == 0 || strcmp(varies, "v0") == 0) {
            lac_warn(reader, "rg.beta",
                     "takes the nominal %s for every cell; friction.spread.%s has no effect on it",
                     varies, varies);
        }
    }
}

// What a beta from the friction law needs.
static void check_law(lac_reader *reader, const lac_case *c)
{
    const lac_friction_params *law = c->friction.params;
    const lac_material_def *m = &c->material;
    warn_nominal_beta(reader, c);
    if (!lac_refuse(reader, !HAS("friction"), "rg.beta", "needs a friction law") && law != NULL &&
        (!isnan(law->v1) || !isnan(law->v2))) {
        lac_warn(reader, "rg.beta", "takes the friction law without its cut-offs v1 and v2");
    }
    (void)lac_refuse(reader,
                     isnan(m->shear_modulus) || (isnan(m->shear_speed) && isnan(m->density)),
                     "rg.beta", "needs material.shear_modulus and shear_speed or density");
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
    if (c->rg.betas == 0) {
        check_law(reader, c);
    }
}

static void read_indicator(lac_reader *reader, const lac_node *node, lac_model *model)
{
    const lac_model_info *info = lac_find_model(reader, node, LAC_KIND_ANALYSIS, "indicator");
    size_t errors = reader->report->errors;
    bool nothing = lac_node_is_null(node);
    if (info == NULL ||
        (!nothing && !lac_expect_map(reader, node, "a mapping such as {slipping_strength: 0.8}"))) {
        return;
    }
    if (lac_model_create(info, model, NULL) != LAC_OK) {
        reader->no_memory = true;
        return;
    }
    if (!nothing) {
        lac_read_table(reader, node, info, NULL, model->params);
    }
    bool sound = reader->report->errors == errors;
    const char *fault = sound && info->validate != NULL ? info->validate(model->params) : NULL;
    if (fault != NULL) {
        lac_add_error(reader, node, "%s", fault);
    }
}

void lac_read_analysis(lac_reader *reader, const lac_node *node, lac_case *c)
{
    if (node->bad || !lac_expect_map(reader, node, "a mapping of indicators such as {rg: {}}")) {
        return;
    }
    c->analysis.item = lac_reader_array(reader, node->count, sizeof *c->analysis.item);
    for (size_t i = 0; c->analysis.item != NULL && i < node->count; i++) {
        lac_model *model = &c->analysis.item[c->analysis.count];
        if (!node->child[i]->ignored && !node->child[i]->bad) {
            read_indicator(reader, node->child[i], model);
            c->analysis.count += model->info != NULL ? 1 : 0;
        }
    }
}

static void check_slipping(lac_reader *reader, const lac_case *c, lac_analysis_rg *rg)
{
    const lac_friction_params *law = c->friction.info != NULL ? c->friction.params : NULL;
    char key[] = "analysis.rg.slipping_strength";
    const bool from_law = c->rg.betas == 0;
    const double beta = from_law ? (double)NAN : c->rg.beta[0];
    if (!isnan(rg->slipping_rate)) {
        return;
    }
    if (isnan(rg->slipping_strength) && !from_law) {
        rg->slipping_strength = 0.5 * (1.0 + beta);
    }
    (void)lac_refuse(reader, rg->slipping_strength >= 1.0 || rg->slipping_strength <= beta,
                     HAS(key) ? key : "rg.beta",
                     "leaves no room for slip: must be beta = %g < slipping_strength < 1", beta);
    (void)lac_refuse(
        reader, law != NULL && !lac_heterogeneity_has(&c->friction_spread, "b") && !(law->b > 0.0),
        "analysis.rg",
        "cannot use the strength, which never drops with b = 0 in the friction law: give "
        "slipping_rate");
    (void)lac_refuse(reader,
                     from_law && isnan(rg->slipping_strength) && !isnan(rg->critical_fraction), key,
                     "is missing: where critical_fraction is given no cascade gives beta");
}

// The static cascade of the case's own interface; a single block has none, which is no error.
static void check_cascade(lac_reader *reader, const lac_case *c, const lac_analysis_rg *rg)
{
    double friction = c->rg.friction;
    bool domain = HAS("interface.domain");
    if (!isnan(rg->critical_fraction) || (!domain && !HAS("interface.surface"))) {
        return;
    }
    (void)lac_refuse(reader, c->rg.field == LAC_RG_ELASTIC && domain, "rg.field",
                     "needs interface.surface to press; a domain goes with equal or uniform (or "
                     "give analysis.rg.critical_fraction)");
    if (isnan(friction)) {
        lac_find_coulomb(reader, c, "rg", &friction);
    }
}

void lac_check_analysis(lac_reader *reader, lac_case *c)
{
    if (!lac_clean(reader, "analysis") || !lac_clean(reader, "rg") ||
        !lac_clean(reader, "friction") || !lac_clean(reader, "interface")) {
        return;
    }
    for (size_t i = 0; i < c->analysis.count; i++) {
        lac_analysis_rg *rg = lac_analysis_cascade(&c->analysis.item[i]);
        if (rg != NULL) {
            check_slipping(reader, c, rg);
            check_cascade(reader, c, rg);
        }
    }
}
