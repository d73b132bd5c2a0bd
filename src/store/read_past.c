// SPDX-License-Identifier: GPL-3.0-or-later
// What a file of a run keeps for another run to go on from: its checkpoint, and the snapshots that
// hold slip, slip rate and state of the cells.
#include "store/past.h"

#include "base/date.h"
#include "store/input.h"

void lac_stored_past_clear(lac_stored_past *past)
{
    lac_stored_file_close(past->file);
    lac_checkpoint_file_clear(&past->checkpoint);
    free(past->case_text);
    free(past->time);
    *past = (lac_stored_past){0};
}

static bool has(const lac_stored_file *in, const char *name, nc_type *type)
{
    int id = 0;
    return nc_inq_varid(in->id, name, &id) == NC_NOERR &&
           nc_inq_vartype(in->id, id, type) == NC_NOERR;
}

// What every snapshot must hold.
static const struct {
    const char *name, *key;
} needed[] = {{"cell_slip", "slip"}, {"cell_slip_rate", "slip_rate"}, {"cell_state", "state"}};

static void find_lacks(lac_stored_past *past)
{
    nc_type type = NC_NAT;
    char list[64] = "";
    bool rough = false;
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++) {
        const bool there = has(past->file, needed[i].name, &type);
        lac_append(list, sizeof list, "%s%s", list[0] != '\0' && !there ? ", " : "",
                   there ? "" : needed[i].key);
        rough = rough || (there && type != NC_DOUBLE);
    }
    if (list[0] != '\0') {
        (void)snprintf(past->lacks, sizeof past->lacks,
                       "keeps no fields [%s] of its cells: output.fields: [slip, slip_rate, state]",
                       list);
    } else if (rough) {
        (void)snprintf(past->lacks, sizeof past->lacks,
                       "keeps its cells in single precision: output.precision: double");
    }
}

// Whether all values of a snapshot are there.
static lac_status look_at(const lac_stored_past *past, size_t snapshot, bool *whole, lac_error *err)
{
    lac_status status = LAC_OK;
    *whole = isfinite(past->time[snapshot]);
    for (size_t i = 0; *whole && i < sizeof needed / sizeof *needed; i++) {
        lac_stored_values cells = {0};
        status = lac_stored_file_row(past->file, needed[i].name, (ptrdiff_t)snapshot, &cells, err);
        *whole = status == LAC_OK;
        for (size_t k = 0; *whole && k < cells.n * cells.width; k++) {
            *whole = isfinite(cells.value[k]);
        }
        lac_stored_values_clear(&cells);
    }
    return status == LAC_ENOMEM ? status : LAC_OK;
}

// Of a run that was killed the last ones may be torn.
static lac_status find_snapshots(lac_stored_past *past, lac_error *err)
{
    lac_stored_values times = {0};
    bool whole = false;
    LAC_TRY_RETURN(lac_stored_file_values(past->file, "snapshot_time", &times, err));
    past->time = times.value;
    past->snapshots = past->lacks[0] == '\0' ? times.n : 0;
    while (past->snapshots > 0 && !whole) {
        LAC_TRY_RETURN(look_at(past, past->snapshots - 1, &whole, err));
        past->snapshots -= whole ? 0 : 1;
    }
    return LAC_OK;
}

// One that cannot be used, of another program or another file, is as none.
static lac_status find_checkpoint(const char *path, lac_stored_past *past, lac_error *err)
{
    lac_error why = {""};
    char begun[32];
    lac_checkpoint_file *kept = &past->checkpoint;
    const lac_status status = lac_checkpoint_file_read(path, kept, &why);
    past->has_checkpoint =
        status == LAC_OK && strcmp(kept->program, lac_checkpoint_file_program()) == 0 &&
        strcmp(lac_date_format(kept->begun, begun, sizeof begun), past->created) == 0;
    return status == LAC_ENOMEM ? lac_fail_memory(err) : LAC_OK;
}

lac_status lac_stored_past_open(const char *path, lac_stored_past *out, lac_error *err)
{
    lac_stored_values times = {0};
    lac_status status;
    *out = (lac_stored_past){0};
    LAC_TRY(lac_stored_file_open(path, &out->file, err));
    out->case_text = lac_nc_text_of(out->file->id, "case", out->file->size);
    LAC_TRY(out->case_text != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_LEAVE_IF(*out->case_text == '\0' || !has(out->file, "time", &(nc_type){0}), err, LAC_EINPUT,
                 "%s: is no run to go on from", path);
    (void)lac_stored_file_text(out->file, NULL, "date_created", out->created, sizeof out->created);
    LAC_TRY(lac_stored_file_series(out->file, "time", &times, err));
    LAC_LEAVE_IF(times.n == 0, err, LAC_EINPUT, "%s: holds no record yet", path);
    out->first = times.value[0];
    out->last = times.value[times.n - 1];
    find_lacks(out);
    LAC_TRY(find_snapshots(out, err));
    LAC_TRY(find_checkpoint(path, out, err));
out:
    lac_stored_values_clear(&times);
    return status;
}

static lac_status read_cells(const lac_stored_past *past, const char *name, size_t snapshot,
                             size_t n, double *out, lac_error *err)
{
    lac_stored_values cells = {0};
    lac_status status = lac_stored_file_row(past->file, name, (ptrdiff_t)snapshot, &cells, err);
    bool good = status == LAC_OK && cells.n * cells.width == n;
    for (size_t i = 0; good && i < n; i++) {
        out[i] = cells.value[i];
        good = isfinite(out[i]);
    }
    lac_stored_values_clear(&cells);
    LAC_FAIL_IF(status == LAC_OK && !good, err, LAC_EIO,
                "%s: is damaged: lacks values of %s at snapshot %zu", past->file->path, name,
                snapshot);
    return status;
}

const char *lac_stored_past_field(const lac_weakening *of)
{
    return of->modes.n != 1 ? NULL : of->kind->pore ? "excess_pore_pressure" : "broken_cohesion";
}

static const char *cells_of(const char *field, char name[64])
{
    (void)snprintf(name, 64, "cell_%s", field);
    return name;
}

bool lac_stored_past_has(const lac_stored_past *past, const char *field)
{
    char name[64];
    return has(past->file, cells_of(field, name), &(nc_type){0});
}

static lac_status read_weakening(const lac_stored_past *past, size_t snapshot,
                                 const lac_weakening_set *weak, lac_problem_state *state,
                                 lac_error *err)
{
    char name[64];
    for (size_t k = 0; weak != NULL && k < weak->count; k++) {
        const char *field = cells_of(lac_stored_past_field(&weak->item[k]), name);
        double *to = state->weak + weak->item[k].first * state->n;
        LAC_TRY_RETURN(read_cells(past, field, snapshot, state->n, to, err));
    }
    return LAC_OK;
}

lac_status lac_stored_past_state(const lac_stored_past *past, size_t snapshot,
                                 const lac_problem *problem, lac_problem_state *state,
                                 lac_error *err)
{
    const size_t n = state->n;
    const bool vector = lac_problem_is_vector(problem);
    const char *slip = vector ? "cell_slip_x" : "cell_slip";
    LAC_TRY_RETURN(read_cells(past, slip, snapshot, n, state->slip[0], err));
    if (vector) {
        LAC_TRY_RETURN(read_cells(past, "cell_slip_y", snapshot, n, state->slip[1], err));
    }
    LAC_TRY_RETURN(read_cells(past, "cell_slip_rate", snapshot, n, state->rate, err));
    LAC_TRY_RETURN(read_cells(past, "cell_state", snapshot, n, state->log_state, err));
    for (size_t i = 0; i < n; i++) {
        const double theta = state->log_state[i];
        LAC_FAIL_IF(!(theta > 0.0), err, LAC_EIO, "%s: is damaged: cell_state of cell %zu is %g",
                    past->file->path, i, theta);
        state->log_state[i] = log(theta);
    }
    return read_weakening(past, snapshot, lac_problem_weakening(problem), state, err);
}
