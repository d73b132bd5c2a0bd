// SPDX-License-Identifier: GPL-3.0-or-later
// A history of loads as a table in units that suit the largest values.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cli/common/words.h"
#include "cli/contact/contact.h"

enum { WIDTH = 12 };
enum { P, Q_X, Q_Y, SHIFT_X, SHIFT_Y, STICK, WORK, HIGHEST, HIGHEST_X, HIGHEST_Y, COLUMNS };

// One column of the table: a value of every step, shown in a unit that suits the largest.
typedef struct column {
    const char *name, *unit;
    double largest, scale;
    const char *prefix;
    bool shown;
} column;

static const column all_columns[COLUMNS] = {
    [P] = {.name = "P", .unit = "N"},
    [Q_X] = {.name = "Q_x", .unit = "N"},
    [Q_Y] = {.name = "Q_y", .unit = "N"},
    [SHIFT_X] = {.name = "shift_x", .unit = "m"},
    [SHIFT_Y] = {.name = "shift_y", .unit = "m"},
    [STICK] = {.name = "stick", .unit = "%"},
    [WORK] = {.name = "work", .unit = "J"},
    [HIGHEST] = {.name = "q/(f p)", .unit = ""},
    [HIGHEST_X] = {.name = "at x", .unit = "m"},
    [HIGHEST_Y] = {.name = "y", .unit = "m"},
};

// Sticking is of the contact cells.
static double value_of(const lac_contact_outcome *o, size_t step, size_t at)
{
    const lac_history_record *r = &o->record[step];
    const lac_tangential_stats *shear = &r->shear;
    const double area = lac_grid_area(&o->contact->grid);
    const double value[COLUMNS] = {
        [P] = r->pressure * area,
        [Q_X] = shear->traction[0] * area,
        [Q_Y] = shear->traction[1] * area,
        [SHIFT_X] = shear->shift[0],
        [SHIFT_Y] = shear->shift[1],
        [STICK] = 100.0 * (double)shear->stick_cells / (double)shear->contact_cells,
        [WORK] = shear->dissipation,
        [HIGHEST] = isnan(r->highest[0]) ? (double)NAN : shear->highest_ratio,
        [HIGHEST_X] = r->highest[0],
        [HIGHEST_Y] = r->highest[1],
    };
    return value[at];
}

// The unit with the prefix in which the largest value is at least 1.
static void choose_unit(const lac_contact_outcome *o, size_t at, column *c)
{
    static const struct {
        double scale;
        const char *prefix;
    } units[] = {{1e9, "G"},  {1e6, "M"},  {1e3, "k"}, {1, ""},
                 {1e-3, "m"}, {1e-6, "u"}, {1e-9, "n"}};
    enum { UNITS = sizeof units / sizeof units[0], METRE = 3 };
    const bool bare = c->unit[0] == '%' || c->unit[0] == '\0';
    c->shown = true;
    c->scale = 1;
    c->prefix = "";
    for (size_t i = 0; i < o->result->steps; i++) {
        c->largest = fmax(c->largest, fabs(value_of(o, i, at)));
    }
    for (size_t i = c->unit[0] == 'm' ? METRE : 0; !bare && c->largest > 0 && i < UNITS; i++) {
        c->scale = units[i].scale;
        c->prefix = units[i].prefix;
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

static void print_header(const column *columns)
{
    printf("\n  %5s", "step");
    for (const column *c = columns; c < columns + COLUMNS; c++) {
        if (c->shown) {
            const bool bare = c->unit[0] == '\0';
            printf(" %*s", WIDTH,
                   cli_format(bare ? "%s" : "%s (%s%s)", c->name, c->prefix, c->unit).s);
        }
    }
    putchar('\n');
}

static void print_step(const lac_contact_outcome *o, size_t step, const column *columns)
{
    const double noise = 1e-9;
    printf("  %5zu", step + 1);
    for (size_t i = 0; i < COLUMNS; i++) {
        const column *c = &columns[i];
        const double value = value_of(o, step, i);
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

void cli_steps_print(const lac_contact_outcome *o)
{
    const lac_history_result *r = o->result;
    column columns[COLUMNS];
    memcpy(columns, all_columns, sizeof columns);
    for (size_t i = 0; i < COLUMNS; i++) {
        choose_unit(o, i, &columns[i]);
    }
    share_unit(&columns[Q_X], &columns[Q_Y]);
    share_unit(&columns[SHIFT_X], &columns[SHIFT_Y]);
    share_unit(&columns[HIGHEST_X], &columns[HIGHEST_Y]);
    hide_idle_axis(columns);
    cli_row("friction", "%.4g, direct", o->friction);
    cli_row("steps", "%zu of %zu (%s)", r->steps, r->planned, o->status);
    if (r->loaded) {
        cli_row("first slip", "at %.4g f P if nothing slipped before, at x = %s, y = %s",
                r->first_slip.factor, cli_amount(r->first_place[0], "m").s,
                cli_amount(r->first_place[1], "m").s);
    }
    print_header(columns);
    for (size_t i = 0; i < r->steps; i++) {
        print_step(o, i, columns);
    }
    putchar('\n');
    print_cycles(o, &columns[WORK]);
}
