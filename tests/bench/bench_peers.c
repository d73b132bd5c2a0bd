// SPDX-License-Identifier: GPL-3.0-or-later
// The problems of other earthquake-cycle codes, B1 (a line) and C1 (a plane): steps, time and error
// of the last event; docs/theory/transfer.md, "Measured".
#include <math.h>
#include <stdio.h>

#include "support/cost.h"
#include "support/fault.h"

static const char *const methods[] = {[LAC_BDF] = "bdf", [LAC_ADAMS] = "adams", [LAC_ERK] = "erk"};

static void row(const char *name, const fault *f, lac_method method, double end, double rtol,
                const double *events, size_t count)
{
    fault_events seen;
    double begin = cpu_seconds();
    lac_run_result r = fault_run(f, method, end, rtol, &seen);
    double taken = cpu_seconds() - begin;
    double off = seen.count == count ? seen.time[count - 1] / events[count - 1] - 1 : (double)NAN;
    printf("%-4s %-5s %6.0e %8lld %8lld %8lld %8.2f  %9.1e\n", name, methods[method], rtol,
           (long long)r.steps, (long long)r.rhs_evaluations, (long long)r.linear_solves, taken,
           off);
    (void)fflush(stdout);
}

int main(void)
{
    fault f;
    printf("     method  rtol    steps      rhs   solves    CPU s  last event off by\n");
    fault_b1(&f);
    for (double rtol = 1e-4; rtol > 5e-9; rtol *= 1e-2) {
        row("B1", &f, LAC_BDF, 1.5e10, rtol, fault_b1_events, 4);
        row("B1", &f, LAC_ERK, 1.5e10, rtol, fault_b1_events, 4);
    }
    fault_free(&f);
    fault_c1(&f);
    for (double rtol = 1e-4; rtol > 5e-7; rtol *= 1e-2) {
        row("C1", &f, LAC_BDF, 4e9, rtol, fault_c1_events, 3);
        row("C1", &f, LAC_ERK, 4e9, rtol, fault_c1_events, 3);
    }
    fault_free(&f);
    return 0;
}
