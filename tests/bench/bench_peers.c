// SPDX-License-Identifier: GPL-3.0-or-later
// The problems of other earthquake-cycle codes, B1 (a line) and C1 (a plane), in every formulation
// and by every method: steps, time, how far off each event is, and
// the worst peak, of the steps' ends and the digits published; docs/choosing.md.
//   bench_peers [b1|c1|rate|traction|slip|bdf|adams|erk] ...     of each kind all if none is named
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lacuna/simulation.h"

#include "support/cost.h"
#include "support/fault.h"

static const char *const methods[] = {[LAC_BDF] = "bdf", [LAC_ADAMS] = "adams", [LAC_ERK] = "erk"};

static const char *const formulations[] = {"rate", "traction", "slip"};

// The words on the command line.
typedef struct words {
    int count;
    char **word;
} words;

static bool given(const words *w, const char *name)
{
    for (int i = 1; i < w->count; i++) {
        if (strcmp(w->word[i], name) == 0) {
            return true;
        }
    }
    return false;
}

// Whether a name is asked for: it is given, or none of its kind is.
static bool wanted(const words *w, const char *name, const char *const *kind, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (given(w, kind[i])) {
            return given(w, name);
        }
    }
    return true;
}

// One of the two, and which tolerances to try.
typedef struct peer {
    const char *name;
    void (*create)(lac_formulation, fault *);
    const double *events, *peaks;
    size_t count;
    double end;
    int loosest, tightest; // rtol 10^-k
} peer;

static const peer peers[] = {
    {"b1", fault_b1, fault_b1_events, fault_b1_peaks, 4, 1.5e10, 4, 8},
    {"c1", fault_c1, fault_c1_events, fault_c1_peaks, 3, 4e9, 4, 7},
};

// CPU time of one K x, which on these two is a pair of Fourier transforms [s].
static double apply_seconds(const fault *f)
{
    enum { TIMES = 300 };
    const lac_transfer *k = &f->parts.transfer;
    size_t n = f->parts.domain->n;
    double *x = calloc(2 * n + k->kind->work(k->state), sizeof *x);
    if (x == NULL) {
        exit(1);
    }
    for (size_t i = 0; i < n; i++) {
        x[i] = sin((double)i);
    }
    double begin = cpu_seconds();
    for (int i = 0; i < TIMES; i++) {
        k->kind->apply(k->state, x, x + n, x + 2 * n);
    }
    double taken = cpu_seconds() - begin;
    free(x);
    return taken / TIMES;
}

static void row(const peer *p, const fault *f, lac_method method, double rtol)
{
    fault_events observation;
    double begin = cpu_seconds();
    lac_run_result r = fault_run(f, method, p->end, rtol, &observation);
    double taken = cpu_seconds() - begin;
    double filters = (double)(r.rhs_evaluations + r.linear_solves) * apply_seconds(f);
    (void)printf("%-4s %-9s %-6s %6.0e %8lld %8lld %8lld %8.2f %6.1f ", p->name,
                 lac_formulation_name(lac_problem_formulation(f->parts.problem)), methods[method],
                 rtol, (long long)r.steps, (long long)r.rhs_evaluations, (long long)r.linear_solves,
                 taken, taken / filters);
    for (size_t i = 0; i < p->count; i++) {
        double off =
            observation.count == p->count ? observation.time[i] / p->events[i] - 1 : (double)NAN;
        (void)printf(" %8.1e", off);
    }
    double peak = 0;
    for (size_t i = 0; i < p->count && observation.count == p->count; i++) {
        peak = fmax(peak, fabs(observation.peak[i] / p->peaks[i] - 1));
    }
    (void)printf("  peaks %7.1e", peak);
    (void)printf("\n");
    (void)fflush(stdout);
}

static void table(const peer *p, const words *w)
{
    for (int k = 0; k < 3; k++) {
        if (!wanted(w, formulations[k], formulations, 3)) {
            continue;
        }
        fault f;
        p->create((lac_formulation)(LAC_FORMULATION_RATE + k), &f);
        for (int m = LAC_BDF; m <= LAC_ERK; m++) {
            for (int digits = p->loosest; digits <= p->tightest; digits++) {
                if (wanted(w, methods[m], methods, 3)) {
                    row(p, &f, (lac_method)m, pow(10, -digits));
                }
            }
        }
        fault_free(&f);
    }
}

int main(int argc, char **argv)
{
    static const char *const names[] = {"b1", "c1"};
    words w = {argc, argv};
    (void)printf("     unknown   method   rtol    steps      rhs   solves    CPU s  ratio  events "
                 "off by\n");
    for (size_t i = 0; i < 2; i++) {
        if (wanted(&w, names[i], names, 2)) {
            table(&peers[i], &w);
        }
    }
    return 0;
}
