// SPDX-License-Identifier: GPL-3.0-or-later
// CVODE as the engine of BDF and Adams; slip is a quadrature where it is no unknown.
#include <cvodes/cvodes.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "run/engine.h"

typedef struct cvode {
    void *mem;
    N_Vector y, slip;
    N_Vector seen_y, seen_slip; // over what is asked for
    SUNNonlinearSolver solver;  // Newton's iteration, or with Adams the fixed point's
    int64_t evaluations;        // of dy/dt by Newton's since the last restart
    double held_to;             // rtol of the slip's tolerance
    bool coarse;                // slip is held to what a double resolves of it
} cvode;

static bool is_adams(const lac_engine *engine) { return engine->def->method == LAC_ADAMS; }

static int rates(sunrealtype t, N_Vector y, N_Vector ydot, void *user)
{
    lac_engine *engine = user;
    engine->found = false;
    bool good = lac_problem_derivative(engine->problem, lac_engine_clock(engine, t),
                                       lac_vector_data(y), lac_vector_data(ydot), engine->work);
    return good ? 0 : 1;
}

static int slip_rates(sunrealtype t, N_Vector y, N_Vector v, void *user)
{
    lac_engine *engine = user;
    lac_vector_forget(v);
    double *to = lac_vector_data(v);
    if (engine->found && lac_problem_rates_stay(engine->problem)) {
        memcpy(to, engine->work, engine->n * sizeof *to);
        return 0;
    }
    lac_problem_rates(engine->problem, lac_engine_clock(engine, t), lac_vector_look(y), to,
                      engine->work);
    engine->found = true;
    return 0;
}

// An error of rtol in each unknown is worth as much of v and theta.
static int weights(N_Vector y, N_Vector w, void *user)
{
    const lac_engine *engine = user;
    const double *at = lac_vector_look(y);
    const double even = lac_problem_even_weight(engine->problem, at, engine->rtol);
    if (even > 0.0) {
        lac_vector_forget(w);
        N_VConst(even, w); // which norms need not read
    } else {
        lac_problem_weights(engine->problem, at, engine->rtol, lac_vector_alone(w));
    }
    return 0;
}

static void cvode_free(lac_engine *engine)
{
    cvode *c = engine->inner;
    if (c == NULL) {
        return;
    }
    CVodeFree(&c->mem);
    (void)SUNNonlinSolFree(c->solver);
    N_VDestroy(c->y);
    N_VDestroy(c->slip);
    N_VDestroy(c->seen_y);
    N_VDestroy(c->seen_slip);
    free(c);
    engine->inner = NULL;
}

static lac_status attach_solver(lac_engine *engine, cvode *c, lac_error *err)
{
    // Three vectors of Anderson acceleration: plain fixed-point iteration is poor here.
    c->solver = is_adams(engine) ? SUNNonlinSol_FixedPoint(c->y, 3, engine->sun)
                                 : lac_newton_create(engine, c->mem);
    bool good = c->solver != NULL && CVodeSetNonlinearSolver(c->mem, c->solver) == CV_SUCCESS;
    return good ? LAC_OK : lac_fail_memory(err);
}

// Slip beside y, whose errors count; to one tolerance, the least, where the slip itself counts
// besides, so that no cell keeps its own.
// @param resolved  what counts besides where the slip itself does not, relative to the slip
static int set_slip_tolerance(const lac_engine *engine, cvode *c, double resolved)
{
    int flag = CV_MEM_FAIL;
    N_Vector tolerance = N_VClone(c->slip);
    if (!lac_vector_lacks(c->slip)) {
        double *absolute = lac_vector_data(tolerance);
        const double relative = lac_problem_slip_tolerance(engine->problem, engine->rtol, absolute);
        const double least = lac_problem_least_tolerance(engine->problem, absolute);
        flag = relative > 0.0 ? CVodeQuadSStolerances(c->mem, relative, least)
                              : CVodeQuadSVtolerances(c->mem, resolved, tolerance);
    }
    N_VDestroy(tolerance);
    c->held_to = engine->rtol;
    return flag;
}

static int set_slip(const lac_engine *engine, cvode *c)
{
    int flag = CVodeQuadInit(c->mem, slip_rates, c->slip);
    flag |= CVodeSetQuadErrCon(c->mem, SUNTRUE);
    return flag == CV_SUCCESS ? set_slip_tolerance(engine, c, 0.0) : flag;
}

static int set_options(lac_engine *engine, cvode *c)
{
    int flag = CVodeSetUserData(c->mem, engine);
    flag |= CVodeWFtolerances(c->mem, weights);
    flag |= c->slip != NULL ? set_slip(engine, c) : CV_SUCCESS;
    flag |= CVodeSetMaxNumSteps(c->mem, -1);
    flag |= CVodeSetMaxHnilWarns(c->mem, -1);
    flag |= CVodeSetMaxErrTestFails(c->mem, 20);
    flag |= CVodeSetMaxConvFails(c->mem, 40);
    if (engine->def->max_order > 0) {
        flag |= CVodeSetMaxOrd(c->mem, (int)engine->def->max_order);
    }
    return flag;
}

static lac_status make_vectors(lac_engine *engine, cvode *c, lac_error *err)
{
    c->y = lac_vector_create(engine->range, lac_problem_arrays(engine->problem), true, engine->sun);
    c->seen_y = c->y == NULL ? NULL : lac_vector_clone_empty(c->y);
    LAC_FAIL_MEMORY_IF(c->seen_y == NULL || lac_vector_lacks(c->y), err);
    engine->y = lac_vector_data(c->y);
    if (lac_problem_has_slip(engine->problem)) {
        engine->slip = engine->y + lac_problem_slip_place(engine->problem);
        return LAC_OK;
    }
    c->slip = lac_vector_create(engine->range, 1, true, engine->sun);
    c->seen_slip = c->slip == NULL ? NULL : lac_vector_clone_empty(c->slip);
    LAC_FAIL_MEMORY_IF(c->seen_slip == NULL || lac_vector_lacks(c->slip), err);
    N_VConst(0.0, c->slip);
    engine->slip = lac_vector_data(c->slip);
    return LAC_OK;
}

// The engine's y and slip are current. @param written  they may have been written, or will be; else
// who writes them comes here before the integrator does more
static void settle(cvode *c, bool written)
{
    N_Vector const of[] = {c->y, c->slip};
    for (size_t k = 0; k < 2 && of[k] != NULL; k++) {
        (void)(written ? lac_vector_alone(of[k]) : lac_vector_look(of[k]));
    }
}

static bool lacks_memory(const cvode *c)
{
    return lac_vector_lacks(c->y) || (c->slip != NULL && lac_vector_lacks(c->slip));
}

static lac_status set_up(lac_engine *engine, cvode *c, lac_error *err)
{
    c->mem = CVodeCreate(is_adams(engine) ? CV_ADAMS : CV_BDF, engine->sun);
    LAC_FAIL_MEMORY_IF(c->mem == NULL, err);
    LAC_SUN_SILENCE_CVODE(c->mem);
    bool good =
        CVodeInit(c->mem, rates, 0.0, c->y) == CV_SUCCESS && set_options(engine, c) == CV_SUCCESS;
    lac_status status = good ? attach_solver(engine, c, err) : LAC_OK;
    LAC_FAIL_MEMORY_IF(lacks_memory(c), err);
    return good ? status : lac_fail(err, LAC_ENUMERIC, "the integrator cannot be set up");
}

static lac_status cvode_create(lac_engine *engine, lac_error *err)
{
    cvode *c = calloc(1, sizeof *c);
    LAC_FAIL_MEMORY_IF(c == NULL, err);
    engine->inner = c;
    LAC_TRY_RETURN(make_vectors(engine, c, err));
    lac_problem_initial(engine->problem, engine->y);
    LAC_TRY_RETURN(set_up(engine, c, err));
    settle(c, true);
    return LAC_OK;
}

static void cvode_count(lac_engine *engine)
{
    cvode *c = engine->inner;
    long now[5] = {0};
    (void)CVodeGetNumSteps(c->mem, &now[0]);
    (void)CVodeGetNumRhsEvals(c->mem, &now[1]);
    (void)CVodeGetNumNonlinSolvIters(c->mem, &now[2]);
    (void)CVodeGetNumErrTestFails(c->mem, &now[3]);
    (void)CVodeGetNumNonlinSolvConvFails(c->mem, &now[4]);
    c->evaluations += is_adams(engine) ? 0 : lac_newton_evaluations(c->solver);
    engine->counts.steps = engine->before.steps + now[0];
    engine->counts.rhs_evaluations = engine->before.rhs_evaluations + now[1] + c->evaluations;
    engine->counts.newton_iterations = engine->before.newton_iterations + now[2];
    engine->counts.error_test_fails = engine->before.error_test_fails + now[3];
    engine->counts.nonlinear_fails = engine->before.nonlinear_fails + now[4];
}

static lac_status cvode_restart(lac_engine *engine, double h, lac_error *err)
{
    cvode *c = engine->inner;
    settle(c, true);
    c->evaluations = 0;
    bool held = c->slip == NULL || (engine->rtol == c->held_to && !c->coarse) ||
                set_slip_tolerance(engine, c, 0.0) == CV_SUCCESS;
    c->coarse = false; // a run that goes on from here begins like this too
    bool good = held && CVodeReInit(c->mem, 0.0, c->y) == CV_SUCCESS &&
                (c->slip == NULL || CVodeQuadReInit(c->mem, c->slip) == CV_SUCCESS) &&
                CVodeSetInitStep(c->mem, h) == CV_SUCCESS &&
                CVodeSetMaxStep(c->mem, lac_engine_longest_step(engine)) == CV_SUCCESS;
    settle(c, true);
    return good ? LAC_OK : lac_engine_cannot_restart(engine, err);
}

// Which unknown the integrator fights with: the largest weighted local error. False where that is
// not known.
static bool find_worst(const lac_engine *engine, size_t *worst)
{
    const cvode *c = engine->inner;
    N_Vector errors = N_VClone(c->y);
    bool known = !lac_vector_lacks(c->y) && CVodeGetEstLocalErrors(c->mem, errors) == CV_SUCCESS;
    const double *e = lac_vector_data(errors);
    *worst = 0;
    for (size_t i = 1; known && i < engine->unknowns; i++) {
        *worst = fabs(e[i]) > fabs(e[*worst]) ? i : *worst;
    }
    N_VDestroy(errors);
    return known;
}

static lac_status gave_up(lac_engine *engine, int flag, lac_error *err)
{
    cvode *c = engine->inner;
    size_t worst = 0;
    sunrealtype h = 0.0;
    int order = 0;
    (void)CVodeGetCurrentStep(c->mem, &h);
    (void)CVodeGetCurrentOrder(c->mem, &order);
    // of all cells, not of those here
    bool known = engine->range->team == NULL && order > 0 && find_worst(engine, &worst);
    lac_status status = lac_engine_gave_up(engine, CVodeGetReturnFlagName(flag), h, order, err);
    if (known && err != NULL) {
        const char *names[] = {lac_problem_unknown(engine->problem), "ln theta", "slip"};
        size_t which = worst / engine->n;
        size_t weak = lac_problem_slip_place(engine->problem) > 0 ? 3 : 2;
        lac_append(err->message, sizeof err->message, "; worst unknown: %s of cell %zu",
                   which < weak ? names[which] : "of the weakening", worst % engine->n);
    }
    return status;
}

static lac_status cvode_advance(lac_engine *engine, double stop, lac_error *err)
{
    cvode *c = engine->inner;
    sunrealtype t = engine->t;
    if (CVodeSetStopTime(c->mem, stop) != CV_SUCCESS) {
        return gave_up(engine, CV_ILL_INPUT, err);
    }
    sunrealtype at;
    engine->found = false;
    int flag = CVode(c->mem, stop, c->y, &t, CV_ONE_STEP);
    if (flag == CV_TOO_MUCH_ACC && c->slip != NULL && !c->coarse) {
        // A slip so far beyond dc that rtol dc is lost in its last digit.
        c->coarse = set_slip_tolerance(engine, c, 8.0 * DBL_EPSILON) == CV_SUCCESS;
        flag = CVode(c->mem, stop, c->y, &t, CV_ONE_STEP);
    }
    bool slid = flag >= 0 && (c->slip == NULL || CVodeGetQuad(c->mem, &at, c->slip) == CV_SUCCESS);
    settle(c, false);
    engine->found = engine->found && flag == CV_SUCCESS && lac_problem_rates_stay(engine->problem);
    if (flag < 0) {
        return gave_up(engine, flag, err);
    }
    sunrealtype h;
    int order;
    (void)CVodeGetLastStep(c->mem, &h);
    (void)CVodeGetLastOrder(c->mem, &order);
    engine->t = flag == CV_TSTOP_RETURN ? stop : t;
    engine->step = h;
    engine->order = order;
    return slid ? LAC_OK
                : lac_fail(err, LAC_ENUMERIC, "no slip at t = %.17g s", lac_engine_time(engine));
}

// Straight into the place that is asked for: vectors of their own would only be copied from.
static bool cvode_at(lac_engine *engine, double t, double *observation)
{
    cvode *c = engine->inner;
    double *slip = observation + engine->unknowns;
    settle(c, true);
    lac_vector_lend(c->seen_y, observation);
    if (CVodeGetDky(c->mem, t, 0, c->seen_y) != CV_SUCCESS) {
        return false;
    }
    (void)lac_vector_data(c->seen_y);
    if (c->slip == NULL) {
        size_t place = lac_problem_slip_place(engine->problem);
        memmove(slip, observation + place, engine->n * sizeof *slip);
        return true;
    }
    lac_vector_lend(c->seen_slip, slip);
    bool known = CVodeGetQuadDky(c->mem, t, 0, c->seen_slip) == CV_SUCCESS;
    (void)lac_vector_data(c->seen_slip);
    return known;
}

const lac_engine_kind lac_engine_cvode = {.create = cvode_create,
                                          .free = cvode_free,
                                          .restart = cvode_restart,
                                          .advance = cvode_advance,
                                          .at = cvode_at,
                                          .count = cvode_count};
