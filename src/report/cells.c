// SPDX-License-Identifier: GPL-3.0-or-later
// The contact domain: its pressure, and what its cells do in the snapshots that were kept. Cells
// are gathered into squares, so that the page of a large joint stays small.
#include "report/run.h"

#include <gsl/gsl_interp.h>

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
        const size_t place =
            along(g->y.value[i], r->dy, r->ny) * r->nx + along(g->x.value[i], r->dx, r->nx);
        if (number[place] == UINT32_MAX) {
            if (r->squares == most) {
                return false;
            }
            r->place[r->squares] = (double)place;
            r->count[r->squares] = 0;
            number[place] = (uint32_t)r->squares++;
        }
        r->square[i] = number[place];
        r->count[number[place]]++;
    }
    return true;
}

// Lays the cells out, on squares of so many cells that at most `most` of them hold one.
// @return false: the file has no two cells, or the page has failed
static bool create_raster(lac_page *page, size_t most, lac_page_raster *r)
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

// Of a line, whose snapshots are rows of one map, as many as a screen has.
enum { MOST_SQUARES = 12000, SNAPSHOTS = 40, LINE_SNAPSHOTS = 400, LEVELS = 254 };

// A cell that moves this much faster than the mean at the start is said to slip.
static const double slipping_ratio = 10.0;

// NaN where nothing moved at the start, so that nothing tells what slips.
static double slipping_rate(lac_page *page)
{
    const double rate = lac_page_over_time(page, "slip_rate")[0];
    return rate > 0.0 ? slipping_ratio * rate : NAN;
}

// Snapshots that the page shows.
typedef struct shots {
    size_t count, most;
    size_t index[LINE_SNAPSHOTS];
    lac_stored_values time;
    double *before; // [time.n]
    uint8_t *keep;  // [time.n]
    double *value;  // [count][squares] of a field
    double *share;  // [count][squares] of the cells that slip
    uint8_t *bytes; // [squares]
} shots;

// A field of the snapshots: what is written of it.
typedef struct field {
    const char *key, *variable;
    lac_page_summary how;
    bool logarithm; // of its values
    bool common;    // one range for all snapshots; of a line always
} field;

static const field fields[] = {
    {"rate", "cell_slip_rate", LAC_PAGE_MOST, true, true},
    {"slip", "cell_slip", LAC_PAGE_MEAN, false, false},
    {"traction", "cell_traction", LAC_PAGE_MEAN, false, true},
    {"safety", "cell_factor_of_safety", LAC_PAGE_MEAN, true, true},
    {"pore", "cell_pore_pressure", LAC_PAGE_MEAN, false, true},
    {"excess", "cell_excess_pore_pressure", LAC_PAGE_MEAN, false, true},
    {"heat", "cell_temperature", LAC_PAGE_MEAN, false, true},
    {"broken", "cell_broken_cohesion", LAC_PAGE_MEAN, false, true},
};

static void choose_shots(lac_page *page, shots *s)
{
    s->time = lac_page_values(page, page->file, "snapshot_time");
    while (s->time.n > 0 && isnan(s->time.value[s->time.n - 1])) { // torn
        s->time.n--;
    }
    const size_t n = s->time.n;
    s->keep = lac_page_room(page, n);
    s->before = lac_page_room(page, n * sizeof *s->before);
    if (s->keep == NULL || s->before == NULL) {
        return;
    }
    for (size_t i = 0; i < n; i++) {
        const size_t low = gsl_interp_bsearch(page->time, s->time.value[i], 0, page->n);
        s->before[i] = page->before[low] - (s->time.value[i] - page->time[low]); // its record's
    }
    memset(s->keep, 1, n);
    if (n > s->most) {
        lac_page_thin_to(n, s->time.value, s->before, s->most, s->most, s->keep);
    }
    for (size_t i = 0; i < n; i++) {
        s->keep[i] = s->keep[i] && s->count < s->most;
        if (s->keep[i]) {
            s->index[s->count++] = i;
        }
    }
}

// Values to bytes: 0 is missing, or what has no place in the range; 1 to 255 the range.
static uint8_t to_byte(double value, double low, double high)
{
    if (!isfinite(value)) {
        return 0;
    }
    const double place = high > low ? (value - low) / (high - low) : 0.0;
    return (uint8_t)(1.5 + LEVELS * (place < 0.0 ? 0.0 : place > 1.0 ? 1.0 : place));
}

static void find_range(size_t n, const double *value, double *low, double *high)
{
    for (size_t i = 0; i < n; i++) {
        if (isfinite(value[i])) {
            *low = isnan(*low) || value[i] < *low ? value[i] : *low;
            *high = isnan(*high) || value[i] > *high ? value[i] : *high;
        }
    }
}

// Marks what has no logarithm, where there is any.
static void write_backwards(lac_json *json, size_t n, const double *value, uint8_t *bytes)
{
    bool any = false;
    for (size_t i = 0; i < n; i++) {
        bytes[i] = isinf(value[i]) ? 1 : 0;
        any = any || bytes[i] != 0;
    }
    if (any) {
        lac_json_bytes(json, "backwards", bytes, n);
    }
}

// Maps of the squares under a key.
typedef struct maps {
    const char *key;
    size_t count;
    const double *value; // [count][squares]
    double low, high;    // their range; NaN: each has its own
} maps;

static void write_maps(lac_json *json, const lac_page_raster *r, const maps *m, uint8_t *bytes)
{
    lac_json_open(json, m->key, '[');
    for (size_t k = 0; k < m->count; k++) {
        const double *value = m->value + k * r->squares;
        double low = m->low, high = m->high;
        if (isnan(low)) {
            find_range(r->squares, value, &low, &high);
        }
        for (size_t i = 0; i < r->squares; i++) {
            bytes[i] = to_byte(value[i], low, high);
        }
        lac_json_open(json, NULL, '{');
        lac_json_digits(json, "low", low, 5);
        lac_json_digits(json, "high", high, 5);
        lac_json_bytes(json, "map", bytes, r->squares);
        write_backwards(json, r->squares, value, bytes);
        lac_json_close(json, '}');
    }
    lac_json_close(json, ']');
}

// @return whether the field is there in all of them
static bool read_field(lac_page *page, const lac_page_raster *r, const shots *s, const field *f)
{
    const double limit = slipping_rate(page);
    bool there = s->count > 0;
    for (size_t k = 0; k < s->count && there; k++) {
        lac_stored_values row = {0};
        double *out = s->value + k * r->squares;
        there = lac_page_good(page, lac_stored_file_row(page->file, f->variable,
                                                        (ptrdiff_t)s->index[k], &row, page->err)) &&
                row.value != NULL && row.width == r->cells;
        if (there) {
            lac_page_raster_summarise(r, f->how, row.value, 0.0, out);
            for (size_t i = 0; f->logarithm && i < r->squares; i++) {
                out[i] = out[i] > 0.0 ? log10(out[i]) : isnan(out[i]) ? NAN : -INFINITY;
            }
        }
        if (there && f->how == LAC_PAGE_MOST) {
            lac_page_raster_summarise(r, LAC_PAGE_SHARE_ABOVE, row.value, limit,
                                      s->share + k * r->squares);
        }
        lac_stored_values_clear(&row);
    }
    return there;
}

static void write_shares(lac_page *page, const lac_page_raster *r, const shots *s)
{
    const maps shares = {"slipping", s->count, s->share, 0.0, 1.0};
    double slipping[LINE_SNAPSHOTS] = {0};
    write_maps(&page->json, r, &shares, s->bytes);
    for (size_t i = 0; i < s->count * r->squares; i++) {
        const double cells = s->share[i] * (double)r->count[i % r->squares];
        slipping[i / r->squares] += isnan(cells) ? 0.0 : cells;
    }
    for (size_t k = 0; k < s->count; k++) {
        slipping[k] = round(slipping[k]);
    }
    lac_page_column(page, "slipping_cells", s->count, slipping, NULL, 17);
}

static void write_snapshots(lac_page *page, const lac_page_raster *r, const shots *s)
{
    lac_page_column(page, "snapshot_time", s->time.n, s->time.value, s->keep, 12);
    lac_page_column(page, "snapshot_before", s->time.n, s->before, s->keep, 6);
    for (const field *f = fields; f < fields + sizeof fields / sizeof *fields; f++) {
        maps of = {f->key, s->count, s->value, NAN, NAN};
        if (!read_field(page, r, s, f)) {
            continue;
        }
        if (f->common || r->ny == 1) {
            find_range(s->count * r->squares, s->value, &of.low, &of.high);
        }
        write_maps(&page->json, r, &of, s->bytes);
        if (f->how == LAC_PAGE_MOST) {
            write_shares(page, r, s);
        }
    }
}

static void write_raster(lac_page *page, const lac_page_raster *r, const shots *s)
{
    const lac_stored_values pressure = lac_page_values(page, page->file, "pressure");
    lac_json *json = &page->json;
    lac_json_integer(json, "cells", (int64_t)r->cells);
    lac_json_integer(json, "nx", (int64_t)r->nx);
    lac_json_integer(json, "ny", (int64_t)r->ny);
    lac_json_digits(json, "dx", r->dx, 8);
    lac_json_digits(json, "dy", r->dy, 8);
    lac_json_integer(json, "block", (int64_t)r->block);
    lac_json_digits(json, "slipping_rate", slipping_rate(page), 6);
    lac_page_column(page, "place", r->squares, r->place, NULL, 17);
    if (pressure.value != NULL && pressure.n == r->cells) {
        const maps of = {"pressure", 1, s->value, NAN, NAN};
        lac_page_raster_summarise(r, LAC_PAGE_MEAN, pressure.value, 0.0, s->value);
        write_maps(&page->json, r, &of, s->bytes);
    }
}

void lac_page_cells(lac_page *page, const char *key)
{
    lac_page_raster raster;
    shots s = {0};
    if (!create_raster(page, MOST_SQUARES, &raster)) {
        return; // a block
    }
    s.most = raster.ny == 1 ? LINE_SNAPSHOTS : SNAPSHOTS;
    choose_shots(page, &s);
    const size_t room_of = (s.count > 0 ? s.count : 1) * raster.squares;
    s.value = lac_page_room(page, room_of * sizeof *s.value);
    s.share = lac_page_room(page, room_of * sizeof *s.share);
    s.bytes = lac_page_room(page, raster.squares);
    if (page->status == LAC_OK) {
        lac_json_open(&page->json, key, '{');
        write_raster(page, &raster, &s);
        write_snapshots(page, &raster, &s);
        lac_json_close(&page->json, '}');
    }
}
