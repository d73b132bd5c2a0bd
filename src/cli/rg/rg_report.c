// SPDX-License-Identifier: GPL-3.0-or-later
// What the cascade gave, in words and tables.
#include <math.h>
#include <stdio.h>

#include "base/rg_rows.h"
#include "cli/common/words.h"
#include "cli/rg/rg.h"

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

static void print_first(const lac_scene_rg *rg, const lac_rg_result *r)
{
    double place[2];
    const size_t first = lac_scene_rg_first(rg, r, place);
    if (first != SIZE_MAX) {
        cli_row("slips first", "the cell at (%.4g, %.4g) m%s, by Q/Q_nom = %.4g", place[0],
                place[1], rg->seeds > 1 ? " of the last interface" : "", r->cell_load[first]);
    }
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
    cli_row("rule, field", "%s, %s", lac_scene_rg_rule(c), lac_scene_rg_field(c));
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
