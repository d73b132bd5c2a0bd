// SPDX-License-Identifier: GPL-3.0-or-later
// Linear least squares of a few columns by Householder reflections, without memory of its own.
#include "base/least_squares.h"

#include "base/statistics.h"

static const double dependent = 1e-12;

// x -= 2 v (v.x) / (v.v)
static void reflect(size_t n, const double *v, double squares, double *x)
{
    double part = 2.0 * lac_dot(n, v, x) / squares;
    for (size_t i = 0; i < n; i++) {
        x[i] -= part * v[i];
    }
}

double lac_least_squares(size_t n, size_t k, double *columns, double *y, double *c)
{
    double corner[LAC_LEAST_SQUARES_MAX];        // diagonal of R; 0: the column is left out
    double squares[LAC_LEAST_SQUARES_MAX] = {0}; // of each reflection's vector
    for (size_t j = 0; j < k; j++) {
        double *v = columns + j * n;
        double whole = sqrt(lac_dot(n, v, v));
        double rest = sqrt(lac_dot(n - j, v + j, v + j));
        corner[j] = 0.0;
        if (!(rest > dependent * whole)) {
            continue;
        }
        corner[j] = v[j] > 0.0 ? -rest : rest;
        v[j] -= corner[j];
        squares[j] = lac_dot(n - j, v + j, v + j);
        for (size_t l = j + 1; l < k; l++) {
            reflect(n - j, v + j, squares[j], columns + l * n + j);
        }
        reflect(n - j, v + j, squares[j], y + j);
    }
    for (size_t j = k; j-- > 0;) {
        double right = y[j];
        for (size_t l = j + 1; l < k; l++) {
            right -= columns[l * n + j] * c[l];
        }
        bool left_out = corner[j] == 0.0;
        c[j] = left_out ? 0.0 : right / corner[j];
        y[j] = left_out ? y[j] : 0.0;
    }
    for (size_t j = k; j-- > 0;) {
        if (corner[j] != 0.0) {
            reflect(n - j, columns + j * n + j, squares[j], y + j);
        }
    }
    return lac_dot(n, y, y);
}
