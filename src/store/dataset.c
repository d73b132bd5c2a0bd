// SPDX-License-Identifier: GPL-3.0-or-later
// A dataset as a netCDF-4 file, written in one go.
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/date.h"
#include "store/nc.h"

enum { UNIT = 64, MEANINGS = 512 };

typedef struct writer {
    const lac_nc *file;
    const lac_dataset *dataset;
    char unit[UNIT]; // of times
    double shift;    // what the unit's whole second leaves of the start [s]
    double *values;  // room for the largest variable
} writer;

// CF's dates count from a whole second.
static void set_clock(writer *w)
{
    char date[32] = "";
    double start = 0.0;
    const bool dated = lac_dataset_start(w->dataset, &start);
    (void)snprintf(w->unit, sizeof w->unit, "s");
    if (dated && lac_date_format(floor(start), date, sizeof date)[0] != '\0') {
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

static lac_status put_numbers(const writer *w, const lac_item *item, int id, lac_error *err)
{
    const double shift = (item->row->flags & LAC_TIME) != 0 ? w->shift : 0.0;
    lac_item_values(item, w->values);
    for (size_t i = 0; i < item->count; i++) {
        const bool known = isfinite(w->values[i]);
        const double missing = (item->row->flags & LAC_WHOLE) != 0 ? NC_FILL_INT : NC_FILL_DOUBLE;
        w->values[i] = known ? w->values[i] + shift : missing;
    }
    errno = 0;
    return lac_nc_check(w->file->path, nc_put_var_double(w->file->id, id, w->values), err, "write",
                        item->name);
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

static lac_status define(const writer *w, const lac_item *item, nc_type type, int rank,
                         const int *dims, int *id, lac_error *err)
{
    const lac_variable *row = item->row;
    const char *unit = (row->flags & LAC_TIME) != 0 ? w->unit
                       : item->unit != NULL         ? item->unit
                                                    : "1";
    const lac_nc_var var = {.name = item->name,
                            .unit = item->is_text && type != NC_INT ? NULL : unit,
                            .long_name = item->long_name,
                            .comment = row->comment,
                            .coordinates = row->coordinates,
                            .type = type,
                            .fill = (row->flags & LAC_MISSING) != 0};
    return lac_nc_define(w->file, &var, rank, dims, NULL, rank > 1 ? 1 : 0, id, err);
}

static lac_status put_variable(const writer *w, const lac_item *item, lac_error *err)
{
    const nc_type type = item->is_text                         ? NC_STRING
                         : (item->row->flags & LAC_WHOLE) != 0 ? NC_INT
                                                               : NC_DOUBLE;
    int dims[LAC_MOST_DIMS];
    int id = 0;
    lac_status status = LAC_OK;
    for (size_t d = 0; d < item->rank; d++) {
        // One that only JSON knows stands in no file.
        if (nc_inq_dimid(w->file->id, item->dim[d], &dims[d]) != NC_NOERR) {
            LAC_TRY(lac_nc_dim(w->file, item->dim[d], item->length[d], &dims[d], err));
        }
    }
    LAC_TRY(define(w, item, type, (int)item->rank, dims, &id, err));
    LAC_TRY(item->is_text ? put_strings(w, item, id, err) : put_numbers(w, item, id, err));
    LAC_TRY(put_attributes(w, item, id, err));
out:
    return status;
}

static lac_status put_all(const lac_nc *file, void *context, lac_error *err)
{
    writer *w = context;
    lac_item item = {0};
    lac_status status = LAC_OK;
    w->file = file;
    while (lac_dataset_next(w->dataset, &item)) {
        const bool global = item.rank == 0 && (item.row->flags & LAC_SINGLE) == 0;
        LAC_TRY(global ? put_global(w, &item, err) : put_variable(w, &item, err));
    }
out:
    return status;
}

lac_status lac_store_dataset(const char *path, bool force, const lac_provenance *provenance,
                             const lac_dataset *dataset, lac_error *err)
{
    writer w = {.dataset = dataset};
    lac_item item = {0};
    size_t most = 1;
    set_clock(&w);
    while (lac_dataset_next(dataset, &item)) {
        most = item.count > most ? item.count : most;
    }
    w.values = malloc(most * sizeof *w.values);
    const char *summary = lac_dataset_summary(dataset);
    lac_status status = w.values != NULL
                            ? lac_nc_write(path, force, provenance, summary, put_all, &w, err)
                            : lac_fail_memory(err);
    free(w.values);
    return status;
}
