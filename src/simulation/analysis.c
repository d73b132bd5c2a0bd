// SPDX-License-Identifier: GPL-3.0-or-later
// The indicators of a case's run, with what they need to know before it starts.
#include "scene/scene_rg.h"
#include "simulation/internal.h"

// The cascade on the interface of the case itself.
static lac_status run_cascade(const lac_case *c, lac_critical_fraction *out, lac_error *err)
{
    lac_scene_rg cascade;
    char how[LAC_ANALYSIS_TEXT / 2];
    lac_case own = *c;
    own.rg.named = true;
    own.rg.seeds = 1;
    own.rg.path = LAC_RG_SERIES; // of the critical force alone, which is not asked for
    own.rg.betas = own.rg.betas > 0 ? 1 : 0;
    if (isnan(own.rg.friction)) {
        own.rg.friction = ((const lac_friction_params *)c->friction.params)->f0;
    }
    lac_status status = lac_scene_rg_run(&own, NULL, &cascade, err);
    LAC_TRY_RETURN(lac_fail_within(err, status, "analysis.rg"));
    (void)snprintf(how, sizeof how, "rule %s, field %s, beta %.4g%s, %zu places of the blocks",
                   lac_rg_rule_names[own.rg.rule], lac_rg_field_names[own.rg.field],
                   cascade.beta[0], own.rg.betas == 0 ? " (from the friction law, mean)" : "",
                   cascade.result[0]->places);
    *out = lac_critical_fraction_of(cascade.result[0], how, cascade.beta[0]);
    lac_scene_rg_clear(&cascade);
    return LAC_OK;
}

static lac_status find_critical(const lac_scene *scene, const lac_analysis_rg *rg,
                                lac_critical_fraction *out, lac_error *err)
{
    const lac_case *c = scene->source;
    *out = (lac_critical_fraction){.value = rg->critical_fraction,
                                   .low = NAN,
                                   .high = NAN,
                                   .beta = c->rg.betas > 0 ? c->rg.beta[0] : (double)NAN};
    if (!isnan(rg->critical_fraction)) {
        (void)snprintf(out->source, sizeof out->source, "given in the case");
        return LAC_OK;
    }
    if (c->surface.info == NULL && c->domain.info == NULL) {
        (void)snprintf(out->source, sizeof out->source,
                       "none: a single block has no cells to hand load on");
        return LAC_OK;
    }
    return run_cascade(c, out, err);
}

lac_status lac_indicators_prepare(const lac_scene *scene, lac_critical_fraction *critical,
                                  lac_error *err)
{
    const lac_model_list *models = &scene->source->analysis;
    for (size_t i = 0; i < models->count; i++) {
        const lac_analysis_rg *rg = lac_analysis_cascade(&models->item[i]);
        if (rg != NULL) {
            LAC_TRY_RETURN(find_critical(scene, rg, critical, err));
        }
    }
    return LAC_OK;
}

lac_status lac_indicators_create(const lac_scene *scene, const lac_critical_fraction *critical,
                                 lac_analysis **out, lac_error *err)
{
    const lac_model_list *models = &scene->source->analysis;
    const lac_analysis_scene made_for = {.domain = scene->contact.domain,
                                         .hierarchy = scene->hierarchy,
                                         .friction = scene->friction,
                                         .critical = *critical,
                                         .shear_modulus = scene->source->material.shear_modulus};
    *out = NULL;
    return models->count > 0 ? lac_analysis_create(&made_for, models->count, models->item, out, err)
                             : LAC_OK;
}
