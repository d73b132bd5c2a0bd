// SPDX-License-Identifier: GPL-3.0-or-later
// A dataset as a netCDF-4 file, written in one go.
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/date.h"
#include "data/dataset.h"
#include "store/nc.h"

enum { UNIT = 64, MEANINGS = 512, MOST_MEANINGS = 64, CHUNK = 1 << 18 /* values, about 2 MB */ };

typedef struct writer {
    const lac_nc *file;
    const lac_dataset *dataset;
    lac_clock clock;
    char unit[UNIT]; // of times
    double shift;    // what the unit's whole second leaves of the start [s]
    double *values;  // room for the largest variable
} writer;

// A date counts from a whole second.
static void set_clock(writer *w)
{
    char date[32] = "";
    double start = 0.0;
    w->clock = lac_dataset_clock(w->dataset, &start);
    (void)snprintf(w->unit, sizeof w->unit, "%s",
                   w->clock == LAC_CLOCK_1970 ? "seconds since 1970-01-01 00:00:00" : "s");
    if (w->clock == LAC_CLOCK_START &&
        lac_date_format(floor(start), date, sizeof date)[0] != '\0') {
        (void)snprintf(w->unit, sizeof w->unit, "seconds since %s", date);
        w->shift = start - floor(start);
    }
}

static lac_status put_attribute(const writer *w, int id, const char *name, const char *text,
                                double number, bool whole, lac_error *err)
{
    if (text != NULL || !isfinite(number)) {
        return lac_nc_text(w->file, id, name, text, err);
    }
    return whole ? lac_nc_integer(w->file, id, name, (long long)number, err)
                 : lac_nc_real(w->file, id, name, number, err);
}

static lac_status put_attributes(const writer *w, const lac_item *item, int id, lac_error *err)
{
    lac_attribute attribute = {0};
    lac_status status = LAC_OK;
    while (status == LAC_OK && lac_item_next_attribute(item, &attribute)) {
        status = put_attribute(w, id, attribute.name, attribute.text, attribute.number, false, err);
    }
    return status;
}

static lac_status put_global(const writer *w, const lac_item *item, lac_error *err)
{
    double number = NAN;
    char room[LAC_TEXT_ROOM];
    const char *text = item->is_text ? lac_item_text(item, 0, room) : NULL;
    if (!item->is_text) {
        lac_item_values(item, &number);
    }
    return put_attribute(w, NC_GLOBAL, item->name, text, number,
                         (item->row->flags & LAC_WHOLE) != 0, err);
}

// Large maps are not copied.
static bool is_written_as_it_is(const lac_item *item)
{
    return lac_item_array(item) != NULL && (item->row->flags & (LAC_MISSING | LAC_TIME)) == 0;
}

// What is missing, filled in; times on the file's clock.
static const double *values_of(const writer *w, const lac_item *item)
{
    const bool whole = (item->row->flags & LAC_WHOLE) != 0;
    const double shift = (item->row->flags & LAC_TIME) != 0 ? w->shift : 0.0;
    if (is_written_as_it_is(item)) {
        return lac_item_array(item);
    }
    lac_item_values(item, w->values);
    for (size_t i = 0; i < item->count; i++) {
        const double missing = whole ? NC_FILL_INT : NC_FILL_DOUBLE;
        w->values[i] = isfinite(w->values[i]) ? w->values[i] + shift : missing;
    }
    return w->values;
}

static lac_status put_numbers(const writer *w, const lac_item *item, int id, lac_error *err)
{
    errno = 0;
    return lac_nc_check(w->file->path, nc_put_var_double(w->file->id, id, values_of(w, item)), err,
                        "write", item->name);
}

static lac_status put_strings(const writer *w, const lac_item *item, int id, lac_error *err)
{
    lac_status status = LAC_OK;
    for (size_t i = 0; i < item->count && status == LAC_OK; i++) {
        char room[LAC_TEXT_ROOM];
        const char *text = lac_item_text(item, i, room);
        size_t at[LAC_MOST_DIMS];
        for (size_t d = item->rank, place = i; d-- > 0; place /= item->length[d]) {
            at[d] = place % item->length[d];
        }
        text = text != NULL ? text : "";
        status = lac_nc_check(w->file->path, nc_put_var1_string(w->file->id, id, at, &text), err,
                              "write", item->name);
    }
    return status;
}

// Texts over dimensions as rows of characters, as long as the longest needs.
static lac_status put_characters(const writer *w, const lac_item *item, int id, size_t length,
                                 lac_error *err)
{
    char room[LAC_TEXT_ROOM];
    char *all = calloc(item->count, length);
    if (all == NULL) {
        return lac_fail_memory(err);
    }
    for (size_t i = 0; i < item->count; i++) {
        const char *text = lac_item_text(item, i, room);
        memcpy(all + i * length, text != NULL ? text : "", text != NULL ? strlen(text) : 0);
    }
    errno = 0;
    lac_status status = lac_nc_check(w->file->path, nc_put_var_text(w->file->id, id, all), err,
                                     "write", item->name);
    free(all);
    return status == LAC_OK ? lac_nc_text(w->file, id, "_Encoding", "utf-8", err) : status;
}

// The places of a dimension as flags: readers of netCDF-3 and -4 alike take them.
static lac_status put_meanings(const writer *w, const lac_item *item, int id, lac_error *err)
{
    char meanings[MEANINGS] = "", room[LAC_TEXT_ROOM];
    int values[MOST_MEANINGS];
    for (size_t i = 0; i < item->count; i++) {
        const size_t used = strlen(meanings);
        const char *text = lac_item_text(item, i, room);
        if (i == MOST_MEANINGS || used + strlen(text) + 2 > sizeof meanings) {
            return lac_fail(err, LAC_EINPUT, "%s: %s has too many meanings", w->file->path,
                            item->name);
        }
        values[i] = (int)i;
        (void)snprintf(meanings + used, sizeof meanings - used, "%s%s", i > 0 ? " " : "", text);
    }
    int code = nc_put_att_int(w->file->id, id, "flag_values", NC_INT, item->count, values);
    code = code == NC_NOERR ? nc_put_var_int(w->file->id, id, values) : code;
    lac_status status = lac_nc_check(w->file->path, code, err, "write", item->name);
    return status == LAC_OK ? lac_nc_text(w->file, id, "flag_meanings", meanings, err) : status;
}

static size_t longest_text(const lac_item *item)
{
    char room[LAC_TEXT_ROOM];
    size_t longest = 1;
    for (size_t i = 0; i < item->count; i++) {
        const char *text = lac_item_text(item, i, room);
        const size_t length = text != NULL ? strlen(text) : 0;
        longest = length > longest ? length : longest;
    }
    return longest;
}

static nc_type type_of(const lac_item *item)
{
    const unsigned flags = item->row->flags;
    if (item->is_text && (flags & LAC_MEANINGS) == 0) {
        return (flags & LAC_CHARS) != 0 ? NC_CHAR : NC_STRING;
    }
    return (flags & (LAC_WHOLE | LAC_MEANINGS)) != 0 ? NC_INT : NC_DOUBLE;
}

// Whole rows of a map. @return false: netCDF chooses
static bool choose_chunk(const lac_item *item, size_t chunk[LAC_MOST_DIMS])
{
    if (item->rank != 2 || item->is_text || item->count <= CHUNK) {
        return false;
    }
    const size_t rows = CHUNK / item->length[1];
    chunk[0] = rows < 1 ? 1 : rows < item->length[0] ? rows : item->length[0];
    chunk[1] = item->length[1] < CHUNK ? item->length[1] : CHUNK;
    return true;
}

static lac_status define(const writer *w, const lac_item *item, int rank, const int *dims, int *id,
                         lac_error *err)
{
    const lac_variable *row = item->row;
    const nc_type type = type_of(item);
    const bool is_time = (row->flags & LAC_TIME) != 0;
    const bool dated = is_time && w->clock == LAC_CLOCK_1970;
    const bool number = type == NC_INT || type == NC_DOUBLE;
    const char *unit = is_time ? w->unit : item->unit != NULL ? item->unit : "1";
    const lac_nc_var var = {.name = item->name,
                            .unit = number ? unit : NULL,
                            .long_name = item->long_name,
                            .standard_name = dated ? "time" : NULL,
                            .comment = item->comment,
                            .coordinates = row->coordinates,
                            .type = type,
                            .fill = (row->flags & LAC_MISSING) != 0};
    size_t chunk[LAC_MOST_DIMS];
    const size_t *chosen = choose_chunk(item, chunk) ? chunk : NULL;
    lac_status status = lac_nc_define(w->file, &var, rank, dims, chosen, rank > 1 ? 1 : 0, id, err);
    return status == LAC_OK && dated
               ? lac_nc_text(w->file, *id, "calendar", "proleptic_gregorian", err)
               : status;
}

// One that only JSON knows stands in no file.
static lac_status find_dim(const writer *w, const char *name, size_t length, int *dim,
                           lac_error *err)
{
    return nc_inq_dimid(w->file->id, name, dim) == NC_NOERR
               ? LAC_OK
               : lac_nc_dim(w->file, name, length, dim, err);
}

static lac_status put_variable(const writer *w, const lac_item *item, lac_error *err)
{
    const nc_type type = type_of(item);
    const size_t length = type == NC_CHAR ? longest_text(item) : 0;
    int dims[LAC_MOST_DIMS + 1];
    int rank = (int)item->rank;
    int id = 0;
    lac_status status = LAC_OK;
    for (int d = 0; d < rank; d++) {
        LAC_TRY(find_dim(w, item->dim[d], item->length[d], &dims[d], err));
    }
    if (type == NC_CHAR) {
        char name[NC_MAX_NAME];
        (void)snprintf(name, sizeof name, "%s_length", item->name);
        LAC_TRY(find_dim(w, name, length, &dims[rank++], err));
    }
    LAC_TRY(define(w, item, rank, dims, &id, err));
    if (!item->is_text) {
        LAC_TRY(put_numbers(w, item, id, err));
    } else if (type == NC_INT) {
        LAC_TRY(put_meanings(w, item, id, err));
    } else {
        LAC_TRY(type == NC_CHAR ? put_characters(w, item, id, length, err)
                                : put_strings(w, item, id, err));
    }
    LAC_TRY(put_attributes(w, item, id, err));
out:
    return status;
}

static lac_status put_all(writer *w, lac_error *err)
{
    lac_item item = {0};
    lac_status status = LAC_OK;
    while (lac_dataset_next(w->dataset, &item)) {
        const bool global = item.rank == 0 && (item.row->flags & LAC_SINGLE) == 0;
        LAC_TRY(global ? put_global(w, &item, err) : put_variable(w, &item, err));
    }
out:
    return status;
}

lac_status lac_nc_dataset(const lac_nc *file, const lac_dataset *dataset, lac_error *err)
{
    writer w = {.file = file, .dataset = dataset};
    lac_item item = {0};
    size_t most = 1;
    set_clock(&w);
    while (lac_dataset_next(dataset, &item)) {
        most = !is_written_as_it_is(&item) && item.count > most ? item.count : most;
    }
    w.values = malloc(most * sizeof *w.values);
    lac_status status = w.values != NULL ? put_all(&w, err) : lac_fail_memory(err);
    free(w.values);
    return status;
}

static lac_status put(const lac_nc *file, void *context, lac_error *err)
{
    const lac_dataset *const *dataset = context;
    return lac_nc_dataset(file, *dataset, err);
}

lac_status lac_store_dataset(const char *path, bool force, const lac_provenance *provenance,
                             const lac_dataset *dataset, lac_error *err)
{
    return lac_nc_write(path, force, provenance, lac_dataset_summary(dataset), put, &dataset, err);
}
