// SPDX-License-Identifier: GPL-3.0-or-later
// The grid that `interface` describes, and what is wrong with it as a whole.
#include <math.h>

#include "case/sections.h"

// Beyond this the contact of some surfaces did not converge.
static const double most_oblong = 1e4;

lac_grid lac_interface_grid(const lac_interface_def *def)
{
    bool counted = def->cells_x > 0;
    size_t nx = counted ? (size_t)def->cells_x : (size_t)1 << (def->levels > 0 ? def->levels : 0);
    size_t ny = counted && def->cells_y > 0 ? (size_t)def->cells_y : nx;
    double dx = def->size / (double)nx;
    lac_grid grid = {.nx = nx, .ny = ny, .dx = dx, .dy = dx};
    grid.periodic = def->boundary == LAC_PERIODIC;
    if (def->shape == LAC_LINE) {
        grid.ny = 1;
        grid.dy = 1.0; // forces on a line are per metre of width
    } else if (def->width > 0) {
        grid.dy = def->width / (double)ny;
    }
    return grid;
}

static void check_cells(lac_reader *reader, const lac_interface_def *def)
{
    bool along_x = lac_present(reader, "interface.cells_x");
    bool along_y = lac_present(reader, "interface.cells_y");
    if (along_x && lac_present(reader, "interface.levels")) {
        lac_blame_key(reader, "interface.cells_x",
                      "is given beside interface.levels; exactly one is allowed");
    } else if (along_y && !along_x) {
        lac_blame_key(reader, "interface.cells_y", "goes with interface.cells_x");
    } else if (along_x) {
        lac_grid grid = lac_interface_grid(def);
        double cells = (double)grid.nx * (double)grid.ny;
        if (cells > LAC_MOST_CELLS) {
            lac_blame_key(reader, along_y ? "interface.cells_y" : "interface.cells_x",
                          "makes %.0f cells; at most %.0f (4096 x 4096) are possible", cells,
                          (double)LAC_MOST_CELLS);
        }
    }
}

static void check_line(lac_reader *reader, const lac_interface_def *def)
{
    if (def->shape != LAC_LINE) {
        return;
    }
    if (def->cells_y > 1) {
        lac_blame_key(reader, "interface.cells_y", "must be 1 or absent on a line");
    }
    if (!isnan(def->width)) {
        lac_blame_key(reader, "interface.width",
                      "must be absent on a line, whose forces are for each metre of width");
    }
    bool pressed = lac_present(reader, "interface.surface") || lac_present(reader, "load.history");
    if (def->boundary == LAC_FREE && pressed) {
        lac_blame_key(
            reader, "interface.boundary",
            "must be periodic on a line that is pressed or has a static history; a strip that "
            "ends is a plane with cells_y: 1 and a width");
    }
}

static void check_width(lac_reader *reader, const lac_interface_def *def)
{
    lac_grid grid = lac_interface_grid(def);
    double ratio = fmax(grid.dx / grid.dy, grid.dy / grid.dx);
    if (!isnan(def->width) && ratio > most_oblong) {
        lac_blame_key(reader, "interface.width",
                      "makes cells of %g m by %g m; one side may be at most %g times the other",
                      grid.dx, grid.dy, most_oblong);
    }
}

// A grid of several cells must say which of them touch, and how large they are.
static void check_source(lac_reader *reader, lac_interface_def *def)
{
    bool surface = lac_present(reader, "interface.surface");
    bool domain = lac_present(reader, "interface.domain");
    lac_grid grid = lac_interface_grid(def);
    if (lac_grid_cells(&grid) > 1) {
        if (!surface && !domain) {
            lac_blame_key(reader, "interface.surface", "is missing: %s needs a surface or a domain",
                          def->cells_x > 0 ? "a grid of cells" : "levels > 0");
        }
        if (isnan(def->size)) {
            lac_blame_key(reader, "interface.size", "is missing: must be a length such as \"1 m\"");
        }
        return;
    }
    if (surface || domain) {
        lac_blame_key(
            reader, surface ? "interface.surface" : "interface.domain",
            "needs interface.levels > 0, or more cells_x or cells_y: a single block has no cells");
    }
    if (isnan(def->size)) {
        def->size = 1.0;
    }
}

void lac_check_interface(lac_reader *reader, lac_interface_def *def)
{
    if (lac_present(reader, "interface.surface") && lac_present(reader, "interface.domain")) {
        lac_blame_key(reader, "interface.domain",
                      "is given beside interface.surface; exactly one is allowed");
    }
    if (lac_present(reader, "interface.spread") && !lac_present(reader, "interface.domain")) {
        lac_blame_key(reader, "interface.spread",
                      "goes with interface.domain; the pressures of a surface follow from pressing "
                      "it");
    }
    if (!lac_clean(reader, "interface")) {
        return;
    }
    if (def->cells_x <= 0 && def->levels < 0) {
        def->levels = 0;
    }
    check_cells(reader, def);
    check_line(reader, def);
    if (lac_clean(reader, "interface")) {
        check_source(reader, def);
        check_width(reader, def);
    }
}
