// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdio.h>

#include "cli/fractal.h"

// The fit with no resolution left out.
static lac_scaling whole_of(const lac_scaling *scaling)
{
    lac_scaling whole = *scaling;
    if (lac_scaling_fit(&whole, 0, NULL) != LAC_OK) {
        whole.dimension = whole.error = whole.regression_error = NAN;
    }
    return whole;
}

static void write_fit(cli_json *json, const lac_scene_contact *contact)
{
    const lac_scene_fractal *fractal = &contact->fractal;
    const lac_scaling *s = &fractal->scaling;
    bool scaled = fractal->scaled;
    lac_scaling whole = {0};
    char area[32], pressure[32];
    (void)snprintf(area, sizeof area, "m^%.3f", s->dimension);
    (void)snprintf(pressure, sizeof pressure, "N m^-%.3f", s->dimension);
    if (scaled) {
        whole = whole_of(s);
    }
    cli_json_number(json, "delta_s", scaled ? s->dimension : NAN);
    cli_json_number(json, "delta_s_error", scaled ? s->error : NAN);
    cli_json_number(json, "delta_s_regression_error", scaled ? s->regression_error : NAN);
    cli_json_number(json, "delta_s_all", scaled ? whole.dimension : NAN);
    cli_json_number(json, "delta_s_all_error", scaled ? whole.error : NAN);
    cli_json_number(json, "delta_s_all_regression_error", scaled ? whole.regression_error : NAN);
    cli_json_number(json, "delta_s_smooth", scaled ? s->smooth : NAN);
    cli_json_number(json, "delta_s_from_slopes", scaled ? s->from_slopes : NAN);
    cli_json_boolean(json, "delta_s_weak", scaled && s->few_cells);
    cli_json_text(json, "delta_s_none", scaled ? NULL : fractal->why.message);
    cli_json_text(json, "coarsening", scaled ? cli_coarsening(s->coarsening) : NULL);
    cli_json_number(json, "e_star_Pa", contact->e_star);
    cli_json_number(json, "load_N", scaled ? s->load : NAN);
    cli_json_number(json, "load_spread", scaled ? s->load_error : NAN);
    cli_json_number(json, "fractal_pressure", scaled ? s->fractal_pressure : NAN);
    cli_json_text(json, "fractal_pressure_unit", scaled ? pressure : NULL);
    cli_json_number(json, "fractal_area", scaled ? s->fractal_area : NAN);
    cli_json_text(json, "fractal_area_unit", scaled ? area : NULL);
}

static void write_resolutions(cli_json *json, const lac_scene_contact *contact)
{
    const lac_scaling *s = &contact->fractal.scaling;
    double nominal = lac_grid_area(&contact->grid);
    cli_json_open(json, "resolutions", '[');
    for (size_t i = 0; i < s->n && contact->fractal.scaled; i++) {
        const lac_resolution *at = &s->at[i];
        cli_json_open(json, NULL, '{');
        cli_json_number(json, "cell_size_m", at->cell);
        cli_json_number(json, "area_m2", at->area);
        cli_json_number(json, "area_fraction", at->area / nominal);
        cli_json_number(json, "pressure_Pa", at->pressure);
        cli_json_number(json, "load_N", at->pressure * at->area);
        cli_json_integer(json, "cells", (int64_t)at->cells);
        cli_json_number(json, "boundary_m", at->boundary);
        cli_json_number(json, "smooth_area_m2", lac_smooth_area(at));
        cli_json_number(json, "rms_slope", at->slope);
        cli_json_number(json, "kappa", at->area * at->slope * contact->e_star / s->load);
        cli_json_number(json, "local_delta_s", at->local);
        cli_json_boolean(json, "fitted", i + s->left_out < s->n);
        cli_json_close(json, '}');
    }
    cli_json_close(json, ']');
}

static void write_boxes(cli_json *json, const lac_scene_contact *contact)
{
    const lac_box_count *b = &contact->boxes;
    cli_json_open(json, "boxes", '[');
    for (size_t i = 0; i < b->sizes && contact->counted; i++) {
        cli_json_open(json, NULL, '{');
        cli_json_number(json, "side_cells", b->side[i]);
        cli_json_number(json, "side_m", b->side[i] * contact->grid.dx);
        cli_json_number(json, "count", b->count[i]);
        cli_json_number(json, "minimum", b->minimum[i]);
        cli_json_number(json, "local_d_box", -b->slope[i]);
        cli_json_boolean(json, "fitted", i >= b->fit_first && i <= b->fit_last);
        cli_json_close(json, '}');
    }
    cli_json_close(json, ']');
}

static void write_clusters(cli_json *json, const lac_scene_contact *contact)
{
    const lac_cluster_summary *c = &contact->fractal.clusters;
    if (!contact->fractal.clustered) {
        cli_json_null(json, "clusters");
        return;
    }
    cli_json_open(json, "clusters", '{');
    cli_json_integer(json, "number", (int64_t)c->n);
    cli_json_integer(json, "largest_cells", (int64_t)c->largest);
    cli_json_number(json, "largest_extent_m", c->largest_extent);
    cli_json_number(json, "widest_m", c->widest);
    cli_json_number(json, "mean_cells", c->mean);
    cli_json_number(json, "weighted_mean_cells", c->weighted);
    cli_json_open(json, "octaves", '[');
    for (size_t i = 0; i < c->octaves; i++) {
        cli_json_open(json, NULL, '{');
        cli_json_integer(json, "from_cells", (int64_t)1 << i);
        cli_json_integer(json, "number", (int64_t)c->count[i]);
        cli_json_integer(json, "cells", (int64_t)c->cells_of[i]);
        cli_json_close(json, '}');
    }
    cli_json_close(json, ']');
    cli_json_close(json, '}');
}

static void write_sizes(cli_json *json, const lac_scene_fractal *fractal)
{
    cli_json_open(json, "size_effect", '[');
    for (size_t i = 0; i < fractal->sizes; i++) {
        const lac_size_strength *at = &fractal->size[i];
        cli_json_open(json, NULL, '{');
        cli_json_number(json, "size_m", at->size);
        cli_json_number(json, "relative_strength", at->relative);
        cli_json_number(json, "relative_strength_low", at->low);
        cli_json_number(json, "relative_strength_high", at->high);
        cli_json_number(json, "mean_pressure_Pa", at->pressure);
        cli_json_close(json, '}');
    }
    cli_json_close(json, ']');
    cli_json_open(json, "published_exponents", '[');
    const lac_size_exponent *x;
    for (size_t i = 0; fractal->sizes > 0 && (x = lac_size_exponent_at(i)) != NULL; i++) {
        cli_json_open(json, NULL, '{');
        cli_json_text(json, "quantity", x->quantity);
        cli_json_number(json, "exponent_low", x->low);
        cli_json_number(json, "exponent_high", x->high);
        cli_json_number(json, "shortest_m", x->shortest_m);
        cli_json_number(json, "longest_m", x->longest_m);
        cli_json_boolean(json, "stated", x->stated);
        cli_json_text(json, "source", x->source);
        cli_json_close(json, '}');
    }
    cli_json_close(json, ']');
}

void cli_fractal_json(cli_json *json, const lac_scene_contact *contact)
{
    write_fit(json, contact);
    write_resolutions(json, contact);
    write_boxes(json, contact);
    write_clusters(json, contact);
    write_sizes(json, &contact->fractal);
}
