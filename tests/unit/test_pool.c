// SPDX-License-Identifier: GPL-3.0-or-later
// The pool of processes, by what its tasks give, break and leave; and what is kept of them, torn at
// every byte.
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "cli/common/keep.h"
#include "cli/common/pool.h"
#include "support/scratch.h"
#include "support/test.h"

enum { TASKS = 200, SIZE = 6000 }; // more than a pipe takes at once

// Bytes that follow from the task alone.
typedef struct made {
    size_t task;
    pid_t by;
    unsigned char of[SIZE];
} made;

typedef struct job {
    cli_pool pool;
    size_t next, last, broken;
    int times[TASKS];
    int signal[TASKS];
    pid_t by[TASKS];
    double cpu[TASKS], memory[TASKS];
    cli_progress progress;
    lac_status fails;
} job;

static size_t next(void *context)
{
    job *j = context;
    return j->next < j->last ? j->next++ : CLI_POOL_NONE;
}

static lac_status work(void *context, size_t task, void *result, lac_error *err)
{
    const job *j = context;
    made *m = result;
    if (task == j->broken) {
        (void)raise(SIGKILL);
    }
    if (task == 7 && j->fails != LAC_OK) {
        return lac_fail(err, j->fails, "task %zu failed", task);
    }
    m->task = task;
    m->by = getpid();
    memset(m->of, (int)(task * 31 % 251), SIZE);
    return LAC_OK;
}

static lac_status take(void *context, size_t task, const void *result, const cli_pool_end *end,
                       lac_error *err)
{
    job *j = context;
    const made *m = result;
    (void)err;
    j->times[task]++;
    j->signal[task] = end->signal;
    j->cpu[task] = end->cpu_time;
    j->memory[task] = end->memory;
    assert_int_equal(end->answered, m != NULL);
    if (m != NULL) {
        j->by[task] = m->by;
        assert_int_equal(m->task, task);
        for (size_t i = 0; i < SIZE; i++) {
            assert_int_equal(m->of[i], task * 31 % 251);
        }
    }
    return LAC_OK;
}

static lac_status run(job *j, size_t tasks, int jobs, bool fresh, lac_error *err)
{
    j->last = tasks;
    j->pool = (cli_pool){"tasks", tasks,        0, sizeof(made), jobs, fresh, -1,
                         0.0,     &j->progress, j, next,         work, take,  j->pool.limit};
    return cli_pool_run(&j->pool, err);
}

// Every task is taken over once, and workers are as many as asked for, begun again only where one
// broke down.
static void all_tasks(void **state)
{
    (void)state;
    for (int jobs = 1; jobs <= 3; jobs += 2) {
        for (int broken = 0; broken <= 1; broken++) {
            job j = {.broken = broken != 0 ? 20 : SIZE_MAX};
            lac_error err = {""};
            assert_int_equal(run(&j, TASKS, jobs, false, &err), LAC_OK);
            pid_t seen[TASKS];
            size_t workers = 0;
            for (size_t i = 0; i < TASKS; i++) {
                size_t k = 0;
                assert_int_equal(j.times[i], 1);
                assert_int_equal(j.signal[i], i == j.broken ? SIGKILL : 0);
                while (k < workers && seen[k] != j.by[i]) {
                    k++;
                }
                if (k == workers && i != j.broken) {
                    seen[workers++] = j.by[i];
                }
            }
            assert_in_range(workers, 1, (size_t)(jobs + broken));
            assert_int_equal(j.pool.done, TASKS);
        }
    }
}

// A process each has its own time and memory, and its own end.
static void process_a_task(void **state)
{
    (void)state;
    job j = {.broken = 3};
    lac_error err = {""};
    assert_int_equal(run(&j, 12, 2, true, &err), LAC_OK);
    for (size_t i = 0; i < 12; i++) {
        assert_int_equal(j.times[i], 1);
        assert_int_equal(j.signal[i], i == 3 ? SIGKILL : 0);
        assert_true(isfinite(j.cpu[i]) && j.memory[i] > 1e5);
        for (size_t k = 0; k < i && i != 3; k++) {
            assert_int_not_equal(j.by[i], j.by[k]);
        }
    }
}

static lac_status spin(void *context, size_t task, void *result, lac_error *err)
{
    const clock_t begun = clock();
    while (task == 1 && clock() - begun < 20 * CLOCKS_PER_SEC) {
    }
    return work(context, task, result, err);
}

static double a_second(void *context, size_t task)
{
    (void)context;
    return task == 1 ? 1.0 : INFINITY;
}

static void limit_of_time(void **state)
{
    (void)state;
    job j = {.broken = SIZE_MAX, .last = 3};
    lac_error err = {""};
    j.pool = (cli_pool){.what = "tasks",
                        .total = 3,
                        .size = sizeof(made),
                        .jobs = 2,
                        .fresh = true,
                        .journal = -1,
                        .progress = &j.progress,
                        .context = &j,
                        .next = next,
                        .work = spin,
                        .take = take,
                        .limit = a_second};
    assert_int_equal(cli_pool_run(&j.pool, &err), LAC_OK);
    assert_int_equal(j.signal[1], SIGXCPU);
    assert_int_equal(j.signal[0] + j.signal[2], 0);
}

// A task whose status is not LAC_OK ends the pool; no process is left.
static void an_error(void **state)
{
    (void)state;
    for (int fresh = 0; fresh <= 1; fresh++) {
        job j = {.broken = SIZE_MAX, .fails = LAC_EIO};
        lac_error err = {""};
        assert_int_equal(run(&j, 50, 2, fresh != 0, &err), LAC_EIO);
        assert_string_equal(err.message, "task 7 failed");
        assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
        assert_int_equal(errno, ECHILD);
    }
}

static void words(void **state)
{
    (void)state;
    int jobs = 0;
    lac_error err = {""};
    assert_int_equal(cli_pool_jobs("64", &jobs, &err), LAC_OK);
    assert_int_equal(jobs, 64);
    assert_int_equal(cli_pool_jobs(NULL, &jobs, &err), LAC_OK);
    assert_in_range(jobs, 1, 64);
    for (const char *const *bad = (const char *const[]){"", "0", "65", "-1", "2x", NULL};
         *bad != NULL; bad++) {
        assert_int_equal(cli_pool_jobs(*bad, &jobs, &err), LAC_EINPUT);
    }
}

typedef struct taken {
    size_t n;
    uint64_t sum;
} taken;

static void count(void *context, uint64_t key, const void *content)
{
    taken *t = context;
    const made *m = content;
    assert_int_equal(m->task, key);
    t->n++;
    t->sum += key;
}

static cli_keep keep_of(uint64_t mark)
{
    return (cli_keep){"test", sizeof(made), mark, 0.0, "", NULL, 0.0};
}

// Whatever the file was torn to, whole records are taken over, and it goes on behind them.
static void torn(void **state)
{
    (void)state;
    scratch s;
    scratch_create(&s);
    lac_error err = {""};
    taken none = {0, 0};
    char out[128]; // longer than the last eight paths live
    (void)snprintf(out, sizeof out, "%s", scratch_path(&s, "out.nc"));
    cli_keep keep = keep_of(5);
    made m = {.task = 0};
    assert_int_equal(cli_keep_open(&keep, out, false, count, &none, &err), LAC_OK);
    for (size_t i = 0; i < 3; i++) {
        m.task = i + 1;
        assert_int_equal(cli_keep_add(&keep, i + 1, &m, &err), LAC_OK);
    }
    cli_keep_close(&keep, false);
    struct stat info;
    char done[300];
    (void)snprintf(done, sizeof done, "%s.runs/done", out);
    assert_int_equal(stat(done, &info), 0);
    const off_t record = (off_t)(16 + sizeof(made)), heading = info.st_size - 3 * record;
    size_t size = 0;
    unsigned char *whole = scratch_read(done, &size);
    for (off_t cut = heading; cut <= info.st_size; cut += 97) {
        taken got = {0, 0};
        keep = keep_of(5);
        (void)scratch_write(&s, "out.nc.runs/done", whole, (size_t)cut);
        assert_int_equal(cli_keep_open(&keep, out, true, count, &got, &err), LAC_OK);
        assert_int_equal(got.n, (cut - heading) / record);
        m.task = 9;
        assert_int_equal(cli_keep_add(&keep, 9, &m, &err), LAC_OK);
        cli_keep_close(&keep, false);
        taken again = {0, 0};
        keep = keep_of(5);
        assert_int_equal(cli_keep_open(&keep, out, true, count, &again, &err), LAC_OK);
        assert_int_equal(again.sum, got.sum + 9);
        cli_keep_close(&keep, false);
    }
    whole[heading + record + 100] ^= 1; // in the second record
    taken got = {0, 0};
    keep = keep_of(5);
    (void)scratch_write(&s, "out.nc.runs/done", whole, size);
    assert_int_equal(cli_keep_open(&keep, out, true, count, &got, &err), LAC_OK);
    assert_int_equal(got.n, 1);
    cli_keep_close(&keep, true);
    assert_int_equal(stat(done, &info), -1);
    free(whole);
    scratch_remove(&s);
}

static void another_s(void **state)
{
    (void)state;
    scratch s;
    scratch_create(&s);
    lac_error err = {""};
    taken none = {0, 0};
    const char *out = scratch_path(&s, "out.nc");
    cli_keep keep = keep_of(5), other = keep_of(6), whose = keep_of(5);
    whose.command = "trade";
    assert_int_equal(cli_keep_open(&keep, out, false, count, &none, &err), LAC_OK);
    assert_int_equal(cli_keep_open(&other, out, false, count, &none, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "another test is at work there"));
    cli_keep_close(&other, true); // takes nothing away
    cli_keep_close(&keep, false);
    assert_int_equal(cli_keep_open(&other, out, true, count, &none, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "is of another case"));
    cli_keep_close(&other, false);
    assert_int_equal(cli_keep_open(&whose, out, false, count, &none, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "was not written by trade"));
    assert_int_equal(cli_keep_open(&whose, out, true, count, &none, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "was not written by trade"));
    cli_keep_close(&whose, false);
    keep = keep_of(5);
    assert_int_equal(cli_keep_open(&keep, out, true, count, &none, &err), LAC_OK);
    assert_int_equal(none.n, 0);
    cli_keep_close(&keep, true);
    scratch_remove(&s);
}

int main(void)
{
    (void)signal(SIGPIPE, SIG_IGN); // as the program does
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_tasks),     cmocka_unit_test(process_a_task),
        cmocka_unit_test(limit_of_time), cmocka_unit_test(an_error),
        cmocka_unit_test(words),         cmocka_unit_test(torn),
        cmocka_unit_test(another_s),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
