// SPDX-License-Identifier: GPL-3.0-or-later
// Clusters, area scaling and size effect of a measured contact, in rows and, with -v, in tables.
#include "cli/contact/fractal.h"

#include <math.h>
#include <stdio.h>

#include "cli/common/words.h"

enum { TEXT = 32 };

// A dimension, or a dash where there is none.
static const char *local(double value, char *text, size_t size)
{
    (void)snprintf(text, size, isfinite(value) ? "%.3f" : "-", value);
    return text;
}

static void print_fit(const lac_scaling *s)
{
    char fine[TEXT], coarse[TEXT], smooth[TEXT], slopes[TEXT];
    cli_row("Delta_S", "%.3f +/- %.3f (cells of %s to %s, %s)%s", s->dimension, s->error,
            cli_quantity(s->at[s->n - s->left_out - 1].cell, "m", fine, sizeof fine),
            cli_quantity(s->at[0].cell, "m", coarse, sizeof coarse),
            lac_coarsening_text(s->coarsening),
            s->few_cells ? " (weak: fewer than 100 cells at the coarsest)" : "");
    cli_row("", "%s less boundary cells; %s from the rms slopes alone",
            local(s->smooth, smooth, sizeof smooth), local(s->from_slopes, slopes, sizeof slopes));
    cli_row("fractal area", "%.4g m^%.3f", s->fractal_area, s->dimension);
    cli_row("fractal pressure", "%.4g N m^-%.3f", s->fractal_pressure, s->dimension);
}

static void print_size_effect(const lac_scene_fractal *f)
{
    const lac_size_strength *last = &f->size[f->sizes - 1];
    char size[TEXT];
    cli_row("size effect", "strength ~ b^-%.3f: at %s %.3g (%.3g to %.3g) of what it is here",
            2 - f->scaling.dimension, cli_quantity(last->size, "m", size, sizeof size),
            last->relative, last->low, last->high);
}

void cli_fractal_print(const lac_scene_contact *contact)
{
    const lac_scene_fractal *f = &contact->fractal;
    const lac_cluster_summary *c = &f->clusters;
    char across[TEXT];
    if (f->clustered && lac_grid_cells(&contact->grid) > 1) {
        cli_row("clusters", "%zu, mean %.3g cells, largest %zu cells (%s across)", c->n, c->mean,
                c->largest, cli_quantity(c->largest_extent, "m", across, sizeof across));
    }
    if (f->scaled) {
        print_fit(&f->scaling);
    } else if (contact->solved) {
        cli_row("Delta_S", "none: %s", f->why.message);
    }
    if (f->sizes > 0) {
        print_size_effect(f);
    }
}

static void print_resolutions(const lac_scene_contact *contact)
{
    const lac_scaling *s = &contact->fractal.scaling;
    double nominal = lac_grid_area(&contact->grid);
    char cell[TEXT], pressure[TEXT], slope[TEXT];
    printf("\nResolutions (%s; * fitted)\n", lac_coarsening_text(s->coarsening));
    printf("  %12s %10s %12s %9s %9s %7s %9s %8s\n", "cell", "A_r / A_0", "p_r", "cells",
           "rms slope", "kappa", "p_r A_r/P", "Delta_S");
    for (size_t i = 0; i < s->n; i++) {
        const lac_resolution *at = &s->at[i];
        printf("%c %12s %10.6f %12s %9zu %9.4f %7.3f %9.6f %8s\n",
               i + s->left_out < s->n ? '*' : ' ', cli_quantity(at->cell, "m", cell, sizeof cell),
               at->area / nominal, cli_quantity(at->pressure, "Pa", pressure, sizeof pressure),
               at->cells, at->slope, at->area * at->slope * contact->e_star / s->load,
               at->pressure * at->area / s->load, local(at->local, slope, sizeof slope));
    }
}

static void print_boxes(const lac_scene_contact *contact)
{
    const lac_box_count *b = &contact->boxes;
    char side[TEXT], slope[TEXT];
    printf("\nBoxes (* fitted)\n  %8s %12s %12s %12s %8s\n", "cells", "side", "boxes", "least",
           "D_box");
    for (size_t i = 0; i < b->sizes; i++) {
        printf("%c %8.0f %12s %12.1f %12.0f %8s\n",
               i >= b->fit_first && i <= b->fit_last ? '*' : ' ', b->side[i],
               cli_quantity(b->side[i] * contact->grid.dx, "m", side, sizeof side), b->count[i],
               b->minimum[i], local(-b->slope[i], slope, sizeof slope));
    }
}

static void print_clusters(const lac_cluster_summary *c)
{
    printf("\nClusters\n  %18s %10s %10s\n", "cells in one", "clusters", "cells");
    for (size_t i = 0; i < c->octaves; i++) {
        char range[TEXT];
        (void)snprintf(range, sizeof range, "%llu to %llu", 1ull << i, (2ull << i) - 1);
        printf("  %18s %10zu %10zu\n", i == 0 ? "1" : range, c->count[i], c->cells_of[i]);
    }
}

static void print_published(void)
{
    const lac_size_exponent *x;
    puts("\nPublished exponents of strength ~ b^-x");
    for (size_t i = 0; (x = lac_size_exponent_at(i)) != NULL; i++) {
        char range[TEXT], from[TEXT], to[TEXT], lengths[2 * TEXT + 8] = "lengths not stated";
        (void)snprintf(range, sizeof range, x->high > x->low ? "%.2f-%.2f" : "%.2f", x->low,
                       x->high);
        if (isfinite(x->shortest_m)) {
            (void)snprintf(lengths, sizeof lengths, "%s to %s",
                           cli_quantity(x->shortest_m, "m", from, sizeof from),
                           cli_quantity(x->longest_m, "m", to, sizeof to));
        }
        printf("  %-10s %-20s %-18s %s\n", range, x->quantity, lengths, x->source);
    }
}

static void print_sizes(const lac_scene_fractal *f)
{
    char size[TEXT], pressure[TEXT];
    printf("\nSize effect, strength ~ b^-x, x = %.3f +/- %.3f\n", 2 - f->scaling.dimension,
           f->scaling.error);
    printf("  %12s %10s %18s %14s\n", "specimen", "strength", "within an error", "p_0 at p*");
    for (size_t i = 0; i < f->sizes; i++) {
        char range[TEXT];
        (void)snprintf(range, sizeof range, "%.3g to %.3g", f->size[i].low, f->size[i].high);
        printf("  %12s %10.4g %18s %14s\n", cli_quantity(f->size[i].size, "m", size, sizeof size),
               f->size[i].relative, range,
               cli_quantity(f->size[i].pressure, "Pa", pressure, sizeof pressure));
    }
    print_published();
}

void cli_fractal_tables(const lac_scene_contact *contact)
{
    const lac_scene_fractal *f = &contact->fractal;
    if (f->scaled) {
        print_resolutions(contact);
    }
    if (contact->counted) {
        print_boxes(contact);
    }
    if (f->clustered) {
        print_clusters(&f->clusters);
    }
    if (f->sizes > 0) {
        print_sizes(f);
    }
}
