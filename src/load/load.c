// SPDX-License-Identifier: GPL-3.0-or-later
// The loads of a case, made ready from what it names, and their sum at any time; and the tables of
// those that it can name, from the lists of kinds.h.
#include "load/load.h"

#include "load/kinds.h"

const char *const lac_share_names[] = {"pressure", "equal", "elastic", NULL};

// The descriptor is the first member of the kind's row.
static const lac_load_kind *kind_of(const lac_model *model)
{
    return (const lac_load_kind *)(const void *)model->info;
}

// The index-th of the loads, in the order of a set; NULL past the end.
static const lac_model *model_at(const lac_load_models *models, size_t index)
{
    const size_t pore = index - models->shear_count;
    const size_t normal = pore - models->pore_count;
    return index < models->shear_count     ? &models->shear[index]
           : pore < models->pore_count     ? &models->pore[pore]
           : normal < models->normal_count ? &models->normal[normal]
                                           : NULL;
}

// Where the signal of the index-th load goes. Shear stress over the nominal area goes to what it is
// shared as: a spring's is the same on all cells; here it has no stiffness.
static size_t place_of(const lac_load_set *set, size_t i)
{
    static const size_t shear[] = {[LAC_SHARE_PRESSURE] = offsetof(lac_load_state, stress),
                                   [LAC_SHARE_EQUAL] = offsetof(lac_load_state, spring_stress),
                                   [LAC_SHARE_ELASTIC] = offsetof(lac_load_state, elastic)};
    return i < set->shear               ? shear[set->load[i].share]
           : i < set->shear + set->pore ? offsetof(lac_load_state, pore)
                                        : offsetof(lac_load_state, normal);
}

// What one load adds.
static void add_load(const lac_load *load, double t, lac_load_state *sum)
{
    if (load->kind->signal != NULL) {
        const lac_signal signal = load->kind->signal(load, t);
        double *to = (double *)(void *)((char *)sum + load->to);
        to[0] += signal.value;
        to[1] += signal.rate;
    } else if (load->kind->add != NULL) {
        load->kind->add(load, t, sum);
    }
}

// What one shear load adds along the unit vector of the set. Out of line: few runs have one.
static __attribute__((noinline)) void add_along(const lac_load_set *set, size_t i, double t,
                                                lac_load_state *sum)
{
    lac_load_state whole = {0};
    const double azimuth = set->load[i].azimuth;
    const double part = set->along[0] * cos(azimuth) + set->along[1] * sin(azimuth);
    add_load(&set->load[i], t, &whole);
    const double *from = (const void *)&whole; // all members before the lake are doubles
    double *to = (void *)sum;
    const size_t stiffness = offsetof(lac_load_state, spring_stiffness) / sizeof *to;
    for (size_t k = 0; k < offsetof(lac_load_state, lake) / sizeof *to; k++) {
        to[k] += k == stiffness ? from[k] : part * from[k]; // holds every way
    }
}

void lac_load_evaluate(const lac_load_set *set, double t, lac_load_state *sum)
{
    const size_t directed = set->directed ? set->shear : 0;
    *sum = (lac_load_state){0};
    for (size_t i = 0; i < directed; i++) {
        add_along(set, i, t, sum);
    }
    for (size_t i = directed; i < set->count; i++) {
        add_load(&set->load[i], t, sum);
    }
}

lac_load_set lac_load_set_along(const lac_load_set *set, double x, double y)
{
    lac_load_set along = *set;
    along.directed = true;
    along.along[0] = x;
    along.along[1] = y;
    return along;
}

lac_status lac_load_set_heading(const lac_load_set *set, double pressure, double *heading,
                                lac_error *err)
{
    lac_load_state at[2], alone;
    for (int c = 0; c < 2; c++) {
        const lac_load_set along = lac_load_set_along(set, 1.0 - c, c);
        lac_load_evaluate(&along, 0.0, &at[c]);
    }
    lac_load_evaluate(set, 0.0, &alone);
    // Shared as the pressures are, and alike.
    const double shared[] = {at[0].ratio * pressure + at[0].stress,
                             at[1].ratio * pressure + at[1].stress};
    const double alike[] = {at[0].equal_ratio * pressure + at[0].spring_stress,
                            at[1].equal_ratio * pressure + at[1].spring_stress};
    const double across = shared[0] * alike[1] - shared[1] * alike[0];
    const double size = hypot(shared[0], shared[1]) * hypot(alike[0], alike[1]);
    const double rounding = 1e-12;
    LAC_FAIL_IF(fabs(across) > rounding * size, err, LAC_EINPUT,
                "load.shear: loads that are shared differently (share) pull different ways at the "
                "start; give them one azimuth or one share");
    const double pull[] = {shared[0] + alike[0], shared[1] + alike[1]};
    LAC_FAIL_IF(hypot(pull[0], pull[1]) < rounding * lac_load_shear(&alone, pressure), err,
                LAC_EINPUT,
                "load.shear: loads cancel at the start; must give a shear load, unless initial "
                "gives both slip_rate and state");
    *heading = atan2(pull[1], pull[0]);
    return LAC_OK;
}

// Adds what the loads from the `first` up to the `end` put on each cell by itself.
static void add_cells(const lac_load_set *set, size_t first, size_t end, double t, double *value,
                      double *rate)
{
    for (size_t i = first; i < end; i++) {
        const lac_load *load = &set->load[i];
        if (load->kind->cells != NULL) {
            load->kind->cells(load, &set->places, t, value, rate);
        }
    }
}

static void fill(size_t n, lac_signal with, double *value, double *rate)
{
    for (size_t i = 0; i < n; i++) {
        value[i] = with.value;
        rate[i] = with.rate;
    }
}

void lac_load_evaluate_pore(const lac_load_set *set, double t, const lac_load_state *sum,
                            double *value, double *rate)
{
    fill(set->places.n, (lac_signal){sum->pore, sum->pore_rate}, value, rate);
    add_cells(set, set->shear, set->shear + set->pore, t, value, rate);
}

void lac_load_evaluate_normal(const lac_load_set *set, double t, const lac_load_state *sum,
                              double *value, double *rate)
{
    fill(set->places.n, (lac_signal){sum->normal, sum->normal_rate}, value, rate);
    add_cells(set, set->shear + set->pore, set->count, t, value, rate);
}

void lac_load_evaluate_cells(const lac_load_set *set, double t, const lac_load_state *sum,
                             double *value, double *rate)
{
    if (!lac_load_set_presses(set)) {
        lac_load_evaluate_pore(set, t, sum, value, rate);
        return;
    }
    lac_load_evaluate_normal(set, t, sum, value, rate);
    for (size_t i = 0; i < set->places.n; i++) {
        value[i] = sum->pore - value[i];
        rate[i] = sum->pore_rate - rate[i];
    }
    add_cells(set, set->shear, set->shear + set->pore, t, value, rate);
}

double lac_load_next_break(const lac_load_set *set, double t)
{
    double first = INFINITY;
    for (size_t i = 0; i < set->count; i++) {
        const lac_load *load = &set->load[i];
        first =
            load->kind->next_break != NULL ? fmin(first, load->kind->next_break(load, t)) : first;
    }
    return first;
}

double lac_load_longest_step(const lac_load_set *set, double t)
{
    double longest = INFINITY;
    for (size_t i = 0; i < set->count; i++) {
        const lac_load *load = &set->load[i];
        longest = load->kind->longest_step != NULL
                      ? fmin(longest, load->kind->longest_step(load, t))
                      : longest;
    }
    return longest;
}

static bool is_linear(const lac_load_kind *kind, const void *params)
{
    return kind->linear && !(kind->bends != NULL && kind->bends(params));
}

bool lac_load_model_is_linear(const lac_model *model)
{
    return is_linear(kind_of(model), model->params);
}

void lac_load_set_note(lac_load_set *set)
{
    for (const lac_load *load = set->load; load < set->load + set->count; load++) {
        set->bends = set->bends || !is_linear(load->kind, load->params);
        set->changes = set->changes || !load->kind->constant;
        set->shaped = set->shaped || load->share == LAC_SHARE_ELASTIC;
        set->varies = set->varies || load->kind->cells != NULL;
    }
}

double lac_load_model_azimuth(const lac_model *model)
{
    const lac_param *row =
        lac_param_find(model->info->params, model->info->param_count, LAC_AZIMUTH);
    double azimuth = NAN;
    if (row != NULL) {
        memcpy(&azimuth, (const char *)model->params + row->offset, sizeof azimuth);
    }
    return azimuth;
}

lac_share lac_load_models_share(const lac_model *model)
{
    for (size_t i = 0; i < model->info->param_count; i++) {
        const lac_param *param = &model->info->params[i];
        if (param->choices == lac_share_names) {
            int share;
            memcpy(&share, (const char *)model->params + param->offset, sizeof share);
            return (lac_share)share;
        }
    }
    return LAC_SHARE_PRESSURE;
}

double lac_load_shear(const lac_load_state *state, double pressure)
{
    double ratio = state->ratio + state->equal_ratio + state->elastic_ratio;
    return ratio * pressure + state->stress + state->elastic + state->spring_stress;
}

lac_load_traits lac_load_models_traits(const lac_load_models *models)
{
    lac_load_traits traits = {.constant = true};
    const lac_model *model;
    for (size_t i = 0; (model = model_at(models, i)) != NULL; i++) {
        traits.constant = traits.constant && kind_of(model)->constant;
        traits.slope = traits.slope || kind_of(model)->slope;
        for (size_t k = 0; k < model->info->param_count; k++) {
            const lac_param *param = &model->info->params[k];
            traits.files =
                traits.files || (param->type == LAC_PATH && lac_param_given(param, model->params));
        }
    }
    return traits;
}

lac_status lac_load_blame_cell(const lac_load_set *set, size_t cell, double taken, double normal,
                               double t, lac_status status, lac_error *err)
{
    const lac_load_places *places = &set->places;
    return lac_fail(err, status,
                    "the pore pressure%s of cell %zu, at x = %g m, y = %g m, is %g Pa at t = %g s; "
                    "must be below the mean normal stress, %g Pa",
                    lac_load_set_presses(set) ? " less the added normal stress" : "", cell,
                    lac_grid_x(places->grid, places->index[cell]),
                    lac_grid_y(places->grid, places->index[cell]), taken, t, normal);
}

// Says which of the loads an error is of.
static lac_status blame(const lac_load_set *set, size_t i, lac_status status, lac_error *err)
{
    static const char *const lists[] = {"shear", "pore_pressure", "normal_stress"};
    const size_t of = i < set->shear ? 0 : i < set->shear + set->pore ? 1 : 2;
    const size_t first[] = {0, set->shear, set->shear + set->pore};
    return lac_fail_within(err, status, "load.%s.%zu.%s", lists[of], i - first[of],
                           set->load[i].kind->info.name);
}

bool lac_load_set_presses(const lac_load_set *set) { return set->count > set->shear + set->pore; }

// The index-th load that reads something; NULL: there are fewer.
static const lac_load *driven(const lac_load_set *set, size_t index)
{
    for (size_t i = 0; i < set->count; i++) {
        if (set->load[i].kind->driver != NULL && index-- == 0) {
            return &set->load[i];
        }
    }
    return NULL;
}

const lac_load_driver *lac_load_set_driver(const lac_load_set *set, size_t index)
{
    const lac_load *load = driven(set, index);
    return load != NULL ? load->kind->driver : NULL;
}

double lac_load_set_driver_at(const lac_load_set *set, size_t index, double t)
{
    const lac_load *load = driven(set, index);
    return load->kind->driver->value(load, t);
}

lac_status lac_load_prepare(const lac_load_kind *kind, const void *params,
                            const lac_load_clock *clock, void **state, lac_error *err)
{
    *state = kind->state_size > 0 ? calloc(1, kind->state_size) : NULL;
    LAC_FAIL_MEMORY_IF(kind->state_size > 0 && *state == NULL, err);
    const lac_status status =
        kind->prepare != NULL ? kind->prepare(params, clock, *state, err) : LAC_OK;
    if (status != LAC_OK) {
        lac_load_release(kind, *state);
        *state = NULL;
    }
    return status;
}

void lac_load_release(const lac_load_kind *kind, void *state)
{
    if (state != NULL) {
        kind->release(state);
        free(state);
    }
}

lac_status lac_load_set_create(const lac_load_models *models, const lac_load_clock *clock,
                               lac_load_set *set, lac_error *err)
{
    const lac_model *model;
    const size_t count = models->shear_count + models->pore_count + models->normal_count;
    *set = (lac_load_set){.shear = models->shear_count,
                          .pore = models->pore_count,
                          .load = calloc(count + 1, sizeof *set->load)};
    LAC_FAIL_MEMORY_IF(set->load == NULL, err);
    for (size_t i = 0; (model = model_at(models, i)) != NULL; i++) {
        const lac_load_kind *kind = kind_of(model);
        lac_load *load = &set->load[set->count++];
        const double azimuth = lac_load_model_azimuth(model);
        *load = (lac_load){.kind = kind,
                           .params = model->params,
                           .share = lac_load_models_share(model),
                           .azimuth = isnan(azimuth) ? 0.0 : azimuth};
        load->to = place_of(set, set->count - 1);
        lac_status status = lac_load_prepare(kind, load->params, clock, &load->state, err);
        if (status != LAC_OK) {
            status = blame(set, i, status, err);
            lac_load_set_clear(set);
            return status;
        }
    }
    lac_load_set_note(set);
    return LAC_OK;
}

lac_status lac_load_set_place(lac_load_set *set, const lac_load_places *places, lac_error *err)
{
    if (!set->varies) {
        return LAC_OK;
    }
    set->places = *places;
    for (size_t i = 0; i < set->count; i++) {
        const lac_load *load = &set->load[i];
        if (load->kind->place != NULL) {
            lac_status status = load->kind->place(load->params, places, load->state, err);
            LAC_TRY_RETURN(blame(set, i, status, err));
        }
    }
    return LAC_OK;
}

void lac_load_set_clear(lac_load_set *set)
{
    for (size_t i = 0; i < set->count; i++) {
        lac_load_release(set->load[i].kind, set->load[i].state);
    }
    free(set->load);
    free(set->shape);
    lac_geometry_free(set->geometry);
    *set = (lac_load_set){0};
}

static const lac_normal_load *const normal[] = {LAC_NORMAL_LOADS(LAC_ROW_ADDRESS)};
static const lac_load_kind *const shear[] = {LAC_SHEAR_LOADS(LAC_ROW_ADDRESS)};
static const lac_load_kind *const pore[] = {LAC_PORE_LOADS(LAC_ROW_ADDRESS)};
static const lac_load_kind *const stress[] = {LAC_NORMAL_STRESSES(LAC_ROW_ADDRESS)};

LAC_KINDS_AT(lac_normal_load, lac_normal_load_get, normal)
LAC_KINDS_AT(lac_load_kind, lac_shear_load_get, shear)
LAC_KINDS_AT(lac_load_kind, lac_pore_load_get, pore)
LAC_KINDS_AT(lac_load_kind, lac_normal_stress_get, stress)
