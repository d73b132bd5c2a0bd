// SPDX-License-Identifier: GPL-3.0-or-later
// What the page of a run is made with: thinning, JSON, squares of cells.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report/run.h"
#include "support/test.h"

enum { N = 20000, BUCKETS = 50 };

static void test_thinning_keeps_ends_and_peaks(void **state)
{
    (void)state;
    static double time[N], before[N], flat[N], spiked[N];
    static uint8_t keep[N];
    const double *const columns[] = {flat, spiked, NULL};
    for (size_t i = 0; i < N; i++) {
        time[i] = 10.0 * (double)i;
        before[i] = 10.0 * (double)(N - 1 - i);
        spiked[i] = i == 777 ? 5.0 : i == 15001 ? -5.0 : i % 7 == 0 ? NAN : 0.0;
    }
    const size_t kept = lac_page_thin(N, time, before, BUCKETS, 3, columns, keep);
    assert_true(kept >= BUCKETS && kept <= (size_t)2 * BUCKETS * (2 + 2 * 2));
    assert_true(keep[0] && keep[N - 1] && keep[N - 2] && keep[777] && keep[15001]);
    size_t counted = 0;
    for (size_t i = 0; i < N; i++) {
        counted += keep[i];
    }
    assert_int_equal(counted, kept);
}

// A dip is kept as a peak is, wherever it is, of every column; and what is kept of a column turned
// upside down is the same.
static void test_thinning_keeps_dips_as_peaks(void **state)
{
    (void)state;
    static double time[N], before[N], column[3][N], turned[3][N];
    static uint8_t keep[N], of_turned[N];
    const double *const columns[] = {column[0], column[1], column[2]};
    const double *const others[] = {turned[0], turned[1], turned[2]};
    for (size_t i = 0; i < N; i++) {
        time[i] = 10.0 * (double)i;
        before[i] = 10.0 * (double)(N - 1 - i);
    }
    for (size_t place = 131; place + 1 < N; place += 397) {
        for (size_t c = 0; c < 3; c++) {
            const size_t dip = place + c; // neighbours: a border of a bucket cannot keep all three
            for (size_t i = 0; i < N; i++) {
                column[c][i] = i == dip ? -9.0 : sin(0.37 * (double)i + (double)c);
                turned[c][i] = -column[c][i];
            }
        }
        const size_t kept = lac_page_thin(N, time, before, BUCKETS, 3, columns, keep);
        assert_int_equal(lac_page_thin(N, time, before, BUCKETS, 3, others, of_turned), kept);
        assert_memory_equal(keep, of_turned, N);
        assert_true(keep[place] && keep[place + 1] && keep[place + 2]);
    }
}

static void test_few_records_are_all_kept(void **state)
{
    (void)state;
    const double time[] = {0.0, 0.0, 0.0}, before[] = {0.0, 0.0, 0.0};
    uint8_t keep[3] = {0};
    assert_int_equal(lac_page_thin(3, time, before, BUCKETS, 0, NULL, keep), 3);
    assert_int_equal(lac_page_thin(1, time, before, BUCKETS, 0, NULL, keep), 1);
    // all at one time: two of them do
    static double same[N];
    static uint8_t of_same[N];
    assert_true(lac_page_thin(N, same, same, BUCKETS, 0, NULL, of_same) <= 4);
    assert_true(of_same[0] && of_same[N - 1]);
}

static void test_text_is_json_that_ends_no_script(void **state)
{
    (void)state;
    char *text = NULL;
    size_t size;
    lac_page page = {.json = {.out = open_memstream(&text, &size), .page = true}};
    lac_json *json = &page.json;
    const double column[] = {1.0, NAN, -INFINITY, 1e-300};
    const uint8_t keep[] = {1, 1, 1, 1};
    const uint8_t bytes[] = {0, 255, 16, 1};
    assert_non_null(json->out);
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "a", "</script>\"\\\n\x01\u202e\xff");
    lac_json_text(json, "b", NULL);
    lac_json_boolean(json, "c", true);
    lac_page_column(&page, "d", 4, column, keep, 6);
    lac_json_bytes(json, "e", bytes, 4);
    lac_json_bytes(json, "f", bytes, 0);
    lac_json_close(json, '}');
    assert_false(json->broken);
    assert_int_equal(fclose(json->out), 0);
    assert_string_equal(text,
                        "{\"a\":\"\\u003c/script>\\u0022\\u005c\\u000a\\u0001?\\ufffd\",\"b\":null,"
                        "\"c\":true,\"d\":[1,null,null,1e-300],\"e\":\"AP8QAQ==\",\"f\":\"\"}");
    free(text);
}

static void test_squares_summarise_their_cells(void **state)
{
    (void)state;
    uint32_t square[] = {0, 0, 1, 1, 2}, count[] = {2, 2, 1};
    const lac_page_raster raster = {.cells = 5, .squares = 3, .square = square, .count = count};
    const double value[] = {1.0, 3.0, NAN, 4.0, NAN};
    double out[3];
    lac_page_raster_summarise(&raster, LAC_PAGE_MOST, value, 0.0, out);
    assert_true(out[0] == 3.0 && out[1] == 4.0 && isnan(out[2]));
    lac_page_raster_summarise(&raster, LAC_PAGE_MEAN, value, 0.0, out);
    assert_true(out[0] == 2.0 && isnan(out[1]) && isnan(out[2]));
    lac_page_raster_summarise(&raster, LAC_PAGE_SHARE_ABOVE, value, 3.0, out);
    assert_true(out[0] == 0.5 && out[1] == 0.5 && isnan(out[2]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_thinning_keeps_ends_and_peaks),
        cmocka_unit_test(test_thinning_keeps_dips_as_peaks),
        cmocka_unit_test(test_few_records_are_all_kept),
        cmocka_unit_test(test_text_is_json_that_ends_no_script),
        cmocka_unit_test(test_squares_summarise_their_cells),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
