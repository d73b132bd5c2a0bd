// SPDX-License-Identifier: GPL-3.0-or-later
// A case with other values, run: with derivatives by CVODES' sensitivities, or by differences of
// runs where a parameter changes the cells or when the loads break.
#include "fit/internal.h"

enum { MOST_STEPS = 200000, MOST_BREAKS = 100000 };

// Half differences of a coordinate: between nudged problems, and between runs, whose own errors
// are larger.
static const double small = 1e-5;
static const double large = 1e-3;

static void variant_clear(lac_fit_variant *v)
{
    lac_scene_free(v->scene);
    lac_case_free(v->c);
    *v = (lac_fit_variant){0};
}

static lac_status variant_create(const lac_fit *fit, lac_fit_variant *v, lac_error *err)
{
    *v = (lac_fit_variant){0};
    lac_status status =
        lac_case_read_text(fit->source->path, fit->text, strlen(fit->text), NULL, &v->c, NULL, err);
    for (size_t k = 0; status == LAC_OK && k < fit->def->count; k++) {
        lac_case_value value;
        LAC_FAIL_IF(!lac_case_find(v->c, fit->def->parameter[k].key, &value), err, LAC_EINPUT,
                    "fit.parameters.%s: is not in the resolved case", fit->def->parameter[k].key);
        v->at[k] = value.at;
    }
    return status;
}

lac_status lac_fit_model_create(const lac_fit *fit, lac_fit_model *model, lac_error *err)
{
    *model = (lac_fit_model){.fit = fit, .rtol = LAC_FIT_LOOSE};
    model->scratch = malloc(5 * (fit->data.n + 1) * sizeof *model->scratch);
    LAC_FAIL_MEMORY_IF(model->scratch == NULL, err);
    lac_status status = lac_load_files_create(&model->files, err);
    return status == LAC_OK ? variant_create(fit, &model->base, err) : status;
}

void lac_fit_model_clear(lac_fit_model *model)
{
    variant_clear(&model->base);
    lac_points_free(model->points);
    for (size_t i = 0; model->nudged != NULL && i < 2 * model->fit->def->count; i++) {
        variant_clear(&model->nudged[i]);
    }
    free(model->nudged);
    lac_load_files_free(model->files);
    free(model->scratch);
    *model = (lac_fit_model){0};
}

void lac_fit_put(const lac_fit_def *def, const double *u, double *const *at)
{
    for (size_t k = 0; k < def->count; k++) {
        *at[k] = lac_fit_value(def->parameter[k].log, u[k]);
    }
}

// Brings the scene of a variant to coordinates u.
static lac_status bring(lac_fit_model *model, lac_fit_variant *v, const double *u, lac_error *err)
{
    const lac_fit *fit = model->fit;
    lac_fit_put(fit->def, u, v->at);
    const char *fault = lac_case_validate(v->c);
    LAC_FAIL_IF(fault != NULL, err, LAC_EINPUT, "%s", fault);
    if (v->scene != NULL && fit->moves_all) {
        lac_scene_free(v->scene);
        v->scene = NULL;
    }
    if (v->scene == NULL) {
        return lac_scene_create(v->c, model->files, &v->scene, err);
    }
    lac_status status = lac_scene_renew(v->scene, model->files, fit->moves_loads, err);
    LAC_MADE(status, &v->scene, lac_scene_free);
}

// The same of the base, and the cells of the point that the readings are of: they stay while the
// contact does.
static lac_status bring_base(lac_fit_model *model, const double *u, lac_error *err)
{
    const lac_case *c = model->fit->source;
    LAC_TRY_RETURN(bring(model, &model->base, u, err));
    if (c->fit.point == NULL || (model->points != NULL && !model->fit->moves_all)) {
        return LAC_OK;
    }
    lac_points_free(model->points);
    return lac_points_create(model->base.scene->contact.domain, 1,
                             &c->point[lac_case_point(c, c->fit.point)], &model->points, err);
}

// How far off a trial with few cells may be: by its time of failure, or what it shows last.
static lac_status judge(const lac_fit_model *model, const lac_sensitivity *seen, lac_error *err)
{
    const lac_lump *lump = model->base.scene->lump;
    if (lump == NULL || (!seen->failed && seen->reached == 0)) {
        return LAC_OK;
    }
    return lac_lump_judge(
        lump, seen->failed ? lac_lump_error(lump, false, seen->failure_time) : lump->error,
        model->fit->source->lump.error, err);
}

static lac_sensitivity_def follow_of(const lac_fit_model *model, double end, size_t n,
                                     const double *time)
{
    return (lac_sensitivity_def){
        .problem = lac_scene_problem(model->base.scene),
        .point = model->points != NULL ? model->points->point : NULL,
        .friction = model->fit->friction,
        .rtol = fmin(model->rtol, model->fit->source->run.rtol),
        .end = end > 0.0 ? end : 1e-9, // a run of no length has nothing to integrate
        .failure_rate = model->fit->source->run.failure_rate,
        .failure_slip = model->fit->source->run.failure_slip,
        .max_steps = MOST_STEPS,
        .n = n,
        .time = time};
}

lac_status lac_fit_model_run(lac_fit_model *model, const double *u, double end, size_t n,
                             const double *time, lac_sensitivity *out, lac_error *err)
{
    out->reached = 0;
    out->failed = false;
    LAC_TRY_RETURN(bring_base(model, u, err));
    lac_sensitivity_def def = follow_of(model, end, n, time);
    LAC_TRY_RETURN(lac_sensitivity_run(&def, out, err));
    return judge(model, out, err);
}

lac_status lac_fit_model_read(lac_fit_model *model, const double *u, double *slip, double *log_rate,
                              lac_error *err)
{
    const lac_fit_data *data = &model->fit->data;
    lac_sensitivity seen = {.slip = slip, .log_rate = log_rate};
    lac_status status =
        lac_fit_model_run(model, u, data->time[data->n - 1], data->n, data->time, &seen, err);
    return status == LAC_OK && seen.reached < data->n
               ? lac_fail(err, LAC_ENUMERIC, "fails before the last reading")
               : status;
}

static lac_status make_nudged(lac_fit_model *model, lac_error *err)
{
    size_t count = 2 * model->fit->def->count;
    lac_status status = LAC_OK;
    if (model->nudged != NULL) {
        return LAC_OK;
    }
    model->nudged = calloc(count, sizeof *model->nudged);
    LAC_FAIL_MEMORY_IF(model->nudged == NULL, err);
    for (size_t i = 0; status == LAC_OK && i < count; i++) {
        status = variant_create(model->fit, &model->nudged[i], err);
    }
    return status;
}

// What a coordinate counts in: an e-fold, or a part of its range or value.
static double unit_of(const lac_fit *fit, size_t k, double u)
{
    const lac_fit_parameter *p = &fit->def->parameter[k];
    bool bounded = isfinite(p->low) && isfinite(p->high);
    return p->log ? 1.0 : bounded ? 0.1 * (p->high - p->low) : fmax(fabs(u), 1e-3 * p->sigma);
}

// Whether the loads of two problems break at the same times.
static bool breaks_agree(const lac_problem *a, const lac_problem *b, double end)
{
    double t = 0.0;
    for (size_t i = 0; i < MOST_BREAKS; i++) {
        double next = lac_problem_next_break(a, t);
        if (lac_problem_next_break(b, t) != next) {
            return false;
        }
        if (!(next < end)) {
            return true;
        }
        t = next;
    }
    return false;
}

static bool comparable(const lac_fit_model *model, const lac_perturbation *perturbation, double end)
{
    const lac_problem *base = lac_scene_problem(model->base.scene);
    return lac_problem_cells(perturbation->low) == lac_problem_cells(base) &&
           lac_problem_cells(perturbation->high) == lac_problem_cells(base) &&
           breaks_agree(base, perturbation->low, end) &&
           breaks_agree(base, perturbation->high, end);
}

// Which parameters the run can be differentiated by, with the problems for these.
static lac_status nudge_all(lac_fit_model *model, const double *u, double end,
                            lac_perturbation *perturbation, int *by, lac_error *err)
{
    size_t count = model->fit->def->count;
    double moved[LAC_MOST_FITTED];
    const lac_lump *lump = model->base.scene->lump;
    LAC_TRY_RETURN(make_nudged(model, err));
    for (size_t k = 0; k < count; k++) {
        double step = small * unit_of(model->fit, k, u[k]);
        memcpy(moved, u, count * sizeof *moved);
        moved[k] = u[k] - step;
        LAC_TRY_RETURN(bring(model, &model->nudged[2 * k], moved, err));
        moved[k] = u[k] + step;
        LAC_TRY_RETURN(bring(model, &model->nudged[2 * k + 1], moved, err));
        for (size_t side = 0; side < 2 && lump != NULL && !model->fit->moves_all; side++) {
            LAC_TRY_RETURN(lac_scene_lump(model->nudged[2 * k + side].scene, lump, err));
        }
        *perturbation =
            (lac_perturbation){.low = lac_scene_problem(model->nudged[2 * k].scene),
                               .high = lac_scene_problem(model->nudged[2 * k + 1].scene),
                               .step = step};
        const bool other_cells = lump != NULL && model->fit->moves_all;
        by[k] =
            !other_cells && comparable(model, perturbation, end) ? LAC_BY_SENSITIVITY : LAC_BY_RUNS;
        perturbation += by[k] == LAC_BY_SENSITIVITY ? 1 : 0;
    }
    return LAC_OK;
}

// Puts the columns of the sensitivities where they belong among all; NaN in the others.
static void spread_columns(size_t n, size_t count, const int *by, double *x)
{
    size_t from = 0;
    for (size_t k = 0; k < count; k++) {
        from += by[k] == LAC_BY_SENSITIVITY ? n : 0;
    }
    for (size_t at = n * count; at-- > 0;) {
        x[at] = by[at % count] == LAC_BY_SENSITIVITY ? x[--from] : NAN;
    }
}

// A run with the derivatives that it can be differentiated by. @param by  [parameters] set
static lac_status follow(lac_fit_model *model, const double *u, double end, size_t n,
                         lac_sensitivity *out, int *by, lac_error *err)
{
    lac_perturbation perturbation[LAC_MOST_FITTED];
    size_t count = model->fit->def->count;
    LAC_TRY_RETURN(bring_base(model, u, err));
    LAC_TRY_RETURN(nudge_all(model, u, end, perturbation, by, err));
    lac_sensitivity_def def = follow_of(model, end, n, model->fit->data.time);
    for (size_t k = 0; k < count; k++) {
        def.perturbations += by[k] == LAC_BY_SENSITIVITY ? 1 : 0;
    }
    def.rtol = fmin(LAC_FIT_TIGHT, def.rtol);
    def.perturbation = perturbation;
    LAC_TRY_RETURN(lac_sensitivity_run(&def, out, err));
    LAC_TRY_RETURN(judge(model, out, err));
    spread_columns(1, count, by, out->failure_by);
    return LAC_OK;
}

lac_status lac_fit_model_failure(lac_fit_model *model, const double *u, lac_sensitivity *out,
                                 lac_error *err)
{
    int by[LAC_MOST_FITTED];
    return follow(model, u, model->fit->source->run.end, 0, out, by, err);
}

// One column of the derivatives by two runs.
static lac_status difference(lac_fit_model *model, const double *u, size_t k, lac_sensitivity *out,
                             lac_error *err)
{
    const lac_fit_data *data = &model->fit->data;
    size_t count = model->fit->def->count;
    double moved[LAC_MOST_FITTED];
    double step = large * unit_of(model->fit, k, u[k]);
    lac_status status = LAC_OK;
    const double before = model->rtol;
    model->rtol = LAC_FIT_TIGHT;
    double *slip = model->scratch, *log_rate = slip + data->n;
    for (int side = -1; side <= 1; side += 2) {
        memcpy(moved, u, count * sizeof *moved);
        moved[k] += side * step;
        LAC_TRY(lac_fit_model_read(model, moved, slip, log_rate, err));
        for (size_t i = 0; i < data->n; i++) {
            size_t at = i * count + k;
            double share = side / (2.0 * step);
            out->slip_by[at] = (side < 0 ? 0.0 : out->slip_by[at]) + share * slip[i];
            out->log_rate_by[at] = (side < 0 ? 0.0 : out->log_rate_by[at]) + share * log_rate[i];
        }
    }
out:
    model->rtol = before;
    return status;
}

lac_status lac_fit_model_differentiate(lac_fit_model *model, const double *u, lac_sensitivity *out,
                                       int *by, lac_error *err)
{
    const lac_fit_data *data = &model->fit->data;
    size_t count = model->fit->def->count;
    double failure_by[LAC_MOST_FITTED] = {0};
    out->failure_by = failure_by;
    const lac_status status = follow(model, u, data->time[data->n - 1], data->n, out, by, err);
    out->failure_by = NULL;
    LAC_TRY_RETURN(status);
    LAC_FAIL_IF(out->reached < data->n, err, LAC_ENUMERIC, "fails before the last reading");
    spread_columns(data->n, count, by, out->slip_by);
    spread_columns(data->n, count, by, out->log_rate_by);
    for (size_t k = 0; k < count; k++) {
        if (by[k] == LAC_BY_RUNS) {
            LAC_TRY_RETURN(difference(model, u, k, out, err));
        }
    }
    return LAC_OK;
}
