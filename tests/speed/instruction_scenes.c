// SPDX-License-Identifier: GPL-3.0-or-later
// Three small runs whose instructions are counted (tools/dev/instruction-counts), and what the
// counts depend on besides Lacuna.
//   instruction_scenes made-with | cycle | creep | events
#include <gnu/libc-version.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sundials/sundials_version.h>

#include <fftw3.h>

#include "lacuna/simulation.h"
#include "support/fault.h"

// One line: compiler and options, libraries, and the instruction set that loops over cells take.
static int made_with(void)
{
    char sundials[32] = "";
    (void)SUNDIALSGetVersion(sundials, (int)sizeof sundials);
    const char *set = __builtin_cpu_supports("avx512f") ? "v4"
                      : __builtin_cpu_supports("avx2")  ? "v3"
                                                        : "default";
    (void)printf("gcc %d.%d.%d %s, glibc %s, SUNDIALS %s, %s, instruction set %s\n", __GNUC__,
                 __GNUC_MINOR__, __GNUC_PATCHLEVEL__, LACUNA_C_FLAGS, gnu_get_libc_version(),
                 sundials, fftw_version, set);
    return 0;
}

// Runs to its end, which must be that one.
static int finish(const tree *t, const lac_run_def *how, lac_status expected)
{
    lac_run_result r;
    lac_error err = {""};
    lac_status status = lac_run(t->problem, how, NULL, &r, &err);
    if (status != expected || (status == LAC_OK && r.end != LAC_END_STOP)) {
        (void)fprintf(stderr, "instruction_scenes: ended otherwise: %s\n", err.message);
        return 1;
    }
    (void)printf("%lld steps, %lld evaluations, to %g s\n", (long long)r.steps,
                 (long long)r.rhs_evaluations, r.time);
    return 0;
}

static lac_run_def no_records(double end)
{
    lac_run_def how = lac_run_default();
    how.end = end;
    how.failure_rate = 1e3;
    how.record = (lac_cadence){.time = NAN, .steps = 0, .per_decade = NAN};
    return how;
}

// The first earthquake of the problem B1: 1 024 cells, elastic rock by FFT, tractions by erk.
static int cycle(void)
{
    fault f;
    fault_b1(LAC_FORMULATION_TRACTION, &f);
    lac_run_def how = no_records(1e10);
    how.method = LAC_ERK;
    how.rtol = 1e-4;
    how.stop_rate = 1e-3;
    int status = finish(&f.parts, &how, LAC_OK);
    fault_free(&f);
    return status;
}

// Creep of a tree of some 800 cells to failure: rates by bdf.
static int creep(void)
{
    tree t;
    tree_def def = tree_default(5, 5);
    def.keep = 0.95;
    tree_create(&def, &t);
    lac_run_def how = no_records(1e10);
    how.rtol = 1e-5;
    how.stop_rate = 0.5;
    int status = finish(&t, &how, LAC_OK);
    tree_clear(&t);
    return status;
}

static bool long_enough(void *context)
{
    int *left = context;
    return --*left <= 0;
}

// Cells that slip one by one: fidelity events, some hundred thousand steps of single cells.
static int events(void)
{
    int left = 60;
    tree t;
    tree_def def = tree_default(5, 1);
    def.keep = 1.0;
    def.k0 = 0.15 * def.pressure * (def.b - def.a) / def.dc;
    def.ratio = 0.5;
    tree_create(&def, &t);
    lac_run_def how = no_records(1e12);
    how.fidelity = LAC_FIDELITY_ASYNC;
    how.rtol = 1e-6;
    how.max_steps = INT64_MAX;
    how.interrupted = long_enough;
    how.context = &left;
    int status = finish(&t, &how, LAC_EINTERRUPT);
    tree_clear(&t);
    return status;
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        int (*run)(void);
    } scenes[] = {{"made-with", made_with}, {"cycle", cycle}, {"creep", creep}, {"events", events}};
    for (size_t i = 0; argc == 2 && i < sizeof scenes / sizeof scenes[0]; i++) {
        if (strcmp(argv[1], scenes[i].name) == 0) {
            return scenes[i].run();
        }
    }
    (void)fprintf(stderr, "usage: instruction_scenes made-with | cycle | creep | events\n");
    return 2;
}
