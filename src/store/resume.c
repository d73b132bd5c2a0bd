// SPDX-License-Identifier: GPL-3.0-or-later
// A file that goes on: netCDF cannot take records back, so that those up to the checkpoint are
// copied into a new file, which then takes the old one's name.
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/date.h"
#include "base/netcdf.h"
#include "store/input.h"
#include "store/internal.h"

enum { BLOCK = 1 << 16 }; // values copied at once, or one row

// One variable over time, snapshots or events.
typedef struct series {
    const lac_column *to;
    int from; // its number in the old file
    nc_type type;
    size_t rows; // to copy
    bool never_missing;
} series;

static lac_status fail_damaged(const lac_stored_file *in, const char *name, lac_error *err)
{
    return lac_fail(err, LAC_EIO,
                    "%s: is damaged: lacks values of %s that the checkpoint counts on", in->path,
                    name);
}

// Where a variable stands in the old file, which must have it as the new one does.
static lac_status find_series(const lac_store *s, const lac_stored_file *in, series *v,
                              lac_error *err)
{
    const lac_item *item = &v->to->item;
    int dims[NC_MAX_VAR_DIMS] = {0};
    int rank = 0;
    nc_type type = NC_NAT;
    size_t length = 0, width = 1;
    int code = nc_inq_varid(in->id, item->name, &v->from);
    code = code == NC_NOERR ? nc_inq_varndims(in->id, v->from, &rank) : code;
    if (code != NC_NOERR || (size_t)rank != item->rank) {
        return fail_damaged(in, item->name, err);
    }
    code = nc_inq_var(in->id, v->from, NULL, &type, NULL, dims, NULL);
    code = code == NC_NOERR ? nc_inq_dimlen(in->id, dims[0], &length) : code;
    if (rank == 2 && code == NC_NOERR) {
        code = nc_inq_dimlen(in->id, dims[1], &width);
    }
    v->type = lac_writer_type(&s->writer, item);
    bool fits = code == NC_NOERR && type == v->type && length >= v->rows && width == item->count &&
                lac_input_may_hold(in, v->rows * width);
    return fits ? LAC_OK : fail_damaged(in, item->name, err);
}

static lac_status copy_rows(const lac_store *s, const lac_stored_file *in, const series *v,
                            size_t first, size_t rows, double *values, lac_error *err)
{
    const char *name = v->to->item.name;
    const size_t start[2] = {first, 0};
    const size_t count[2] = {rows, v->to->item.count};
    const double missing = lac_netcdf_fill(in->id, v->from);
    int code = nc_get_vara_double(in->id, v->from, start, count, values);
    if (code != NC_NOERR) {
        return lac_input_fail(in, code, err, name);
    }
    for (size_t i = 0; v->never_missing && i < rows; i++) {
        if (values[i] == missing) {
            return fail_damaged(in, name, err);
        }
    }
    errno = 0;
    code = lac_nc_append(&s->file, NC_DOUBLE, v->to->id, start, count, values);
    return lac_nc_check(s->file.path, code, err, "write", name);
}

static lac_status copy_series(const lac_store *s, const lac_stored_file *in, const series *v,
                              lac_error *err)
{
    const size_t width = v->to->item.count;
    size_t most = width < BLOCK ? BLOCK / width : 1;
    lac_status status = LAC_OK;
    double *values = malloc(most * width * sizeof *values);
    LAC_FAIL_MEMORY_IF(values == NULL, err);
    for (size_t first = 0; first < v->rows; first += most) {
        size_t rows = v->rows - first < most ? v->rows - first : most;
        LAC_TRY(copy_rows(s, in, v, first, rows, values, err));
    }
out:
    free(values);
    return status;
}

static lac_status copy_all(lac_store *s, const lac_stored_file *in, const lac_checkpoint_file *from,
                           lac_error *err)
{
    const lac_columns *all = &s->writer.columns;
    const size_t time = lac_columns_along(all, "time");
    lac_status status = LAC_OK;
    for (size_t along = 0; along < LAC_MOST_GROWING; along++) {
        const char *name = all->growth[along].name != NULL ? all->growth[along].name : "";
        s->writer.columns.growth[along].written = (size_t)(along == time  ? from->records
                                                           : *name == 's' ? from->snapshots
                                                           : *name == 'e' ? from->events
                                                                          : 0);
    }
    for (const lac_column *c = all->column; c < all->column + all->n; c++) {
        const bool real = (c->item.row->flags & (LAC_WHOLE | LAC_MISSING)) == 0;
        series v = {.to = c, .never_missing = c->along == time && real};
        if (c->along != LAC_ONCE) {
            v.rows = all->growth[c->along].written;
            LAC_TRY(find_series(s, in, &v, err));
            LAC_TRY(copy_series(s, in, &v, err));
        }
    }
out:
    return status;
}

// Puts what an attribute of the old file says before `more`.
static lac_status extend(const lac_store *s, const lac_stored_file *in, const char *name,
                         const char *between, const char *more, lac_error *err)
{
    char *old = lac_nc_text_of(in->id, name, in->size);
    size_t size = old != NULL ? strlen(old) + strlen(between) + strlen(more) + 1 : 0;
    char *text = old != NULL ? malloc(size) : NULL;
    lac_status status = LAC_OK;
    if (text == NULL) {
        status = lac_fail_memory(err);
    } else {
        bool both = *old != '\0' && *more != '\0';
        (void)snprintf(text, size, "%s%s%s", old, both ? between : "", more);
        status = lac_nc_text(&s->file, NC_GLOBAL, name, text, err);
    }
    free(old);
    free(text);
    return status;
}

static lac_status put_past(const lac_store *s, const lac_stored_file *in,
                           const lac_checkpoint_file *from, lac_error *err)
{
    char resumed[96];
    lac_status status = LAC_OK;
    char *command = lac_nc_text_of(s->file.id, "history", SIZE_MAX);
    LAC_FAIL_MEMORY_IF(command == NULL, err);
    (void)snprintf(resumed, sizeof resumed, "%s checkpoint at %.17g s",
                   from->from.planned ? "planned" : "forced", from->from.time);
    LAC_TRY(extend(s, in, "history", "\n", command, err));
    LAC_TRY(extend(s, in, "resumed", "; ", resumed, err));
    LAC_TRY(extend(s, in, "date_created", "", "", err));
out:
    free(command);
    return status;
}

// Whether the file is the one that the checkpoint was made beside. It may have grown since.
static lac_status check_pair(const lac_stored_file *in, const lac_checkpoint_file *from,
                             lac_error *err)
{
    char date[32];
    double last = NAN;
    size_t records = 0;
    int id = 0;
    const size_t at = from->records > 0 ? (size_t)from->records - 1 : 0;
    char *made = lac_nc_text_of(in->id, "date_created", in->size);
    (void)lac_date_format(from->begun, date, sizeof date);
    bool same = made != NULL && strcmp(made, date) == 0;
    free(made);
    LAC_FAIL_MEMORY_IF(made == NULL, err);
    int code = nc_inq_dimid(in->id, "time", &id);
    code = code == NC_NOERR ? nc_inq_dimlen(in->id, id, &records) : code;
    LAC_FAIL_IF(same && code == NC_NOERR && records <= at && from->records > 0, err, LAC_EINPUT,
                "%s%s: %zu records of %llu", in->path,
                in->loss.damaged
                    ? ": lacks what its checkpoint counts on, its journal being damaged"
                    : ": is older than its checkpoint",
                records, (unsigned long long)from->records);
    code = code == NC_NOERR ? nc_inq_varid(in->id, "time", &id) : code;
    code =
        code == NC_NOERR && from->records > 0 ? nc_get_var1_double(in->id, id, &at, &last) : code;
    if (code != NC_NOERR) {
        return lac_input_fail(in, code, err, "time");
    }
    LAC_FAIL_IF(!same || (from->records > 0 && last != from->last_time && last != NC_FILL_DOUBLE),
                err, LAC_EINPUT, "%s: its checkpoint is of another run, begun %s", in->path, date);
    return LAC_OK;
}

lac_status lac_store_take_over(lac_store *s, const lac_checkpoint_file *from, lac_error *err)
{
    lac_stored_file *in = NULL;
    lac_status status = LAC_OK;
    LAC_TRY(lac_stored_file_open(s->file.path, &in, err));
    LAC_TRY(check_pair(in, from, err));
    LAC_TRY(lac_nc_reserve(&s->file, in->size, err));
    LAC_TRY(copy_all(s, in, from, err));
    LAC_TRY(put_past(s, in, from, err));
    s->has_checkpoint = true;
out:
    lac_stored_file_close(in);
    return status;
}
