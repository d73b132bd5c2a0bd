// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>

#include "base/vsum.h"
#include "model/internal.h"

// What acts on the mean slip at the start, over the nominal area.
typedef struct at_start {
    double rate;   // mean slip rate [m/s]
    double direct; // a p [Pa]
    double excess; // (b - a) p [Pa]
    double eta;    // what uniform slip is damped by [Pa s/m]
} at_start;

static at_start look_at_start(const lac_problem *problem)
{
    double n = (double)problem->n;
    double to_nominal = problem->cell_area / problem->nominal_area;
    at_start s = {.eta = (problem->damping + problem->mean_damping) * n * to_nominal};
    lac_drive drive;
    (void)lac_problem_drive(problem, 0.0, &drive);
    for (size_t i = 0; i < problem->n; i++) {
        double p = problem->pressure[i] * drive.share * to_nominal;
        double a = lac_cellwise_of(&problem->friction->column[LAC_A], i);
        double b = lac_cellwise_of(&problem->friction->column[LAC_B], i);
        s.rate += exp(problem->log_rate0[i]) / n;
        s.direct += a * p;
        s.excess += (b - a) * p;
    }
    return s;
}

lac_failure lac_problem_failure(const lac_problem *problem, double rate, double slip)
{
    lac_failure failure = {
        .rate = rate, .most_rate = INFINITY, .slip = slip > 0.0 ? slip : problem->length};
    bool held = problem->at_start.spring_stiffness > 0.0 || problem->anchor != NULL;
    if (held || rate >= LAC_NO_FAILURE_RATE) {
        return failure;
    }
    at_start s = look_at_start(problem);
    double reached = s.excess * log(rate / s.rate) / s.eta;
    double counts = s.direct / s.eta;
    if (s.eta > 0.0 && reached < rate && counts < rate && counts > s.rate) {
        failure.rate = counts;
        failure.most_rate = LAC_MOST_SHARE * counts;
        failure.lowered = true;
    }
    return failure;
}

double lac_failing_rate(const lac_failure *failure, size_t n, const double *v, double mean)
{
    double most = failure->most_rate;
    double sum = 0.0;
    if (!failure->lowered || lac_vmost(n, v) <= most) {
        return fabs(mean);
    }
    for (size_t i = 0; i < n; i++) {
        sum += fabs(v[i]) > most ? copysign(most, v[i]) : v[i]; // a NaN stays
    }
    double capped = fabs(sum) / (double)n;
    return fabs(mean) < capped ? fabs(mean) : capped;
}
