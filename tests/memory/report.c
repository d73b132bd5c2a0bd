// SPDX-License-Identifier: GPL-3.0-or-later
#include "memory/report.h"
#include "base/fail.h"
#include "lacuna/simulation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fit/fit.h"
#include "memory/failing_malloc.h"
#include "memory/whole_run.h"
#include "report/report.h"
#include "support/test.h"

enum { READINGS = 8, TIMES = 3, DRAWS = 4 };

static const double start = 1577836800.0; // of whole_run: 2020-01-01
static char run[] = "/tmp/lacuna-report-run-XXXXXX";
static char events[] = "/tmp/lacuna-report-events-XXXXXX";
static char fit[] = "/tmp/lacuna-report-fit-XXXXXX";

static void make_name(char *name)
{
    const int fd = mkstemp(name);
    assert_true(fd >= 0);
    (void)close(fd);
}

static lac_status store_fit(lac_error *err)
{
    static double x[DRAWS] = {1.0, 2.0, 3.0, 4.0};
    static const double failure[DRAWS] = {90.0, 70.0, NAN, 80.0};
    static const double time[TIMES] = {0.0, 30.0, 60.0}, fitted[TIMES] = {0.0, 1e-6, 2e-6};
    static double band[LAC_FIT_QUANTILES * TIMES];
    const lac_chain chain = {
        .dimension = 1, .walkers = 2, .steps = 2, .x = x, .log_density = x, .acceptance = x};
    const lac_fit_result result = {
        .parameters = 1,
        .unknowns = 1,
        .unknown = {{.key = "friction.aging.dc", .unit = "m", .best = 2.0}},
        .chain = &chain,
        .times = TIMES,
        .time = time,
        .displacement = band,
        .rate = band,
        .fitted = fitted,
        .readings = TIMES,
        .reading_time = time,
        .observed = fitted,
        .draws = DRAWS,
        .draw_failure = failure};
    const lac_case source = {.dated = true, .start_date = start};
    const lac_provenance provenance = {.title = "fitted", .seed = 1};
    lac_dataset *dataset = NULL;
    lac_status status =
        lac_fit_describe(&(lac_fit_outcome){&source, &result, "complete"}, &dataset, err);
    if (status == LAC_OK) {
        status = lac_store_dataset(fit, true, &provenance, dataset, err);
    }
    lac_dataset_free(dataset);
    return status;
}

void report_prepare(void)
{
    lac_error err = {""};
    make_name(run);
    make_name(events);
    make_name(fit);
    assert_int_equal(whole_run(run, &err), LAC_OK);
    assert_int_equal(whole_resumed(events, &err), LAC_OK);
    assert_int_equal(store_fit(&err), LAC_OK);
}

void report_remove(void)
{
    (void)unlink(run);
    (void)unlink(events);
    (void)unlink(fit);
}

lac_status whole_report(const char *path, lac_error *err)
{
    double time[READINGS], displacement[READINGS];
    for (size_t i = 0; i < READINGS; i++) {
        time[i] = start + 2.0 * (double)i;
        displacement[i] = -1e-3 * log(10.0 - (double)i);
    }
    const lac_series series = {
        .n = READINGS, .dated = true, .time = time, .displacement = displacement};
    lac_page_def def = {
        .run = run, .series = &series, .series_name = "readings", .fit = fit, .made_by = "test"};
    lac_status status;
    LAC_TRY(lac_page_write(&def, path, true, err));
    def = (lac_page_def){.run = events, .made_by = "test"};
    LAC_TRY(lac_page_write(&def, path, true, err));
out:
    return status;
}

enum { CELLS = 2 };

// A recording with columns of every kind, and something in each.
static lac_status begin(lac_recording **recording, lac_error *err)
{
    static uint32_t index[CELLS] = {0, 1};
    static double pressure[CELLS] = {1.0, 2.0};
    static const lac_extra extra = {
        .name = "own", .unit = "1", .long_name = "own", .comment = "c", .over = LAC_OVER_TIME};
    const lac_domain domain = {.grid = {.nx = CELLS, .ny = 1, .dx = 1.0, .dy = 1.0},
                               .n = CELLS,
                               .index = index,
                               .pressure = pressure};
    const lac_recording_def def = {.domain = &domain,
                                   .fields = LAC_FIELD_SLIP | LAC_FIELD_RATE,
                                   .extras = 1,
                                   .extra = &extra,
                                   .events = true};
    return lac_recording_create(&def, recording, err);
}

// The i-th of everything.
static lac_status put(lac_recording *recording, size_t i, lac_error *err)
{
    const lac_sink sink = lac_recording_sink(recording);
    const double own = (double)i, field[CELLS] = {own, own};
    const lac_record record = {
        .time_local = own,
        .observation = {.mean_rate = 1.0, .max_rate = 1.0, .normal_force = 1.0},
        .extra = &own};
    const lac_snapshot snapshot = {.time = own, .slip = field, .slip_rate = field};
    const lac_event event = {.time_local = own, .x = own, .size = own};
    lac_status status;
    LAC_TRY(sink.record(sink.context, &record, err));
    LAC_TRY(sink.snapshot(sink.context, &snapshot, err));
    LAC_TRY(sink.event(sink.context, &event, err));
out:
    return status;
}

static size_t count_of(const lac_recording *recording, const char *name)
{
    assert_non_null(lac_dataset_unit(lac_recording_dataset(recording), name));
    return lac_dataset_count(lac_recording_dataset(recording), name);
}

// All columns along a dimension have the values of the same places.
static void check_whole(const lac_recording *recording)
{
    static const struct {
        const char *first, *other;
        size_t width;
    } pairs[] = {{"time", "time_local", 1},
                 {"time", "own", 1},
                 {"snapshot_time", "cell_slip", CELLS},
                 {"snapshot_time", "cell_slip_rate", CELLS},
                 {"event_time", "event_x", 1},
                 {"event_time", "event_size", 1}};
    const lac_dataset *all = lac_recording_dataset(recording);
    for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
        const double *first = lac_dataset_array(all, pairs[k].first);
        const double *other = lac_dataset_array(all, pairs[k].other);
        const size_t n = count_of(recording, pairs[k].first);
        assert_int_equal(count_of(recording, pairs[k].other), n * pairs[k].width);
        for (size_t i = 0; i < n * pairs[k].width; i++) {
            assert_true(other[i] == first[i / pairs[k].width]);
        }
    }
}

// What memory does not suffice for is left out whole: of a run that is looked at while it goes on
// nobody else would see that a column is short. The same record may come again.
void recording_stays_whole(void)
{
    bool fails = true;
    for (long k = 0; fails; k++) {
        lac_recording *recording = NULL;
        assert_int_equal(begin(&recording, NULL), LAC_OK);
        fail_allocation(k, false);
        const lac_status status = put(recording, 0, NULL);
        fails = stop_failing();
        assert_int_equal(status, fails ? LAC_ENOMEM : LAC_OK);
        check_whole(recording);
        assert_int_equal(put(recording, 0, NULL), LAC_OK);
        check_whole(recording);
        assert_int_equal(count_of(recording, "time"), 1);
        lac_recording_free(recording);
    }
}

// Of what is handed on and does not fit nothing is left, and all before it; later parts fit again.
void recording_is_handed_on_whole(void)
{
    bool fails = true;
    for (long k = 0; fails; k++) {
        lac_recording *recording = NULL, *from = NULL;
        assert_int_equal(begin(&recording, NULL), LAC_OK);
        assert_int_equal(begin(&from, NULL), LAC_OK);
        assert_int_equal(put(from, 0, NULL), LAC_OK);
        fail_allocation(0, false); // where there was nothing none is needed
        assert_int_equal(lac_recording_move(recording, from, NULL), LAC_OK);
        assert_false(stop_failing());
        assert_int_equal(put(from, 1, NULL), LAC_OK);
        fail_allocation(k, false);
        const lac_status status = lac_recording_move(recording, from, NULL);
        fails = stop_failing();
        assert_int_equal(status, fails ? LAC_ENOMEM : LAC_OK);
        assert_int_equal(count_of(recording, "time"), fails ? 1 : 2);
        check_whole(recording);
        check_whole(from);
        assert_int_equal(count_of(from, "time"), 0);
        assert_int_equal(put(from, 2, NULL), LAC_OK);
        assert_int_equal(lac_recording_move(recording, from, NULL), LAC_OK);
        assert_int_equal(count_of(recording, "event_time"), fails ? 2 : 3);
        check_whole(recording);
        lac_recording_free(from);
        lac_recording_free(recording);
    }
}

lac_status whole_live(const char *path, lac_error *err)
{
    enum { PUT = 90 }; // more snapshots than a page keeps
    lac_recording *recording = NULL, *before = NULL;
    char *json = NULL, *html = NULL;
    lac_status status;
    (void)path;
    LAC_TRY(begin(&recording, err));
    LAC_TRY(lac_recording_text(recording, "title", "live", err));
    for (size_t i = 0; i < PUT; i++) {
        LAC_TRY(put(recording, i, err));
    }
    LAC_TRY(lac_page_thin_recording(recording, err));
    const lac_page_def def = {.run = "x.nc", .recording = recording, .made_by = "test"};
    LAC_TRY(lac_page_data(&def, &json, err));
    LAC_TRY(lac_page_live_page("00", &html, err));
    LAC_TRY(lac_recording_create(&(lac_recording_def){0}, &before, err));
    LAC_TRY(lac_recording_load(before, run, &(lac_checkpoint_file){.records = 2}, err));
out:
    free(html);
    free(json);
    lac_recording_free(before);
    lac_recording_free(recording);
    return status;
}
