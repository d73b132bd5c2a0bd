// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/free_slip.h"

#include <math.h>
#include <stddef.h>

static const double pi = 3.14159265358979323846;

enum { PARTS = 6, POINTS = 5, DIRECTIONS = 4000 };

static const double node[POINTS] = {-0.90617984593866399, -0.53846931010568309, 0,
                                    0.53846931010568309, 0.90617984593866399};
static const double weight[POINTS] = {0.23692688505618909, 0.47862867049936647, 0.56888888888888889,
                                      0.47862867049936647, 0.23692688505618909};

static double at_centre(double nu, double dx, double dy)
{
    double sum = 0;
    for (size_t i = 0; i < DIRECTIONS; i++) {
        double phi = 0.5 * pi * ((double)i + 0.5) / DIRECTIONS; // a quarter of the cell
        double c = cos(phi), s = sin(phi);
        double border = fmin(0.5 * dx / c, 0.5 * dy / s);
        sum += border / (c * c + s * s / (1 - nu)) * 0.5 * pi / DIRECTIONS;
    }
    return 4 * sum;
}

double free_slip(double g, double nu, double dx, double dy, double x, double y)
{
    if (x == 0 && y == 0) {
        return at_centre(nu, dx, dy) / (pi * g);
    }
    double sum = 0, hx = dx / PARTS, hy = dy / PARTS;
    for (size_t part = 0; part < PARTS * PARTS; part++) {
        double cx = x + ((double)(part % PARTS) + 0.5) * hx - 0.5 * dx;
        double cy = y + ((double)(part / PARTS) + 0.5) * hy - 0.5 * dy;
        for (size_t k = 0; k < POINTS * POINTS; k++) {
            double px = cx + 0.5 * hx * node[k % POINTS];
            double py = cy + 0.5 * hy * node[k / POINTS];
            sum += weight[k % POINTS] * weight[k / POINTS] * hypot(px, py) /
                   (px * px + py * py / (1 - nu));
        }
    }
    return sum * 0.25 * hx * hy / (pi * g);
}

// u = 1/(4 pi^2) int tau_hat/S exp(ikx) d2k with tau_hat = 2 pi s^2 exp(-k^2 s^2/2); the integral
// over |k| is known.
double gaussian_slip(double g, double nu, double s, double a, double phi)
{
    double sum = 0;
    for (size_t i = 0; i < DIRECTIONS; i++) {
        double theta = 2 * pi * (double)i / DIRECTIONS;
        double c = cos(theta), along = a * cos(theta - phi) / s;
        double softness = 2 / (g * (1 - c * c + c * c / (1 - nu)));
        sum += softness * exp(-0.5 * along * along) * 2 * pi / DIRECTIONS;
    }
    return s / (2 * pi) * sqrt(0.5 * pi) * sum;
}
