// SPDX-License-Identifier: GPL-3.0-or-later
// A straight line through points, and how its slope differs between parts of them.
#include "fractal/line_fit.h"

#include <math.h>

lac_line lac_line_fit(const double *x, const double *y, size_t n)
{
    double mean_x = 0.0;
    double mean_y = 0.0;
    for (size_t i = 0; i < n; i++) {
        mean_x += x[i] / (double)n;
        mean_y += y[i] / (double)n;
    }
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (size_t i = 0; i < n; i++) {
        xx += (x[i] - mean_x) * (x[i] - mean_x);
        xy += (x[i] - mean_x) * (y[i] - mean_y);
        yy += (y[i] - mean_y) * (y[i] - mean_y);
    }
    double slope = xy / xx;
    double rest = fmax(0.0, yy - slope * xy);
    return (lac_line){.slope = slope,
                      .intercept = mean_y - slope * mean_x,
                      .error = n > 2 ? sqrt(rest / (double)(n - 2) / xx) : 0.0};
}

double lac_line_range_spread(const double *x, const double *y, size_t n, double slope)
{
    size_t least = n < 4 ? 2 : (n + 1) / 2;
    double sum = 0.0;
    double runs = 0.0;
    for (size_t a = 0; a + least <= n; a++) {
        for (size_t length = least; a + length <= n; length++) {
            double departure = lac_line_fit(&x[a], &y[a], length).slope - slope;
            sum += departure * departure;
            runs += 1.0;
        }
    }
    return sqrt(sum / runs);
}
