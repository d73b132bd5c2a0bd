// SPDX-License-Identifier: GPL-3.0-or-later
// A problem followed to given times with derivatives of what is seen: CVODES' forward
// sensitivities. lac_run has the records, events and restarts of a whole simulation; this has none
// of them and starts in microseconds, for the many runs of a fit.
#include "run/sensitivity_state.h"

#include <cvodes/cvodes.h>

#include "base/need.h"

static int rates(sunrealtype t, N_Vector y, N_Vector ydot, void *user)
{
    lac_sensitivity_state *f = user;
    bool good = lac_sensitivity_state_derivative(f, f->def->problem, t, lac_vector_data(y),
                                                 lac_vector_data(ydot));
    return good ? 0 : 1;
}

// CVODES prescribes the parameters.
static int sensitivity_rates(int count, sunrealtype t, N_Vector y, N_Vector ydot, N_Vector *s,
                             N_Vector *sdot, void *user, N_Vector spare, N_Vector other)
{
    lac_sensitivity_state *f = user;
    (void)ydot, (void)spare, (void)other;
    for (int k = 0; k < count; k++) {
        if (!lac_sensitivity_state_sensitivity(f, (size_t)k, t, lac_vector_data(y),
                                               lac_vector_data(s[k]), lac_vector_data(sdot[k]))) {
            return 1;
        }
    }
    return 0;
}

static int weights(N_Vector y, N_Vector w, void *user)
{
    const lac_sensitivity_state *f = user;
    const double *at = lac_vector_data(y);
    double *weight = lac_vector_data(w);
    double rtol = f->rtol;
    lac_problem_weights(f->def->problem, at, rtol, weight);
    for (size_t i = f->mean; i <= f->seen; i++) {
        weight[i] = 1.0 / (rtol * (fabs(at[i]) + f->slip_scale));
    }
    return 0;
}

static SUNLinearSolver_Type embedded(SUNLinearSolver solver)
{
    (void)solver;
    return SUNLINEARSOLVER_MATRIX_EMBEDDED;
}

// (1 - gamma J) x = b: the problem's own solve, and slip behind it, on which nothing depends.
static int solve(SUNLinearSolver solver, SUNMatrix none, N_Vector x, N_Vector b, sunrealtype tol)
{
    lac_sensitivity_state *f = solver->content;
    sunrealtype t, gamma, rl1;
    N_Vector predicted, y, rate, zn1;
    void *user;
    (void)none, (void)tol;
    if (CVodeGetNonlinearSystemData(f->mem, &t, &predicted, &y, &rate, &gamma, &rl1, &zn1, &user) !=
        CV_SUCCESS) {
        return LAC_SUN_BROKEN;
    }
    N_VScale(1.0, b, x);
    const double *at = lac_vector_data(y);
    double *found = lac_vector_data(x);
    const lac_problem *problem = f->def->problem;
    if (!lac_problem_newton(problem, lac_sensitivity_state_clock(f, t), at, gamma, found,
                            f->work)) {
        return SUNLS_LUFACT_FAIL;
    }
    double slip[2] = {found[f->mean], found[f->seen]}; // one of them where no point is seen
    found[f->mean] = found[f->seen] = 0.0;
    double by = lac_sensitivity_state_reach(f, found);
    if (by > 0.0) {
        double *there = f->probe;
        double change[2] = {0.0, 0.0}, speed[2] = {0.0, 0.0};
        for (int side = -1; side <= 1; side += 2) {
            for (size_t i = 0; i < f->m; i++) {
                there[i] = at[i] + side * by * found[i];
            }
            (void)lac_sensitivity_state_rates(f, problem, t, there, speed);
            change[0] += side * speed[0];
            change[1] += side * speed[1];
        }
        slip[0] += gamma * change[0] / (2.0 * by);
        slip[1] += gamma * change[1] / (2.0 * by);
    }
    found[f->seen] = slip[1];
    found[f->mean] = slip[0];
    return 0;
}

static void follower_clear(lac_sensitivity_state *f)
{
    int count = (int)f->def->perturbations;
    CVodeFree(&f->mem);
    SUNLinSolFreeEmpty(f->linear);
    N_VDestroyVectorArray(f->s, count);
    N_VDestroyVectorArray(f->seen_s, count);
    N_VDestroy(f->y);
    N_VDestroy(f->observation);
    SUNContext_Free(&f->sun);
    free(f->work);
    free(f->probe);
}

static lac_status allocate(lac_sensitivity_state *f, lac_error *err)
{
    const lac_sensitivity_def *def = f->def;
    size_t work = lac_problem_work(def->problem);
    f->n = lac_problem_cells(def->problem);
    f->mean = lac_problem_unknowns(def->problem);
    f->seen = f->mean + (def->point != NULL ? 1 : 0);
    f->m = f->seen + 1;
    for (size_t k = 0; k < def->perturbations; k++) {
        size_t low = lac_problem_work(def->perturbation[k].low);
        size_t high = lac_problem_work(def->perturbation[k].high);
        work = low > work ? low : work;
        work = high > work ? high : work;
    }
    f->work = calloc(work, sizeof *f->work);
    f->probe = calloc(4 * f->m, sizeof *f->probe);
    LAC_TRY_RETURN(lac_need_sundials(err));
    LAC_FAIL_MEMORY_IF(f->work == NULL || f->probe == NULL || LAC_SUN_CONTEXT_CREATE(&f->sun) != 0,
                       err);
    f->scale = f->probe + 3 * f->m;
    LAC_SUN_SILENCE_CONTEXT(f->sun);
    f->y = lac_vector_create(&(lac_range){.all = f->m, .n = f->m, .block = f->m}, 1, false, f->sun);
    f->observation = f->y != NULL ? N_VClone(f->y) : NULL;
    if (f->observation != NULL && def->perturbations > 0) {
        f->s = N_VCloneVectorArray((int)def->perturbations, f->y);
        f->seen_s = N_VCloneVectorArray((int)def->perturbations, f->y);
    }
    bool lacking = f->observation == NULL || lac_vector_lacks(f->y) ||
                   (def->perturbations > 0 && (f->s == NULL || f->seen_s == NULL));
    return lacking ? lac_fail_memory(err) : LAC_OK;
}

// States of the nudged problems at the start, and what a component is worth.
static lac_status start(lac_sensitivity_state *f, lac_error *err)
{
    const lac_sensitivity_def *def = f->def;
    double *y = lac_vector_data(f->y);
    lac_problem_initial(def->problem, y);
    y[f->mean] = y[f->seen] = 0.0;
    double rate[2];
    (void)lac_sensitivity_state_rates(f, def->problem, 0.0, y, rate);
    const double mean = rate[0];
    LAC_FAIL_IF(!(fabs(mean) > 0.0) || !isfinite(mean), err, LAC_EINPUT,
                "the mean slip rate at the start is %g m/s", mean);
    lac_problem_weights(def->problem, y, 1.0, f->scale);
    for (size_t i = 0; i < f->mean; i++) {
        f->scale[i] = 1.0 / f->scale[i];
    }
    // The first step is a thousandth of dc/v, or of the state's own time.
    double time_scale = 1e3 * lac_problem_first_step(def->problem, 0.0, y, f->work);
    f->slip_scale = fabs(mean) * time_scale;
    f->scale[f->mean] = f->scale[f->seen] = f->slip_scale;
    for (size_t k = 0; k < def->perturbations; k++) {
        double *s = lac_vector_data(f->s[k]);
        const lac_perturbation *perturbation = &def->perturbation[k];
        lac_problem_initial(perturbation->low, f->probe);
        lac_problem_initial(perturbation->high, s);
        for (size_t i = 0; i < f->mean; i++) {
            s[i] = (s[i] - f->probe[i]) / (2.0 * perturbation->step);
        }
        s[f->mean] = s[f->seen] = 0.0;
    }
    return LAC_OK;
}

// Absolute tolerances of the sensitivities: an e-fold of the parameter may move a component by an
// e-fold of its own.
static int set_sensitivities(lac_sensitivity_state *f)
{
    int count = (int)f->def->perturbations;
    if (count == 0) {
        return CV_SUCCESS;
    }
    for (int k = 0; k < count; k++) {
        double *tolerance = lac_vector_data(f->seen_s[k]);
        for (size_t i = 0; i < f->m; i++) {
            tolerance[i] = f->def->rtol * f->scale[i];
        }
    }
    int flag = CVodeSensInit(f->mem, count, CV_STAGGERED, sensitivity_rates, f->s);
    flag |= CVodeSensSVtolerances(f->mem, f->def->rtol, f->seen_s);
    flag |= CVodeSetSensErrCon(f->mem, SUNTRUE);
    return flag;
}

static lac_status set_up(lac_sensitivity_state *f, lac_error *err)
{
    f->mem = CVodeCreate(CV_BDF, f->sun);
    f->linear = SUNLinSolNewEmpty(f->sun);
    LAC_FAIL_MEMORY_IF(f->mem == NULL || f->linear == NULL, err);
    LAC_SUN_SILENCE_CVODE(f->mem);
    f->linear->ops->gettype = embedded;
    f->linear->ops->solve = solve;
    f->linear->content = f;
    if (CVodeInit(f->mem, rates, 0.0, f->y) != CV_SUCCESS ||
        CVodeSetUserData(f->mem, f) != CV_SUCCESS ||
        CVodeWFtolerances(f->mem, weights) != CV_SUCCESS ||
        CVodeSetLinearSolver(f->mem, f->linear, NULL) != CV_SUCCESS ||
        CVodeSetMaxNumSteps(f->mem, -1) != CV_SUCCESS ||
        CVodeSetMaxHnilWarns(f->mem, -1) != CV_SUCCESS ||
        CVodeSetMaxErrTestFails(f->mem, 20) != CV_SUCCESS ||
        CVodeSetMaxConvFails(f->mem, 40) != CV_SUCCESS || set_sensitivities(f) != CV_SUCCESS) {
        return lac_vector_lacks(f->y)
                   ? lac_fail_memory(err)
                   : lac_fail(err, LAC_ENUMERIC, "the integrator cannot be set up");
    }
    return lac_vector_lacks(f->y) ? lac_fail_memory(err) : LAC_OK;
}

// Puts a state and its derivatives into row i of the output.
static void put(lac_sensitivity_state *f, double t, size_t i, N_Vector state, N_Vector *by)
{
    lac_sensitivity *out = f->out;
    size_t count = f->def->perturbations;
    const double *y = lac_vector_data(state);
    const bool friction = f->def->friction;
    out->slip[i] = friction ? lac_sensitivity_state_friction(f, f->def->problem, t, y) : y[f->seen];
    out->log_rate[i] = lac_sensitivity_state_log_rate(f, f->def->problem, t, y);
    for (size_t k = 0; k < count; k++) {
        const double *s = lac_vector_data(by[k]);
        out->slip_by[i * count + k] =
            friction ? lac_sensitivity_state_by(f, lac_sensitivity_state_friction, k, t, y, s)
                     : s[f->seen];
        out->log_rate_by[i * count + k] =
            lac_sensitivity_state_by(f, lac_sensitivity_state_log_rate, k, t, y, s);
    }
}

// The state at an integrator's time within the last step, in f->observation.
static bool look(lac_sensitivity_state *f, double t)
{
    return CVodeGetDky(f->mem, t, 0, f->observation) == CV_SUCCESS;
}

// And its derivatives, in f->seen_s.
static bool look_at_all(lac_sensitivity_state *f, double t)
{
    return look(f, t) &&
           (f->def->perturbations == 0 || CVodeGetSensDky(f->mem, t, 0, f->seen_s) == CV_SUCCESS);
}

static double past_at(lac_sensitivity_state *f, double t)
{
    return !look(f, t)
               ? NAN
               : lac_sensitivity_state_past(f, f->def->problem, t, lac_vector_data(f->observation));
}

static double slip_at(lac_sensitivity_state *f, double t)
{
    return !look(f, t) ? NAN : fabs(lac_vector_data(f->observation)[f->mean]);
}

// The crossing of the failure rate, or slip, between two times of the last step, by bisection: both
// are continuous there, and no step is long.
static double find_crossing(lac_sensitivity_state *f, bool by_slip, double low, double high)
{
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        if (!(middle > low && middle < high)) {
            break;
        }
        bool past = by_slip ? slip_at(f, middle) >= f->failure.slip : past_at(f, middle) >= 0.0;
        low = past ? low : middle;
        high = past ? middle : high;
    }
    return high;
}

// dt_f/dp = -(dg/dp)/(dg/dt), g of lac_sensitivity_state_past, or the slip.
static lac_status find_failure(lac_sensitivity_state *f, bool by_slip, double t, double step,
                               lac_error *err)
{
    lac_sensitivity *out = f->out;
    out->failed = true;
    out->failure_time = f->origin + t;
    if (f->def->perturbations == 0) {
        return LAC_OK;
    }
    double h = 1e-3 * step;
    double growth = (past_at(f, t) - past_at(f, t - h)) / h;
    LAC_FAIL_IF(!look_at_all(f, t), err, LAC_ENUMERIC, "no state at the failure, t = %.17g s",
                out->failure_time);
    const double *y = lac_vector_data(f->observation);
    double rate[2];
    (void)lac_sensitivity_state_rates(f, f->def->problem, t, y, rate);
    for (size_t k = 0; k < f->def->perturbations; k++) {
        const double *s = lac_vector_data(f->seen_s[k]);
        out->failure_by[k] =
            by_slip ? -s[f->mean] / rate[0]
                    : -lac_sensitivity_state_by(f, lac_sensitivity_state_past, k, t, y, s) / growth;
    }
    return LAC_OK;
}

// Everything that lies within the step just made to t.
static lac_status look_back(lac_sensitivity_state *f, double t, bool *done, lac_error *err)
{
    const lac_sensitivity_def *def = f->def;
    sunrealtype step = 0.0;
    (void)CVodeGetLastStep(f->mem, &step);
    double now = past_at(f, t);
    LAC_FAIL_IF(isnan(now), err, LAC_ENUMERIC, "no slip rate at t = %.17g s", f->origin + t);
    bool by_slip = slip_at(f, t) >= f->failure.slip;
    bool by_rate = now >= 0.0;
    if (by_slip || by_rate) {
        double gone = by_slip ? find_crossing(f, true, t - step, t) : INFINITY;
        double fast = by_rate ? find_crossing(f, false, t - step, t) : INFINITY;
        t = fmin(gone, fast);
        LAC_TRY_RETURN(find_failure(f, gone < fast, t, step, err));
        *done = true;
    }
    while (f->out->reached < def->n && def->time[f->out->reached] - f->origin <= t) {
        double at = fmax(def->time[f->out->reached] - f->origin, t - step);
        LAC_FAIL_IF(!look_at_all(f, at), err, LAC_ENUMERIC, "no state at t = %.17g s",
                    f->origin + at);
        put(f, at, f->out->reached++, f->observation, f->seen_s);
    }
    return LAC_OK;
}

// Begins anew where the loads jump or bend.
static lac_status cross_break(lac_sensitivity_state *f, double at, lac_error *err)
{
    const lac_problem *problem = f->def->problem;
    bool sensitive = f->def->perturbations > 0;
    sunrealtype t;
    LAC_FAIL_IF(sensitive && CVodeGetSens(f->mem, &t, f->s) != CV_SUCCESS, err, LAC_ENUMERIC,
                "no sensitivities at t = %g s", at);
    f->origin = at;
    f->limit = nextafter(lac_problem_next_break(problem, at), -INFINITY);
    f->rtol = lac_engine_rtol(f->def->rtol, ++f->beginnings); // derivatives need no more digits
    lac_problem_loads_at now;
    double *y = lac_vector_data(f->y);
    LAC_FAIL_IF(!lac_problem_drive(problem, at, y, f->work, &now) ||
                    !lac_sensitivity_state_jump(f, at),
                err, LAC_ENUMERIC, "no slip rate balances the load at t = %g s", at);
    lac_problem_forget(problem, f->work);
    double h = lac_problem_first_step(problem, at, y, f->work);
    double mean, max;
    lac_problem_speed(problem, at, y, false, &mean, &max, f->work);
    if (lac_check_rates(problem, max, at, f->work, err) != LAC_OK) {
        return LAC_ENUMERIC;
    }
    LAC_FAIL_IF(CVodeReInit(f->mem, 0.0, f->y) != CV_SUCCESS ||
                    (sensitive && CVodeSensReInit(f->mem, CV_STAGGERED, f->s) != CV_SUCCESS) ||
                    CVodeSetInitStep(f->mem, h) != CV_SUCCESS ||
                    CVodeSetMaxStep(f->mem, lac_problem_longest_step(problem, at)) != CV_SUCCESS,
                err, LAC_ENUMERIC, "the integrator cannot restart at t = %g s", at);
    return LAC_OK;
}

// Whether a jump of the loads was the failure itself, whose time no parameter of a state moves.
static bool fell(lac_sensitivity_state *f, double at)
{
    if (!(lac_sensitivity_state_past(f, f->def->problem, 0.0, lac_vector_data(f->y)) >= 0.0)) {
        return false;
    }
    f->out->failed = true;
    f->out->failure_time = at;
    for (size_t k = 0; k < f->def->perturbations; k++) {
        f->out->failure_by[k] = 0.0;
    }
    return true;
}

static lac_status integrate(lac_sensitivity_state *f, lac_error *err)
{
    const lac_sensitivity_def *def = f->def;
    double *y = lac_vector_data(f->y);
    bool done = false;
    double next = lac_problem_next_break(def->problem, 0.0);
    f->limit = nextafter(next, -INFINITY);
    double h = lac_problem_first_step(def->problem, 0.0, y, f->work);
    (void)CVodeSetInitStep(f->mem, fmin(h, 0.5 * fmin(def->end, next)));
    for (; f->out->reached < def->n && def->time[f->out->reached] <= 0.0; f->out->reached++) {
        put(f, 0.0, f->out->reached, f->y, f->s); // before any step
    }
    while (!done) {
        double stop = fmin(def->end, next) - f->origin;
        sunrealtype t = 0.0;
        LAC_FAIL_IF(f->out->steps++ >= def->max_steps, err, LAC_ENUMERIC,
                    "%lld steps were not enough", (long long)def->max_steps);
        int flag = CVodeSetStopTime(f->mem, stop);
        flag = flag < 0 ? flag : CVode(f->mem, stop, f->y, &t, CV_ONE_STEP);
        LAC_FAIL_IF(flag < 0, err, LAC_ENUMERIC, "the integrator gave up (flag %d) at t = %.17g s",
                    flag, f->origin + t);
        LAC_TRY_RETURN(look_back(f, t, &done, err));
        if (!done && flag == CV_TSTOP_RETURN) {
            done = next >= def->end;
            if (!done) {
                LAC_TRY_RETURN(cross_break(f, next, err));
                done = fell(f, next);
                next = lac_problem_next_break(def->problem, next);
            }
        }
    }
    return LAC_OK;
}

lac_status lac_sensitivity_run(const lac_sensitivity_def *def, lac_sensitivity *out, lac_error *err)
{
    lac_sensitivity_state f = {.def = def, .out = out, .limit = INFINITY, .rtol = def->rtol};
    lac_status status = LAC_OK;
    out->reached = 0;
    out->failed = false;
    out->failure_time = NAN;
    out->steps = 0;
    LAC_TRY(allocate(&f, err));
    LAC_TRY(start(&f, err));
    f.failure = lac_problem_failure(def->problem, def->failure_rate, def->failure_slip);
    if (lac_sensitivity_state_past(&f, def->problem, 0.0, lac_vector_data(f.y)) >= 0.0) {
        out->failed = true;
        out->failure_time = 0.0;
        goto out;
    }
    LAC_TRY(set_up(&f, err));
    LAC_TRY(integrate(&f, err));
out:
    follower_clear(&f);
    return status;
}
