// SPDX-License-Identifier: GPL-3.0-or-later
// The grid that `interface` describes, and what is wrong with it as a whole.
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
    bool along_x = HAS("interface.cells_x"), along_y = HAS("interface.cells_y");
    lac_grid grid = lac_interface_grid(def);
    double cells = (double)grid.nx * (double)grid.ny;
    (void)(lac_refuse(reader, along_x && HAS("interface.levels"), "interface.cells_x",
                      "is given beside interface.levels; exactly one is allowed") ||
           lac_refuse(reader, along_y && !along_x, "interface.cells_y",
                      "goes with interface.cells_x") ||
           lac_refuse(reader, along_x && cells > LAC_MOST_CELLS,
                      along_y ? "interface.cells_y" : "interface.cells_x",
                      "makes %.0f cells; at most %.0f (32768 x 32768) are possible", cells,
                      (double)LAC_MOST_CELLS));
}

static void check_line(lac_reader *reader, const lac_interface_def *def)
{
    bool line = def->shape == LAC_LINE;
    bool pressed = HAS("interface.surface") || HAS("load.history");
    (void)lac_refuse(reader, line && def->cells_y > 1, "interface.cells_y",
                     "must be 1 or absent on a line");
    (void)lac_refuse(reader, line && !isnan(def->width), "interface.width",
                     "must be absent on a line, whose forces are for each metre of width");
    (void)lac_refuse(reader, line && def->boundary == LAC_FREE && pressed, "interface.boundary",
                     "must be periodic on a line that is pressed or has a static history; a strip "
                     "that ends is a plane with cells_y: 1 and a width");
}

// A grid of several cells must say which of them touch, and how large they are.
static void check_source(lac_reader *reader, lac_interface_def *def)
{
    bool surface = HAS("interface.surface");
    bool given = surface || HAS("interface.domain");
    lac_grid grid = lac_interface_grid(def);
    bool several = lac_grid_cells(&grid) > 1;
    (void)lac_refuse(reader, several && !given, "interface.surface",
                     "is missing: %s needs a surface or a domain",
                     def->cells_x > 0 ? "a grid of cells" : "levels > 0");
    (void)lac_refuse(reader, several && isnan(def->size), "interface.size",
                     "is missing: must be a length such as \"1 m\"");
    (void)lac_refuse(
        reader, !several && given, surface ? "interface.surface" : "interface.domain",
        "needs interface.levels > 0, or more cells_x or cells_y: a single block has no cells");
    if (!several && isnan(def->size)) {
        def->size = 1.0;
    }
}

void lac_check_interface(lac_reader *reader, lac_interface_def *def)
{
    (void)lac_refuse(reader, HAS("interface.surface") && HAS("interface.domain"),
                     "interface.domain",
                     "is given beside interface.surface; exactly one is allowed");
    (void)lac_refuse(
        reader, HAS("interface.spread") && !HAS("interface.domain"), "interface.spread",
        "goes with interface.domain; the pressures of a surface follow from pressing it");
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
        const lac_grid grid = lac_interface_grid(def);
        const double ratio = fmax(grid.dx / grid.dy, grid.dy / grid.dx);
        (void)lac_refuse(reader, !isnan(def->width) && ratio > most_oblong, "interface.width",
                         "makes cells of %g m by %g m; one side may be at most %g times the other",
                         grid.dx, grid.dy, most_oblong);
    }
}
