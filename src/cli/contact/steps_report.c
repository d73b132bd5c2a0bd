// SPDX-License-Identifier: GPL-3.0-or-later
// A history of loads as JSON, or as a table in units that suit the largest values.
#include <math.h>

#include "cli/common/words.h"
#include "cli/contact/steps.h"

enum { WIDTH = 12 };

// One column of the table: a value of a record, shown in a unit that suits the largest.
typedef struct column {
    const char *name, *unit;
    double (*value)(const lac_history_record *record, const lac_grid *grid);
    double largest, scale;
    const char *prefix;
    bool shown;
} column;

static double normal_force(const lac_history_record *r, const lac_grid *grid)
{
    return r->pressure * lac_grid_area(grid);
}

static double shear_x(const lac_history_record *r, const lac_grid *grid)
{
    return r->shear.traction[0] * lac_grid_area(grid);
}

static double shear_y(const lac_history_record *r, const lac_grid *grid)
{
    return r->shear.traction[1] * lac_grid_area(grid);
}

static double shift_x(const lac_history_record *r, const lac_grid *grid)
{
    (void)grid;
    return r->shear.shift[0];
}

static double shift_y(const lac_history_record *r, const lac_grid *grid)
{
    (void)grid;
    return r->shear.shift[1];
}

// Of the contact cells.
static double stick(const lac_history_record *r, const lac_grid *grid)
{
    (void)grid;
    return 100.0 * (double)r->shear.stick_cells / (double)r->shear.contact_cells;
}

static double work(const lac_history_record *r, const lac_grid *grid)
{
    (void)grid;
    return r->shear.dissipation;
}

static double highest(const lac_history_record *r, const lac_grid *grid)
{
    (void)grid;
    return isnan(r->highest[0]) ? NAN : r->shear.highest_ratio;
}

static double highest_x(const lac_history_record *r, const lac_grid *grid)
{
    (void)grid;
    return r->highest[0];
}

static double highest_y(const lac_history_record *r, const lac_grid *grid)
{
    (void)grid;
    return r->highest[1];
}

enum { P, Q_X, Q_Y, SHIFT_X, SHIFT_Y, STICK, WORK, HIGHEST, HIGHEST_X, HIGHEST_Y, COLUMNS };

static const column all_columns[COLUMNS] = {
    [P] = {.name = "P", .unit = "N", .value = normal_force},
    [Q_X] = {.name = "Q_x", .unit = "N", .value = shear_x},
    [Q_Y] = {.name = "Q_y", .unit = "N", .value = shear_y},
    [SHIFT_X] = {.name = "shift_x", .unit = "m", .value = shift_x},
    [SHIFT_Y] = {.name = "shift_y", .unit = "m", .value = shift_y},
    [STICK] = {.name = "stick", .unit = "%", .value = stick},
    [WORK] = {.name = "work", .unit = "J", .value = work},
    [HIGHEST] = {.name = "q/(f p)", .unit = "", .value = highest},
    [HIGHEST_X] = {.name = "at x", .unit = "m", .value = highest_x},
    [HIGHEST_Y] = {.name = "y", .unit = "m", .value = highest_y},
};

// The unit with the prefix in which the largest value is at least 1.
static void choose_unit(column *c, const cli_steps *steps)
{
    static const struct {
        double scale;
        const char *prefix;
    } units[] = {{1e9, "G"},  {1e6, "M"},  {1e3, "k"}, {1, ""},
                 {1e-3, "m"}, {1e-6, "u"}, {1e-9, "n"}};
    enum { UNITS = sizeof units / sizeof units[0], METRE = 3 };
    bool length = c->unit[0] == 'm';
    bool bare = c->unit[0] == '%' || c->unit[0] == '\0';
    c->shown = true;
    c->largest = 0;
    c->scale = 1;
    c->prefix = "";
    for (size_t i = 0; i < steps->result.steps; i++) {
        c->largest = fmax(c->largest, fabs(c->value(&steps->record[i], &steps->grid)));
    }
    for (size_t i = length ? METRE : 0; !bare && c->largest > 0 && i < UNITS; i++) {
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
    const column *larger = a->largest >= b->largest ? a : b;
    const double scale = larger->scale;
    const char *prefix = larger->prefix;
    a->scale = scale;
    b->scale = scale;
    a->prefix = prefix;
    b->prefix = prefix;
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
    for (size_t i = 0; i < COLUMNS; i++) {
        char head[32];
        bool bare = columns[i].unit[0] == '\0';
        if (!columns[i].shown) {
            continue;
        }
        (void)snprintf(head, sizeof head, "%s%s%s%s%s", columns[i].name, bare ? "" : " (",
                       bare ? "" : columns[i].prefix, columns[i].unit, bare ? "" : ")");
        printf(" %*s", WIDTH, head);
    }
    putchar('\n');
}

static void print_step(const cli_steps *steps, size_t at, const column *columns)
{
    const lac_history_record *record = &steps->record[at];
    const double noise = 1e-9;
    printf("  %5zu", at + 1);
    for (size_t i = 0; i < COLUMNS; i++) {
        double value = columns[i].value(record, &steps->grid);
        if (!columns[i].shown) {
            continue;
        }
        if (isnan(value)) {
            printf(" %*s", WIDTH, "-");
        } else {
            value = fabs(value) > noise * columns[i].largest ? value / columns[i].scale : 0.0;
            printf(" %*.5g", WIDTH, value);
        }
    }
    putchar('\n');
}

static double longest_shift(const cli_steps *steps)
{
    double longest = 0;
    for (size_t i = 0; i < steps->result.steps; i++) {
        const double *shift = steps->record[i].shear.shift;
        longest = fmax(longest, hypot(shift[0], shift[1]));
    }
    return longest;
}

// The closed ones; a history of thousands of increments may close as many.
static void print_cycles(const cli_steps *steps, const column *work_column)
{
    enum { MOST = 20 };
    const double closed = 0.01 * longest_shift(steps);
    size_t printed = 0;
    for (size_t i = 0; i < steps->result.steps; i++) {
        const lac_history_record *record = &steps->record[i];
        char label[48];
        if (record->cycle_start == SIZE_MAX || record->cycle_shift > closed) {
            continue;
        }
        if (printed++ == MOST) {
            cli_row("more cycles", "in the file and with --json");
            return;
        }
        (void)snprintf(label, sizeof label, "cycle %zu to %zu", record->cycle_start, i + 1);
        cli_row(label, "%.5g %sJ of frictional work",
                record->cycle_dissipation / work_column->scale, work_column->prefix);
    }
}

static void print_first_slip(const cli_steps *steps)
{
    const lac_history_result *result = &steps->result;
    char x[32], y[32];
    if (result->loaded) {
        cli_row("first slip", "at %.4g f P if nothing slipped before, at x = %s, y = %s",
                result->first_slip.factor, cli_quantity(result->first_place[0], "m", x, sizeof x),
                cli_quantity(result->first_place[1], "m", y, sizeof y));
    }
}

void cli_steps_print(const cli_steps *steps)
{
    column columns[COLUMNS];
    for (size_t i = 0; i < COLUMNS; i++) {
        columns[i] = all_columns[i];
        choose_unit(&columns[i], steps);
    }
    share_unit(&columns[Q_X], &columns[Q_Y]);
    share_unit(&columns[SHIFT_X], &columns[SHIFT_Y]);
    share_unit(&columns[HIGHEST_X], &columns[HIGHEST_Y]);
    hide_idle_axis(columns);
    cli_row("friction", "%.4g, direct", steps->friction);
    cli_row("steps", "%zu of %zu (%s)", steps->result.steps, steps->result.planned, steps->status);
    print_first_slip(steps);
    print_header(columns);
    for (size_t i = 0; i < steps->result.steps; i++) {
        print_step(steps, i, columns);
    }
    putchar('\n');
    print_cycles(steps, &columns[WORK]);
}

static void write_step(lac_json *json, const lac_history_record *r, const lac_grid *grid)
{
    const lac_tangential_report *shear = &r->shear;
    lac_json_open(json, NULL, '{');
    lac_json_number(json, "p_N", normal_force(r, grid));
    lac_json_number(json, "q_N", shear_x(r, grid));
    lac_json_number(json, "q_y_N", shear_y(r, grid));
    lac_json_number(json, "shift_m", shear->shift[0]);
    lac_json_number(json, "shift_y_m", shear->shift[1]);
    lac_json_integer(json, "contact_cells", (int64_t)shear->contact_cells);
    lac_json_integer(json, "stick_cells", (int64_t)shear->stick_cells);
    lac_json_integer(json, "slip_cells", (int64_t)shear->slip_cells);
    lac_json_number(json, "dissipation_J", shear->dissipation);
    lac_json_number(json, "cumulative_dissipation_J", r->dissipated);
    if (r->cycle_start == SIZE_MAX) {
        lac_json_null(json, "cycle_start");
    } else {
        lac_json_integer(json, "cycle_start", (int64_t)r->cycle_start);
    }
    lac_json_number(json, "cycle_dissipation_J", r->cycle_dissipation);
    lac_json_number(json, "cycle_shift_m", r->cycle_shift);
    lac_json_number(json, "highest_ratio", highest(r, grid));
    lac_json_number(json, "highest_x_m", r->highest[0]);
    lac_json_number(json, "highest_y_m", r->highest[1]);
    lac_json_integer(json, "iterations", shear->iterations);
    lac_json_integer(json, "products", shear->products);
    lac_json_integer(json, "contact_iterations", r->contact_iterations);
    lac_json_number(json, "residual", shear->residual);
    lac_json_close(json, '}');
}

static void write_first_slip(lac_json *json, const cli_steps *steps)
{
    const lac_first_slip *first = &steps->result.first_slip;
    if (!steps->result.loaded) {
        lac_json_null(json, "first_slip");
        return;
    }
    lac_json_open(json, "first_slip", '{');
    lac_json_number(json, "q_over_fp", first->factor);
    lac_json_number(json, "q_N", first->load * lac_grid_area(&steps->grid));
    lac_json_number(json, "x_m", steps->result.first_place[0]);
    lac_json_number(json, "y_m", steps->result.first_place[1]);
    lac_json_number(json, "shift_m", first->shift[0]);
    lac_json_number(json, "shift_y_m", first->shift[1]);
    lac_json_close(json, '}');
}

void cli_steps_json(lac_json *json, const cli_steps *steps)
{
    lac_json_text(json, "status", steps->status);
    lac_json_text(json, "history_method", "direct");
    lac_json_number(json, "friction_coefficient", steps->friction);
    lac_json_integer(json, "planned_steps", (int64_t)steps->result.planned);
    write_first_slip(json, steps);
    lac_json_open(json, "steps", '[');
    for (size_t i = 0; i < steps->result.steps; i++) {
        write_step(json, &steps->record[i], &steps->grid);
    }
    lac_json_close(json, ']');
}
