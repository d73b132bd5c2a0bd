// SPDX-License-Identifier: GPL-3.0-or-later
// (1 - gamma J) d = -r, r = rl1 z_1 + c - gamma f(z_0 + c), for the correction c of a step; z is
// CVODE's history, gamma and rl1 are its coefficients (Hindmarsh et al. 2005, ACM TOMS 31, 363).
#include "run/engine.h"

#include <cvodes/cvodes.h>

// As much of what the iteration may leave as CVODE lets a linear solver leave: a residual below it
// needs no solve.
static const double small_residual = 0.05;

typedef struct newton {
    lac_engine *engine;
    void *cvode;
    SUNNonlinSolSysFn residual; // CVODE's
    SUNNonlinSolConvTestFn test;
    void *test_data;
    int most;            // iterations
    int current;         // iterations before this one
    long iterations;     // of the last solve
    bool failed;         // it found nothing
    int64_t evaluations; // of dy/dt
} newton;

// What CVODE hands out of a step.
typedef struct step {
    sunrealtype t, gamma, rl1;
    N_Vector z0, y, f, z1;
} step;

static SUNNonlinearSolver_Type find_root(SUNNonlinearSolver solver)
{
    (void)solver;
    return SUNNONLINEARSOLVER_ROOTFIND;
}

static lac_sun_status take_residual(SUNNonlinearSolver solver, SUNNonlinSolSysFn residual)
{
    newton *self = solver->content;
    self->residual = residual;
    return 0;
}

static lac_sun_status take_test(SUNNonlinearSolver solver, SUNNonlinSolConvTestFn test, void *data)
{
    newton *self = solver->content;
    self->test = test;
    self->test_data = data;
    return 0;
}

static lac_sun_status take_most(SUNNonlinearSolver solver, int most)
{
    newton *self = solver->content;
    self->most = most;
    return 0;
}

static lac_sun_status give_iterations(SUNNonlinearSolver solver, long *iterations)
{
    const newton *self = solver->content;
    *iterations = self->iterations;
    return 0;
}

static lac_sun_status give_current(SUNNonlinearSolver solver, int *current)
{
    const newton *self = solver->content;
    *current = self->current;
    return 0;
}

// A solve that fails is not tried again here: CVODE takes a shorter step.
static lac_sun_status give_failures(SUNNonlinearSolver solver, long *failures)
{
    const newton *self = solver->content;
    *failures = self->failed ? 1 : 0;
    return 0;
}

static lac_sun_status release(SUNNonlinearSolver solver)
{
    free(solver->content);
    SUNNonlinSolFreeEmpty(solver);
    return 0;
}

// -r in place of f. Where there is no dy/dt, CVODE's residual says so in its own way.
static int take_rates(newton *self, const step *s, N_Vector correction, N_Vector y, N_Vector f)
{
    lac_engine *engine = self->engine;
    const bool first = f == correction;
    if (first) {
        lac_vector_forget(correction);
        lac_vector_forget(s->f);
        (void)lac_vector_data(y); // with all else that waits, in one pass
    } else {
        N_VLinearSum(1.0, s->z0, 1.0, correction, y);
    }
    engine->found = false;
    if (!lac_problem_derivative(engine->problem, lac_engine_clock(engine, s->t), lac_vector_look(y),
                                lac_vector_alone(f), engine->work)) {
        if (first) {
            N_VConst(0.0, correction);
        }
        int why = self->residual(correction, s->f, self->cvode);
        return why == 0 ? SUN_NLS_CONV_RECVR : why;
    }
    self->evaluations++;
    sunrealtype c[] = {-s->rl1, first ? s->gamma : -1.0, s->gamma};
    N_Vector x[] = {s->z1, correction, s->f};
    return N_VLinearCombination(first ? 2 : 3, c, x, f) == 0 ? 0 : LAC_SUN_BROKEN;
}

// d in place of -r.
static bool solve_linear(newton *self, const step *s, N_Vector y, N_Vector f)
{
    lac_engine *engine = self->engine;
    engine->counts.linear_solves++;
    return lac_problem_newton_next(engine->problem, lac_engine_clock(engine, s->t),
                                   lac_vector_look(y), s->gamma, lac_vector_alone(f), engine->work);
}

// At first c is 0: y is z_0, and what becomes d stands in the place of c itself.
static int iterate(SUNNonlinearSolver solver, const step *s, N_Vector correction, N_Vector weight,
                   double tolerance)
{
    newton *self = solver->content;
    for (self->current = 0; self->current < self->most; self->current++) {
        const bool first = self->current == 0;
        N_Vector y = first ? s->z0 : s->y, f = first ? correction : s->f;
        int status = take_rates(self, s, correction, y, f);
        if (status != 0) {
            return status;
        }
        self->iterations++;
        bool small = N_VWrmsNorm(f, weight) <= small_residual * tolerance;
        if (!small && !solve_linear(self, s, y, f)) {
            N_VConst(0.0, f);
            return SUN_NLS_CONV_RECVR;
        }
        if (small && !first) {
            self->engine->found = true; // as the correction stays
            N_VConst(0.0, f);
        } else if (!first) {
            N_VLinearSum(1.0, correction, 1.0, f, correction);
        }
        status = self->test(solver, correction, f, tolerance, weight, self->test_data);
        if (status != SUN_NLS_CONTINUE) {
            return status;
        }
    }
    return SUN_NLS_CONV_RECVR;
}

static int solve(SUNNonlinearSolver solver, N_Vector predicted, N_Vector correction,
                 N_Vector weight, sunrealtype tolerance, sunbooleantype setup, void *mem)
{
    newton *self = solver->content;
    step s;
    void *user;
    (void)predicted, (void)setup;
    self->iterations = 0;
    if (CVodeGetNonlinearSystemData(mem, &s.t, &s.z0, &s.y, &s.f, &s.gamma, &s.rl1, &s.z1, &user) !=
        CV_SUCCESS) {
        return LAC_SUN_BROKEN;
    }
    int status = iterate(solver, &s, correction, weight, tolerance);
    self->failed = status != 0;
    return status;
}

SUNNonlinearSolver lac_newton_create(lac_engine *engine, void *cvode)
{
    SUNNonlinearSolver solver = SUNNonlinSolNewEmpty(engine->sun);
    newton *self = calloc(1, sizeof *self);
    if (solver == NULL || self == NULL) {
        SUNNonlinSolFreeEmpty(solver);
        free(self);
        return NULL;
    }
    *self = (newton){.engine = engine, .cvode = cvode, .most = 3};
    solver->content = self;
    solver->ops->gettype = find_root;
    solver->ops->solve = solve;
    solver->ops->free = release;
    solver->ops->setsysfn = take_residual;
    solver->ops->setctestfn = take_test;
    solver->ops->setmaxiters = take_most;
    solver->ops->getnumiters = give_iterations;
    solver->ops->getcuriter = give_current;
    solver->ops->getnumconvfails = give_failures;
    return solver;
}

int64_t lac_newton_evaluations(SUNNonlinearSolver solver)
{
    newton *self = solver->content;
    int64_t evaluations = self->evaluations;
    self->evaluations = 0;
    return evaluations;
}
