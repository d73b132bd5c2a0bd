// SPDX-License-Identifier: GPL-3.0-or-later
// The base of a sliding mass over its slip: dip and thickness, and the forces that follow.
#include "load/geometry.h"

#include <gsl/gsl_integration.h>
#include <gsl/gsl_interp.h>

#include "load/load.h"

enum { ROOM = LAC_MOST_NODES + 2 }; // a table and a node beyond each of its ends

// A value over slip: one number, or a smooth curve.
typedef struct curve {
    double value;       // where `spline` is NULL
    gsl_interp *spline; // through `y`; NULL
    double y[ROOM];
} curve;

struct lac_geometry {
    lac_geometry_def def;
    double x[ROOM]; // slip of the nodes, one more before and behind
    curve angle, thickness;
    gsl_integration_glfixed_table *points; // of quadrature; NULL: the angle is no table
    lac_slab start;                        // at slip 0, `normal` and `pull` not yet relative to it
};

// A node beyond each end, of the same value, makes Steffen's slope there 0: the curve goes on level
// without a bend.
static lac_status draw(const lac_geometry *g, const double *value, size_t count, curve *out,
                       lac_error *err)
{
    const size_t n = g->def.nodes;
    out->value = count > 0 ? value[0] : NAN;
    if (count < 2) {
        return LAC_OK;
    }
    memcpy(out->y + 1, value, n * sizeof *value);
    out->y[0] = value[0];
    out->y[n + 1] = value[n - 1];
    out->spline = gsl_interp_alloc(gsl_interp_steffen, n + 2);
    LAC_FAIL_MEMORY_IF(out->spline == NULL, err);
    (void)gsl_interp_init(out->spline, g->x, out->y, n + 2);
    return LAC_OK;
}

static double read_curve(const lac_geometry *g, const curve *c, double slip, double *slope,
                         double *bend)
{
    const size_t n = g->def.nodes;
    *slope = *bend = 0.0;
    if (c->spline == NULL) {
        return c->value;
    }
    if (!(slip > g->x[1])) {
        return c->y[1];
    }
    if (slip >= g->x[n]) {
        return c->y[n];
    }
    *slope = gsl_interp_eval_deriv(c->spline, g->x, c->y, slip, NULL);
    *bend = gsl_interp_eval_deriv2(c->spline, g->x, c->y, slip, NULL);
    return gsl_interp_eval(c->spline, g->x, c->y, slip, NULL);
}

// The weight over the base goes with H cos(alpha), which a thickness of one number keeps.
static void thicken(const lac_geometry *g, double slip, lac_slab *s)
{
    const double tangent = tan(s->angle);
    double bend;
    s->thickness = read_curve(g, &g->thickness, slip, &s->thickness_slope, &bend);
    if (g->thickness.spline == NULL) {
        s->thickness *= cos(g->start.angle) / cos(s->angle);
        s->thickness_slope = s->thickness * tangent * s->angle_slope;
    }
}

// normal and pull per density and gravity, or where no thickness is known per weight
static lac_slab slab_at(const lac_geometry *g, double slip)
{
    lac_slab s;
    const double radius = g->def.radius;
    s.angle = read_curve(g, &g->angle, slip, &s.angle_slope, &s.angle_bend);
    if (!isnan(radius)) {
        s.angle -= slip / radius;
        s.angle_slope = -1.0 / radius;
    }
    thicken(g, slip, &s);
    const bool tabled = g->thickness.spline != NULL;
    const double cosine = cos(s.angle), tangent = tan(s.angle);
    s.normal = tabled ? s.thickness * cosine * cosine : cosine;
    s.normal_slope = tabled ? s.thickness_slope * cosine * cosine : 0.0;
    s.normal_slope -= (tabled ? 2.0 : 1.0) * s.normal * tangent * s.angle_slope;
    return s;
}

lac_slab lac_geometry_at(const lac_geometry *g, double slip)
{
    lac_slab s = slab_at(g, slip);
    const double tangent = tan(s.angle);
    s.normal /= g->start.normal;
    s.normal_slope /= g->start.normal;
    s.pull = s.normal * tangent;
    s.pull_slope = s.normal_slope * tangent + s.normal * (1.0 + tangent * tangent) * s.angle_slope;
    return s;
}

lac_status lac_geometry_create(const lac_geometry_def *def, lac_geometry **out, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_geometry *g = *out = calloc(1, sizeof *g);
    LAC_FAIL_MEMORY_IF(g == NULL, err);
    g->def = *def;
    memcpy(g->x + 1, def->slip, def->nodes * sizeof *g->x);
    if (def->nodes > 1) {
        const double first = def->slip[1] - def->slip[0];
        const double last = def->slip[def->nodes - 1] - def->slip[def->nodes - 2];
        g->x[0] = def->slip[0] - first;
        g->x[def->nodes + 1] = def->slip[def->nodes - 1] + last;
    }
    LAC_TRY(draw(g, def->angle, def->angles, &g->angle, err));
    LAC_TRY(draw(g, def->thickness, def->thicknesses, &g->thickness, err));
    if (g->angle.spline != NULL) {
        g->points = gsl_integration_glfixed_table_alloc(8);
        LAC_TRY(g->points != NULL ? LAC_OK : lac_fail_memory(err));
    }
    double slope, bend;
    g->start.angle = read_curve(g, &g->angle, 0.0, &slope, &bend);
    g->start = slab_at(g, 0.0);
out:
    LAC_MADE(status, out, lac_geometry_free);
}

void lac_geometry_free(lac_geometry *g)
{
    if (g == NULL) {
        return;
    }
    gsl_interp_free(g->angle.spline);
    gsl_interp_free(g->thickness.spline);
    if (g->points != NULL) {
        gsl_integration_glfixed_table_free(g->points);
    }
    free(g);
}

lac_geometry_load lac_geometry_weigh(const lac_geometry_def *def, double density)
{
    lac_geometry *g;
    if (def->angles == 0 || lac_geometry_create(def, &g, NULL) != LAC_OK) {
        return (lac_geometry_load){NAN, 0.0};
    }
    const double cosine = cos(g->start.angle);
    const lac_geometry_load load = {density * LAC_GRAVITY * g->start.thickness * cosine * cosine,
                                    tan(g->start.angle)};
    lac_geometry_free(g);
    return load;
}

static double steepness(const lac_geometry *g, double slip)
{
    const lac_slab s = lac_geometry_at(g, slip);
    return fabs(s.pull_slope) + fabs(s.normal_slope);
}

double lac_geometry_steepest(const lac_geometry *g)
{
    const int parts = 8; // of the way from a node to the next
    double most = steepness(g, 0.0);
    for (size_t i = 1; i < g->def.nodes; i++) {
        for (int k = 0; k <= parts; k++) {
            most = fmax(most, steepness(g, g->x[i] + (g->x[i + 1] - g->x[i]) * k / parts));
        }
    }
    return most;
}

static double sine_at(double slip, void *of)
{
    const lac_geometry *g = of;
    double slope, bend;
    return sin(read_curve(g, &g->angle, slip, &slope, &bend));
}

// Integral of sin(alpha) from one slip to a later one; from node to node.
static double fall_over(const lac_geometry *g, double from, double to)
{
    const gsl_function sine = {sine_at, (void *)g};
    double fall = 0.0;
    for (size_t i = 0; i <= g->def.nodes; i++) {
        const double low = i == 0 ? from : fmax(from, g->x[i]);
        const double high = i == g->def.nodes ? to : fmin(to, g->x[i + 1]);
        fall += high > low ? gsl_integration_glfixed(&sine, low, high, g->points) : 0.0;
    }
    return fall;
}

static double fall_at(const lac_geometry *g, double slip, double angle)
{
    if (!isnan(g->def.radius)) {
        return g->def.radius * (cos(angle) - cos(g->start.angle));
    }
    if (g->points == NULL) {
        return slip * sin(angle);
    }
    return slip > 0.0 ? fall_over(g, 0.0, slip) : -fall_over(g, slip, 0.0);
}

// Height of water in a column of height H whose foot is y below the level, and its integral over y.
static double filled(double y, double height) { return fmin(fmax(y, 0.0), height); }

static double filling(double y, double height)
{
    const double above = fmax(y, 0.0), over = fmax(y - height, 0.0);
    return 0.5 * (above * above - over * over);
}

lac_buoyancy lac_geometry_float(const lac_geometry *g, double slip, double length,
                                const lac_lake *lake)
{
    const lac_slab s = lac_geometry_at(g, slip);
    const double sine = sin(s.angle), cosine = cos(s.angle), height = s.thickness;
    const double low = lake->level - lake->foot + fall_at(g, slip, s.angle); // of the lower end
    const double rise = length * sine, high = low - rise;
    // Next to level the whole base is as its middle: else digits would be lost.
    const bool level = !(fabs(rise) > 1e-6 * height);
    const double middle = low - 0.5 * rise;
    const double h =
        level ? filled(middle, height) : (filling(low, height) - filling(high, height)) / rise;
    const double by_low = level ? (middle > 0.0 && middle < height ? 1.0 : 0.0)
                                : (filled(low, height) - filled(high, height)) / rise;
    const double by_height = level ? (middle > height ? 1.0 : 0.0)
                                   : (fmax(low - height, 0.0) - fmax(high - height, 0.0)) / rise;
    const double by_rise = level ? -0.5 * by_low : (filled(high, height) - h) / rise;
    const double h_slope =
        by_low * sine + by_height * s.thickness_slope + by_rise * length * cosine * s.angle_slope;
    const double gamma = lake->unit_weight;
    const bool alike = isnan(lake->angle);
    const double there = alike ? s.angle : lake->angle, turns = alike ? s.angle_slope : 0.0;
    const double normal = cos(there) * cos(there), along = sin(there) * cos(there);
    return (lac_buoyancy){gamma * h * normal, gamma * (h_slope * normal - 2.0 * h * along * turns),
                          gamma * h * along,
                          gamma * (h_slope * along + h * (2.0 * normal - 1.0) * turns)};
}
