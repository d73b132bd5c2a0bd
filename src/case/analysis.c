// SPDX-License-Identifier: GPL-3.0-or-later
// analysis: the indicators that a run follows, how they are read and what is wrong with them.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "case/sections.h"
#include "rg/rg.h"

static const char from_friction[] = "from-friction";

static void read_beta(lac_reader *reader, const lac_node *node, lac_analysis_rg *rg)
{
    if (node->kind == LAC_NODE_SCALAR && strcmp(node->text, from_friction) == 0) {
        rg->beta_from_friction = true;
    } else if (node->kind != LAC_NODE_SCALAR) {
        lac_add_error(reader, node, "must be a number or %s", from_friction);
    } else {
        (void)lac_read_beta(reader, node, &rg->beta);
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
    lac_analysis_rg *rg = lac_analysis_cascade(model);
    const lac_table table = {
        .params = info->params, .count = info->param_count, .own = rg != NULL ? "beta" : NULL};
    if (!nothing) {
        lac_read_table(reader, node, &table, model->params);
    }
    if (rg != NULL && !nothing && lac_node_child(node, "beta") != NULL) {
        read_beta(reader, lac_node_child(node, "beta"), rg);
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
    c->analysis.item = calloc(node->count + 1, sizeof *c->analysis.item);
    if (c->analysis.item == NULL) {
        reader->no_memory = true;
        return;
    }
    for (size_t i = 0; i < node->count; i++) {
        lac_model *model = &c->analysis.item[c->analysis.count];
        if (!node->child[i]->ignored && !node->child[i]->bad) {
            read_indicator(reader, node->child[i], model);
            c->analysis.count += model->info != NULL ? 1 : 0;
        }
    }
}

// What the cascade does not name is as in the section rg.
static void fill_in(const lac_case *c, lac_analysis_rg *rg)
{
    if (isnan(rg->beta) && !rg->beta_from_friction) {
        rg->beta_from_friction = c->rg.betas == 0;
        rg->beta = c->rg.betas > 0 ? c->rg.beta[0] : NAN;
    }
    if (isnan(rg->critical_fraction)) {
        rg->rule = rg->rule < 0 ? c->rg.rule : rg->rule;
        rg->field = rg->field < 0 ? c->rg.field : rg->field;
        rg->shifts = rg->shifts < 0 ? c->rg.shifts : rg->shifts;
        rg->loads = rg->loads < 0 ? c->rg.loads : rg->loads;
    }
    bool told = !isnan(rg->slipping_rate) || !isnan(rg->slipping_rate_ratio);
    if (isnan(rg->slipping_strength) && !told && !rg->beta_from_friction) {
        rg->slipping_strength = 0.5 * (1.0 + rg->beta);
    }
}

static void check_slipping(lac_reader *reader, const lac_case *c, const lac_analysis_rg *rg)
{
    const lac_friction_params *law = c->friction.info != NULL ? c->friction.params : NULL;
    char key[] = "analysis.rg.slipping_strength";
    if (!isnan(rg->slipping_rate) || !isnan(rg->slipping_rate_ratio)) {
        return;
    }
    (void)lac_refuse(reader, rg->slipping_strength >= 1.0 || rg->slipping_strength <= rg->beta,
                     HAS(key) ? key : "analysis.rg.beta",
                     "leaves no room for slip: must be beta = %g < slipping_strength < 1",
                     rg->beta);
    (void)lac_refuse(
        reader, law != NULL && !lac_heterogeneity_has(&c->friction_spread, "b") && !(law->b > 0.0),
        "analysis.rg",
        "can't tell slip by the strength, which never drops with b = 0 in the friction law: give "
        "slipping_rate or slipping_rate_ratio");
    (void)lac_refuse(reader,
                     rg->beta_from_friction && isnan(rg->slipping_strength) &&
                         !isnan(rg->critical_fraction),
                     key, "is missing: no cascade tells beta where critical_fraction is given");
}

// The static cascade of the case's own interface; a single block has none, which is no error.
static void check_cascade(lac_reader *reader, const lac_case *c, lac_analysis_rg *rg)
{
    double friction = c->rg.friction;
    bool domain = HAS("interface.domain");
    if (!isnan(rg->critical_fraction) || (!domain && !HAS("interface.surface"))) {
        return;
    }
    (void)lac_refuse(reader, rg->field == LAC_RG_ELASTIC && domain, "analysis.rg.field",
                     "needs interface.surface to press; a domain goes with equal or uniform (or "
                     "give critical_fraction)");
    if (rg->beta_from_friction) {
        lac_warn_nominal_beta(reader, c, "analysis.rg.beta");
        lac_check_waves(reader, &c->material, "analysis.rg.beta");
    }
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
            fill_in(c, rg);
            check_slipping(reader, c, rg);
            check_cascade(reader, c, rg);
        }
    }
}
