// SPDX-License-Identifier: GPL-3.0-or-later
// B1 and C1, the problems of other earthquake-cycle codes: the events of B1 in every formulation by
// every method, closer with rtol; the bundled cases are the problems. `tools/bench peers` runs both
// to their ends.
#include <math.h>
#include <stdlib.h>

#include "lacuna/simulation.h"
#include "scene/scene.h"
#include "support/fault.h"
#include "support/test.h"
#include "support/trees.h"

static const char *const methods[] = {[LAC_BDF] = "bdf", [LAC_ADAMS] = "adams", [LAC_ERK] = "erk"};

// Largest error of the first two events, of which the second tells: the first follows from a slow
// approach alone.
// @param crest  what its peaks stay below
static double worst_of_two(const fault *f, lac_method method, double rtol, double crest)
{
    fault_events observation;
    (void)fault_run(f, method, 9e9, rtol, &observation);
    assert_int_equal(observation.count, 2);
    for (size_t k = 0; k < 2; k++) {
        print_message("peak off by %.1e at the steps' ends, %.1e between them\n",
                      observation.peak[k] / fault_b1_peaks[k] - 1,
                      observation.crest[k] / fault_b1_peaks[k] - 1);
        assert_true(fabs(observation.crest[k] / fault_b1_peaks[k] - 1) < crest);
    }
    double first = fabs(observation.time[0] / fault_b1_events[0] - 1);
    return fmax(first, fabs(observation.time[1] / fault_b1_events[1] - 1));
}

// What the errors stay below at rtol 1e-4 (those of adams scatter two- to threefold with rounding),
// and at 1e-6 where it is given: where it costs least, to save time.
typedef struct bound {
    double loose, tight;
} bound;

static void b1_in(lac_formulation formulation, const bound *most)
{
    fault f;
    fault_b1(formulation, &f);
    for (int m = LAC_BDF; m <= LAC_ERK; m++) {
        const char *name = lac_formulation_name(formulation);
        double off = worst_of_two(&f, (lac_method)m, 1e-4, 3e-3);
        print_message("%s, %s: off by %.1e at rtol 1e-4\n", name, methods[m], off);
        assert_true(off < most[m].loose);
        if (most[m].tight > 0) {
            off = worst_of_two(&f, (lac_method)m, 1e-6, 1e-4);
            print_message("%s, %s: off by %.1e at rtol 1e-6\n", name, methods[m], off);
            assert_true(off < most[m].tight);
        }
    }
    fault_free(&f);
}

static void b1_has_its_events_with_rate_as_unknown(void **state)
{
    (void)state;
    b1_in(LAC_FORMULATION_RATE, (const bound[]){{5e-5, 5e-7}, {1e-5, 0}, {2e-4, 0}});
}

static void b1_has_its_events_with_traction_as_unknown(void **state)
{
    (void)state;
    b1_in(LAC_FORMULATION_TRACTION, (const bound[]){{2e-5, 0}, {5e-6, 5e-8}, {3e-6, 5e-9}});
}

static void b1_has_its_events_with_slip_as_unknown(void **state)
{
    (void)state;
    b1_in(LAC_FORMULATION_SLIP, (const bound[]){{5e-6, 0}, {5e-6, 0}, {1e-6, 0}});
}

// Reads the case, and compares what it starts from with what the formulas give here.
static void same_start(const char *path, void (*create)(lac_formulation, fault *))
{
    lac_error err = {""};
    lac_case *c;
    lac_case_issues report = {0};
    lac_scene *scene;
    fault f;
    create(LAC_FORMULATION_TRACTION, &f);
    assert_int_equal(lac_case_read(path, NULL, &c, &report, &err), LAC_OK);
    assert_int_equal(lac_scene_create(c, NULL, &scene, &err), LAC_OK);
    assert_int_equal(lac_problem_formulation(scene->problem), LAC_FORMULATION_TRACTION);
    size_t n = f.parts.domain->n;
    assert_int_equal(scene->contact.domain->n, n);
    double *have = new_doubles(2 * n), *want = new_doubles(2 * n);
    lac_problem_initial(scene->problem, have);
    lac_problem_initial(f.parts.problem, want);
    for (size_t i = 0; i < 2 * n; i++) {
        assert_true(fabs(have[i] / want[i] - 1) < 1e-12);
        // At the plate's rate everywhere nothing would change.
        want[i] *= i < n ? 1 + 1e-3 * sin((double)i) : 1;
        have[i] = want[i];
    }
    double *rates = new_doubles(2 * n), *wanted = new_doubles(2 * n);
    double *work = new_doubles(lac_problem_work(f.parts.problem));
    assert_true(lac_problem_derivative(scene->problem, 1.0, have, rates, work));
    lac_problem_forget(f.parts.problem, work);
    assert_true(lac_problem_derivative(f.parts.problem, 1.0, want, wanted, work));
    double most = 0;
    for (size_t i = 0; i < n; i++) {
        most = fmax(most, fabs(wanted[i]));
    }
    for (size_t i = 0; i < n; i++) {
        assert_true(fabs(rates[i] - wanted[i]) < 1e-10 * most);
        assert_true(fabs(rates[n + i] - wanted[n + i]) < 1e-8 * exp(-want[n + i]));
    }
    free(have);
    free(want);
    free(rates);
    free(wanted);
    free(work);
    lac_scene_free(scene);
    lac_case_issues_clear(&report);
    lac_case_free(c);
    fault_free(&f);
}

static void cases_are_the_problems(void **state)
{
    (void)state;
    same_start(LACUNA_SOURCE_DIR "/cases/peers/periodic-line.yaml", fault_b1);
    same_start(LACUNA_SOURCE_DIR "/cases/peers/plane-patch.yaml", fault_c1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cases_are_the_problems),
        cmocka_unit_test(b1_has_its_events_with_rate_as_unknown),
        cmocka_unit_test(b1_has_its_events_with_traction_as_unknown),
        cmocka_unit_test(b1_has_its_events_with_slip_as_unknown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
