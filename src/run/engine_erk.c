// SPDX-License-Identifier: GPL-3.0-or-later
// ERKStep as an engine: explicit steps for a whole run, or for short stretches of another engine.
#include <arkode/arkode_erkstep.h>

#include "base/clones.h"
#include "run/engine.h"

// Cash-Karp 5(4) on the two unknowns of each cell and, where it is none of them, slip.
// ERKStep 6.4 takes a right-hand side that fails as fatal; the step is then tried again from the
// last good state with a shorter one.
typedef struct erk {
    void *mem;
    N_Vector y, scratch;
    size_t size;   // of y, with slip where it is no unknown
    double *saved; // [size]
    double *aside; // lac_problem_work, for what is only looked at
    bool looking;  // is the step's inside looked at?
    double last;   // integrator's time of the rates that the run's own scratch holds
    double first;  // step that a restart begins with [s]
    void *control; // of the step; freed by LAC_SUN_ERK_CONTROL_FREE
} erk;

static int rates(sunrealtype t, N_Vector y, N_Vector ydot, void *user)
{
    lac_engine *engine = user;
    if (lac_vector_lacks(y)) {
        return -1;
    }
    double *at = lac_vector_data(y);
    double *dot = lac_vector_data(ydot);
    size_t n = engine->n;
    // Inside the step in scratch of its own, so that looking leaves nothing behind. At its end
    // SUNDIALS 7 takes the rates where they are first asked for, here or by the next step, which
    // begins with them: in the run's own scratch either way.
    erk *c = engine->inner;
    double *work = c->looking && t < engine->t ? c->aside : engine->work;
    c->last = work == engine->work ? t : c->last;
    bool good = lac_problem_derivative(engine->problem, lac_engine_clock(engine, t), at, dot, work);
    if (!lac_problem_has_slip(engine->problem)) {
        memcpy(dot + engine->unknowns, work, n * sizeof *dot);
    }
    return good ? 0 : 1;
}

// Of slip beside y. @param weight  the tolerance; overwritten
LAC_CLONES static void lac_erk_weigh_slip(size_t n, double relative, const double *slip,
                                          double *weight)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double error = relative * fabs(slip[i]) + weight[i];
        double least = 8.0 * DBL_EPSILON * fabs(slip[i]); // no finer than a double
        weight[i] = 1.0 / (least > error ? least : error);
    }
}

static int weights(N_Vector y, N_Vector w, void *user)
{
    const lac_engine *engine = user;
    if (lac_vector_lacks(w)) {
        return -1;
    }
    double *weight = lac_vector_data(w);
    size_t n = engine->n;
    lac_problem_weights(engine->problem, lac_vector_data(y), engine->rtol, weight);
    if (lac_problem_has_slip(engine->problem)) {
        return 0;
    }
    const double *at = lac_vector_data(y) + engine->unknowns;
    double *slip = weight + engine->unknowns;
    const double relative = lac_problem_slip_tolerance(engine->problem, engine->rtol, slip);
    lac_erk_weigh_slip(n, relative, at, slip);
    return 0;
}

static void erk_free(lac_engine *engine)
{
    erk *c = engine->inner;
    if (c == NULL) {
        return;
    }
    LAC_SUN_ERK(Free)(&c->mem);
    LAC_SUN_ERK_CONTROL_FREE(c->control);
    N_VDestroy(c->y);
    N_VDestroy(c->scratch);
    free(c->saved);
    free(c->aside);
    free(c);
    engine->inner = NULL;
}

static lac_status make_vectors(lac_engine *engine, erk *c, lac_error *err)
{
    bool slip_in_y = lac_problem_has_slip(engine->problem);
    c->size = slip_in_y ? engine->unknowns : engine->unknowns + engine->n;
    c->y =
        lac_vector_create(engine->range, lac_problem_arrays(engine->problem) + (slip_in_y ? 0 : 1),
                          false, engine->sun);
    c->scratch = c->y == NULL ? NULL : N_VClone(c->y);
    c->saved = malloc((c->size + 1) * sizeof *c->saved);
    c->aside = calloc(lac_problem_work(engine->problem), sizeof *c->aside);
    bool lacking = c->scratch == NULL || lac_vector_lacks(c->y);
    LAC_FAIL_MEMORY_IF(lacking || c->saved == NULL || c->aside == NULL, err);
    N_VConst(0.0, c->y);
    engine->y = lac_vector_data(c->y);
    size_t place = slip_in_y ? lac_problem_slip_place(engine->problem) : engine->unknowns;
    engine->slip = engine->y + place;
    return LAC_OK;
}

// Order that the case asks this method for; 0: none. Where it only helps another, it has its own.
static int chosen_order(const lac_engine *engine)
{
    return engine->def->method == LAC_ERK ? (int)engine->def->max_order : 0;
}

static int set_options(lac_engine *engine, erk *c)
{
    int flag = LAC_SUN_ERK(SetUserData)(c->mem, engine);
    flag |= LAC_SUN_ERK(WFtolerances)(c->mem, weights);
    int order = chosen_order(engine);
    flag |= order == 8  ? lac_erk_set_order_8(c->mem)
            : order > 0 ? LAC_SUN_ERK(SetOrder)(c->mem, order)
                        : ERKStepSetTableNum(c->mem, ARKODE_CASH_KARP_6_4_5);
    flag |= LAC_SUN_ERK(SetMaxNumSteps)(c->mem, -1);
    flag |= LAC_SUN_ERK(SetMaxErrTestFails)(c->mem, 30);
    flag |= LAC_SUN_ERK(SetMaxHnilWarns)(c->mem, -1);
    flag |= LAC_SUN_ERK(SetInterpolantDegree)(c->mem, 5);
    flag |= LAC_SUN_ERK_CONTROL(c->mem, engine->sun, &c->control);
    return flag;
}

static lac_status erk_create(lac_engine *engine, lac_error *err)
{
    erk *c = calloc(1, sizeof *c);
    LAC_FAIL_MEMORY_IF(c == NULL, err);
    engine->inner = c;
    LAC_TRY_RETURN(make_vectors(engine, c, err));
    lac_problem_initial(engine->problem, engine->y);
    c->mem = ERKStepCreate(rates, 0.0, c->y, engine->sun);
    LAC_FAIL_MEMORY_IF(c->mem == NULL || lac_vector_lacks(c->y), err);
    LAC_SUN_SILENCE_ERK(c->mem);
    LAC_FAIL_IF(set_options(engine, c) != ARK_SUCCESS, err, LAC_ENUMERIC,
                "the integrator cannot be set up");
    return LAC_OK;
}

static void erk_count(lac_engine *engine)
{
    erk *c = engine->inner;
    long now[3] = {0};
    (void)LAC_SUN_ERK(GetNumSteps)(c->mem, &now[0]);
    (void)LAC_SUN_ERK_EVALUATIONS(c->mem, &now[1]);
    (void)LAC_SUN_ERK(GetNumErrTestFails)(c->mem, &now[2]);
    engine->counts.steps = engine->before.steps + now[0];
    engine->counts.rhs_evaluations = engine->before.rhs_evaluations + now[1];
    engine->counts.error_test_fails = engine->before.error_test_fails + now[2];
    engine->order = chosen_order(engine) > 0 ? chosen_order(engine) : 5;
}

static lac_status erk_restart(lac_engine *engine, double h, lac_error *err)
{
    erk *c = engine->inner;
    lac_problem_forget(engine->problem, c->aside);
    c->first = h;
    bool good = ERKStepReInit(c->mem, rates, 0.0, c->y) == ARK_SUCCESS &&
                LAC_SUN_ERK(SetInitStep)(c->mem, h) == ARK_SUCCESS &&
                LAC_SUN_ERK(SetMaxStep)(c->mem, lac_engine_longest_step(engine)) == ARK_SUCCESS;
    return good ? LAC_OK : lac_engine_cannot_restart(engine, err);
}

static lac_status gave_up(lac_engine *engine, int flag, lac_error *err)
{
    erk *c = engine->inner;
    sunrealtype h = 0.0;
    LAC_FAIL_MEMORY_IF(lac_vector_lacks(c->y), err);
    (void)LAC_SUN_ERK(GetCurrentStep)(c->mem, &h);
    return lac_engine_gave_up(engine, LAC_SUN_ERK(GetReturnFlagName)(flag), h, engine->order, err);
}

static bool rates_failed(int flag)
{
    return flag == ARK_RHSFUNC_FAIL || flag == ARK_UNREC_RHSFUNC_ERR ||
           flag == ARK_REPTD_RHSFUNC_ERR;
}

static lac_status erk_advance(lac_engine *engine, double stop, lac_error *err)
{
    erk *c = engine->inner;
    double *data = lac_vector_data(c->y);
    size_t bytes = c->size * sizeof *data;
    memcpy(c->saved, data, bytes);
    double h = c->first > 0.0 ? c->first : engine->step;

    for (int tries = 0;; tries++) {
        sunrealtype t = engine->t;
        (void)LAC_SUN_ERK(SetStopTime)(c->mem, stop);
        int flag = LAC_SUN_ERK(Evolve)(c->mem, stop, c->y, &t, ARK_ONE_STEP);
        if (flag >= 0) {
            engine->t = flag == ARK_TSTOP_RETURN ? stop : t;
            break;
        }
        memcpy(data, c->saved, bytes);
        h *= 0.1;
        if (lac_vector_lacks(c->y) || !rates_failed(flag) || tries == 40 ||
            engine->t + h == engine->t) {
            return gave_up(engine, flag, err);
        }
        stop -= engine->t;
        engine->base += engine->t;
        engine->t = 0.0;
        erk_count(engine);
        engine->before = engine->counts;
        LAC_TRY_RETURN(erk_restart(engine, h, err));
        engine->counts.restarts++;
    }
    c->first = 0.0;
    sunrealtype last;
    (void)LAC_SUN_ERK(GetLastStep)(c->mem, &last);
    engine->step = last;
    // Of other pairs the last rates at this time may be those of a stage.
    engine->found =
        LAC_SUN_ERK_ENDS_WITH_RATES && chosen_order(engine) == 0 && c->last == engine->t;
    return LAC_OK;
}

static bool erk_at(lac_engine *engine, double t, double *observation)
{
    size_t n = engine->n;
    erk *c = engine->inner;
    c->looking = true; // the interpolant evaluates rates
    int flag = LAC_SUN_ERK(GetDky)(c->mem, t, 0, c->scratch);
    c->looking = false;
    if (flag != ARK_SUCCESS) {
        return false;
    }
    const double *data = lac_vector_data(c->scratch);
    memcpy(observation, data, engine->unknowns * sizeof *observation);
    memcpy(observation + engine->unknowns, data + (engine->slip - engine->y),
           n * sizeof *observation);
    return true;
}

const lac_engine_kind lac_engine_erk = {.create = erk_create,
                                        .free = erk_free,
                                        .restart = erk_restart,
                                        .advance = erk_advance,
                                        .at = erk_at,
                                        .count = erk_count};
