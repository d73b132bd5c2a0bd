// SPDX-License-Identifier: GPL-3.0-or-later
// Pore pressure of water that is pumped into the joint and spreads in it by diffusion: from a well,
// as a Gaussian on a plane, and from a line across the joint. Closed forms on a plane without
// borders; docs/theory/loads.md, eqs. 2 and 3.
#include <gsl/gsl_sf_expint.h>
#include <math.h>
#include <stdlib.h>

#include "load/kinds.h"

// What both begin with: they pump from start to stop; a stop of NaN never comes.
typedef struct pumping {
    double start, stop;     // [s]
    double x;               // of the source [m]
    double diffusivity;     // alpha [m2/s]
    double compressibility; // beta [1/Pa]
    double porosity;        // phi [1]
} pumping;

typedef struct well_params {
    pumping pump;
    double y;         // [m]
    double rate;      // Q0 [m3/s]
    double radius;    // L [m]
    double thickness; // w [m]
} well_params;

typedef struct line_params {
    pumping pump;
    double flux; // q0 [m/s]
} line_params;

static double next_break(const lac_load *load, double t)
{
    const pumping *p = load->params;
    return t < p->start ? p->start : t < p->stop ? p->stop : INFINITY;
}

static const char *fault(const void *params)
{
    const pumping *p = params;
    return p->stop <= p->start ? "stop must be later than start" : NULL;
}

// E1(x); from 50 on it is below 4e-24, and taken as 0.
static double exponential_integral(double x) { return x < 50.0 ? gsl_sf_expint_E1(x) : 0.0; }

// What a cell's distance from the well comes to once and for all.
typedef struct reach {
    double r2;    // its square [m2]
    double least; // E1(r^2/(2 L^2)); INFINITY at the well
} reach;

typedef struct well_state {
    reach *cell; // [n]
} well_state;

static void release(void *p)
{
    free(((well_state *)p)->cell);
    free(p);
}

static lac_status prepare(const void *params, const lac_load_clock *clock, void **state,
                          lac_error *err)
{
    (void)params;
    (void)clock;
    *state = calloc(1, sizeof(well_state));
    return *state != NULL ? LAC_OK : lac_fail_memory(err);
}

static lac_status place(const void *params, const lac_load_places *places, void *at, lac_error *err)
{
    const well_params *p = params;
    well_state *state = at;
    free(state->cell);
    state->cell = malloc(places->n * sizeof *state->cell);
    LAC_FAIL_MEMORY_IF(state->cell == NULL, err);
    for (size_t i = 0; i < places->n; i++) {
        double x = lac_grid_x(places->grid, places->index[i]) - p->pump.x;
        double y = lac_grid_y(places->grid, places->index[i]) - p->y;
        double r2 = x * x + y * y;
        double k = 0.5 * r2 / (p->radius * p->radius);
        state->cell[i] = (reach){r2, k < 1e-12 ? INFINITY : exponential_integral(k)};
    }
    return LAC_OK;
}

// What a well that has pumped for tau makes at a distance whose square is r2, over
// Q0/(4 pi alpha beta phi w):
//   E1(r^2/(2 s)) - E1(r^2/(2 L^2)),   s = L^2 + 2 alpha tau;   ln(s/L^2) at r = 0
static lac_signal well_at(const well_params *p, const reach *cell, double tau)
{
    double least = p->radius * p->radius;
    double spread = 2.0 * p->pump.diffusivity * tau;
    double s = least + spread;
    double k = 0.5 * cell->r2 / s;
    double rate = 2.0 * p->pump.diffusivity * exp(-k) / s;
    bool inside = isinf(cell->least);
    return (lac_signal){inside ? log1p(spread / least) : exponential_integral(k) - cell->least,
                        rate};
}

static void add_well(const lac_load *load, const lac_load_places *places, double t, double *value,
                     double *rate)
{
    const well_params *p = load->params;
    const pumping *pump = &p->pump;
    const reach *cell = ((const well_state *)load->state)->cell;
    const double storage = pump->compressibility * pump->porosity * p->thickness;
    const double scale = p->rate / (4.0 * LAC_PI * pump->diffusivity * storage);
    for (size_t i = 0; t >= pump->start && i < places->n; i++) {
        lac_signal here = well_at(p, &cell[i], t - pump->start);
        if (t >= pump->stop) {
            lac_signal gone = well_at(p, &cell[i], t - pump->stop);
            here.value -= gone.value;
            here.rate -= gone.rate;
        }
        value[i] += scale * here.value;
        rate[i] += scale * here.rate;
    }
}

// What a line that has pumped for tau makes at a distance z, over q0/(beta phi sqrt(alpha)):
//   G = sqrt(tau) [exp(-k^2)/sqrt(pi) - k erfc(k)],   k = |z|/sqrt(4 alpha tau)
// whose rate at z = 0 begins without bounds: at tau = 0 it is taken as none.
static lac_signal line_at(const line_params *p, double z, double tau)
{
    if (!(tau > 0.0)) {
        return (lac_signal){0.0, 0.0};
    }
    double root = sqrt(tau);
    double k = fabs(z) / (2.0 * sqrt(p->pump.diffusivity) * root);
    double gauss = exp(-k * k) / sqrt(LAC_PI);
    return (lac_signal){root * (gauss - k * erfc(k)), 0.5 * gauss / root};
}

static void add_line(const lac_load *load, const lac_load_places *places, double t, double *value,
                     double *rate)
{
    const line_params *p = load->params;
    const pumping *pump = &p->pump;
    const double storage = pump->compressibility * pump->porosity;
    const double scale = p->flux / (storage * sqrt(pump->diffusivity));
    for (size_t i = 0; t >= pump->start && i < places->n; i++) {
        double z = lac_grid_x(places->grid, places->index[i]) - pump->x;
        lac_signal here = line_at(p, z, t - pump->start);
        if (t >= pump->stop) {
            lac_signal gone = line_at(p, z, t - pump->stop);
            here.value -= gone.value;
            here.rate -= gone.rate;
        }
        value[i] += scale * here.value;
        rate[i] += scale * here.rate;
    }
}

#define PUMP(name) offsetof(pumping, name)
#define WELL(name) offsetof(well_params, name)

#define PUMP_ROWS                                                                            \
    LAC_REAL("diffusivity", "m2/s", PUMP(diffusivity), NAN, 0, 1e6, LAC_ABOVE_MIN,           \
             "hydraulic diffusivity of the joint"),                                          \
        LAC_REAL("compressibility", "1/Pa", PUMP(compressibility), NAN, 0, 1, LAC_ABOVE_MIN, \
                 "of the water and the pores together"),                                     \
        LAC_REAL("porosity", "1", PUMP(porosity), NAN, 0, 1, LAC_ABOVE_MIN, "of the joint"), \
        LAC_START_ROW(pumping),                                                              \
        LAC_REAL("stop", "s", PUMP(stop), NAN, -INFINITY, INFINITY, LAC_OPTIONAL,            \
                 "when pumping ends, since the start of the run; never if absent")

static const lac_param well_rows[] = {
    LAC_REAL("rate", "m3/s", WELL(rate), NAN, -1e6, 1e6, 0,
             "volume of water that is pumped in; negative draws it out"),
    LAC_REAL("x", "m", PUMP(x), NAN, -1e9, 1e9, 0,
             "place of the well along slip, from the corner of the joint"),
    LAC_REAL("y", "m", WELL(y), NAN, -1e9, 1e9, 0, "and across"),
    LAC_REAL("radius", "m", WELL(radius), NAN, 0, 1e9, LAC_ABOVE_MIN,
             "standard deviation of the Gaussian over which it enters"),
    LAC_REAL("thickness", "m", WELL(thickness), NAN, 0, 1e6, LAC_ABOVE_MIN,
             "of the layer that takes it up"),
    PUMP_ROWS,
};

const lac_load_kind lac_pore_injection = {
    .info = LAC_ABOUT("injection",
                      "water pumped into a well that spreads over the joint by diffusion, without "
                      "borders",
                      "Carslaw & Jaeger (1959) Conduction of Heat in Solids, 10.3 (line source); "
                      "docs/theory/loads.md, \"Loads over the joint\"",
                      LAC_ROWS(well_rows, well_params), .validate = fault),
    .prepare = prepare,
    .release = release,
    .cells = add_well,
    .place = place,
    .next_break = next_break,
};

static const lac_param line_rows[] = {
    LAC_REAL("flux", "m/s", offsetof(line_params, flux), NAN, -1e6, 1e6, 0,
             "volume of water that enters for each area of the layer's section and time; negative "
             "draws it out"),
    LAC_REAL("x", "m", PUMP(x), NAN, -1e9, 1e9, 0,
             "place of the line, which runs across slip, from the corner of the joint"),
    PUMP_ROWS,
};

const lac_load_kind lac_pore_line_injection = {
    .info = LAC_ABOUT("line_injection",
                      "water pumped in along a line across the joint, that spreads by diffusion, "
                      "without borders",
                      "Carslaw & Jaeger (1959) Conduction of Heat in Solids, 2.9",
                      LAC_ROWS(line_rows, line_params), .validate = fault),
    .cells = add_line,
    .next_break = next_break,
};
