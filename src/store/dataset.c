// SPDX-License-Identifier: GPL-3.0-or-later
// A dataset as a netCDF-4 file, in one go or place by place; its variables as arrays in memory that
// grow by places, of which a run that is kept in memory is made too.
#include <assert.h>

#include "base/ask.h"
#include "base/date.h"
#include "store/writer.h"

void lac_columns_clear(lac_columns *columns)
{
    for (size_t i = 0; i < columns->n; i++) {
        free(columns->column[i].values);
        free((void *)columns->column[i].text);
    }
    free(columns->column);
    *columns = (lac_columns){0};
}

bool lac_item_is_global(const lac_item *item)
{
    return item->rank == 0 && (item->row->flags & LAC_SINGLE) == 0;
}

size_t lac_columns_along(const lac_columns *columns, const char *dim)
{
    size_t along = 0;
    while (along < columns->growing && strcmp(columns->growth[along].name, dim) != 0) {
        along++;
    }
    return along < columns->growing ? along : LAC_ONCE;
}

// The dimension along which an item grows, noted where it is new.
static size_t find_growth(lac_columns *columns, const lac_item *item)
{
    if (item->rank == 0 || item->length[0] != LAC_GROWS) {
        return LAC_ONCE;
    }
    const size_t known = lac_columns_along(columns, item->dim[0]);
    const size_t along = known != LAC_ONCE ? known : columns->growing++;
    assert(along < LAC_MOST_GROWING);
    columns->growth[along].name = item->dim[0];
    columns->growth[along].cells |= (item->row->flags & LAC_CELLS) != 0;
    return along;
}

lac_status lac_columns_create(const lac_dataset *dataset, lac_columns *columns, lac_error *err)
{
    lac_item item = {0};
    columns->column = calloc(dataset->entries + 1, sizeof *columns->column);
    LAC_FAIL_MEMORY_IF(columns->column == NULL, err);
    while (lac_dataset_next(dataset, &item)) {
        if (!lac_item_is_global(&item)) {
            columns->column[columns->n++] =
                (lac_column){.item = item, .along = find_growth(columns, &item)};
        }
    }
    return LAC_OK;
}

lac_status lac_column_reserve(lac_column *column, size_t n, lac_error *err)
{
    return lac_grow((void *)&column->values, &column->room, column->count + n,
                    sizeof *column->values, err);
}

lac_status lac_columns_put(lac_columns *columns, size_t along, unsigned but, const char **lacks,
                           lac_error *err)
{
    lac_column *end = columns->column + columns->n;
    for (lac_column *c = columns->column; c < end; c++) {
        if (c->along == along && (c->item.row->flags & but) == 0) {
            LAC_TRY_RETURN(lac_column_reserve(c, c->item.count, err));
            double *values = c->values + c->count;
            lac_item_values(&c->item, values);
            const bool may = c->item.rank > 1 || (c->item.row->flags & LAC_MISSING) != 0;
            if (lacks != NULL && !may && isnan(*values)) {
                *lacks = c->item.name;
                return LAC_ENUMERIC;
            }
        }
    }
    for (lac_column *c = columns->column; c < end; c++) {
        if (c->along == along && (c->item.row->flags & but) == 0) {
            c->count += c->item.count;
        }
    }
    columns->growth[along].places++;
    return LAC_OK;
}

// A date counts from a whole second, or in the unit to the microsecond.
lac_status lac_writer_clock(lac_writer *w, lac_error *err)
{
    char date[32] = "", fraction[16] = "";
    const double start = w->dataset->start;
    const char *path = w->file != NULL ? w->file->path : "dataset";
    w->clock = w->dataset->clock;
    (void)snprintf(w->unit, sizeof w->unit, "%s",
                   w->clock == LAC_CLOCK_1970 ? "seconds since 1970-01-01 00:00:00" : "s");
    if (w->clock == LAC_CLOCK_NONE || w->clock == LAC_CLOCK_1970) {
        return LAC_OK;
    }
    const bool next =
        w->clock == LAC_CLOCK_DATE && start - floor(start) >= 1.0 - 5e-7; // rounded up
    const double second = floor(start) + (next ? 1.0 : 0.0);
    const bool is_date = lac_date_format(second, date, sizeof date)[0] != '\0';
    const double rest = start - second;
    if (w->clock == LAC_CLOCK_DATE) {
        LAC_FAIL_IF(!is_date, err, LAC_EINPUT, "%s: the start must lie in the years 0 to 9999",
                    path);
        const long micro = lround(rest * 1e6);
        date[10] = ' ';
        date[19] = '\0'; // UTC is CF's default zone
        if (micro > 0) {
            (void)snprintf(fraction, sizeof fraction, ".%06ld", micro);
        }
    } else {
        w->shift = is_date ? rest : 0.0;
    }
    if (is_date) {
        (void)snprintf(w->unit, sizeof w->unit, "seconds since %s%s", date, fraction);
    }
    return LAC_OK;
}

static lac_status reserve(lac_writer *w, size_t bytes, lac_error *err)
{
    w->pending += bytes;
    return lac_nc_reserve(w->file, w->pending, err);
}

// What is missing, filled in; times on the file's clock.
static void fill(const lac_writer *w, const lac_column *c, double *values, size_t n)
{
    const unsigned flags = c->item.row->flags;
    const double shift = (flags & LAC_TIME) != 0 ? w->shift : 0.0;
    const double missing = (flags & LAC_WHOLE) == 0  ? NC_FILL_DOUBLE
                           : (flags & LAC_LONG) != 0 ? (double)NC_FILL_INT64
                                                     : NC_FILL_INT;
    const bool fixed = c->along == LAC_ONCE && (flags & LAC_LATE) == 0;
    if ((flags & LAC_CELLS) != 0 && c->along != LAC_ONCE) {
        return; // put as they are, to the bit
    }
    for (size_t i = 0; i < n; i++) {
        const bool none = fixed ? !isfinite(values[i]) : isnan(values[i]);
        values[i] = none ? missing : values[i] + shift;
    }
}

// @param first, n  places along a dimension that grows
static lac_status put(const lac_writer *w, const lac_column *c, size_t first, size_t n,
                      const void *values, lac_error *err)
{
    size_t start[LAC_MOST_DIMS] = {0}, count[LAC_MOST_DIMS] = {0};
    for (size_t d = 0; d < c->item.rank; d++) {
        count[d] = c->item.length[d];
    }
    if (c->along != LAC_ONCE) {
        start[0] = first;
        count[0] = n;
        if (w->part > 0 && (c->item.row->flags & LAC_CELLS) != 0) {
            start[1] = w->first;
            count[1] = w->part;
        }
    }
    const nc_type type = c->item.row->held == LAC_HELD_BYTES ? NC_UBYTE : NC_DOUBLE;
    lac_nc within = *w->file;
    within.id = c->file;
    errno = 0;
    return lac_nc_check(within.path, lac_nc_append(&within, type, c->id, start, count, values), err,
                        "write", c->item.name);
}

lac_status lac_writer_put_values(const lac_writer *w, const lac_column *c, size_t first, size_t n,
                                 double *values, lac_error *err)
{
    fill(w, c, values, n * c->item.count);
    return put(w, c, first, n, values, err);
}

// All that the dataset holds of a variable now. Large maps are not copied.
static lac_status put_now(const lac_writer *w, const lac_column *c, size_t place, lac_error *err)
{
    const void *array = lac_item_array(&c->item);
    if (array != NULL && (c->item.row->flags & (LAC_MISSING | LAC_TIME)) == 0) {
        return put(w, c, place, 1, array, err);
    }
    double *values = malloc((c->item.count + 1) * sizeof *values);
    LAC_FAIL_MEMORY_IF(values == NULL, err);
    lac_item_values(&c->item, values);
    lac_status status = lac_writer_put_values(w, c, place, 1, values, err);
    free(values);
    return status;
}

static lac_status put_strings(const lac_writer *w, const lac_column *c, lac_error *err)
{
    const lac_item *item = &c->item;
    lac_status status = LAC_OK;
    for (size_t i = 0; i < item->count && status == LAC_OK; i++) {
        char room[LAC_TEXT_ROOM];
        const char *text = lac_item_text(item, i, room);
        size_t at[LAC_MOST_DIMS];
        for (size_t d = item->rank, place = i; d-- > 0; place /= item->length[d]) {
            at[d] = place % item->length[d];
        }
        text = text != NULL ? text : "";
        status = lac_nc_check(w->file->path, nc_put_var1_string(c->file, c->id, at, &text), err,
                              "write", item->name);
    }
    return status;
}

static lac_status put_characters(const lac_writer *w, const lac_column *c, lac_error *err)
{
    const size_t length = lac_item_longest_text(&c->item);
    char room[LAC_TEXT_ROOM];
    char *all = calloc(c->item.count, length);
    LAC_FAIL_MEMORY_IF(all == NULL, err);
    for (size_t i = 0; i < c->item.count; i++) {
        const char *text = lac_item_text(&c->item, i, room);
        memcpy(all + i * length, text != NULL ? text : "", text != NULL ? strlen(text) : 0);
    }
    errno = 0;
    lac_status status = lac_nc_check(w->file->path, nc_put_var_text(c->file, c->id, all), err,
                                     "write", c->item.name);
    free(all);
    return status;
}

// The flags 0, 1 ... that texts are the meanings of.
static lac_status put_places(const lac_writer *w, const lac_column *c, lac_error *err)
{
    int code = NC_NOERR;
    for (size_t i = 0; i < c->item.count && code == NC_NOERR; i++) {
        const int value = (int)i;
        code = nc_put_var1_int(c->file, c->id, &i, &value);
    }
    return lac_nc_check(w->file->path, code, err, "write", c->item.name);
}

static lac_status put_fixed(const lac_writer *w, const lac_column *c, lac_error *err)
{
    switch (c->item.is_text ? lac_writer_type(w, &c->item) : NC_DOUBLE) {
    case NC_CHAR:
        return put_characters(w, c, err);
    case NC_STRING:
        return put_strings(w, c, err);
    case NC_INT:
        return put_places(w, c, err);
    default:
        return c->item.count > 0 ? put_now(w, c, 0, err) : LAC_OK;
    }
}

// All is defined before a value is written: going back to defining flushes the file.
lac_status lac_writer_begin(lac_writer *w, lac_error *err)
{
    const lac_columns *all = &w->columns;
    LAC_TRY_RETURN(lac_writer_clock(w, err));
    LAC_TRY_RETURN(lac_columns_create(w->dataset, &w->columns, err));
    LAC_TRY_RETURN(
        lac_dataset_put_attributes(w->dataset, false, lac_nc_put_attribute, (void *)w->file, err));
    for (lac_column *c = all->column; c < all->column + all->n; c++) {
        LAC_TRY_RETURN(lac_writer_define(w, c, err));
        if (c->along != LAC_ONCE && (c->item.row->flags & LAC_CELLS) == 0) {
            LAC_TRY_RETURN(lac_column_reserve(c, w->batch * c->item.count, err));
        }
    }
    for (const lac_column *c = all->column; c < all->column + all->n; c++) {
        const bool fixed = c->along == LAC_ONCE && (c->item.row->flags & LAC_LATE) == 0;
        LAC_TRY_RETURN(fixed ? put_fixed(w, c, err) : LAC_OK);
    }
    return LAC_OK;
}

static lac_status flush(lac_writer *w, size_t along, lac_error *err)
{
    lac_growth *g = &w->columns.growth[along];
    lac_column *end = w->columns.column + w->columns.n;
    size_t bytes = 0;
    if (g->places == 0) {
        return LAC_OK;
    }
    for (const lac_column *c = w->columns.column; c < end; c++) {
        bytes += c->along == along ? c->count * sizeof *c->values : 0;
    }
    LAC_TRY_RETURN(g->cells ? LAC_OK : reserve(w, bytes, err)); // of cells that is there
    for (lac_column *c = w->columns.column; c < end; c++) {
        if (c->along == along && c->count > 0) {
            LAC_TRY_RETURN(lac_writer_put_values(w, c, g->written, g->places, c->values, err));
            c->count = 0;
        }
    }
    g->written += g->places;
    g->places = 0;
    return LAC_OK;
}

// Room for all of one place, incompressible at worst: a disk that fills leaves no half of it.
static lac_status reserve_place(lac_writer *w, size_t along, unsigned flag, lac_error *err)
{
    const lac_columns *all = &w->columns;
    size_t bytes = 0;
    for (const lac_column *c = all->column; c < all->column + all->n; c++) {
        const bool own = along != LAC_ONCE || (c->item.row->flags & flag) != 0;
        bytes += c->along == along && own ? c->item.count * (sizeof(double) + 1) : 0;
    }
    return bytes > 0 ? reserve(w, bytes, err) : LAC_OK;
}

// Those that are not kept in memory.
static lac_status put_cells(lac_writer *w, size_t along, unsigned flag, lac_error *err)
{
    const lac_columns *all = &w->columns;
    const size_t place = along != LAC_ONCE ? all->growth[along].written : 0;
    lac_status status = reserve_place(w, along, flag, err);
    for (const lac_column *c = all->column; c < all->column + all->n && status == LAC_OK; c++) {
        const bool own = c->along == along && (c->item.row->flags & flag) != 0;
        status = own ? put_now(w, c, place, err) : LAC_OK;
    }
    return status;
}

lac_status lac_writer_put(lac_writer *w, const char *dim, const char **lacks, lac_error *err)
{
    const size_t along = lac_columns_along(&w->columns, dim);
    if (along == LAC_ONCE) {
        return LAC_OK;
    }
    const lac_growth *g = &w->columns.growth[along];
    const bool here = w->part > 0; // the cells are in the file already
    w->part = 0;
    if (g->places == w->batch) {
        LAC_TRY_RETURN(flush(w, along, err));
    }
    LAC_TRY_RETURN(g->cells && !here ? put_cells(w, along, LAC_CELLS, err) : LAC_OK);
    LAC_TRY_RETURN(lac_columns_put(&w->columns, along, LAC_CELLS, lacks, err));
    LAC_TRY_RETURN(g->cells || w->batch == 1 ? flush(w, along, err) : LAC_OK);
    return LAC_OK;
}

lac_status lac_writer_put_part(lac_writer *w, const char *dim, size_t first, size_t n,
                               lac_error *err)
{
    const lac_columns *all = &w->columns;
    const size_t along = lac_columns_along(all, dim);
    LAC_TRY_RETURN(w->part == 0 && along != LAC_ONCE ? reserve_place(w, along, LAC_CELLS, err)
                                                     : LAC_OK);
    w->first = first;
    w->part = n;
    for (const lac_column *c = all->column; c < all->column + all->n && along != LAC_ONCE; c++) {
        const bool own = c->along == along && (c->item.row->flags & LAC_CELLS) != 0;
        if (own && lac_item_array(&c->item) != NULL) {
            LAC_TRY_RETURN(put_now(w, c, all->growth[along].written, err));
        }
    }
    return LAC_OK;
}

lac_status lac_writer_put_late(lac_writer *w, lac_error *err)
{
    return put_cells(w, LAC_ONCE, LAC_LATE, err);
}

size_t lac_writer_places(const lac_writer *w, const char *dim)
{
    const size_t along = lac_columns_along(&w->columns, dim);
    const lac_growth *g = &w->columns.growth[along];
    return along != LAC_ONCE ? g->written + g->places : 0;
}

lac_status lac_writer_flush(lac_writer *w, lac_error *err)
{
    for (size_t along = 0; along < LAC_MOST_GROWING; along++) {
        LAC_TRY_RETURN(flush(w, along, err));
    }
    return LAC_OK;
}

lac_status lac_writer_sync(lac_writer *w, lac_error *err)
{
    LAC_TRY_RETURN(lac_writer_flush(w, err));
    w->pending = 0;
    return lac_nc_sync(w->file, err);
}

void lac_writer_clear(lac_writer *w) { lac_columns_clear(&w->columns); }

// Where one of these fails there is no file.
lac_status lac_store_dataset(const char *path, bool force, const lac_provenance *provenance,
                             const lac_dataset *dataset, lac_error *err)
{
    lac_nc file = {0};
    lac_writer w = {.file = &file, .dataset = dataset};
    lac_status status;
    LAC_TRY(lac_nc_create(&file, path, force, err));
    LAC_TRY(lac_provenance_put(provenance, dataset->summary, lac_nc_put_attribute, &file, err));
    LAC_TRY(lac_writer_begin(&w, err));
    LAC_TRY(lac_nc_close(&file, err));
    LAC_TRY(lac_nc_publish(&file, err));
out:
    lac_writer_clear(&w);
    lac_nc_clear(&file);
    return status;
}

void lac_provenance_sign(lac_provenance *provenance, const lac_write_options *options)
{
    provenance->now = options->now != 0.0 ? options->now : NAN;
    provenance->command_line = options->command_line;
    provenance->libraries = options->libraries;
}

lac_status lac_dataset_write(const lac_dataset *dataset, const char *path,
                             const lac_write_options *options, lac_error *err)
{
    lac_write_options own = lac_write_options_default();
    LAC_TRY_RETURN(LAC_NEED(err, dataset, path));
    LAC_TRY_RETURN(lac_take_options("lac_write_options", options, &own, sizeof own, err));
    lac_provenance made =
        dataset->made != NULL ? *dataset->made : (lac_provenance){.seed = INT64_MIN};
    lac_provenance_sign(&made, &own);
    return lac_store_dataset(path, own.force, &made, dataset, err);
}
