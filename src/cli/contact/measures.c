// SPDX-License-Identifier: GPL-3.0-or-later
// The contact in numbers, as rows or JSON: cells, pressures, box dimension and what weakens it.
#include "cli/contact/measures.h"

#include <math.h>

#include "cli/common/words.h"
#include "data/dataset.h"

static double fraction(const lac_scene_contact *contact)
{
    return (double)contact->domain->n / (double)lac_grid_cells(&contact->grid);
}

// Over the cells that touch.
static double mean_real_pressure(const lac_domain *domain)
{
    double sum = 0;
    for (size_t i = 0; i < domain->n; i++) {
        sum += domain->pressure[i];
    }
    return sum / (double)domain->n;
}

static double max_pressure(const lac_domain *domain)
{
    double largest = 0;
    for (size_t i = 0; i < domain->n; i++) {
        largest = fmax(largest, domain->pressure[i]);
    }
    return largest;
}

static const char *weakness(const lac_box_count *boxes)
{
    if (boxes->few_cells) {
        return " (weak: fewer than 500 cells)";
    }
    return boxes->dense ? " (more than 30 % of the area: not a fractal set)" : "";
}

static void print_grid(const lac_grid *grid)
{
    char side[32], width[40] = "";
    if (grid->ny > 1 && fabs(grid->dy / grid->dx - 1) > 1e-9) {
        (void)snprintf(width, sizeof width, " x ");
        (void)cli_quantity(grid->dy, "m", width + 3, sizeof width - 3);
    }
    cli_row("grid", "%zu x %zu cells of %s%s%s", grid->nx, grid->ny,
            cli_quantity(grid->dx, "m", side, sizeof side), width,
            grid->periodic ? "" : ", free at its border");
}

void cli_measures_print(const lac_scene_contact *contact)
{
    const lac_grid *grid = &contact->grid;
    print_grid(grid);
    cli_row("contact cells", "%zu (%.3g %% of the area)", contact->domain->n,
            100 * fraction(contact));
    cli_row_quantity("mean real pressure", mean_real_pressure(contact->domain), "Pa");
    cli_row_quantity("largest pressure", max_pressure(contact->domain), "Pa");
    if (contact->counted) {
        cli_row("D_box", "%.3f +/- %.3f%s", contact->boxes.dimension, contact->boxes.error,
                weakness(&contact->boxes));
    } else if (lac_grid_cells(grid) > 1) {
        cli_row("D_box", "none: the grid or the contact is too small to count boxes");
    }
    if (isfinite(contact->blocks.dimension)) {
        cli_row("D of all blocks", "%.4f", contact->blocks.dimension);
    }
}

lac_status cli_measures_json(lac_json *json, const lac_scene_contact *contact, lac_error *err)
{
    const lac_contact_outcome outcome = {.contact = contact, .brief = true};
    lac_dataset *dataset = NULL;
    lac_status status = lac_contact_describe(&outcome, &dataset, err);
    if (status == LAC_OK) {
        lac_dataset_json(dataset, json);
    }
    lac_dataset_free(dataset);
    return status;
}
