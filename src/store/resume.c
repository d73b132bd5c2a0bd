// SPDX-License-Identifier: GPL-3.0-or-later
// A file that goes on: netCDF cannot take records back, so that those up to the checkpoint are
// copied into a new file, which then takes the old one's name.
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/date.h"
#include "store/input.h"
#include "store/internal.h"

enum { BLOCK = 1 << 16 }; // values copied at once, or one row

// One variable over time, snapshots or events.
typedef struct series {
    char name[NC_MAX_NAME + 1];
    int to, from; // its number in the new file and in the old one
    nc_type type;
    int rank;
    size_t rows, width; // rows to copy, values in each
    bool never_missing;
} series;

static bool is_time_column(const lac_store *s, int id, const char *name)
{
    for (size_t c = 0; c < LAC_COLUMNS; c++) {
        if (s->columns[c] == id) {
            return lac_columns[c].var.type == NC_DOUBLE && strcmp(name, "step_size") != 0;
        }
    }
    return false;
}

static lac_status fail_damaged(const lac_input *in, const char *name, lac_error *err)
{
    return lac_fail(err, LAC_EIO,
                    "%s: is damaged: lacks values of %s that the checkpoint counts on", in->path,
                    name);
}

// Whether a variable of the new file grows, and where it stands in the old one.
static lac_status find_series(const lac_store *s, const lac_input *in,
                              const lac_kept_checkpoint *from, series *v, bool *grows,
                              lac_error *err)
{
    char first[NC_MAX_NAME + 1] = "";
    int dims[NC_MAX_VAR_DIMS] = {0};
    int old_dims[NC_MAX_VAR_DIMS] = {0};
    int old_rank = 0;
    nc_type old_type = NC_NAT;
    size_t length = 0;
    size_t old_width = 1;
    int code = nc_inq_var(s->file.id, v->to, v->name, &v->type, &v->rank, dims, NULL);
    if (code == NC_NOERR && v->rank > 0) {
        code = nc_inq_dimname(s->file.id, dims[0], first);
    }
    *grows = code == NC_NOERR && (v->rank == 1 || v->rank == 2) &&
             (strcmp(first, "time") == 0 || strcmp(first, "snapshot") == 0 ||
              strcmp(first, "event") == 0);
    if (!*grows) {
        return lac_nc_check(s->file.path, code, err, "read", v->name);
    }
    v->width = 1;
    code = v->rank == 2 ? nc_inq_dimlen(s->file.id, dims[1], &v->width) : NC_NOERR;
    v->rows = (size_t)(first[0] == 't'   ? from->records
                       : first[0] == 's' ? from->snapshots
                                         : from->events);
    v->never_missing = is_time_column(s, v->to, v->name);
    code = code == NC_NOERR ? nc_inq_varid(in->id, v->name, &v->from) : code;
    code = code == NC_NOERR ? nc_inq_varndims(in->id, v->from, &old_rank) : code;
    if (code != NC_NOERR || old_rank != v->rank) {
        return fail_damaged(in, v->name, err);
    }
    code = nc_inq_var(in->id, v->from, NULL, &old_type, NULL, old_dims, NULL);
    code = code == NC_NOERR ? nc_inq_dimlen(in->id, old_dims[0], &length) : code;
    if (v->rank == 2 && code == NC_NOERR) {
        code = nc_inq_dimlen(in->id, old_dims[1], &old_width);
    }
    bool fits = code == NC_NOERR && old_type == v->type && length >= v->rows &&
                old_width == v->width && lac_input_may_hold(in, v->rows * v->width);
    return fits ? LAC_OK : fail_damaged(in, v->name, err);
}

static lac_status copy_rows(const lac_store *s, const lac_input *in, const series *v, size_t first,
                            size_t rows, void *values, lac_error *err)
{
    const size_t start[2] = {first, 0};
    const size_t count[2] = {rows, v->width};
    const double *real = values;
    const bool whole_numbers = v->type != NC_DOUBLE && v->type != NC_FLOAT;
    const double missing = lac_input_fill(in, v->from, v->type);
    int code = whole_numbers ? nc_get_vara_longlong(in->id, v->from, start, count, values)
                             : nc_get_vara_double(in->id, v->from, start, count, values);
    if (code != NC_NOERR) {
        return lac_input_fail(in, code, err, v->name);
    }
    for (size_t i = 0; v->never_missing && i < rows; i++) {
        if (real[i] == missing) {
            return fail_damaged(in, v->name, err);
        }
    }
    errno = 0;
    code =
        lac_nc_append(&s->file, whole_numbers ? NC_INT64 : NC_DOUBLE, v->to, start, count, values);
    return lac_nc_check(s->file.path, code, err, "write", v->name);
}

static lac_status copy_series(const lac_store *s, const lac_input *in, const series *v,
                              lac_error *err)
{
    size_t most = v->width < BLOCK ? BLOCK / v->width : 1;
    lac_status status = LAC_OK;
    void *values = malloc(most * v->width * sizeof(double));
    if (values == NULL) {
        return lac_fail_memory(err);
    }
    for (size_t first = 0; first < v->rows; first += most) {
        size_t rows = v->rows - first < most ? v->rows - first : most;
        LAC_TRY(copy_rows(s, in, v, first, rows, values, err));
    }
out:
    free(values);
    return status;
}

static lac_status copy_all(const lac_store *s, const lac_input *in, const lac_kept_checkpoint *from,
                           lac_error *err)
{
    int variables = 0;
    lac_status status = LAC_OK;
    LAC_TRY(lac_nc_check(s->file.path, nc_inq_nvars(s->file.id, &variables), err, "read", ""));
    for (int id = 0; id < variables; id++) {
        series v = {.to = id};
        bool grows = false;
        LAC_TRY(find_series(s, in, from, &v, &grows, err));
        if (grows) {
            LAC_TRY(copy_series(s, in, &v, err));
        }
    }
out:
    return status;
}

// The text of an attribute, to be freed; "" where there is none; NULL where memory is short.
static char *attribute(int file, const char *name, size_t bound)
{
    size_t length = 0;
    nc_type type = NC_NAT;
    bool there = nc_inq_att(file, NC_GLOBAL, name, &type, &length) == NC_NOERR && type == NC_CHAR &&
                 length <= bound;
    char *text = calloc((there ? length : 0) + 1, 1);
    if (text != NULL && there && nc_get_att_text(file, NC_GLOBAL, name, text) != NC_NOERR) {
        text[0] = '\0';
    }
    return text;
}

// Puts what an attribute of the old file says before `more`.
static lac_status extend(const lac_store *s, const lac_input *in, const char *name,
                         const char *between, const char *more, lac_error *err)
{
    char *old = attribute(in->id, name, in->size);
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

static lac_status put_past(const lac_store *s, const lac_input *in, const lac_kept_checkpoint *from,
                           lac_error *err)
{
    char resumed[96];
    lac_status status = LAC_OK;
    char *command = attribute(s->file.id, "history", SIZE_MAX);
    if (command == NULL) {
        return lac_fail_memory(err);
    }
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
static lac_status check_pair(const lac_input *in, const lac_kept_checkpoint *from, lac_error *err)
{
    char date[32];
    double last = NAN;
    size_t records = 0;
    int id = 0;
    const size_t at = from->records > 0 ? (size_t)from->records - 1 : 0;
    char *made = attribute(in->id, "date_created", in->size);
    (void)lac_date_format(from->begun, date, sizeof date);
    bool same = made != NULL && strcmp(made, date) == 0;
    free(made);
    if (made == NULL) {
        return lac_fail_memory(err);
    }
    int code = nc_inq_dimid(in->id, "time", &id);
    code = code == NC_NOERR ? nc_inq_dimlen(in->id, id, &records) : code;
    if (same && code == NC_NOERR && records <= at && from->records > 0) {
        return lac_fail(err, LAC_EINPUT, "%s%s: %zu records of %llu", in->path,
                        in->loss.damaged ? ": lacks what its checkpoint counts on, its journal "
                                           "being damaged"
                                         : ": is older than its checkpoint",
                        records, (unsigned long long)from->records);
    }
    code = code == NC_NOERR ? nc_inq_varid(in->id, "time", &id) : code;
    code =
        code == NC_NOERR && from->records > 0 ? nc_get_var1_double(in->id, id, &at, &last) : code;
    if (code != NC_NOERR) {
        return lac_input_fail(in, code, err, "time");
    }
    if (!same || (from->records > 0 && last != from->last_time && last != NC_FILL_DOUBLE)) {
        return lac_fail(err, LAC_EINPUT, "%s: its checkpoint is of another run, begun %s", in->path,
                        date);
    }
    return LAC_OK;
}

lac_status lac_store_take_over(lac_store *s, const lac_kept_checkpoint *from, lac_error *err)
{
    lac_input in = {.open = false};
    lac_status status = LAC_OK;
    LAC_TRY(lac_input_open(&in, s->file.path, err));
    LAC_TRY(check_pair(&in, from, err));
    LAC_TRY(lac_nc_reserve(&s->file, in.size, err));
    LAC_TRY(copy_all(s, &in, from, err));
    LAC_TRY(put_past(s, &in, from, err));
    s->written = (size_t)from->records;
    s->snapshots = (size_t)from->snapshots;
    s->events_written = (size_t)from->events;
    s->has_checkpoint = true;
out:
    lac_input_close(&in);
    return status;
}
