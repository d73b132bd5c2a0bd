// SPDX-License-Identifier: GPL-3.0-or-later
// A case from its definition to its outcome: what a sink of one's own gets, what is in the file,
// and what the options do.
#include <stdio.h>
#include <string.h>

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <unistd.h>

#include "simulation/simulation.h"
#include "simulation/tape.h"
#include "support/store_records.h"
#include "support/test.h"

#define BLOCK LACUNA_SOURCE_DIR "/cases/block.yaml"

static lac_case *read_block(size_t count, const lac_override *sets)
{
    const lac_case_request how = {.overrides = sets, .count = count};
    lac_case_issues report = {0};
    lac_case *c = NULL;
    assert_int_equal(lac_case_read(BLOCK, &how, &c, &report, NULL), LAC_OK);
    lac_case_issues_clear(&report);
    return c;
}

static lac_simulation *create(const lac_case *c, const lac_simulation_options *options)
{
    lac_simulation *simulation = NULL;
    lac_error err = {0};
    if (lac_simulation_create(c, options, &simulation, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return simulation;
}

// theta_ss = (dc/v) x^-(b/a), times the published time for b/a = 1.35 and x = 0.5
static double exact_failure(void) { return 604800 * pow(2, 1.35) * 0.856272305814; }

// solver.accuracy is kept, and said; the case of the caller stays as it is.
static void test_accuracy(void **state)
{
    (void)state;
    const lac_override set = {"solver.accuracy", "1e-6"};
    lac_case *c = read_block(1, &set);
    const double rtol = c->run.rtol;
    lac_simulation *simulation = create(c, NULL);
    const lac_outcome *of = lac_simulation_outcome(simulation);
    assert_string_equal(of->status, "running");
    assert_int_equal(lac_simulation_run(simulation, NULL, NULL), LAC_OK);
    assert_string_equal(of->status, "complete");
    assert_true(of->run.failed && of->run.end == LAC_END_FAILURE);
    const double failure = of->run.failure_origin + of->run.failure_local;
    assert_true(fabs(failure / exact_failure() - 1) < 1e-6);
    assert_true(of->accuracy->asked == 1e-6 && of->accuracy->estimated < 1e-6);
    assert_string_equal(of->accuracy->of, "time of failure");
    assert_non_null(strstr(of->accuracy->text, of->accuracy->method));
    assert_true(of->source->run.rtol == of->accuracy->rtol);
    assert_true(c->run.rtol == rtol && c->accuracy == 1e-6);
    lac_simulation_free(simulation);
    lac_case_free(c);
}

// What came to a sink of one's own.
typedef struct observation {
    size_t records, steps, snapshots, once, cells;
    uint64_t sum;       // of what records and snapshots hold
    double first, last; // values of the first extra quantity over nothing
    int threads;
} observation;

static lac_status on_record(void *context, const lac_record *record, lac_error *err)
{
    observation *s = context;
    (void)err;
    s->records += record->extra != NULL;
    s->cells += record->cells.n;
    s->sum = lac_sum_bytes(s->sum, &record->time_local, sizeof record->time_local);
    s->sum = lac_sum_bytes(s->sum, &record->observation.mean_slip, sizeof(double));
    s->sum = lac_sum_bytes(s->sum, record->extra, record->extra != NULL ? sizeof(double) : 0);
    s->sum = lac_sum_bytes(s->sum, record->cells.slip_rate, record->cells.n * sizeof(double));
    s->sum = lac_sum_bytes(s->sum, record->cells.log_state, record->cells.n * sizeof(double));
    s->threads = omp_get_max_threads();
    return LAC_OK;
}

static lac_status on_step(void *context, const lac_step *step, lac_error *err)
{
    observation *s = context;
    (void)err;
    s->steps += step->step > 0;
    return LAC_OK;
}

static lac_status on_snapshot(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    observation *s = context;
    (void)err;
    s->snapshots += snapshot->slip != NULL;
    s->sum = lac_sum_bytes(s->sum, snapshot->slip, snapshot->n * sizeof(double));
    s->sum = lac_sum_bytes(s->sum, snapshot->traction, snapshot->n * sizeof(double));
    return LAC_OK;
}

static lac_status on_once(void *context, const double *values, lac_error *err)
{
    observation *s = context;
    (void)err;
    s->first = s->once == 0 ? values[0] : s->first;
    s->last = values[0];
    s->once++;
    return LAC_OK;
}

static lac_sink sink_of(observation *s)
{
    return (lac_sink){.size = sizeof(lac_sink),
                      .context = s,
                      .record = on_record,
                      .snapshot = on_snapshot,
                      .step = on_step,
                      .once = on_once};
}

// Indicators, fields, steps: all that the case asks for comes to a sink, and the result has it too.
static void test_own_sink(void **state)
{
    (void)state;
    const lac_override sets[] = {{"analysis.rg.critical_fraction", "0.25"},
                                 {"output.fields", "[slip]"},
                                 {"output.fields_every", "1 day"},
                                 {"time.end", "5 day"}};
    lac_case *c = read_block(4, sets);
    lac_simulation *simulation = create(c, NULL);
    const lac_outcome *of = lac_simulation_outcome(simulation);
    observation s = {0};
    const lac_sink sink = sink_of(&s);
    assert_int_equal(lac_simulation_run(simulation, &sink, NULL), LAC_OK);
    assert_int_equal(s.steps, of->run.steps);
    assert_int_equal(s.records, s.steps + 1);
    assert_int_equal(s.snapshots, 6);
    assert_int_equal(s.once, 2);
    assert_true(s.first == 0.25 && s.last == 0.25 && of->once[0] == 0.25);
    assert_non_null(lac_analysis_get(of->analysis, 0));
    assert_true(of->extras > 0 && of->accuracy == NULL);
    lac_error err = {0};
    assert_int_equal(lac_simulation_run(simulation, NULL, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "run already"));
    lac_simulation_free(simulation);
    lac_case_free(c);
}

// What comes to a sink, with steps or without, and whether it is a pilot run that comes.
static observation observe(const lac_case *c, const lac_simulation_options *options, bool steps,
                           bool *kept)
{
    lac_simulation *simulation = create(c, options);
    observation s = {.sum = LAC_SUM_OF_NOTHING};
    lac_sink sink = sink_of(&s);
    sink.step = steps ? on_step : NULL;
    assert_int_equal(lac_simulation_run(simulation, &sink, NULL), LAC_OK);
    *kept = lac_simulation_accuracy(simulation)->kept;
    lac_simulation_free(simulation);
    return s;
}

// A pilot run that is kept puts out what the run would, cells included where they are looked at;
// who looks at steps gets the run itself.
static void test_kept(void **state)
{
    (void)state;
    const lac_override sets[] = {{"solver.accuracy", "1e-3"},
                                 {"analysis.rg.critical_fraction", "0.25"},
                                 {"output.fields", "[slip, traction]"},
                                 {"output.fields_every", "1 day"}};
    lac_case *c = read_block(4, sets);
    lac_simulation_options options = lac_simulation_options_default();
    bool kept, again;
    const observation pilot = observe(c, &options, false, &kept);
    const observation run = observe(c, &options, true, &again);
    assert_true(kept && !again && pilot.steps == 0 && run.steps > 0);
    assert_true(pilot.records > 10 && pilot.records == run.records);
    assert_true(pilot.snapshots > 10 && pilot.snapshots == run.snapshots);
    assert_true(pilot.cells == pilot.records && pilot.sum == run.sum);
    options.cells_unread = true;
    const observation brief = observe(c, &options, false, &kept);
    assert_true(kept && brief.cells == 0 && brief.records == run.records);
    lac_case_free(c);
}

// Less than this is not kept: the run is made again.
static void test_tape_is_bounded(void **state)
{
    (void)state;
    lac_tape tape = {.most = 2 * sizeof(lac_event)};
    const lac_sink sink = lac_tape_sink(&tape);
    const lac_event event = {.cells = 7};
    observation s = {0};
    const lac_sink to = sink_of(&s);
    assert_int_equal(sink.event(sink.context, &event, NULL), LAC_OK);
    assert_false(tape.over);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(sink.event(sink.context, &event, NULL), LAC_OK);
    }
    assert_true(tape.over && tape.kept.bytes == NULL);
    assert_int_equal(lac_tape_play(&tape, &to, NULL), LAC_OK);
    assert_int_equal(s.records, 0);
    lac_tape_clear(&tape);
}

// Runs into the file that the case names, in this folder or another.
static void write_file(lac_simulation *simulation, const char *path)
{
    lac_store *store = NULL;
    lac_store_def def;
    assert_int_equal(lac_simulation_file(simulation, &def, NULL), LAC_OK);
    assert_string_equal(def.path, "block.nc");
    def.path = path;
    def.force = true;
    assert_int_equal(lac_store_create(&def, &store, NULL), LAC_OK);
    const lac_sink sink = lac_store_sink(store);
    const lac_outcome *of = lac_simulation_outcome(simulation);
    assert_int_equal(lac_simulation_run(simulation, &sink, NULL), LAC_OK);
    assert_int_equal(lac_store_finish(store, of->status, &of->run, 1.0, NULL), LAC_OK);
    lac_store_free(store);
}

// A file has what a recording has, indicators included, and says what was picked.
static void test_file(void **state)
{
    (void)state;
    const lac_override sets[] = {{"solver.accuracy", "1e-3"},
                                 {"analysis.rg.critical_fraction", "0.25"}};
    char path[] = "/tmp/lacuna-simulation-XXXXXX", text[4096];
    const int fd = mkstemp(path);
    assert_true(fd >= 0);
    (void)close(fd);
    lac_case *c = read_block(2, sets);
    lac_simulation *to_file = create(c, NULL), *to_memory = create(c, NULL);
    lac_dataset *recording = NULL;
    write_file(to_file, path);
    assert_int_equal(lac_simulation_record(to_memory, &recording, NULL), LAC_OK);
    const char *name;
    size_t compared = 0;
    for (size_t i = 0; (name = lac_dataset_name(recording, i)) != NULL; i++) {
        const char *dim = lac_dataset_dim(recording, name, 0, NULL);
        const double *kept = lac_dataset_array(recording, name);
        double *values = NULL;
        size_t n = 0;
        if (dim != NULL && strcmp(dim, "time") == 0 &&
            lac_dataset_dim(recording, name, 1, NULL) == NULL &&
            read_over_time(path, name, &values, &n, NULL) == LAC_OK) {
            assert_int_equal(n, lac_dataset_count(recording, name));
            for (size_t k = 0; k < n; k++) {
                assert_true(values[k] == kept[k] || (isnan(values[k]) && isnan(kept[k])));
            }
            compared++;
        }
        free(values);
    }
    assert_true(compared > 10);
    assert_int_equal(lac_store_read_attribute(path, "accuracy", text, sizeof text, NULL), LAC_OK);
    assert_string_equal(text, lac_simulation_outcome(to_file)->accuracy->text);
    assert_int_equal(lac_store_read_attribute(path, "status", text, sizeof text, NULL), LAC_OK);
    assert_string_equal(text, "complete");
    lac_dataset_free(recording);
    lac_simulation_free(to_file);
    lac_simulation_free(to_memory);
    lac_case_free(c);
    (void)unlink(path);
}

static bool at_once(void *context)
{
    (void)context;
    return true;
}

static void test_options(void **state)
{
    (void)state;
    const lac_override sets[] = {{"analysis.rg.critical_fraction", "0.25"}, {"time.end", "1 s"}};
    lac_case *c = read_block(2, sets);
    lac_simulation_options options = lac_simulation_options_default();
    lac_simulation *simulation = NULL;
    lac_error err = {0};
    observation s = {0};
    const lac_sink sink = sink_of(&s);
    const int before = omp_get_max_threads();
    options.threads = before + 2;
    simulation = create(c, &options);
    assert_int_equal(omp_get_max_threads(), before);
    assert_int_equal(lac_simulation_run(simulation, &sink, NULL), LAC_OK);
    assert_int_equal(s.threads, before + 2);
    assert_int_equal(omp_get_max_threads(), before);
    lac_simulation_free(simulation);

    // a program made for fewer options: its structure ends after `context`
    options.interrupted = at_once;
    options.size = offsetof(lac_simulation_options, progress);
    simulation = create(c, &options);
    assert_int_equal(lac_simulation_run(simulation, &sink, NULL), LAC_EINTERRUPT);
    assert_int_equal(s.threads, before);
    assert_string_equal(lac_simulation_outcome(simulation)->status, "interrupted");
    lac_simulation_free(simulation);

    const size_t wrong[] = {0, sizeof options + 1};
    for (size_t i = 0; i < 2; i++) {
        options.size = wrong[i];
        assert_int_equal(lac_simulation_create(c, &options, &simulation, &err), LAC_EINPUT);
        assert_null(simulation);
        assert_non_null(strstr(err.message, "lac_simulation_options_default"));
    }
    lac_case_free(c);
}

// What cannot start is refused before a file would be begun.
static void test_cannot_start(void **state)
{
    (void)state;
    const lac_override set = {"time.failure.mean_slip_rate", "1 mm/year"};
    lac_case *c = read_block(1, &set);
    lac_simulation *simulation = NULL;
    lac_error err = {0};
    assert_int_equal(lac_simulation_create(c, NULL, &simulation, &err), LAC_EINPUT);
    assert_null(simulation);
    assert_non_null(strstr(err.message, "is not below that of failure"));
    lac_case_free(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_accuracy),
        cmocka_unit_test(test_own_sink),
        cmocka_unit_test(test_file),
        cmocka_unit_test(test_options),
        cmocka_unit_test(test_cannot_start),
        cmocka_unit_test(test_kept),
        cmocka_unit_test(test_tape_is_bounded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
