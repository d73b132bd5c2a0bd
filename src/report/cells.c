// SPDX-License-Identifier: GPL-3.0-or-later
// The contact domain: its pressure, and what its cells do in the snapshots that were kept.
#include "report/cells.h"

#include <gsl/gsl_interp.h>
#include <math.h>
#include <string.h>

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
};

// The record nearest to a snapshot's time gives its time before the end.
static double before_of(const lac_page *page, double time)
{
    const size_t low = gsl_interp_bsearch(page->time, time, 0, page->n);
    return page->before[low] - (time - page->time[low]);
}

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
        s->before[i] = before_of(page, s->time.value[i]);
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

// Room for one field in all snapshots.
typedef struct room {
    double *value;  // [snapshots][squares]
    double *share;  // [snapshots][squares] of the cells that slip
    uint8_t *bytes; // [squares]
} room;

// @return whether the field is there in all of them
static bool read_field(lac_page *page, const lac_page_raster *r, const shots *s, const field *f,
                       room *to)
{
    const double limit = slipping_rate(page);
    bool there = s->count > 0;
    for (size_t k = 0; k < s->count && there; k++) {
        lac_stored_values row = {0};
        double *out = to->value + k * r->squares;
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
                                      to->share + k * r->squares);
        }
        lac_stored_values_clear(&row);
    }
    return there;
}

static void write_shares(lac_json *json, const lac_page_raster *r, size_t count, const room *from)
{
    const maps shares = {"slipping", count, from->share, 0.0, 1.0};
    write_maps(json, r, &shares, from->bytes);
    lac_json_open(json, "slipping_cells", '[');
    for (size_t k = 0; k < count; k++) {
        double cells = 0.0;
        for (size_t i = 0; i < r->squares; i++) {
            const double share = from->share[k * r->squares + i];
            cells += isnan(share) ? 0.0 : share * (double)r->count[i];
        }
        lac_json_digits(json, NULL, round(cells), 17);
    }
    lac_json_close(json, ']');
}

static void write_snapshots(lac_page *page, const lac_page_raster *r, const shots *s, room *to)
{
    lac_page_column(page, "snapshot_time", s->time.n, s->time.value, s->keep, 12);
    lac_page_column(page, "snapshot_before", s->time.n, s->before, s->keep, 6);
    for (const field *f = fields; f < fields + sizeof fields / sizeof *fields; f++) {
        maps of = {f->key, s->count, to->value, NAN, NAN};
        if (!read_field(page, r, s, f, to)) {
            continue;
        }
        if (f->common || r->ny == 1) {
            find_range(s->count * r->squares, to->value, &of.low, &of.high);
        }
        write_maps(&page->json, r, &of, to->bytes);
        if (f->how == LAC_PAGE_MOST) {
            write_shares(&page->json, r, s->count, to);
        }
    }
}

static void write_pressure(lac_page *page, const lac_page_raster *r, const room *to)
{
    const lac_stored_values pressure = lac_page_values(page, page->file, "pressure");
    if (pressure.value != NULL && pressure.n == r->cells) {
        const maps of = {"pressure", 1, to->value, NAN, NAN};
        lac_page_raster_summarise(r, LAC_PAGE_MEAN, pressure.value, 0.0, to->value);
        write_maps(&page->json, r, &of, to->bytes);
    }
}

static void write_raster(lac_page *page, const lac_page_raster *r)
{
    lac_json *json = &page->json;
    lac_json_integer(json, "cells", (int64_t)r->cells);
    lac_json_integer(json, "nx", (int64_t)r->nx);
    lac_json_integer(json, "ny", (int64_t)r->ny);
    lac_json_digits(json, "dx", r->dx, 8);
    lac_json_digits(json, "dy", r->dy, 8);
    lac_json_integer(json, "block", (int64_t)r->block);
    lac_json_digits(json, "slipping_rate", slipping_rate(page), 6);
    lac_json_open(json, "place", '[');
    for (size_t k = 0; k < r->squares; k++) {
        lac_json_digits(json, NULL, r->place[k], 17);
    }
    lac_json_close(json, ']');
}

void lac_page_cells(lac_page *page, const char *key)
{
    lac_page_raster raster;
    shots s = {0};
    if (!lac_page_raster_create(page, MOST_SQUARES, &raster)) {
        return; // a block
    }
    s.most = raster.ny == 1 ? LINE_SNAPSHOTS : SNAPSHOTS;
    choose_shots(page, &s);
    const size_t room_of = (s.count > 0 ? s.count : 1) * raster.squares;
    room to = {lac_page_room(page, room_of * sizeof(double)),
               lac_page_room(page, room_of * sizeof(double)), lac_page_room(page, raster.squares)};
    if (page->status == LAC_OK) {
        lac_json_open(&page->json, key, '{');
        write_raster(page, &raster);
        write_pressure(page, &raster, &to);
        write_snapshots(page, &raster, &s, &to);
        lac_json_close(&page->json, '}');
    }
}
