// SPDX-License-Identifier: GPL-3.0-or-later
// Plans, fronts and verdicts of a trade, on numbers made up here.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lacuna/simulation.h"
#include "support/test.h"
#include "trade/trade.h"

static void assert_near(double found, double expected, double error)
{
    assert_true(fabs(found - expected) <= error);
}

static lac_case *read_text(const char *text, lac_case_purpose purpose)
{
    lac_case *c = NULL;
    lac_case_issues report = {0};
    lac_error err = {""};
    const lac_case_request how = {.purpose = purpose};
    assert_int_equal(lac_case_read_text("trade.yaml", text, strlen(text), &how, &c, &report, &err),
                     LAC_OK);
    lac_case_issues_clear(&report);
    return c;
}

static const char block[] = "lacuna: 1\n"
                            "load: {normal: {pressure: 5 MPa}}\n"
                            "friction: {aging: {f0: 0.6, a: 0.01, b: 0.0135, dc: 1 mm}}\n"
                            "initial: {slip_rate: 1 mm/week, state: {ratio_to_steady: 0.5}}\n"
                            "time: {end: 1 year}\n";

static const char pressed[] =
    "lacuna: 1\n"
    "interface: {size: 1, levels: 4, surface: {self-affine: {rms_height: 0.001}}}\n"
    "material: {shear_modulus: 1e9, poisson: 0.2}\n"
    "load: {normal: {pressure: 1e6}, history: {friction: 0.5, steps: [{ratio_x: 0.5}]}}\n";

static const char joint[] = "lacuna: 1\n"
                            "interface: {size: 1 m, levels: 4, domain: {full: {}}}\n"
                            "material: {shear_modulus: 20 GPa}\n"
                            "load: {normal: {pressure: 5 MPa}}\n"
                            "friction: {aging: {f0: 0.6, a: 0.01, b: 0.0135, dc: 1 mm}}\n"
                            "initial: {slip_rate: 1 mm/week, state: {ratio_to_steady: 0.5}}\n"
                            "transfer: {hierarchy: {stiffness: elastic}}\n"
                            "time: {end: 1 year}\n"
                            "rg: {field: uniform, shifts: 4}\n";

// A sequence x + c r^-k: what is left after three of its members is known.
static void richardson(void **state)
{
    (void)state;
    for (double r = 2.0; r <= 5.0; r += 0.5) {
        const double x = 3.0, c = -0.7;
        const double error = lac_richardson_error(x + c, x + c / r, x + c / (r * r), 10.0);
        assert_near(error, 0.7 / (r * r), 1e-12);
    }
    // Luckier than the ladder can be: only its ratio is believed.
    assert_near(lac_richardson_error(1.0, 0.1, -0.1, 4.0), 0.2 / 3.0, 1e-15);
    // By chance all but alike: no better than a twentieth of the change before.
    assert_near(lac_richardson_error(1.0, 0.1, 0.0999, 4.0), 0.05 * 0.9, 1e-15);
    // Not converging: the last change.
    assert_near(lac_richardson_error(1.0, 2.0, 1.1, 10.0), 0.9, 1e-15);
    assert_near(lac_richardson_error(NAN, 2.0, 1.5, 10.0), 0.5, 1e-15);
    assert_near(lac_richardson_error(2.0, 2.0, 2.0, 10.0), 0.0, 0.0);
    assert_near(lac_richardson_error(3.0, 2.0, 2.0, 10.0), 0.05, 1e-15);
    assert_true(isnan(lac_richardson_error(1.0, NAN, 2.0, 10.0)));
}

// Sorted by cost, the front is where the least error so far falls.
static void front_of_many(void **state)
{
    (void)state;
    enum { N = 200 };
    lac_trade_run run[N] = {0};
    srand(7);
    for (int i = 0; i < N; i++) {
        run[i].why = i % 17 == 3 ? LAC_TRADE_CHECK : LAC_TRADE_TRIED;
        run[i].end = LAC_TRADE_DONE;
        run[i].m.cpu_time = (double)(rand() % 40);
        run[i].error = i % 19 == 5 ? NAN : (double)(rand() % 40);
    }
    const double floor = 4.0;
    lac_pareto_front(N, run, floor);
    double least = INFINITY;
    for (int c = 0; c < 40; c++) {
        double best = INFINITY;
        for (int i = 0; i < N; i++) {
            const bool counts = run[i].why == LAC_TRADE_TRIED && !isnan(run[i].error);
            best = run[i].m.cpu_time == c && counts ? fmin(best, fmax(run[i].error, floor)) : best;
        }
        for (int i = 0; i < N; i++) {
            if (run[i].m.cpu_time == c && run[i].why == LAC_TRADE_TRIED) {
                assert_int_equal(run[i].on_front, best < least &&
                                                      fmax(run[i].error, floor) == best &&
                                                      !isnan(run[i].error));
            }
        }
        least = fmin(least, best);
    }
    for (int i = 0; i < N; i++) {
        assert_true(!run[i].on_front || (run[i].why == LAC_TRADE_TRIED && !isnan(run[i].error)));
    }
}

static size_t count_of(const lac_trade *plan, int why)
{
    size_t n = 0;
    for (size_t i = 0; i < plan->runs; i++) {
        n += (plan->run[i].why & why) != 0 ? 1 : 0;
    }
    return n;
}

// Five rungs; on each the case, three methods and three formulations.
static void plan_of_a_run(void **state)
{
    (void)state;
    lac_trade plan;
    lac_case *c = read_text(block, LAC_FOR_RUN);
    assert_int_equal(lac_trade_create(c, LAC_OF_RUN, NULL, false, &plan, NULL), LAC_OK);
    assert_int_equal(plan.settings, 3);
    assert_int_equal(count_of(&plan, LAC_TRADE_TRIED), 5 * (1 + 3 + 3));
    const lac_trade_run *reference = &plan.run[plan.finest];
    assert_string_equal(plan.setting[0].value[reference->at[0]].label, "1e-08");
    assert_int_equal(reference->at[1], -1);
    assert_int_equal(plan.run[plan.coarser[0][0]].at[0], reference->at[0] - 1);
    assert_int_equal(plan.run[plan.coarser[0][1]].at[0], reference->at[0] - 2);
    assert_int_equal(plan.coarser[1][0], SIZE_MAX);
    assert_true(
        lac_trade_is_coarser(&plan, &plan.run[plan.coarser[0][1]], &plan.run[plan.coarser[0][0]]));
    assert_false(
        lac_trade_is_coarser(&plan, &plan.run[plan.coarser[0][0]], &plan.run[plan.coarser[0][1]]));
    lac_trade_clear(&plan);
    assert_int_equal(lac_trade_create(c, LAC_OF_RUN, "method,rtol=1e-3:1e-5", true, &plan, NULL),
                     LAC_OK);
    assert_int_equal(count_of(&plan, LAC_TRADE_TRIED), 3 * 2);
    lac_trade_clear(&plan);
    lac_case_free(c);
}

// A case's own tolerance is always among the rungs.
static void own_tolerance(void **state)
{
    (void)state;
    static const double own[] = {1e-6, 3e-5, 1e-9, 0.02, 1e-13};
    static const size_t rungs[] = {5, 6, 7, 7, 11};
    lac_setting_value value[LAC_SETTING_VALUES];
    lac_case *c = read_text(block, LAC_FOR_RUN);
    for (size_t k = 0; k < sizeof own / sizeof own[0]; k++) {
        c->run.rtol = own[k];
        const size_t n = lac_setting_get(0)->values(c, LAC_OF_RUN, value);
        bool found = false;
        double before = INFINITY;
        assert_int_equal(n, rungs[k]);
        for (size_t i = 0; i < n; i++) {
            const double rtol = strtod(value[i].yaml, NULL);
            assert_true(rtol < before);
            found = found || rtol == own[k];
            before = rtol;
        }
        assert_true(found);
    }
    lac_case_free(c);
}

// A contact is traded over its grid, and over nothing of a run.
static void plan_of_a_contact(void **state)
{
    (void)state;
    lac_trade plan;
    lac_error err;
    lac_case *c = read_text(pressed, LAC_FOR_CONTACT);
    assert_int_equal(lac_trade_create(c, LAC_OF_CONTACT, NULL, false, &plan, NULL), LAC_OK);
    assert_int_equal(plan.settings, 1);
    assert_string_equal(plan.setting[0].setting->name, "levels");
    const lac_trade_run *reference = &plan.run[plan.finest];
    assert_string_equal(plan.setting[0].value[reference->at[0]].label, "4");
    assert_int_equal(lac_trade_of_run(&plan, &plan.run[plan.finest]), LAC_OF_CONTACT);
    assert_int_equal(count_of(&plan, LAC_TRADE_TRIED), 3);
    lac_trade_clear(&plan);
    assert_int_equal(lac_trade_create(c, LAC_OF_CONTACT, "rtol", false, &plan, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "turns nothing in a contact"));
    c->interface.levels = 0;
    assert_int_equal(lac_trade_create(c, LAC_OF_CONTACT, NULL, false, &plan, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "no dial to turn"));
    c->interface.levels = 4;
    lac_case_free(c);
}

// What changes the scene is at its last position in the reference; the cascade has dials of its
// own.
static void plan_of_a_scene(void **state)
{
    (void)state;
    lac_trade plan;
    lac_case *c = read_text(joint, LAC_FOR_RUN);
    assert_int_equal(lac_trade_create(c, LAC_OF_RUN, "levels,transfer", false, &plan, NULL),
                     LAC_OK);
    const lac_trade_run *reference = &plan.run[plan.finest];
    assert_int_equal(plan.settings, 3); // and rtol, for the reference
    assert_string_equal(plan.setting[0].value[reference->at[0]].label, "4");
    assert_string_equal(plan.setting[1].value[reference->at[1]].label, "elastic");
    assert_string_equal(plan.setting[2].value[reference->at[2]].label, "1e-07");
    assert_int_equal(plan.setting[2].shown, 0);
    assert_int_equal(count_of(&plan, LAC_TRADE_TRIED), 3 * (1 + 2));
    lac_trade_clear(&plan);
    assert_int_equal(lac_trade_create(c, LAC_OF_CASCADE, NULL, false, &plan, NULL), LAC_OK);
    assert_int_equal(plan.settings, 1); // uniform: no contacts along a path
    assert_string_equal(plan.setting[0].setting->name, "shifts");
    assert_string_equal(plan.setting[0].value[plan.run[plan.finest].at[0]].label, "16");
    assert_int_equal(lac_trade_of_run(&plan, &plan.run[plan.finest]), LAC_OF_CASCADE);
    lac_trade_clear(&plan);
    assert_int_equal(lac_trade_create(c, LAC_OF_CASCADE, "fidelity", false, &plan, NULL), LAC_OK);
    assert_int_equal(lac_trade_of_run(&plan, &plan.run[plan.finest]), LAC_OF_RUN);
    lac_trade_clear(&plan);
    // dials of the one turn nothing in the other, but where the cascade may become a run
    assert_int_equal(lac_trade_create(c, LAC_OF_CASCADE, "rtol", false, &plan, NULL), LAC_EINPUT);
    assert_int_equal(lac_trade_create(c, LAC_OF_RUN, "shifts", false, &plan, NULL), LAC_EINPUT);
    assert_int_equal(lac_trade_create(c, LAC_OF_CASCADE, "rtol,fidelity", false, &plan, NULL),
                     LAC_OK);
    lac_trade_clear(&plan);
    lac_case_free(c);
}

static void wrong_dials(void **state)
{
    (void)state;
    static const char *const words[] = {
        "speed",          "rtol,rtol",       "levels",
        "rtol=",          "rtol=1e-3::1e-4", "",
        "rtol,",          "transfer",        "rtol=1:2:3:4:5:6:7:8:9:10:11:12:13:14:15:16:17",
        "rtol=1e-4:1e-3", "rtol=1e-3:1e-3",  "rtol=0",
        "rtol=abc",       "levels=6:5",      "shifts=-1:4"};
    lac_case *c = read_text(block, LAC_FOR_RUN);
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        lac_trade plan;
        lac_error err = {""};
        assert_int_equal(lac_trade_create(c, LAC_OF_RUN, words[i], false, &plan, &err), LAC_EINPUT);
        assert_non_null(strstr(err.message, "--dials"));
    }
    lac_case_free(c);
}

// A made-up trade: errors fall as rtol, times grow as its logarithm; one method is twice as dear.
static void fill(lac_trade *plan)
{
    for (size_t i = 0; i < plan->runs; i++) {
        lac_trade_run *run = &plan->run[i];
        const int at = run->at[0], method = run->at[1];
        run->end = LAC_TRADE_DONE;
        for (int q = 0; q < LAC_QUANTITIES; q++) {
            run->m.value[q] = NAN;
        }
        run->m.value[LAC_QUANTITY_SLIP] = 2.0 * (1.0 + pow(10.0, -3.0 - at));
        run->m.cpu_time = (1.0 + at) * (method > 0 ? 2.0 : 1.0);
    }
}

static void verdict(void **state)
{
    (void)state;
    lac_trade plan;
    lac_case *c = read_text(block, LAC_FOR_RUN);
    assert_int_equal(lac_trade_create(c, LAC_OF_RUN, "rtol,method", false, &plan, NULL), LAC_OK);
    fill(&plan);
    lac_trade_request ask = {.quantity = -1, .reach = 2e-5, .within = NAN, .budget = NAN};
    assert_int_equal(lac_trade_judge(&plan, &ask, NULL), LAC_OK);
    assert_int_equal(plan.quantity, LAC_QUANTITY_SLIP); // nothing fails, no limit is reached
    assert_ptr_equal(plan.reference, &plan.run[plan.finest]);
    assert_near(plan.reference->uncertainty, 4.5e-8,
                1e-10); // a twentieth of 9e-7, where 1e-8 is left
    assert_int_equal(plan.recommended->at[0], 2);
    assert_near(plan.recommended->error, 1e-5, 2e-8);
    for (size_t i = 0; i < plan.runs; i++) {
        const bool dear = plan.run[i].at[1] > 0;
        const bool tried = (plan.run[i].why & LAC_TRADE_TRIED) != 0;
        assert_int_equal(plan.run[i].on_front, tried && !dear);
    }

    ask = (lac_trade_request){.quantity = -1, .reach = NAN, .within = 2.5e-3, .budget = NAN};
    assert_int_equal(lac_trade_judge(&plan, &ask, NULL), LAC_OK);
    assert_int_equal(plan.recommended->at[0], 0); // 1e-3 of 2 is 2e-3

    ask.unit = "s"; // of the slip
    assert_int_equal(lac_trade_judge(&plan, &ask, NULL), LAC_EINPUT);

    ask = (lac_trade_request){.quantity = -1, .reach = NAN, .within = NAN, .budget = 3.5};
    assert_int_equal(lac_trade_judge(&plan, &ask, NULL), LAC_OK);
    assert_int_equal(plan.recommended->at[0], 2);

    ask = (lac_trade_request){.quantity = -1, .reach = 1e-12, .within = NAN, .budget = NAN};
    assert_int_equal(lac_trade_judge(&plan, &ask, NULL), LAC_OK);
    assert_null(plan.recommended);
    assert_int_equal(plan.closest->at[0], 4);
    lac_trade_clear(&plan);
    lac_case_free(c);
}

// A reference that breaks is stood in for by the next; one without the quantity is an error.
static void poor_references(void **state)
{
    (void)state;
    lac_trade plan;
    lac_error err = {""};
    lac_case *c = read_text(block, LAC_FOR_RUN);
    assert_int_equal(lac_trade_create(c, LAC_OF_RUN, "rtol,method", false, &plan, NULL), LAC_OK);
    fill(&plan);
    lac_trade_request ask = {.quantity = -1, .reach = NAN, .within = NAN, .budget = NAN};
    plan.run[plan.finest].end = LAC_TRADE_BROKEN;
    assert_int_equal(lac_trade_judge(&plan, &ask, &err), LAC_OK);
    assert_ptr_equal(plan.reference, &plan.run[plan.coarser[0][0]]);
    assert_near(plan.reference->uncertainty, 9e-7, 1e-9); // the rung before it is the last change
    plan.run[plan.coarser[0][0]].end = LAC_TRADE_BROKEN;
    assert_int_equal(lac_trade_judge(&plan, &ask, &err), LAC_OK);
    assert_ptr_equal(plan.reference, &plan.run[plan.coarser[0][1]]);
    assert_true(isnan(plan.reference->uncertainty));
    plan.run[plan.coarser[0][1]].end = LAC_TRADE_GIVEN_UP;
    assert_int_equal(lac_trade_judge(&plan, &ask, &err), LAC_ENUMERIC);
    fill(&plan);
    for (int q = 0; q < LAC_QUANTITIES; q++) {
        ask.quantity = q;
        assert_int_equal(lac_trade_judge(&plan, &ask, &err),
                         q == LAC_QUANTITY_SLIP ? LAC_OK : LAC_EINPUT);
    }
    // Counts that agree are known to one event, no better.
    for (size_t i = 0; i < plan.runs; i++) {
        plan.run[i].m.value[LAC_QUANTITY_EVENTS] = 50.0;
    }
    ask.quantity = LAC_QUANTITY_EVENTS;
    assert_int_equal(lac_trade_judge(&plan, &ask, &err), LAC_OK);
    assert_near(plan.reference->uncertainty, 0.02, 1e-15);
    assert_null(plan.recommended);
    lac_trade_clear(&plan);
    lac_case_free(c);
}

static lac_status count_records(void *context, const lac_record *record, lac_error *err)
{
    (void)record, (void)err;
    ++*(int *)context;
    return LAC_OK;
}

// The probe passes on what it sees; Q/Q_nom is of the effective force.
static void probe(void **state)
{
    (void)state;
    int records = 0;
    double value[LAC_QUANTITIES];
    lac_case *c = read_text(block, LAC_FOR_RUN);
    const lac_sink next = {.context = &records, .record = count_records};
    lac_trade_probe p;
    const lac_sink sink = lac_trade_probe_start(&p, c, &next);
    const double shear[] = {1.0, 3.0, 2.0};
    for (int i = 0; i < 3; i++) {
        const lac_record record = {.observation = {.shear_force = shear[i],
                                                   .effective_force = 10.0,
                                                   .mean_rate = 0.5 * i}};
        assert_int_equal(sink.record(sink.context, &record, NULL), LAC_OK);
    }
    assert_int_equal(sink.event(sink.context, &(lac_event){.cells = 1}, NULL), LAC_OK);
    assert_null(sink.snapshot); // what comes next has no use for them
    const lac_run_result result = {.failed = true,
                                   .failure_origin = 4.0,
                                   .failure_local = 0.5,
                                   .mean_slip = 7.0,
                                   .max_slip_rate = 9.0};
    lac_trade_probe_values(&p, &result, true, value);
    assert_int_equal(records, 3);
    assert_near(value[LAC_QUANTITY_FAILURE], 4.5, 0.0);
    assert_true(isnan(value[LAC_QUANTITY_LIMIT]));
    assert_near(value[LAC_QUANTITY_SLIP], 7.0, 0.0);
    assert_near(value[LAC_QUANTITY_RATE], 1.0, 0.0);
    assert_near(value[LAC_QUANTITY_PEAK], 9.0, 0.0);
    assert_near(value[LAC_QUANTITY_CRITICAL], 3.0 / (0.6 * 10.0), 1e-15);
    assert_near(value[LAC_QUANTITY_EVENTS], 1.0, 0.0);
    const lac_run_result stopped = {.end = LAC_END_STOP, .time = 5.0};
    lac_trade_probe_values(&p, &stopped, false, value);
    assert_near(value[LAC_QUANTITY_LIMIT], 5.0, 0.0);
    assert_true(isnan(value[LAC_QUANTITY_FAILURE]) && isnan(value[LAC_QUANTITY_EVENTS]));
    lac_case_free(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(richardson),      cmocka_unit_test(front_of_many),
        cmocka_unit_test(plan_of_a_run),   cmocka_unit_test(plan_of_a_contact),
        cmocka_unit_test(own_tolerance),   cmocka_unit_test(plan_of_a_scene),
        cmocka_unit_test(wrong_dials),     cmocka_unit_test(verdict),
        cmocka_unit_test(poor_references), cmocka_unit_test(probe),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
