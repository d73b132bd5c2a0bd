// SPDX-License-Identifier: GPL-3.0-or-later
// What the cascade gave: tables and JSON.
#include <math.h>
#include <stdio.h>

#include "base/rg_rows.h"
#include "cli/rg.h"
#include "cli/words.h"

const char *cli_rg_rule(const lac_case *c) { return lac_rg_rule_names[c->rg.rule]; }

const char *cli_rg_field(const lac_case *c) { return lac_rg_field_names[c->rg.field]; }

static const char *with_error(double value, double error, char *text, size_t size)
{
    if (isnan(value)) {
        (void)snprintf(text, size, "none");
    } else if (isnan(error)) {
        (void)snprintf(text, size, "%.4f", value);
    } else {
        (void)snprintf(text, size, "%.4f +/- %.4f", value, error);
    }
    return text;
}

// An estimate with its 95 % interval.
static const char *with_interval(const lac_rg_estimate *e, char *text, size_t size)
{
    if (isfinite(e->value) && isfinite(e->low) && isfinite(e->high)) {
        (void)snprintf(text, size, "%.4f +/- %.4f (%.4f to %.4f)", e->value, e->error, e->low,
                       e->high);
        return text;
    }
    return with_error(e->value, e->error, text, size);
}

static void print_law(const char *label, const lac_rg_power *law)
{
    if (law->holds) {
        cli_row(label, "~ (1 - Q/Q_crit)^-%.2f +/- %.2f", law->exponent, law->error);
    } else if (isnan(law->exponent)) {
        cli_row(label, "none: too few loads below Q_crit");
    } else {
        cli_row(label, "no power law over this range (slope %.2f, bent by %.1f errors)",
                law->exponent, fabs(law->curvature));
    }
}

static void print_levels(const lac_rg_result *r, const lac_scene_rg *rg)
{
    char side[32];
    const double cell = fmax(rg->grid.dx, rg->grid.dy);
    printf("\n  %12s %10s %16s %16s%s\n", "block", "N_tot", "N_slip at Q_crit", "strength (Pa)",
           rg->now.loaded ? "       N_slip now" : "");
    for (size_t level = 0; level <= r->levels; level++) {
        printf("  %12s %10.1f %16.1f %16.4g",
               cli_quantity(ldexp(cell, (int)level), "m", side, sizeof side), r->blocks[level],
               r->slipping[level], r->size[level].strength);
        if (rg->now.loaded) {
            printf(" %16.1f", r->begin[level]);
        }
        printf("\n");
    }
}

static void print_curve(const lac_rg_result *r)
{
    printf("\n  %8s", "Q/Q_nom");
    for (size_t level = 0; level <= r->levels; level++) {
        printf("  level %zu", level);
    }
    printf("\n");
    for (size_t i = 0; i < r->loads; i++) {
        printf("  %8.4f", r->load[i]);
        for (size_t level = 0; level <= r->levels; level++) {
            printf(" %8.4f", r->fraction[i * (r->levels + 1) + level]);
        }
        printf("\n");
    }
}

// How far the joint is from sliding, and what slips already.
static void print_now(const lac_rg_result *r, const lac_scene_rg_now *now)
{
    if (r->begin[r->levels] > 0.0) {
        cli_row("slides now", "at %.3g %% of the places", 100.0 * r->begin[r->levels]);
    }
    cli_row("to Q_crit", "%.4f of Q_nom", r->critical - now->load);
    cli_row("slipping cells", "%.0f of %.0f by themselves", r->begin[0], r->blocks[0]);
    char length[32];
    cli_row("xi now", "%s (clusters), %.4g m (blocks)",
            cli_quantity(r->cluster[0], "m", length, sizeof length), r->block[0]);
}

// The cell of the last interface that slips at the least load, of ties the one that is pressed
// least; SIZE_MAX where none slips.
static size_t first_to_slip(const lac_scene_rg *rg, const lac_rg_result *r)
{
    size_t first = SIZE_MAX;
    for (size_t i = 0; i < r->last_n; i++) {
        bool sooner = first == SIZE_MAX || r->cell_load[i] < r->cell_load[first];
        bool weaker = !sooner && r->cell_load[i] == r->cell_load[first] &&
                      rg->domain->pressure[i] < rg->domain->pressure[first];
        first = !isnan(r->cell_load[i]) && (sooner || weaker) ? i : first;
    }
    return first;
}

static void place_of(const lac_scene_rg *rg, size_t cell, double place[2])
{
    const uint32_t at = rg->domain->index[cell];
    place[0] = ((double)(at % rg->grid.nx) + 0.5) * rg->grid.dx;
    place[1] = ((double)(at / rg->grid.nx) + 0.5) * rg->grid.dy;
}

static void print_first(const lac_scene_rg *rg, const lac_rg_result *r)
{
    double place[2];
    size_t first = first_to_slip(rg, r);
    if (first != SIZE_MAX) {
        place_of(rg, first, place);
        cli_row("slips first", "the cell at (%.4g, %.4g) m%s, by Q/Q_nom = %.4g", place[0],
                place[1], rg->seeds > 1 ? " of the last interface" : "", r->cell_load[first]);
    }
}

static void write_first(cli_json *json, const lac_scene_rg *rg, const lac_rg_result *r)
{
    double place[2] = {NAN, NAN};
    size_t first = first_to_slip(rg, r);
    if (first != SIZE_MAX) {
        place_of(rg, first, place);
    }
    cli_json_open(json, "first_to_slip", '{');
    cli_json_number(json, "x_m", place[0]);
    cli_json_number(json, "y_m", place[1]);
    cli_json_number(json, "q_over_q_nom", first != SIZE_MAX ? r->cell_load[first] : NAN);
    cli_json_close(json, '}');
}

static void print_result(const lac_scene_rg *rg, size_t k, bool from_law, bool verbose)
{
    const lac_rg_result *r = rg->result[k];
    char text[64];
    printf("\n");
    cli_row("beta", from_law ? "%.4f (from the friction law, mean)" : "%.4g", rg->beta[k]);
    (void)with_error(r->critical, r->critical_error, text, sizeof text);
    if (r->joints > 1 && r->places > 1) {
        cli_row("Q_crit/Q_nom", "%s (sd %.4f among interfaces, %.4f among places)", text,
                r->critical_sd, r->place_sd);
    } else if (r->joints > 1) {
        cli_row("Q_crit/Q_nom", "%s (sd %.4f among interfaces)", text, r->critical_sd);
    } else if (r->places > 1) {
        cli_row("Q_crit/Q_nom", "%s (sd %.4f among places)", text, r->place_sd);
    } else {
        cli_row("Q_crit/Q_nom", "%s", text);
    }
    if (rg->now.loaded) {
        print_now(r, &rg->now);
    } else {
        print_first(rg, r);
    }
    cli_row("fixed point C", "%s", with_interval(&r->fixed_point, text, sizeof text));
    cli_row("lambda", "%s", with_interval(&r->lambda, text, sizeof text));
    cli_row("nu", "%s", with_interval(&r->nu, text, sizeof text));
    print_law("xi of clusters", &r->cluster_law);
    print_law("xi of blocks", &r->block_law);
    if (verbose) {
        print_levels(r, rg);
        print_curve(r);
    }
}

void cli_rg_print(const lac_case *c, const lac_scene_rg *rg, bool verbose)
{
    cli_row("rule, field", "%s, %s", cli_rg_rule(c), cli_rg_field(c));
    cli_row("interfaces", "%zu of %zu x %zu cells, the blocks at %zu places of each", rg->seeds,
            rg->grid.nx, rg->grid.ny, rg->result[0]->places);
    cli_row_quantity("nominal pressure", rg->mean.pressure, "Pa");
    cli_row("contact", "%.3g %% of the area", 100 * rg->mean.contact_fraction);
    if (isfinite(rg->mean.dimension)) {
        cli_row("D_box", "%.3f", rg->mean.dimension);
    }
    if (isfinite(rg->mean.dyadic)) {
        cli_row("D of all blocks", "%.4f", rg->mean.dyadic);
    }
    cli_row_quantity("f p", rg->strength, "Pa");
    for (size_t k = 0; k < rg->betas; k++) {
        print_result(rg, k, c->rg.betas == 0, verbose);
    }
}

static void write_interval(cli_json *json, const char *key, const lac_rg_estimate *e)
{
    cli_json_open(json, key, '[');
    cli_json_number(json, NULL, e->low);
    cli_json_number(json, NULL, e->high);
    cli_json_close(json, ']');
}

static void write_law(cli_json *json, const char *key, const lac_rg_power *law)
{
    cli_json_open(json, key, '{');
    cli_json_boolean(json, "power_law", law->holds);
    cli_json_number(json, "exponent", law->exponent);
    cli_json_number(json, "exponent_error", law->error);
    cli_json_number(json, "curvature_over_error", law->curvature);
    cli_json_close(json, '}');
}

static void write_levels(cli_json *json, const lac_rg_result *r, const lac_scene_rg *rg)
{
    const lac_grid *grid = &rg->grid;
    cli_json_open(json, "levels", '[');
    for (size_t level = 0; level <= r->levels; level++) {
        cli_json_open(json, NULL, '{');
        cli_json_integer(json, "level", (int64_t)level);
        cli_json_number(json, "block_size_m", ldexp(fmax(grid->dx, grid->dy), (int)level));
        cli_json_number(json, "n_tot", r->blocks[level]);
        cli_json_number(json, "n_slip_at_q_crit", r->slipping[level]);
        if (rg->now.loaded) {
            cli_json_number(json, "n_slip_now", r->begin[level]);
        }
        bool any = r->size[level].blocks > 0;
        cli_json_number(json, "strength_Pa", any ? r->size[level].strength : NAN);
        cli_json_number(json, "strength_spread_Pa", any ? r->size[level].spread : NAN);
        cli_json_close(json, '}');
    }
    cli_json_close(json, ']');
}

static void write_result(cli_json *json, const lac_case *c, const lac_scene_rg *rg, size_t k)
{
    const lac_rg_result *r = rg->result[k];
    cli_json_open(json, NULL, '{');
    cli_json_text(json, "rule", cli_rg_rule(c));
    cli_json_text(json, "field", cli_rg_field(c));
    cli_json_number(json, "beta", rg->beta[k]);
    cli_json_number(json, "q_crit_over_q_nom", r->critical);
    cli_json_number(json, "q_crit_error", r->critical_error);
    cli_json_number(json, "q_crit_sd", r->critical_sd);
    cli_json_number(json, "q_crit_sd_of_places", r->place_sd);
    if (rg->now.loaded) {
        cli_json_number(json, "distance_to_q_crit", r->critical - rg->now.load);
        cli_json_number(json, "slides_now", r->begin[r->levels]);
        cli_json_number(json, "cluster_length_now_m", r->cluster[0]);
        cli_json_number(json, "block_length_now_m", r->block[0]);
    }
    cli_json_number(json, "critical_fraction", r->fixed_point.value);
    cli_json_number(json, "critical_fraction_error", r->fixed_point.error);
    write_interval(json, "critical_fraction_interval95", &r->fixed_point);
    cli_json_number(json, "lambda", r->lambda.value);
    cli_json_number(json, "lambda_error", r->lambda.error);
    write_interval(json, "lambda_interval95", &r->lambda);
    cli_json_number(json, "exponent", r->nu.value);
    cli_json_number(json, "exponent_error", r->nu.error);
    write_interval(json, "exponent_interval95", &r->nu);
    cli_json_integer(json, "map_points", (int64_t)r->map.points);
    write_law(json, "cluster_length", &r->cluster_law);
    write_law(json, "block_length", &r->block_law);
    write_levels(json, r, rg);
    write_first(json, rg, r);
    cli_json_open(json, "q_crit_of_interfaces", '[');
    for (size_t i = 0; i < r->joints; i++) {
        cli_json_number(json, NULL, r->of_joint[i]);
    }
    cli_json_close(json, ']');
    cli_json_close(json, '}');
}

static void write_interface(cli_json *json, const lac_rg_interface *one)
{
    cli_json_open(json, NULL, '{');
    if (one->seed != INT64_MIN) {
        cli_json_integer(json, "seed", one->seed);
    } else {
        cli_json_null(json, "seed");
    }
    cli_json_number(json, "mean_pressure_Pa", one->pressure);
    cli_json_number(json, "contact_fraction", one->contact_fraction);
    cli_json_number(json, "d_box", one->dimension);
    cli_json_number(json, "d_blocks", one->dyadic);
    cli_json_close(json, '}');
}

void cli_rg_json(cli_json *json, const lac_case *c, const lac_scene_rg *rg)
{
    const lac_rg_result *r = rg->result[0];
    cli_json_text(json, "rule", cli_rg_rule(c));
    cli_json_text(json, "field", cli_rg_field(c));
    cli_json_number(json, "beta", rg->beta[0]);
    cli_json_number(json, "q_crit_over_q_nom", r->critical);
    cli_json_number(json, "critical_fraction", r->fixed_point.value);
    cli_json_integer(json, "interfaces", (int64_t)rg->seeds);
    cli_json_integer(json, "places", (int64_t)r->places);
    cli_json_number(json, "mean_pressure_Pa", rg->mean.pressure);
    cli_json_number(json, "contact_fraction", rg->mean.contact_fraction);
    cli_json_number(json, "d_box", rg->mean.dimension);
    cli_json_number(json, "d_blocks", rg->mean.dyadic);
    cli_json_number(json, "q_nom_Pa", rg->strength);
    cli_json_open(json, "ensemble", '[');
    for (size_t i = 0; i < rg->seeds; i++) {
        write_interface(json, &rg->interface[i]);
    }
    cli_json_close(json, ']');
    cli_json_open(json, "results", '[');
    for (size_t k = 0; k < rg->betas; k++) {
        write_result(json, c, rg, k);
    }
    cli_json_close(json, ']');
}
