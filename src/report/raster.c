// SPDX-License-Identifier: GPL-3.0-or-later
// The maps of a page: cells gathered into squares, so that the page of a large joint stays small.
#include <math.h>
#include <string.h>

#include "report/cells.h"

enum { WIDEST = 512 };

// The grid that the cells are part of, and the cells' places on it.
typedef struct grid {
    size_t nx, ny;
    double dx, dy;
    lac_stored_values x, y;
} grid;

static bool read_count(const lac_stored_file *file, const char *name, size_t *out)
{
    const double value = lac_stored_file_number(file, NULL, name);
    const bool sound = value >= 1.0 && value <= 1e9;
    *out = sound ? (size_t)value : 0;
    return sound;
}

// @return false: nothing that a map could be drawn of
static bool read_grid(lac_page *page, grid *g)
{
    g->x = lac_page_values(page, page->file, "x");
    g->y = lac_page_values(page, page->file, "y");
    g->dx = lac_stored_file_number(page->file, NULL, "grid_dx_m");
    g->dy = lac_stored_file_number(page->file, NULL, "grid_dy_m");
    return read_count(page->file, "grid_nx", &g->nx) && read_count(page->file, "grid_ny", &g->ny) &&
           g->dx > 0.0 && g->dy > 0.0 && g->x.value != NULL && g->y.value != NULL &&
           g->x.n == g->y.n && g->x.n / g->nx <= g->ny;
}

static size_t along(double position, double side, size_t n)
{
    const double place = floor(position / side);
    return place > 0.0 ? (place < (double)n ? (size_t)place : n - 1) : 0;
}

static size_t place_of(const grid *g, const lac_page_raster *r, size_t i)
{
    return along(g->y.value[i], r->dy, r->ny) * r->nx + along(g->x.value[i], r->dx, r->nx);
}

static void choose_block(const grid *g, size_t block, lac_page_raster *r)
{
    r->block = block;
    r->nx = (g->nx + block - 1) / block;
    r->ny = (g->ny + block - 1) / block;
    r->dx = g->dx * (double)block;
    r->dy = g->dy * (double)block;
}

// Numbers the squares that hold a cell; false where they are too many.
static bool number_squares(const grid *g, size_t most, uint32_t *number, lac_page_raster *r)
{
    memset(number, 0xff, r->nx * r->ny * sizeof *number);
    r->squares = 0;
    for (size_t i = 0; i < r->cells; i++) {
        const size_t place = place_of(g, r, i);
        if (number[place] == UINT32_MAX) {
            if (r->squares == most) {
                return false;
            }
            r->place[r->squares] = (uint32_t)place;
            r->count[r->squares] = 0;
            number[place] = (uint32_t)r->squares++;
        }
        r->square[i] = number[place];
        r->count[number[place]]++;
    }
    return true;
}

bool lac_page_raster_create(lac_page *page, size_t most, lac_page_raster *r)
{
    grid g = {0};
    size_t block = 1;
    *r = (lac_page_raster){0};
    if (!read_grid(page, &g) || g.x.n < 2) {
        return false;
    }
    r->cells = g.x.n;
    while (g.nx / block > WIDEST || g.ny / block > WIDEST) {
        block *= 2;
    }
    choose_block(&g, block, r);
    uint32_t *number = lac_page_room(page, r->nx * r->ny * sizeof *number);
    r->square = lac_page_room(page, r->cells * sizeof *r->square);
    r->place = lac_page_room(page, most * sizeof *r->place);
    r->count = lac_page_room(page, most * sizeof *r->count);
    if (page->status != LAC_OK) {
        return false;
    }
    while (!number_squares(&g, most, number, r)) {
        block *= 2;
        choose_block(&g, block, r);
    }
    return true;
}

static void take_in(lac_page_summary how, double value, double limit, double *out)
{
    if (how == LAC_PAGE_MEAN) {
        *out += value; // of a square that lacks one nothing is known
    } else if (isnan(value)) {
        return;
    } else if (how == LAC_PAGE_MOST) {
        *out = isnan(*out) || value > *out ? value : *out;
    } else {
        *out = (isnan(*out) ? 0.0 : *out) + (value >= limit);
    }
}

void lac_page_raster_summarise(const lac_page_raster *raster, lac_page_summary how,
                               const double *value, double limit, double *out)
{
    for (size_t k = 0; k < raster->squares; k++) {
        out[k] = how == LAC_PAGE_MEAN ? 0.0 : NAN;
    }
    for (size_t i = 0; i < raster->cells; i++) {
        take_in(how, value[i], limit, &out[raster->square[i]]);
    }
    for (size_t k = 0; how != LAC_PAGE_MOST && k < raster->squares; k++) {
        out[k] /= (double)raster->count[k];
    }
}
