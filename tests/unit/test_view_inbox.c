// SPDX-License-Identifier: GPL-3.0-or-later
// What a run hands over to who looks at it: all of it, in order; what does not fit is known to
// miss.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
// cmocka needs the headers above first
#include <cmocka.h>

#include "cli/view_inbox.h"
#include "lacuna/store.h"

enum { CELLS = 3, MOST = 8 };

// What came out, in its order.
typedef struct seen {
    size_t records, snapshots, events;
    double time[MOST], slip[MOST], rate[MOST];
    lac_status answer;
} seen;

static lac_status see_record(void *context, const lac_record *record, lac_error *err)
{
    seen *all = context;
    (void)err;
    all->time[all->records++] = record->time_local + (record->extra != NULL ? record->extra[0] : 0);
    return all->answer;
}

static lac_status see_snapshot(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    seen *all = context;
    (void)err;
    all->slip[all->snapshots] = snapshot->slip != NULL ? snapshot->slip[CELLS - 1] : -1;
    all->rate[all->snapshots++] = snapshot->slip_rate[CELLS - 1];
    return all->answer;
}

static lac_status see_event(void *context, const lac_event *event, lac_error *err)
{
    seen *all = context;
    (void)event;
    (void)err;
    all->events++;
    return all->answer;
}

static lac_sink sink_of(seen *all)
{
    return (lac_sink){
        .context = all, .record = see_record, .snapshot = see_snapshot, .event = see_event};
}

// One of each, to who stores them and to the inbox.
static void put(cli_inbox *inbox, double time)
{
    const double extra[1] = {0.5}, rate[CELLS] = {1, 2, time};
    const lac_sink in = cli_inbox_sink(inbox);
    assert_int_equal(in.record(in.context, &(lac_record){.time_local = time, .extra = extra}, NULL),
                     LAC_OK);
    assert_int_equal(
        in.snapshot(in.context, &(lac_snapshot){.time = time, .slip_rate = rate}, NULL), LAC_OK);
    assert_int_equal(in.event(in.context, &(lac_event){0}, NULL), LAC_OK);
}

static void begin(cli_inbox *inbox, seen *stored)
{
    assert_true(cli_inbox_create(inbox));
    inbox->extras = 1;
    inbox->cells = CELLS;
    inbox->fields = LAC_FIELD_RATE;
    inbox->next = sink_of(stored);
}

static size_t empty(cli_inbox *inbox, seen *out)
{
    lac_progress progress;
    bool moved;
    const lac_sink sink = sink_of(out);
    return cli_inbox_empty(inbox, &sink, &progress, &moved);
}

static void all_comes_through(void **state)
{
    cli_inbox inbox;
    seen stored = {0}, out = {0};
    (void)state;
    begin(&inbox, &stored);
    put(&inbox, 7);
    put(&inbox, 9);
    assert_int_equal(empty(&inbox, &out), 6);
    assert_int_equal(out.records + out.snapshots + out.events, 6);
    assert_true(out.time[0] == 7.5 && out.time[1] == 9.5);
    assert_true(out.slip[1] == -1 && out.rate[0] == 7 && out.rate[1] == 9);
    assert_int_equal(empty(&inbox, &out), 0);
    assert_false(cli_inbox_missing(&inbox));
    cli_inbox_clear(&inbox);
}

static void what_does_not_fit_is_known(void **state)
{
    cli_inbox inbox;
    seen stored = {0}, out = {0};
    (void)state;
    begin(&inbox, &stored);
    inbox.most = 1;
    put(&inbox, 7); // an empty inbox takes one, however large
    assert_int_equal(stored.events, 1);
    assert_int_equal(empty(&inbox, &out), 1);
    assert_int_equal(out.records, 1);
    assert_true(cli_inbox_missing(&inbox));
    cli_inbox_clear(&inbox);
}

static void what_is_not_taken_is_known(void **state)
{
    cli_inbox inbox;
    seen stored = {0}, out = {.answer = LAC_ENOMEM};
    (void)state;
    begin(&inbox, &stored);
    put(&inbox, 7);
    assert_false(cli_inbox_missing(&inbox));
    assert_int_equal(empty(&inbox, &out), 3);
    assert_true(cli_inbox_missing(&inbox));
    cli_inbox_clear(&inbox);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_comes_through),
        cmocka_unit_test(what_does_not_fit_is_known),
        cmocka_unit_test(what_is_not_taken_is_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
