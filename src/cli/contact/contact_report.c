// SPDX-License-Identifier: GPL-3.0-or-later
// A contact in words: its surface, its measures, its history of loads, and with -v each specimen.
#include "base/statistics.h"
#include "base/vsum.h"
#include "cli/common/progress.h"
#include "cli/common/words.h"
#include "cli/contact/contact.h"

// Words for lac_measured, and for the fit of a file.
static const char *const measured_words[] = {"the interface", "the file as read",
                                             "the file, as far as it lies on the interface",
                                             "both faces on the interface"};
static const char *const fit_words[] = {"cropped", "padded", "resampled"};

// A misfit that scatter does not explain: one in a thousand at eight shells.
static const double bad_misfit = 3.7;

static void print_file(const lac_file_report *file, const char *label)
{
    cli_row(label, "%s (%s)", file->path, file->format);
    cli_row("", "%zu x %zu samples%s, heights in %s%s; %s", file->nx, file->ny,
            isnan(file->dx) ? "" : cli_format(" %s apart", cli_amount(file->dx, "m").s).s,
            file->height_unit,
            file->masked > 0 ? cli_format(", %zu without height", file->masked).s : "",
            fit_words[file->fit]);
}

static void print_hurst(const lac_surface_measures *m)
{
    if (isnan(m->hurst)) {
        cli_row("Hurst exponent", "none: too few waves");
        return;
    }
    cli_row("Hurst exponent", "%.3f +/- %.3f (waves of %s to %s%s)", m->hurst, m->hurst_error,
            cli_amount(m->fit_shortest, "m").s, cli_amount(m->fit_longest, "m").s,
            m->hurst_misfit > bad_misfit || m->hurst < 0.0 || m->hurst > 1.0
                ? "; no self-affine range"
                : "");
}

// JRC was found from profiles of 10 cm read every millimetre or so; what it gives of coarser ones
// is no roughness that anybody has tested.
static void print_jrc(double z2, double step, double jrc)
{
    const double coarsest = 2e-3; // [m]
    const bool fits = jrc >= 0.0 && jrc <= 20.0;
    const cli_text at = cli_amount(step, "m");
    if (isnan(jrc)) {
        cli_row("Z2, JRC", "%.4g at %s: none: flat", z2, at.s);
    } else if (step > coarsest) {
        cli_row_wrap("Z2, JRC",
                     cli_format("%.4g at %s: no JRC, which is of laboratory profiles read every "
                                "0.25 to 1 mm: give heights as fine where you need one; a run "
                                "needs none",
                                z2, at.s)
                         .s);
    } else if (fits) {
        cli_row("Z2, JRC", "%.4g at %s: %.1f", z2, at.s, jrc);
    } else {
        cli_row_wrap("Z2, JRC",
                     cli_format("%.4g at %s: JRC %.1f is outside of 0 to 20: %s than any profile "
                                "that it was found from; go by Z2 and the rms slopes",
                                z2, at.s, jrc, jrc < 0.0 ? "smoother" : "rougher")
                         .s);
    }
}

static void print_surface(const lac_surface_stats *surface)
{
    const lac_surface_measures *m = &surface->measures;
    for (size_t i = 0; i < surface->files; i++) {
        print_file(&surface->file[i],
                   surface->files < 2 ? "heights" : (i == 0 ? "upper face" : "lower face"));
    }
    cli_row("measured", "%s", measured_words[surface->measured]);
    cli_row_quantity("rms height", m->rms_height, "m");
    cli_row("rms slopes x, y", "%.4g, %.4g", m->rms_slope_x, m->rms_slope_y);
    print_hurst(m);
    print_jrc(m->z2, m->z2_step, m->jrc);
    for (size_t k = 0; k < m->profiles; k++) {
        if (m->profile[k].step != m->z2_step) {
            print_jrc(m->profile[k].z2, m->profile[k].step, m->profile[k].jrc);
        }
    }
}

void cli_measures_print(const lac_scene_contact *contact)
{
    const lac_grid *grid = &contact->grid;
    const size_t cells = contact->domain->n;
    const double *pressure = contact->domain->pressure;
    const bool oblong = grid->ny > 1 && fabs(grid->dy / grid->dx - 1) > 1e-9;
    const char *weakness = contact->boxes.few_cells ? " (weak: fewer than 500 cells)"
                           : contact->boxes.dense
                               ? " (more than 30 % of the area: not a fractal set)"
                               : "";
    cli_row("grid", "%zu x %zu cells of %s%s%s%s", grid->nx, grid->ny, cli_amount(grid->dx, "m").s,
            oblong ? " x " : "", oblong ? cli_amount(grid->dy, "m").s : "",
            grid->periodic ? "" : ", free at its border");
    cli_row("contact cells", "%zu (%.3g %% of the area)", cells,
            100 * ((double)cells / (double)lac_grid_cells(grid)));
    cli_row_quantity("mean real pressure", lac_sum(cells, pressure) / (double)cells, "Pa");
    cli_row_quantity("largest pressure", lac_vmost(cells, pressure), "Pa");
    if (contact->counted) {
        cli_row("D_box", "%.3f +/- %.3f%s", contact->boxes.dimension, contact->boxes.error,
                weakness);
    } else if (lac_grid_cells(grid) > 1) {
        cli_row("D_box", "none: the grid or the contact is too small to count boxes");
    }
    if (isfinite(contact->blocks.dimension)) {
        cli_row("D of all blocks", "%.4f", contact->blocks.dimension);
    }
}

// A dimension, or a dash where there is none.
static cli_text local(double value) { return cli_format(isfinite(value) ? "%.3f" : "-", value); }

static void print_fit(const lac_scaling *s)
{
    cli_row("Delta_S", "%.3f +/- %.3f (cells of %s to %s, %s)%s", s->dimension, s->error,
            cli_amount(s->at[s->n - s->left_out - 1].cell, "m").s, cli_amount(s->at[0].cell, "m").s,
            lac_coarsening_text(s->coarsening),
            s->few_cells ? " (weak: fewer than 100 cells at the coarsest)" : "");
    cli_row("", "%s from the rms slopes alone", local(s->from_slopes).s);
    cli_row("fractal area", "%.4g m^%.3f", s->fractal_area, s->dimension);
    cli_row("fractal pressure", "%.4g N m^-%.3f", s->fractal_pressure, s->dimension);
}

static void print_fractal(const lac_scene_contact *contact)
{
    const lac_scene_fractal *f = &contact->fractal;
    const lac_cluster_summary *c = &f->clusters;
    if (f->clustered && lac_grid_cells(&contact->grid) > 1) {
        cli_row("clusters", "%zu, mean %.3g cells, largest %zu cells (%s across)", c->n, c->mean,
                c->largest, cli_amount(c->largest_extent, "m").s);
    }
    if (f->scaled) {
        print_fit(&f->scaling);
    } else if (contact->solved) {
        cli_row_wrap("Delta_S", cli_format("none: %s", f->why.message).s);
    }
    if (f->sizes > 0) {
        const lac_size_strength *last = &f->size[f->sizes - 1];
        cli_row("size effect", "strength ~ b^-%.3f: at %s %.3g (%.3g to %.3g) of what it is here",
                2 - f->scaling.dimension, cli_amount(last->size, "m").s, last->relative, last->low,
                last->high);
    }
}

static void print_sizes(const lac_scene_fractal *f)
{
    const lac_size_exponent *x;
    printf("\nSize effect, strength ~ b^-x, x = %.3f +/- %.3f\n", 2 - f->scaling.dimension,
           f->scaling.error);
    printf("  %12s %10s %18s %14s\n", "specimen", "strength", "within an error", "p_0 at p*");
    for (size_t i = 0; i < f->sizes; i++) {
        const lac_size_strength *at = &f->size[i];
        printf("  %12s %10.4g %18s %14s\n", cli_amount(at->size, "m").s, at->relative,
               cli_format("%.3g to %.3g", at->low, at->high).s, cli_amount(at->pressure, "Pa").s);
    }
    puts("\nPublished exponents of strength ~ b^-x");
    for (size_t i = 0; (x = lac_size_exponent_get(i)) != NULL; i++) {
        printf("  %-10s %-20s %-18s %s\n",
               cli_format(x->high > x->low ? "%.2f-%.2f" : "%.2f", x->low, x->high).s, x->quantity,
               isfinite(x->shortest_m) ? cli_format("%s to %s", cli_amount(x->shortest_m, "m").s,
                                                    cli_amount(x->longest_m, "m").s)
                                             .s
                                       : "lengths not stated",
               x->source);
    }
}

// The history of loads, as a table in units that suit the largest values.
enum { WIDTH = 12 };
#define OF(field) .at = offsetof(lac_history_record, field)
enum { P, Q_X, Q_Y, SHIFT_X, SHIFT_Y, STICK, WORK, HIGHEST, HIGHEST_X, HIGHEST_Y, COLUMNS };

// One column of the table of steps: a value of each, shown in a unit that suits the largest.
typedef struct column {
    const char *name, *unit;
    size_t at; // in a lac_history_record, of what is held there
    double largest, scale;
    const char *prefix;
    bool shown;
} column;

static double value_of(const lac_contact_outcome *o, size_t step, const column *c)
{
    const lac_history_record *r = &o->record[step];
    double value;
    memcpy(&value, (const char *)r + c->at, sizeof value);
    if (c->unit[0] == '%') {
        return 100.0 * (double)r->shear.stick_cells / (double)r->shear.contact_cells;
    }
    const bool none = c->unit[0] == '\0' && isnan(r->highest[0]);
    return none                ? (double)NAN
           : c->unit[0] == 'N' ? value * lac_grid_area(&o->contact->grid)
                               : value;
}

// The unit with the prefix in which the largest value is at least 1.
static void choose_unit(const lac_contact_outcome *o, column *c)
{
    static const char prefixes[][2] = {"G", "M", "k", "", "m", "u", "n"};
    static const double scales[] = {1e9, 1e6, 1e3, 1, 1e-3, 1e-6, 1e-9};
    enum { UNITS = sizeof scales / sizeof *scales, METRE = 3 };
    const bool bare = c->unit[0] == '%' || c->unit[0] == '\0';
    c->shown = true;
    c->scale = 1;
    c->prefix = "";
    for (size_t i = 0; i < o->result->steps; i++) {
        c->largest = fmax(c->largest, fabs(value_of(o, i, c)));
    }
    for (size_t i = c->unit[0] == 'm' ? METRE : 0; !bare && c->largest > 0 && i < UNITS; i++) {
        c->scale = scales[i];
        c->prefix = prefixes[i];
        if (c->largest >= c->scale) {
            break;
        }
    }
}

// Two columns that belong together are read in one unit.
static void share_unit(column *a, column *b)
{
    column *smaller = a->largest >= b->largest ? b : a;
    const column *larger = smaller == a ? b : a;
    smaller->scale = larger->scale;
    smaller->prefix = larger->prefix;
}

// An axis that is not loaded and hardly moves takes no room.
static void hide_idle_axis(column *columns)
{
    const double idle_load = 1e-6, idle_shift = 0.01;
    for (int i = 1; i >= 0; i--) {
        int other = 1 - i;
        if (columns[Q_X + i].largest <= idle_load * columns[Q_X + other].largest &&
            columns[SHIFT_X + i].largest <= idle_shift * columns[SHIFT_X + other].largest &&
            columns[Q_X + other].shown) {
            columns[Q_X + i].shown = false;
            columns[SHIFT_X + i].shown = false;
        }
    }
}

static void print_step(const lac_contact_outcome *o, size_t step, const column *columns)
{
    const double noise = 1e-9;
    printf("  %5zu", step + 1);
    for (const column *c = columns; c < columns + COLUMNS; c++) {
        const double value = value_of(o, step, c);
        if (c->shown && isnan(value)) {
            printf(" %*s", WIDTH, "-");
        } else if (c->shown) {
            printf(" %*.5g", WIDTH, fabs(value) > noise * c->largest ? value / c->scale : 0.0);
        }
    }
    putchar('\n');
}

// The closed ones; a history of thousands of increments may close as many.
static void print_cycles(const lac_contact_outcome *o, const column *work)
{
    enum { MOST = 20 };
    double longest = 0;
    size_t printed = 0;
    for (size_t i = 0; i < o->result->steps; i++) {
        const double *shift = o->record[i].shear.shift;
        longest = fmax(longest, hypot(shift[0], shift[1]));
    }
    for (size_t i = 0; i < o->result->steps; i++) {
        const lac_history_record *r = &o->record[i];
        if (r->cycle_start == SIZE_MAX || r->cycle_shift > 0.01 * longest) {
            continue;
        }
        if (printed++ == MOST) {
            cli_row("more cycles", "in the file and with --json");
            return;
        }
        cli_row(cli_format("cycle %zu to %zu", r->cycle_start, i + 1).s,
                "%.5g %sJ of frictional work", r->cycle_dissipation / work->scale, work->prefix);
    }
}

static void print_history(const lac_contact_outcome *o)
{
    const lac_history_result *r = o->result;
    column columns[COLUMNS] = {
        [P] = {"P", "N", OF(pressure)},
        [Q_X] = {"Q_x", "N", OF(shear.traction[0])},
        [Q_Y] = {"Q_y", "N", OF(shear.traction[1])},
        [SHIFT_X] = {"shift_x", "m", OF(shear.shift[0])},
        [SHIFT_Y] = {"shift_y", "m", OF(shear.shift[1])},
        [STICK] = {.name = "stick", .unit = "%"},
        [WORK] = {"work", "J", OF(shear.dissipation)},
        [HIGHEST] = {"q/(f p)", "", OF(shear.highest_ratio)},
        [HIGHEST_X] = {"at x", "m", OF(highest[0])},
        [HIGHEST_Y] = {"y", "m", OF(highest[1])},
    };
    for (size_t i = 0; i < COLUMNS; i++) {
        choose_unit(o, &columns[i]);
    }
    share_unit(&columns[Q_X], &columns[Q_Y]);
    share_unit(&columns[SHIFT_X], &columns[SHIFT_Y]);
    share_unit(&columns[HIGHEST_X], &columns[HIGHEST_Y]);
    hide_idle_axis(columns);
    cli_row("friction", "%.4g", o->friction);
    cli_row("steps", "%zu of %zu (%s)", r->steps, r->planned, o->status);
    if (r->loaded) {
        cli_row("first slip", "at %.4g f P if nothing slipped before, at x = %s, y = %s",
                r->first_slip.factor, cli_amount(r->first_place[0], "m").s,
                cli_amount(r->first_place[1], "m").s);
    }
    printf("\n  %5s", "step");
    for (const column *c = columns; c < columns + COLUMNS; c++) {
        if (c->shown) {
            printf(
                " %*s", WIDTH,
                cli_format(*c->unit == '\0' ? "%s" : "%s (%s%s)", c->name, c->prefix, c->unit).s);
        }
    }
    putchar('\n');
    for (size_t i = 0; i < r->steps; i++) {
        print_step(o, i, columns);
    }
    putchar('\n');
    print_cycles(o, &columns[WORK]);
}

void cli_contact_print(const lac_case *c, const lac_contact_outcome *outcome, const char *path,
                       bool tables)
{
    const lac_scene_contact *contact = outcome->contact;
    const lac_contact_stats *report = &contact->report;
    if (c->title != NULL) {
        puts(c->title);
    }
    if (contact->solved) {
        print_surface(&contact->surface);
    }
    cli_row_quantity("nominal pressure", contact->mean_pressure, "Pa");
    cli_measures_print(contact);
    print_fractal(contact);
    if (contact->solved) {
        cli_row("iterations", "%" PRId64 " (%" PRId64 " elastic products)", report->iterations,
                report->products);
        cli_row("complementarity", "%.2g", report->complementarity_error);
        cli_row_quantity("penetration", fabs(report->penetration), "m");
        cli_row_quantity("approach", report->approach, "m");
    }
    if (outcome->result != NULL) {
        print_history(outcome);
    }
    cli_row("time taken", "CPU %s", cli_amount(cli_cpu_time(), "s").s);
    cli_row("file", "%s", path);
    if (tables && contact->fractal.sizes > 0) {
        print_sizes(&contact->fractal);
    }
}
