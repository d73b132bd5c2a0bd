// SPDX-License-Identifier: GPL-3.0-or-later
// What an analysis adds to the records of a run: its variables over time and over levels, and those
// of one value.
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "store/internal.h"

enum { RECORD_CHUNK = 512 };

static size_t width_of(const lac_store *s, const lac_extra *extra)
{
    return extra->over == LAC_OVER_LEVELS ? s->levels : extra->over == LAC_OVER_TIME ? 1 : 0;
}

lac_status lac_store_create_extras(lac_store *s, const lac_store_def *def, lac_error *err)
{
    s->extras = def->extras;
    s->extra = def->extra;
    s->levels = def->hierarchy != NULL ? lac_hierarchy_levels(def->hierarchy) + 1 : 0;
    for (size_t i = 0; i < s->extras; i++) {
        s->width += width_of(s, &s->extra[i]);
    }
    s->extra_ids = malloc((s->extras + 1) * sizeof *s->extra_ids);
    s->values = malloc((s->capacity * s->width + 1) * sizeof *s->values);
    return s->extra_ids != NULL && s->values != NULL ? LAC_OK : lac_fail_memory(err);
}

lac_status lac_store_define_extras(lac_store *s, lac_error *err)
{
    lac_status status = LAC_OK;
    int dims[2] = {0, 0};
    for (size_t i = 0; i < s->extras; i++) {
        const lac_extra *extra = &s->extra[i];
        const bool levels = extra->over == LAC_OVER_LEVELS;
        const int rank = levels ? 2 : extra->over == LAC_OVER_TIME ? 1 : 0;
        const size_t chunk[2] = {RECORD_CHUNK, s->levels};
        const lac_nc_var var = {.name = extra->name,
                                .unit = extra->unit,
                                .long_name = extra->long_name,
                                .comment = extra->comment,
                                .cell_methods = extra->cell_methods,
                                .coordinates = levels ? "block_size" : NULL,
                                .type = extra->count ? NC_INT64 : NC_DOUBLE,
                                .fill = !extra->count,
                                .appended = rank > 0};
        int code = rank > 0 ? nc_inq_dimid(s->file.id, "time", &dims[0]) : NC_NOERR;
        code = code == NC_NOERR && levels ? nc_inq_dimid(s->file.id, "level", &dims[1]) : code;
        LAC_TRY(lac_nc_check(s->file.path, code, err, "define", extra->name));
        LAC_TRY(lac_nc_define(&s->file, &var, rank, dims, chunk, 0, &s->extra_ids[i], err));
    }
out:
    return status;
}

void lac_store_keep_extras(lac_store *s, const double *values)
{
    double *row = s->values + s->buffered * s->width;
    for (size_t i = 0; i < s->width; i++) {
        row[i] = values == NULL || isnan(values[i]) ? NC_FILL_DOUBLE : values[i];
    }
}

// Columns first ... first + width of the buffered rows; the caller frees them.
static double *columns(const lac_store *s, size_t first, size_t width)
{
    double *block = malloc(s->buffered * width * sizeof *block);
    for (size_t r = 0; block != NULL && r < s->buffered; r++) {
        for (size_t i = 0; i < width; i++) {
            block[r * width + i] = s->values[r * s->width + first + i];
        }
    }
    return block;
}

lac_status lac_store_write_extras(const lac_store *s, lac_error *err)
{
    lac_status status = LAC_OK;
    size_t first = 0;
    for (size_t i = 0; i < s->extras; i++) {
        const size_t width = width_of(s, &s->extra[i]);
        const size_t start[2] = {s->written, 0};
        const size_t count[2] = {s->buffered, width};
        if (width == 0) {
            continue;
        }
        double *block = columns(s, first, width);
        if (block == NULL) {
            return lac_fail_memory(err);
        }
        errno = 0;
        int code = lac_nc_append(&s->file, NC_DOUBLE, s->extra_ids[i], start, count, block);
        free(block);
        LAC_TRY(lac_nc_check(s->file.path, code, err, "write", s->extra[i].name));
        first += width;
    }
out:
    return status;
}

lac_status lac_store_put_once(void *context, const double *once, lac_error *err)
{
    lac_store *s = context;
    lac_status status = LAC_OK;
    for (size_t i = 0; i < s->extras; i++) {
        if (s->extra[i].over != LAC_OVER_NOTHING) {
            continue;
        }
        double value = isnan(*once) ? NC_FILL_DOUBLE : *once;
        once++;
        errno = 0;
        LAC_TRY(lac_nc_check(
            s->file.path, lac_nc_append(&s->file, NC_DOUBLE, s->extra_ids[i], NULL, NULL, &value),
            err, "write", s->extra[i].name));
    }
out:
    return status;
}

void lac_store_clear_extras(lac_store *s)
{
    free(s->extra_ids);
    free(s->values);
}
