// SPDX-License-Identifier: GPL-3.0-or-later
// What the pool of processes costs: members of a sweep (runs of cases/block.yaml, 2 kB each) made
// by its workers, with the journal, against the same in bare loops, one a process. Both in turn, so
// that a busy machine slows both.
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/common/keep.h"
#include "cli/common/pool.h"
#include "simulation/simulation.h"
#include "support/cost.h"

enum { MEMBERS = 2000, ROUNDS = 7 };

typedef struct member {
    double failure, series[256];
} member;

typedef struct job {
    lac_case *source;
    cli_keep keep;
    cli_progress progress;
    size_t next;
} job;

static void stop(const lac_error *err)
{
    fprintf(stderr, "bench_pool: %s\n", err->message);
    exit(1);
}

static size_t next(void *context)
{
    job *j = context;
    return j->next < MEMBERS ? j->next++ : CLI_POOL_NONE;
}

static lac_status work(void *context, size_t task, void *result, lac_error *err)
{
    const job *j = context;
    member *m = result;
    const lac_sink none = lac_sink_default();
    lac_simulation *simulation = NULL;
    (void)task;
    lac_status status = lac_simulation_create(j->source, NULL, &simulation, err);
    if (status == LAC_OK) {
        status = lac_simulation_run(simulation, &none, err);
        m->failure = lac_simulation_outcome(simulation)->run.failure_local;
    }
    lac_simulation_free(simulation);
    return status;
}

static lac_status take(void *context, size_t task, const void *result, const cli_pool_end *end,
                       lac_error *err)
{
    (void)end;
    return cli_keep_add(&((job *)context)->keep, task, result, err);
}

static void pooled(job *j, int jobs)
{
    lac_error err = {""};
    cli_pool pool = {.what = "members",
                     .total = MEMBERS,
                     .size = sizeof(member),
                     .jobs = jobs,
                     .progress = &j->progress,
                     .context = j,
                     .next = next,
                     .work = work,
                     .take = take};
    j->next = 0;
    j->keep = (cli_keep){"bench", .size = sizeof(member), .every = 1.0};
    if (cli_keep_open(&j->keep, "/tmp/bench-pool", false, NULL, NULL, &err) != LAC_OK) {
        stop(&err);
    }
    pool.journal = lac_kept_file(j->keep.done);
    if (cli_pool_run(&pool, &err) != LAC_OK) {
        stop(&err);
    }
    cli_keep_close(&j->keep, true);
}

static void bare(job *j, int jobs)
{
    lac_error err = {""};
    member m;
    for (int k = 0; k < jobs; k++) {
        if (fork() == 0) {
            for (size_t i = (size_t)k; i < MEMBERS; i += (size_t)jobs) {
                if (work(j, i, &m, &err) != LAC_OK) {
                    stop(&err);
                }
            }
            _exit(0);
        }
    }
    while (wait(NULL) > 0) {
    }
}

static double children(void)
{
    struct rusage r;
    (void)getrusage(RUSAGE_CHILDREN, &r);
    return (double)(r.ru_utime.tv_sec + r.ru_stime.tv_sec) +
           1e-6 * (double)(r.ru_utime.tv_usec + r.ru_stime.tv_usec);
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(void)
{
    job j = {.next = 0};
    lac_error err = {""};
    const lac_case_request how = {.purpose = LAC_FOR_RUN};
    lac_case_issues issues = {0};
    (void)signal(SIGPIPE, SIG_IGN);
    if (lac_case_read("cases/block.yaml", &how, &j.source, &issues, &err) != LAC_OK) {
        stop(&err);
    }
    printf("%-8s %14s %14s %12s %12s\n", "workers", "bare ms/member", "pool ms/member",
           "CPU, ratio", "time, ratio");
    for (int jobs = 1; jobs <= 2; jobs++) {
        double cpu[ROUNDS], wall[ROUNDS], each[2][ROUNDS];
        for (int round = 0; round < ROUNDS; round++) {
            double c[2], w[2];
            for (int k = 0; k < 2; k++) {
                c[k] = cpu_seconds() + children();
                w[k] = wall_seconds();
                (k == 0 ? bare : pooled)(&j, jobs);
                c[k] = cpu_seconds() + children() - c[k];
                w[k] = wall_seconds() - w[k];
                each[k][round] = 1e3 * c[k] / MEMBERS;
            }
            cpu[round] = c[1] / c[0];
            wall[round] = w[1] / w[0];
        }
        double *const all[] = {cpu, wall, each[0], each[1]};
        for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
            qsort(all[i], ROUNDS, sizeof **all, compare);
        }
        printf("%-8d %14.3f %14.3f %12.3f %12.3f\n", jobs, each[0][ROUNDS / 2], each[1][ROUNDS / 2],
               cpu[ROUNDS / 2], wall[ROUNDS / 2]);
    }
    lac_case_issues_clear(&issues);
    lac_case_free(j.source);
    return 0;
}
