// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's iteration in place of dy/dt, on vectors whose sums wait, against SUNDIALS' own.
#include <stdlib.h>
#include <string.h>

#include <cvodes/cvodes.h>
#include <math.h>

#include "run/engine.h"
#include "support/test.h"
#include "support/tree.h"

static int rates(sunrealtype t, N_Vector y, N_Vector ydot, void *user)
{
    lac_engine *e = user;
    return lac_problem_derivative(e->problem, t, lac_vector_data(y), lac_vector_data(ydot), e->work)
               ? 0
               : 1;
}

static int weights(N_Vector y, N_Vector w, void *user)
{
    const lac_engine *e = user;
    lac_problem_weights(e->problem, lac_vector_data(y), 1e-5, lac_vector_data(w));
    return 0;
}

static SUNLinearSolver_Type embedded(SUNLinearSolver solver)
{
    (void)solver;
    return SUNLINEARSOLVER_MATRIX_EMBEDDED;
}

static int solve(SUNLinearSolver solver, SUNMatrix none, N_Vector x, N_Vector b, sunrealtype tol)
{
    lac_engine *e = solver->content;
    sunrealtype t, gamma, rl1;
    N_Vector predicted, y, f, z1;
    void *user;
    (void)none, (void)tol;
    (void)CVodeGetNonlinearSystemData(e->inner, &t, &predicted, &y, &f, &gamma, &rl1, &z1, &user);
    e->counts.linear_solves++;
    N_VScale(1.0, b, x);
    return lac_problem_newton(e->problem, t, lac_vector_data(y), gamma, lac_vector_data(x), e->work)
               ? 0
               : SUNLS_LUFACT_FAIL;
}

typedef struct course {
    long steps, evaluations, iterations, failures;
    int64_t solves;
} course;

// A run to fast slip with SUNDIALS' own Newton iteration, or ours.
static course creep(const tree *t, double first_step, bool own, double *end)
{
    course way = {0};
    lac_engine e = {.problem = t->problem, .n = t->domain->n, .limit = INFINITY};
    size_t m = lac_problem_unknowns(t->problem);
    assert_int_equal(LAC_SUN_CONTEXT_CREATE(&e.sun), 0);
    e.work = calloc(lac_problem_work(t->problem), sizeof *e.work);
    N_Vector y = lac_vector_create(lac_problem_range(t->problem), m / e.n, own, e.sun);
    lac_problem_initial(t->problem, lac_vector_data(y));
    e.inner = CVodeCreate(CV_BDF, e.sun);
    LAC_SUN_SILENCE_CVODE(e.inner);
    assert_int_equal(CVodeInit(e.inner, rates, 0.0, y), CV_SUCCESS);
    assert_int_equal(CVodeSetUserData(e.inner, &e), CV_SUCCESS);
    assert_int_equal(CVodeWFtolerances(e.inner, weights), CV_SUCCESS);
    assert_int_equal(CVodeSetMaxConvFails(e.inner, 40), CV_SUCCESS);
    SUNLinearSolver linear = SUNLinSolNewEmpty(e.sun);
    SUNNonlinearSolver newton = lac_newton_create(&e, e.inner);
    linear->ops->gettype = embedded;
    linear->ops->solve = solve;
    linear->content = &e;
    assert_int_equal(own ? CVodeSetNonlinearSolver(e.inner, newton)
                         : CVodeSetLinearSolver(e.inner, linear, NULL),
                     CV_SUCCESS);
    assert_int_equal(CVodeSetInitStep(e.inner, first_step), CV_SUCCESS);
    for (int k = 0; k < 250; k++) {
        sunrealtype at;
        assert_true(CVode(e.inner, 1e10, y, &at, CV_ONE_STEP) >= 0);
    }
    memcpy(end, lac_vector_data(y), m * sizeof *end);
    (void)CVodeGetNumSteps(e.inner, &way.steps);
    (void)CVodeGetNumRhsEvals(e.inner, &way.evaluations);
    (void)CVodeGetNumNonlinSolvIters(e.inner, &way.iterations);
    (void)CVodeGetNumNonlinSolvConvFails(e.inner, &way.failures);
    way.evaluations += (long)lac_newton_evaluations(newton);
    way.solves = e.counts.linear_solves;
    CVodeFree(&e.inner);
    SUNLinSolFreeEmpty(linear);
    SUNNonlinSolFree(newton);
    N_VDestroy(y);
    free(e.work);
    SUNContext_Free(&e.sun);
    return way;
}

static void compare(const tree *t, double first_step)
{
    size_t bytes = lac_problem_unknowns(t->problem) * sizeof(double);
    double *theirs = malloc(bytes), *ours = malloc(bytes);
    course they = creep(t, first_step, false, theirs);
    course we = creep(t, first_step, true, ours);
    assert_memory_equal(theirs, ours, bytes);
    assert_memory_equal(&they, &we, sizeof we);
    assert_true(we.failures > 0);
    assert_true(we.solves < we.iterations); // small residuals need none
    free(theirs);
    free(ours);
}

// First steps that are too long, so that solves fail; at the second no rate is finite either.
static void newton_is_theirs_to_the_bit(void **state)
{
    (void)state;
    for (lac_formulation f = LAC_FORMULATION_RATE; f <= LAC_FORMULATION_SLIP; f++) {
        tree_def def = tree_default(3, 4);
        tree t;
        def.k0 *= 0.05; // to failure
        def.formulation = f;
        tree_create(&def, &t);
        compare(&t, 3e4);
        compare(&t, 1e9);
        tree_clear(&t);
    }
}

// A transfer that counts its solves: one for each of Newton's.
static const lac_transfer_kind *counted;
static int64_t solves;

static bool solve_and_count(const void *state, double k_mean, const double *diagonal,
                            const double *y, double *x, double *work)
{
    solves++;
    return counted->solve(state, k_mean, diagonal, y, x, work);
}

// The checkpoint made last before the 100th step, and the solves up to there.
typedef struct kept {
    int64_t steps, solves;
    lac_checkpoint checkpoint;
} kept;

static lac_status count_step(void *context, const lac_step *now, lac_error *err)
{
    (void)now, (void)err;
    ((kept *)context)->steps++;
    return LAC_OK;
}

static lac_status keep(void *context, const lac_checkpoint *now, lac_error *err)
{
    kept *k = context;
    (void)err;
    if (k->steps >= 100 && k->checkpoint.state != NULL) {
        return LAC_OK;
    }
    unsigned char *state = malloc(now->size);
    memcpy(state, now->state, now->size);
    free((unsigned char *)k->checkpoint.state);
    k->checkpoint = *now;
    k->checkpoint.state = state;
    k->solves = solves;
    return LAC_OK;
}

// The same problem on a transfer that counts.
static lac_problem *count_solves(const tree *t, lac_formulation formulation,
                                 lac_transfer_kind *kind)
{
    lac_problem *problem = NULL;
    lac_error err = {""};
    const size_t n = t->domain->n;
    double *start = malloc(lac_problem_unknowns(t->problem) * sizeof *start);
    lac_problem_initial(t->problem, start); // with ln v as unknown
    counted = t->transfer.kind;
    *kind = *counted;
    kind->solve = solve_and_count;
    const lac_transfer transfer = {.kind = kind, .state = t->transfer.state};
    const lac_problem_def def = {.domain = t->domain,
                                 .friction = t->friction,
                                 .transfer = &transfer,
                                 .log_rate = start,
                                 .log_state = start + n,
                                 .formulation = formulation};
    assert_int_equal(lac_problem_create(&def, &problem, &err), LAC_OK);
    free(start);
    return problem;
}

// linear_solves of a run to failure, and of one that goes on from a checkpoint, counted apart.
static void a_run_counts_its_solves(void **state)
{
    (void)state;
    tree_def def = tree_default(3, 4);
    tree t;
    def.k0 *= 0.05; // to failure
    tree_create(&def, &t);
    for (lac_formulation f = LAC_FORMULATION_RATE; f <= LAC_FORMULATION_SLIP; f++) {
        lac_transfer_kind kind;
        lac_problem *problem = count_solves(&t, f, &kind);
        lac_run_def how = lac_run_default();
        lac_run_result whole, rest;
        kept k = {0};
        const lac_sink sink = {.context = &k, .step = count_step, .checkpoint = keep};
        lac_error err = {""};
        how.end = 1e12;
        how.failure_rate = 1e-3;
        how.checkpoint.steps = 40;
        solves = 0;
        if (lac_run(problem, &how, &sink, &whole, &err) != LAC_OK) {
            fail_msg("%s", err.message);
        }
        assert_true(whole.failed && whole.steps > 100 && k.solves > 0);
        assert_int_equal(whole.linear_solves, solves);
        assert_true(whole.linear_solves < whole.newton_iterations);
        solves = k.solves;
        how.resume = &k.checkpoint;
        assert_int_equal(lac_run(problem, &how, NULL, &rest, &err), LAC_OK);
        assert_int_equal(rest.linear_solves, solves);
        assert_int_equal(rest.linear_solves, whole.linear_solves);
        free((unsigned char *)k.checkpoint.state);
        lac_problem_free(problem);
    }
    tree_clear(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(newton_is_theirs_to_the_bit),
                                       cmocka_unit_test(a_run_counts_its_solves)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
