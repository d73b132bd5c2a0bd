// SPDX-License-Identifier: GPL-3.0-or-later
// Pore pressure of water that is pumped into the joint and spreads in it by diffusion: from a well,
// as a Gaussian on a plane, and from a line across the joint. Closed forms, on a plane without
// borders or within those of the joint; docs/theory/loads.md, eqs. 3, 4 and 6.
#include <gsl/gsl_sf_expint.h>

#include "load/kinds.h"

// What both begin with: they pump from start to stop; a stop of NaN never comes.
typedef struct pumping {
    double start, stop;     // [s]
    double x;               // of the source [m]
    double diffusivity;     // alpha [m2/s]
    double compressibility; // beta [1/Pa]
    double porosity;        // phi [1]
    int boundary;
} pumping;

enum { NO_BORDER, NO_FLUX };

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

enum { MODES = 12 };  // as many as LEFT_OUT asks for at TURN
#define TURN 0.2      // of the longer side: where so wide a Gaussian is better known by cosines
#define LEFT_OUT 28.0 // a mirror that makes e^-28 of its source is left out, and so is a cosine

// One direction between two borders that let nothing through.
typedef struct axis {
    double length; // [m]
    size_t mirrors, modes;
    double *mirror; // [mirrors] where the source and its mirrors are [m]
    double *cosine; // [cells along it * modes] of each mode at the source times at the cell,
                    // doubled but for the first
} axis;

typedef struct spread_state {
    reach *cell;  // [n] without borders, of a well
    axis x, y;    // within borders; y of a well
    double turn;  // s from which on cosines take over from mirrors [m2]; INFINITY: no borders
    double *then; // [n] what mirrors make up to then
} spread_state;

static void release(void *at)
{
    spread_state *state = at;
    free(state->cell);
    free(state->then);
    free(state->x.mirror);
    free(state->x.cosine);
    free(state->y.mirror);
    free(state->y.cosine);
    *state = (spread_state){0};
}

static void add(lac_signal *sum, double by, lac_signal part)
{
    sum->value += by * part.value;
    sum->rate += by * part.rate;
}

static reach reach_of(double x, double y, double radius)
{
    double r2 = x * x + y * y;
    double k = 0.5 * r2 / (radius * radius);
    return (reach){r2, k < 1e-12 ? INFINITY : exponential_integral(k)};
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

// Where its source, and its mirrors that are felt until the Gaussian has the variance s, are; and
// the cosines that are felt from then on.
static lac_status fill_axis(axis *a, const char *key, double source, size_t cells, double step,
                            double s, size_t most_modes, lac_error *err)
{
    const double length = (double)cells * step;
    const double far = sqrt(2.0 * LEFT_OUT * s);
    const double most = ceil(0.5 * far / length) + 1.0;
    LAC_FAIL_IF(!(source >= 0.0 && source <= length), err, LAC_EINPUT,
                "%s = %g m lies outside the joint, 0 to %g m; boundary: no-flux needs it within",
                key, source, length);
    a->length = length;
    a->modes = 1 + (size_t)fmin(far / s * length / LAC_PI, (double)most_modes - 1.0);
    a->mirror = malloc((size_t)(4.0 * most + 2.0) * sizeof *a->mirror);
    a->cosine = malloc(cells * a->modes * sizeof *a->cosine);
    LAC_FAIL_MEMORY_IF(a->mirror == NULL || a->cosine == NULL, err);
    for (double k = -most; k <= most; k++) {
        const double at[] = {2.0 * k * length + source, 2.0 * k * length - source};
        for (size_t i = 0; i < 2; i++) {
            if (fmax(-at[i], at[i] - length) < far) {
                a->mirror[a->mirrors++] = at[i];
            }
        }
    }
    for (size_t i = 0; i < cells * a->modes; i++) {
        double wave = (double)(i % a->modes) * LAC_PI / length;
        double x = ((double)(i / a->modes) + 0.5) * step;
        a->cosine[i] = (i % a->modes == 0 ? 1.0 : 2.0) * cos(wave * source) * cos(wave * x);
    }
    return LAC_OK;
}

static double wave2(const axis *a, size_t mode)
{
    double wave = (double)mode * LAC_PI / a->length;
    return wave * wave;
}

// What a mode gains as its Gaussian widens from the variance `from` to s, and its rate over alpha;
// k2: its wave number squared.
static lac_signal widen(double k2, double from, double s)
{
    double half = 0.5 * (s - from);
    return (lac_signal){k2 > 0.0 ? exp(-0.5 * k2 * from) * -expm1(-k2 * half) / k2 : half,
                        exp(-0.5 * k2 * s)};
}

// A source within borders that has flowed for tau: until s = s_t mirrors tell what it makes, then
// each mode of the cosines has gained its part, times `by`.
typedef struct flow {
    double tau;
    bool early;
    lac_signal mode[MODES * MODES];
} flow;

// @param s   variance that the Gaussian has come to [m2]
// @param by  of the value and of the rate
static void begin_flow(const spread_state *state, double tau, double s, lac_signal by, flow *out)
{
    const axis *x = &state->x, *y = &state->y;
    out->tau = tau;
    out->early = s <= state->turn;
    for (size_t m = 0; !out->early && m < x->modes; m++) {
        for (size_t k = 0; k < y->modes; k++) {
            const lac_signal gain = widen(wave2(x, m) + wave2(y, k), state->turn, s);
            out->mode[m * y->modes + k] = (lac_signal){by.value * gain.value, by.rate * gain.rate};
        }
    }
}

static lac_signal add_modes(const spread_state *state, const lac_load_places *places, size_t cell,
                            const flow *on)
{
    const uint32_t at = places->index[cell];
    const axis *x = &state->x, *y = &state->y;
    const double *c_x = x->cosine + at % places->grid->nx * x->modes;
    const double *c_y = y->cosine + at / places->grid->nx * y->modes;
    lac_signal sum = {state->then[cell], 0.0};
    for (size_t m = 0; m < x->modes; m++) {
        const lac_signal *mode = on->mode + m * y->modes;
        lac_signal across = {0.0, 0.0};
        for (size_t k = 0; k < y->modes; k++) {
            add(&across, c_y[k], mode[k]);
        }
        add(&sum, c_x[m], across);
    }
    return sum;
}

// What a source makes in a cell, within borders with its mirrors. @param tau  since it began
typedef lac_signal made(const lac_load *load, const lac_load_places *places, size_t cell,
                        double tau);

// A source, within borders or not.
typedef struct source {
    double least;  // variance at its start [m2]
    double scale;  // of what it makes
    lac_signal by; // of begin_flow
    made *make;    // in a cell
} source;

// Adds what a source makes, less that of one which began when it stopped.
static void add_source(const lac_load *load, const lac_load_places *places, double t,
                       const source *from, double *value, double *rate)
{
    const pumping *p = load->params;
    const spread_state *state = load->state;
    const double since[] = {t - p->start, t - p->stop};
    const size_t flows = t >= p->stop ? 2 : t >= p->start ? 1 : 0;
    flow on[2];
    for (size_t k = 0; k < flows; k++) {
        begin_flow(state, since[k], from->least + 2.0 * p->diffusivity * since[k], from->by,
                   &on[k]);
    }
    for (size_t i = 0; flows > 0 && i < places->n; i++) {
        lac_signal sum = {0.0, 0.0};
        for (size_t k = 0; k < flows; k++) {
            add(&sum, k == 0 ? 1.0 : -1.0,
                on[k].early ? from->make(load, places, i, on[k].tau)
                            : add_modes(state, places, i, &on[k]));
        }
        value[i] += from->scale * sum.value;
        rate[i] += from->scale * sum.rate;
    }
}

static lac_signal open_well(const lac_load *load, const lac_load_places *places, size_t cell,
                            double tau)
{
    (void)places;
    return well_at(load->params, &((const spread_state *)load->state)->cell[cell], tau);
}

static lac_signal mirrored_well(const lac_load *load, const lac_load_places *places, size_t cell,
                                double tau)
{
    const well_params *p = load->params;
    const spread_state *state = load->state;
    const double x = lac_grid_x(places->grid, places->index[cell]);
    const double y = lac_grid_y(places->grid, places->index[cell]);
    lac_signal sum = {0.0, 0.0};
    for (size_t i = 0; i < state->x.mirrors; i++) {
        for (size_t k = 0; k < state->y.mirrors; k++) {
            const reach from = reach_of(x - state->x.mirror[i], y - state->y.mirror[k], p->radius);
            add(&sum, 1.0, well_at(p, &from, tau));
        }
    }
    return sum;
}

// What borders ask for: mirrors and cosines along x, and across where the source has a place there,
// and what the mirrors come to in the end.
// @param y      NULL: it runs across the joint
// @param least  variance that the source has [m2]
static lac_status border(const lac_load *load, const lac_load_places *places, const double *y,
                         double least, made *make, lac_error *err)
{
    const pumping *p = load->params;
    spread_state *state = load->state;
    const lac_grid *grid = places->grid;
    const double width =
        TURN * fmax((double)grid->nx * grid->dx, y != NULL ? (double)grid->ny * grid->dy : 0.0);
    state->turn = fmax(least, width * width);
    state->then = calloc(places->n, sizeof *state->then);
    LAC_FAIL_MEMORY_IF(state->then == NULL, err);
    LAC_TRY_RETURN(fill_axis(&state->x, "x", p->x, grid->nx, grid->dx, state->turn, MODES, err));
    LAC_TRY_RETURN(fill_axis(&state->y, "y", y != NULL ? *y : 0.0, grid->ny, grid->dy, state->turn,
                             y != NULL ? MODES : 1, err));
    for (size_t i = 0; i < places->n; i++) {
        state->then[i] = make(load, places, i, 0.5 * (state->turn - least) / p->diffusivity).value;
    }
    return LAC_OK;
}

static lac_status place_well(const void *params, const lac_load_places *places, void *at,
                             lac_error *err)
{
    const well_params *p = params;
    spread_state *state = at;
    const lac_load load = {.params = params, .state = state};
    release(state);
    if (p->pump.boundary == NO_FLUX) {
        LAC_FAIL_IF(places->grid->ny == 1 && places->grid->nx > 1, err, LAC_EINPUT,
                    "boundary: no-flux is for a joint of shape plane; a line has line_injection");
        return border(&load, places, &p->y, p->radius * p->radius, mirrored_well, err);
    }
    state->turn = INFINITY;
    state->cell = malloc(places->n * sizeof *state->cell);
    LAC_FAIL_MEMORY_IF(state->cell == NULL, err);
    for (size_t i = 0; i < places->n; i++) {
        double x = lac_grid_x(places->grid, places->index[i]) - p->pump.x;
        double y = lac_grid_y(places->grid, places->index[i]) - p->y;
        state->cell[i] = reach_of(x, y, p->radius);
    }
    return LAC_OK;
}

static void add_well(const lac_load *load, const lac_load_places *places, double t, double *value,
                     double *rate)
{
    const well_params *p = load->params;
    const pumping *pump = &p->pump;
    const axis *x = &((const spread_state *)load->state)->x;
    const axis *y = &((const spread_state *)load->state)->y;
    const bool open = pump->boundary != NO_FLUX;
    const double storage = pump->compressibility * pump->porosity * p->thickness;
    const double by = open ? 0.0 : 4.0 * LAC_PI / (x->length * y->length); // eq. 6
    const source from = {p->radius * p->radius,
                         p->rate / (4.0 * LAC_PI * pump->diffusivity * storage),
                         {by, by * pump->diffusivity},
                         open ? open_well : mirrored_well};
    add_source(load, places, t, &from, value, rate);
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

static lac_signal open_line(const lac_load *load, const lac_load_places *places, size_t cell,
                            double tau)
{
    const line_params *p = load->params;
    return line_at(p, lac_grid_x(places->grid, places->index[cell]) - p->pump.x, tau);
}

static lac_signal mirrored_line(const lac_load *load, const lac_load_places *places, size_t cell,
                                double tau)
{
    const spread_state *state = load->state;
    const double x = lac_grid_x(places->grid, places->index[cell]);
    lac_signal sum = {0.0, 0.0};
    for (size_t i = 0; i < state->x.mirrors; i++) {
        add(&sum, 1.0, line_at(load->params, x - state->x.mirror[i], tau));
    }
    return sum;
}

static lac_status place_line(const void *params, const lac_load_places *places, void *at,
                             lac_error *err)
{
    const line_params *p = params;
    const lac_load load = {.params = params, .state = at};
    release(at);
    ((spread_state *)at)->turn = INFINITY;
    return p->pump.boundary == NO_FLUX ? border(&load, places, NULL, 0.0, mirrored_line, err)
                                       : LAC_OK;
}

static void add_line(const lac_load *load, const lac_load_places *places, double t, double *value,
                     double *rate)
{
    const line_params *p = load->params;
    const pumping *pump = &p->pump;
    const bool open = pump->boundary != NO_FLUX;
    const double storage = pump->compressibility * pump->porosity;
    const double root = sqrt(pump->diffusivity);
    const double by = open ? 0.0 : 1.0 / ((const spread_state *)load->state)->x.length;
    const source from = {
        0.0, p->flux / (storage * root), {by / root, by * root}, open ? open_line : mirrored_line};
    add_source(load, places, t, &from, value, rate);
}

#define PUMP(name) offsetof(pumping, name)
#define WELL(name) offsetof(well_params, name)

static const char *const boundaries[] = {"none", "no-flux", NULL};

#define PUMP_ROWS                                                                            \
    LAC_REAL("diffusivity", "m2/s", PUMP(diffusivity), NAN, 0, 1e6, LAC_ABOVE_MIN,           \
             "hydraulic diffusivity of the joint"),                                          \
        LAC_REAL("compressibility", "1/Pa", PUMP(compressibility), NAN, 0, 1, LAC_ABOVE_MIN, \
                 "of the water and the pores together"),                                     \
        LAC_REAL("porosity", "1", PUMP(porosity), NAN, 0, 1, LAC_ABOVE_MIN, "of the joint"), \
        LAC_START_ROW(pumping),                                                              \
        LAC_REAL("stop", "s", PUMP(stop), NAN, -INFINITY, INFINITY, LAC_OPTIONAL,            \
                 "when pumping ends, since the start of the run; never if absent"),          \
        LAC_CHOICE("boundary", PUMP(boundary), NO_BORDER, boundaries, 0,                     \
                   "none: the water spreads beyond the joint; no-flux: it stays in it")

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
    .info =
        LAC_ABOUT("injection", "water pumped into a well that spreads over the joint by diffusion",
                  "Carslaw & Jaeger (1959) Conduction of Heat in Solids, 10.3 (line source); "
                  "docs/theory/loads.md, \"Loads over the joint\"",
                  LAC_ROWS(well_rows, well_params), .validate = fault),
    .state_size = sizeof(spread_state),
    .release = release,
    .cells = add_well,
    .place = place_well,
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
                      "water pumped in along a line across the joint, that spreads by diffusion",
                      "Carslaw & Jaeger (1959) Conduction of Heat in Solids, 2.9",
                      LAC_ROWS(line_rows, line_params), .validate = fault),
    .state_size = sizeof(spread_state),
    .release = release,
    .cells = add_line,
    .place = place_line,
    .next_break = next_break,
};
