// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/quadrature.h"

#include <gsl/gsl_integration.h>
#include <math.h>

// dx/(1 - x^(1-m)) in z = ln x, where the integrand is smooth down to x = 0.
static double integrand(double z, void *params)
{
    double m = *(double *)params;
    return -exp(z) / expm1((1.0 - m) * z);
}

double aging_time(double m, double from, double to)
{
    gsl_integration_workspace *work = gsl_integration_workspace_alloc(2000);
    gsl_function f = {integrand, &m};
    double result;
    double error;
    gsl_integration_qag(&f, log(from), log(to), 0.0, 1e-13, 2000, GSL_INTEG_GAUSS61, work, &result,
                        &error);
    gsl_integration_workspace_free(work);
    return result;
}
