// SPDX-License-Identifier: GPL-3.0-or-later
// A run in memory as its page sees it while it goes on: read as a file is, thinned where it grows.
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "lacuna/simulation.h"
#include "report/report.h"
#include "store/store.h"
#include "store/store_file.h"
#include "support/test.h"

enum { CELLS = 4 };

static lac_recording *begin_as(lac_domain *domain, bool passing)
{
    static uint32_t index[CELLS] = {0, 1, 2, 3};
    static double pressure[CELLS] = {1, 2, 3, 4};
    lac_recording *recording = NULL;
    *domain = (lac_domain){.grid = {.nx = 2, .ny = 2, .dx = 1.0, .dy = 1.0},
                           .n = CELLS,
                           .index = index,
                           .pressure = pressure};
    const lac_recording_def def = {.domain = domain,
                                   .fields = LAC_FIELD_SLIP | LAC_FIELD_RATE,
                                   .events = true,
                                   .passing = passing};
    assert_int_equal(lac_recording_create(&def, &recording, NULL), LAC_OK);
    return recording;
}

static lac_recording *begin(lac_domain *domain) { return begin_as(domain, false); }

// A creep with one burst in its middle.
static void put_records(lac_recording *recording, size_t first, size_t n, size_t burst)
{
    const lac_sink sink = lac_recording_sink(recording);
    for (size_t i = first; i < first + n; i++) {
        const lac_record record = {.time_local = (double)i,
                                   .observation = {.mean_slip = 1e-6 * (double)i,
                                                   .mean_rate = i == burst ? 1.0 : 1e-6,
                                                   .max_rate = 1e-6,
                                                   .shear_force = 1.0,
                                                   .normal_force = 2.0},
                                   .step_size = 1.0};
        assert_int_equal(sink.record(sink.context, &record, NULL), LAC_OK);
    }
}

static void put_snapshot(lac_recording *recording, double time)
{
    const lac_sink sink = lac_recording_sink(recording);
    const double slip[CELLS] = {time, time + 1, time + 2, time + 3}, rate[CELLS] = {1, 1, 1, 1};
    const lac_snapshot snapshot = {.time = time, .slip = slip, .slip_rate = rate};
    assert_int_equal(sink.snapshot(sink.context, &snapshot, NULL), LAC_OK);
}

typedef struct variable {
    size_t count;
    const double *values;
} variable;

static variable find(const lac_recording *recording, const char *name)
{
    const lac_dataset *all = lac_recording_dataset(recording);
    assert_non_null(lac_dataset_unit(all, name));
    return (variable){lac_dataset_count(all, name), lac_dataset_array(all, name)};
}

static void test_read_as_a_file(void **state)
{
    (void)state;
    lac_domain domain;
    lac_recording *recording = begin(&domain);
    lac_stored_file *file = NULL;
    lac_stored_values values = {0};
    lac_error err = {0};
    char text[8];
    put_records(recording, 0, 5, 2);
    put_snapshot(recording, 10);
    put_snapshot(recording, 20);
    assert_int_equal(lac_recording_text(recording, "title", "old", NULL), LAC_OK);
    assert_int_equal(lac_recording_text(recording, "title", "A joint", NULL), LAC_OK);
    assert_int_equal(lac_stored_file_of(recording, &file, NULL), LAC_OK);
    assert_int_equal(lac_stored_file_values(file, "slip_rate", &values, NULL), LAC_OK);
    assert_true(values.n == 5 && values.width == 1 && values.value[2] == 1.0);
    lac_stored_values_clear(&values);
    assert_int_equal(lac_stored_file_row(file, "cell_slip", 1, &values, NULL), LAC_OK);
    assert_true(values.n == 1 && values.width == CELLS && values.value[3] == 23.0);
    lac_stored_values_clear(&values);
    assert_int_equal(lac_stored_file_row(file, "cell_slip", 2, &values, &err), LAC_EINPUT);
    assert_int_equal(lac_stored_file_values(file, "event_time", &values, NULL), LAC_OK);
    assert_true(values.value == NULL && values.n == 0); // none yet
    assert_int_equal(lac_stored_file_values(file, "no_such", &values, NULL), LAC_OK);
    assert_null(values.value);
    assert_true(lac_stored_file_text(file, NULL, "title", text, sizeof text));
    assert_string_equal(text, "A joint");
    assert_false(lac_stored_file_text(file, NULL, "title", text, 7)); // no room
    assert_false(lac_stored_file_text(file, NULL, "case", text, sizeof text));
    lac_stored_file_close(file);
    lac_recording_free(recording);
}

// Names and attributes of variables, as a file has them.
static void test_variables_as_of_a_file(void **state)
{
    (void)state;
    lac_domain domain;
    lac_recording *recording = begin(&domain);
    lac_stored_file *file = NULL;
    char text[64];
    size_t count = 0;
    put_records(recording, 0, 1, 0);
    assert_int_equal(lac_stored_file_of(recording, &file, NULL), LAC_OK);
    (void)lac_stored_file_text(file, "slip_rate", "units", text, sizeof text);
    assert_string_equal(text, "m s-1");
    (void)lac_stored_file_text(file, "slip_rate", "units", text, 5);
    assert_string_equal(text, ""); // no room
    (void)lac_stored_file_text(file, "x", "long_name", text, sizeof text);
    assert_string_equal(text, "position of the cell's centre along x");
    (void)lac_stored_file_text(file, "slip_rate", "case_key", text, sizeof text);
    assert_string_equal(text, "");
    (void)lac_stored_file_text(file, "no_such", "units", text, sizeof text);
    assert_string_equal(text, "");
    assert_true(isnan(lac_stored_file_number(file, "slip_rate", "best_fit")));
    for (; lac_stored_file_variable(file, count, text, sizeof text); count++) {
        assert_string_equal(text, lac_dataset_name(lac_recording_dataset(recording), count));
    }
    assert_true(count > 10);
    assert_false(lac_stored_file_variable(file, 0, text, 1));
    lac_stored_file_close(file);
    lac_recording_free(recording);
}

static void put_event(lac_recording *recording, double time)
{
    const lac_sink sink = lac_recording_sink(recording);
    const lac_event event = {.time_local = time, .cells = 3};
    assert_int_equal(sink.event(sink.context, &event, NULL), LAC_OK);
}

static void expect_same(const lac_recording *a, const lac_recording *b)
{
    const char *name;
    for (size_t v = 0; (name = lac_dataset_name(lac_recording_dataset(a), v)) != NULL; v++) {
        const variable observation = find(a, name), other = find(b, name);
        assert_int_equal(observation.count, other.count);
        if (observation.count > 0) {
            assert_memory_equal(observation.values, other.values,
                                observation.count * sizeof(double));
        }
    }
}

// What two recordings hand on, in three parts, is what one holds that had it all.
static void test_handed_on(void **state)
{
    (void)state;
    lac_domain domain;
    lac_recording *direct = begin(&domain), *whole = begin(&domain);
    lac_recording *coming = begin_as(&domain, true), *taken = begin_as(&domain, true);
    assert_null(lac_dataset_unit(lac_recording_dataset(coming), "pressure"));
    for (size_t part = 0; part < 3; part++) {
        lac_recording *const both[] = {direct, coming};
        for (size_t i = 0; i < 2; i++) {
            // The last instant of the part before comes again.
            put_records(both[i], 4 * part, 5, 6);
            if (part < 2) { // nothing of these comes last
                put_snapshot(both[i], 10.0 * (double)(part + 1));
                put_event(both[i], (double)part);
            }
        }
        assert_int_equal(lac_recording_move(taken, coming, NULL), LAC_OK);
        assert_int_equal(find(coming, "time").count, 0);
        assert_int_equal(find(taken, "time").count, part == 0 ? 5 : 4);
        assert_int_equal(lac_recording_move(whole, taken, NULL), LAC_OK);
        assert_int_equal(lac_recording_move(whole, taken, NULL), LAC_OK); // nothing
        expect_same(direct, whole);
    }
    assert_int_equal(find(whole, "time").count, 13);
    assert_int_equal(find(whole, "cell_slip").count, 2 * CELLS);
    lac_recording_free(taken);
    lac_recording_free(coming);
    lac_recording_free(whole);
    lac_recording_free(direct);
}

static void test_thinned_by_hand(void **state)
{
    (void)state;
    lac_domain domain;
    lac_recording *recording = begin(&domain);
    const uint8_t records[] = {1, 0, 1, 0, 1}, snapshots[] = {0, 1};
    put_records(recording, 0, 5, 2);
    put_snapshot(recording, 10);
    put_snapshot(recording, 20);
    lac_recording_thin(recording, "time", records);
    lac_recording_thin(recording, "snapshot", snapshots);
    lac_recording_thin(recording, "event", NULL); // there is none
    assert_int_equal(find(recording, "time").count, 3);
    assert_true(find(recording, "time").values[1] == 2.0);
    assert_true(find(recording, "slip_rate").values[1] == 1.0);
    assert_int_equal(find(recording, "cell_slip").count, CELLS);
    assert_true(find(recording, "cell_slip").values[0] == 20.0);
    assert_int_equal(find(recording, "pressure").count, CELLS); // runs over cells
    put_records(recording, 5, 1, 2);
    assert_true(find(recording, "time").values[3] == 5.0);
    lac_recording_free(recording);
}

// However long a run is, what is kept of it stays below a bound, and no peak is lost.
static void test_memory_stays_bounded(void **state)
{
    (void)state;
    lac_domain domain;
    lac_recording *recording = begin(&domain);
    size_t most_records = 0, most_shots = 0;
    for (size_t i = 0; i < 200; i++) {
        put_records(recording, 1000 * i, 1000, 77777);
        put_snapshot(recording, (double)(1000 * i));
        assert_int_equal(lac_page_thin_recording(recording, NULL), LAC_OK);
        const size_t n = find(recording, "time").count, s = find(recording, "snapshot_time").count;
        most_records = n > most_records ? n : most_records;
        most_shots = s > most_shots ? s : most_shots;
    }
    const variable time = find(recording, "time"), rate = find(recording, "slip_rate");
    assert_in_range(most_records, 40000, 60000);
    assert_in_range(most_shots, 60, 80);
    assert_true(time.values[0] == 0.0 && time.values[time.count - 1] == 199999.0);
    double peak = 0.0;
    for (size_t i = 0; i < time.count; i++) {
        peak = fmax(peak, rate.values[i]);
        assert_true(i == 0 || time.values[i] > time.values[i - 1]);
    }
    assert_true(peak == 1.0);
    const variable shots = find(recording, "snapshot_time"), slip = find(recording, "cell_slip");
    assert_int_equal(slip.count, CELLS * shots.count);
    for (size_t i = 0; i < shots.count; i++) {
        assert_true(slip.values[CELLS * i] == shots.values[i]);
    }
    assert_true(shots.values[0] == 0.0 && shots.values[shots.count - 1] == 199000.0);
    lac_recording_free(recording);
}

static void test_data_from_memory(void **state)
{
    (void)state;
    lac_domain domain;
    lac_recording *recording = begin(&domain);
    lac_error err = {0};
    char *json = NULL;
    const lac_page_def def = {
        .run = "x.nc", .recording = recording, .made_by = "test", .issues = -1};
    assert_int_equal(lac_page_data(&def, &json, &err), LAC_EINPUT); // no record yet
    assert_null(json);
    put_records(recording, 0, 9, 4);
    assert_int_equal(lac_page_data(&def, &json, &err), LAC_OK);
    assert_non_null(strstr(json, "\"rate\":[1e-06,1e-06,1e-06,1e-06,1,1e-06,"));
    assert_null(strstr(json, "\"forecasts\""));
    free(json);
    lac_recording_free(recording);
}

static void test_live_page(void **state)
{
    (void)state;
    char *html = NULL;
    assert_int_equal(lac_page_live_page("0123abcd", &html, NULL), LAC_OK);
    assert_null(strstr(html, "<script>"));
    assert_null(strstr(html, "<style>"));
    assert_null(strstr(html, "@DATA@"));
    assert_non_null(strstr(html, "<script nonce=\"0123abcd\">"));
    assert_non_null(strstr(html, "<style nonce=\"0123abcd\">"));
    assert_non_null(strstr(html, "{\"live\":true}</script>"));
    free(html);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read_as_a_file),
        cmocka_unit_test(test_variables_as_of_a_file),
        cmocka_unit_test(test_handed_on),
        cmocka_unit_test(test_thinned_by_hand),
        cmocka_unit_test(test_memory_stays_bounded),
        cmocka_unit_test(test_data_from_memory),
        cmocka_unit_test(test_live_page),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
