// SPDX-License-Identifier: GPL-3.0-or-later
#include <string.h>

#include "lacuna/error.h"
#include "support/test.h"

static void message_is_built(void **state)
{
    (void)state;
    lac_error err;
    assert_int_equal(lac_fail(&err, LAC_EINPUT, "cell %d is %s", 3, "odd"), LAC_EINPUT);
    assert_string_equal(err.message, "cell 3 is odd");
    assert_int_equal(lac_fail_within(&err, LAC_EINPUT, "case %s", "x.yaml"), LAC_EINPUT);
    assert_string_equal(err.message, "case x.yaml: cell 3 is odd");
    assert_int_equal(lac_fail_within(&err, LAC_EINPUT, "run"), LAC_EINPUT);
    assert_int_equal(lac_fail_within(&err, LAC_EINPUT, "case %s", "x.yaml"), LAC_EINPUT); // again
    assert_int_equal(lac_fail_within(&err, LAC_EINPUT, "un"), LAC_EINPUT); // is not there yet
    assert_string_equal(err.message, "un: run: case x.yaml: cell 3 is odd");
    assert_int_equal(lac_fail(NULL, LAC_EIO, "dropped"), LAC_EIO);
}

static void long_message_is_cut_at_its_end(void **state)
{
    (void)state;
    lac_error err;
    char text[3000];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    lac_fail(&err, LAC_EIO, "%s", text);
    assert_int_equal(strlen(err.message), sizeof err.message - 1);
    lac_fail_within(&err, LAC_EIO, "where");
    assert_memory_equal(err.message, "where: xxx", 10);
    assert_int_equal(strlen(err.message), sizeof err.message - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(message_is_built),
        cmocka_unit_test(long_message_is_cut_at_its_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
