// SPDX-License-Identifier: GPL-3.0-or-later
// The indicators of a case stand between a run and what keeps its records: they see each record
// first and add their own quantities to it.
#include "analysis/analysis.h"

#include "lacuna/simulation.h"

struct lac_analysis {
    lac_sink next; // first, as lac_sink_before wants it
    size_t n;
    lac_indicator *indicator; // [n]
    size_t *first;            // [n] value of each indicator in a record
    size_t levels;            // values of a quantity over levels
    size_t extras;
    lac_extra *extra; // [extras] of all indicators
    double *once;     // [extras] gathered on request
    double *values;   // of the last record
};

lac_analysis_rg *lac_analysis_cascade(const lac_model *indicator)
{
    const lac_indicator_kind *kind = (const void *)indicator->info;
    return kind->cascade ? indicator->params : NULL;
}

static size_t width(const lac_analysis *a, const lac_extra *extra)
{
    return extra->over == LAC_OVER_LEVELS ? a->levels : extra->over == LAC_OVER_TIME ? 1 : 0;
}

// Lists the quantities of all indicators and where their values stand.
static lac_status gather(lac_analysis *a, lac_error *err)
{
    size_t values = 0;
    for (size_t i = 0; i < a->n; i++) {
        a->extras += a->indicator[i].extras;
    }
    a->extra = malloc((a->extras + 1) * sizeof *a->extra);
    a->once = malloc((a->extras + 1) * sizeof *a->once);
    LAC_FAIL_MEMORY_IF(a->extra == NULL || a->once == NULL, err);
    for (size_t i = 0, k = 0; i < a->n; i++) {
        const lac_indicator *indicator = &a->indicator[i];
        a->first[i] = values;
        for (size_t j = 0; j < indicator->extras; j++) {
            a->extra[k++] = indicator->extra[j];
            values += width(a, &indicator->extra[j]);
        }
    }
    a->values = calloc(values + 1, sizeof *a->values);
    return a->values != NULL ? LAC_OK : lac_fail_memory(err);
}

lac_status lac_analysis_create(const lac_analysis_scene *scene, size_t count,
                               const lac_model *models, lac_analysis **out, lac_error *err)
{
    lac_status status;
    lac_analysis *a = *out = calloc(1, sizeof *a);
    LAC_FAIL_MEMORY_IF(a == NULL, err);
    a->levels = lac_hierarchy_levels(scene->hierarchy) + 1;
    a->indicator = calloc(count + 1, sizeof *a->indicator);
    a->first = calloc(count + 1, sizeof *a->first);
    LAC_TRY(a->indicator != NULL && a->first != NULL ? LAC_OK : lac_fail_memory(err));
    for (size_t i = 0; i < count; i++) {
        lac_indicator *indicator = &a->indicator[a->n++];
        indicator->kind = (const void *)models[i].info; // the first member of the kind
        indicator->state = calloc(1, indicator->kind->state_size);
        LAC_TRY(indicator->state != NULL ? LAC_OK : lac_fail_memory(err));
        LAC_TRY(indicator->kind->create(scene, models[i].params, indicator, err));
    }
    LAC_TRY(gather(a, err));
out:
    LAC_MADE(status, out, lac_analysis_free);
}

void lac_analysis_free(lac_analysis *analysis)
{
    if (analysis == NULL) {
        return;
    }
    for (size_t i = 0; i < analysis->n; i++) {
        if (analysis->indicator[i].state != NULL) {
            analysis->indicator[i].kind->clear(analysis->indicator[i].state);
        }
        free(analysis->indicator[i].state);
    }
    free(analysis->indicator);
    free(analysis->first);
    free(analysis->extra);
    free(analysis->once);
    free(analysis->values);
    free(analysis);
}

static lac_status on_record(void *context, const lac_record *record, lac_error *err)
{
    lac_analysis *a = context;
    lac_record line = *record;
    for (size_t i = 0; i < a->n; i++) {
        lac_indicator *indicator = &a->indicator[i];
        if (indicator->kind->observe != NULL) {
            indicator->kind->observe(indicator, record, a->values + a->first[i]);
        }
    }
    line.extra = a->values;
    return a->next.record != NULL ? a->next.record(a->next.context, &line, err) : LAC_OK;
}

static lac_status on_step(void *context, const lac_step *step, lac_error *err)
{
    lac_analysis *a = context;
    for (size_t i = 0; i < a->n; i++) {
        lac_indicator *indicator = &a->indicator[i];
        if (indicator->kind->step != NULL) {
            LAC_TRY_RETURN(indicator->kind->step(indicator, step, &a->next, err));
        }
    }
    if (a->next.step != NULL) {
        LAC_TRY_RETURN(a->next.step(a->next.context, step, err));
    }
    return LAC_OK;
}

static void on_keep(void *context, lac_archive *archive)
{
    lac_analysis *a = context;
    for (size_t i = 0; i < a->n; i++) {
        lac_indicator *indicator = &a->indicator[i];
        if (indicator->kind->serialize == NULL) {
            archive->refused = indicator->kind->info.name;
            return;
        }
        indicator->kind->serialize(indicator, archive);
    }
    if (a->next.serialize != NULL) {
        a->next.serialize(a->next.context, archive);
    }
}

lac_sink lac_analysis_sink(lac_analysis *analysis, const lac_sink *next)
{
    analysis->next = *next;
    lac_sink sink = lac_sink_before(&analysis->next);
    sink.record = on_record;
    sink.step = lac_analysis_has_events(analysis) || next->step != NULL ? on_step : NULL;
    sink.serialize = on_keep;
    sink.cells_from = analysis->n > 0 ? 0.0 : next->cells_from;
    return sink;
}

bool lac_analysis_has_events(const lac_analysis *analysis)
{
    bool has = false;
    for (size_t i = 0; analysis != NULL && i < analysis->n; i++) {
        has |= analysis->indicator[i].kind->step != NULL;
    }
    return has;
}

size_t lac_analysis_extras(const lac_analysis *analysis, const lac_extra **extra,
                           const double **once)
{
    size_t k = 0;
    for (size_t i = 0; i < analysis->n; i++) {
        size_t own = 0;
        for (size_t j = 0; j < analysis->indicator[i].extras; j++) {
            if (analysis->indicator[i].extra[j].over == LAC_OVER_NOTHING) {
                analysis->once[k++] = analysis->indicator[i].once[own++];
            }
        }
    }
    *extra = analysis->extra;
    *once = analysis->once;
    return analysis->extras;
}

size_t lac_analysis_values(const lac_analysis *analysis)
{
    size_t values = 0;
    for (size_t k = 0; analysis != NULL && k < analysis->extras; k++) {
        values += width(analysis, &analysis->extra[k]);
    }
    return values;
}

lac_status lac_analysis_finish(lac_analysis *analysis, const lac_run_result *result, lac_error *err)
{
    for (size_t i = 0; i < analysis->n; i++) {
        lac_indicator *indicator = &analysis->indicator[i];
        LAC_TRY_RETURN(indicator->kind->finish(indicator, result, &analysis->next, err));
    }
    return LAC_OK;
}

const lac_indicator *lac_analysis_get(const lac_analysis *analysis, size_t index)
{
    return analysis != NULL && index < analysis->n ? &analysis->indicator[index] : NULL;
}

lac_critical_fraction lac_critical_fraction_of(const lac_rg_result *result, const char *how,
                                               double beta)
{
    const double lowest = 0.05; // the map's own range of fit
    const lac_rg_estimate *c = &result->fit.fixed_point;
    lac_critical_fraction out = {.value = NAN, .low = NAN, .high = NAN, .beta = beta};
    if (isnan(result->fit.map.lambda)) {
        (void)snprintf(out.source, sizeof out.source,
                       "none: %zu pairs of slipped fractions are too few for a map (%s)",
                       result->fit.map.points, how);
    } else if (isnan(c->value)) {
        (void)snprintf(out.source, sizeof out.source,
                       "none: the map does not cross the diagonal, lambda = %.4g (%s)",
                       result->fit.map.lambda, how);
    } else if (!(c->value > lowest && c->value < 1.0 - lowest)) {
        (void)snprintf(out.source, sizeof out.source,
                       "none: the map crosses the diagonal at %.3g only, beyond the range from %g "
                       "to %g it was fitted to (%s)",
                       c->value, lowest, 1.0 - lowest, how);
    } else {
        out.value = c->value;
        out.low = c->low;
        out.high = c->high;
        (void)snprintf(out.source, sizeof out.source, "static cascade: %s", how);
    }
    return out;
}
