// SPDX-License-Identifier: GPL-3.0-or-later
// A run kept in memory. Its variables are those that a file would have, from the same tables.
#include "store/recording.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "store/columns.h"
#include "store/recording_internal.h"
#include "store/store.h"

// An array that grows, and what it is.
typedef struct variable {
    lac_recorded seen;
    double *values; // seen.values
    size_t room;
} variable;

// A text of the whole.
typedef struct named_text {
    char *name, *text; // owned
} named_text;

struct lac_recording {
    size_t count, room;
    variable *variable;   // the tables' first, in their order: see the places below
    size_t fields, extra; // where the fields of the cells and the extra quantities begin
    size_t extras, events;
    size_t *width; // [extras] values a record; 0: no record has it
    unsigned wanted;
    size_t cells;
    bool has_last;
    double last_origin, last_local;
    size_t texts;
    named_text *text; // [texts]
};

static void variable_clear(variable *v)
{
    free((char *)v->seen.name);
    free((char *)v->seen.unit);
    free((char *)v->seen.long_name);
    free(v->values);
}

void lac_recording_free(lac_recording *recording)
{
    if (recording == NULL) {
        return;
    }
    for (size_t i = 0; i < recording->count; i++) {
        variable_clear(&recording->variable[i]);
    }
    for (size_t i = 0; i < recording->texts; i++) {
        free(recording->text[i].name);
        free(recording->text[i].text);
    }
    free(recording->text);
    free(recording->variable);
    free(recording->width);
    free(recording);
}

static lac_status make_room(variable *v, size_t n, lac_error *err)
{
    if (v->room - v->seen.count < n) {
        size_t room = v->seen.count + n + v->room; // at least doubled
        double *grown = realloc(v->values, room * sizeof *grown);
        if (grown == NULL) {
            return lac_fail_memory(err);
        }
        v->seen.values = v->values = grown;
        v->room = room;
    }
    return LAC_OK;
}

static lac_status append(variable *v, const double *values, size_t n, lac_error *err)
{
    const lac_status status = make_room(v, n, err);
    if (status == LAC_OK) {
        memcpy(v->values + v->seen.count, values, n * sizeof *values);
        v->seen.count += n;
    }
    return status;
}

static lac_status define(lac_recording *r, const char *name, const char *unit,
                         const char *long_name, const char *dimensions, lac_error *err)
{
    if (r->count == r->room) {
        size_t room = 2 * r->room + 16;
        variable *grown = realloc(r->variable, room * sizeof *grown);
        if (grown == NULL) {
            return lac_fail_memory(err);
        }
        r->variable = grown;
        r->room = room;
    }
    variable *v = &r->variable[r->count];
    *v = (variable){.seen = {.name = strdup(name),
                             .unit = strdup(unit != NULL ? unit : "s"), // those of time have none
                             .long_name = strdup(long_name),
                             .dimensions = dimensions}};
    if (v->seen.name == NULL || v->seen.unit == NULL || v->seen.long_name == NULL) {
        variable_clear(v);
        return lac_fail_memory(err);
    }
    r->count++;
    return LAC_OK;
}

lac_status lac_recording_add(lac_recording *recording, const char *name, const char *unit,
                             const char *long_name, double value, lac_error *err)
{
    lac_status status = define(recording, name, unit, long_name, "", err);
    return status == LAC_OK ? append(&recording->variable[recording->count - 1], &value, 1, err)
                            : status;
}

static lac_status define_columns(lac_recording *r, size_t n, const lac_column *table,
                                 const char *dimension, lac_error *err)
{
    lac_status status = LAC_OK;
    for (size_t c = 0; c < n && status == LAC_OK; c++) {
        const lac_nc_var *var = &table[c].var;
        status = define(r, var->name, var->unit, var->long_name, dimension, err);
    }
    return status;
}

static lac_status define_fields(lac_recording *r, const lac_recording_def *def, lac_error *err)
{
    lac_status status = LAC_OK;
    r->fields = r->count;
    r->wanted = def->fields;
    if (def->fields == 0) {
        return LAC_OK;
    }
    LAC_TRY(define(r, "snapshot_time", "s", "time of the snapshot since the start of the run",
                   "snapshot", err));
    for (size_t f = 0; f < LAC_FIELDS; f++) {
        const lac_nc_var *var = &lac_fields[f].var;
        if ((def->fields & lac_fields[f].flag) != 0) {
            LAC_TRY(define(r, var->name, var->unit, var->long_name, "snapshot cell", err));
        }
    }
out:
    return status;
}

static lac_status define_extras(lac_recording *r, const lac_recording_def *def, lac_error *err)
{
    size_t levels = def->hierarchy != NULL ? lac_hierarchy_levels(def->hierarchy) + 1 : 0;
    lac_status status = LAC_OK;
    r->extra = r->count;
    r->extras = def->extras;
    r->width = malloc((def->extras + 1) * sizeof *r->width);
    if (r->width == NULL) {
        return lac_fail_memory(err);
    }
    for (size_t i = 0; i < def->extras; i++) {
        static const char *const dimensions[] = {
            [LAC_OVER_NOTHING] = "", [LAC_OVER_TIME] = "time", [LAC_OVER_LEVELS] = "time level"};
        const lac_extra *e = &def->extra[i];
        r->width[i] = e->over == LAC_OVER_LEVELS ? levels : e->over == LAC_OVER_TIME ? 1 : 0;
        LAC_TRY(define(r, e->name, e->unit, e->long_name, dimensions[e->over], err));
        if (e->comment != NULL) {
            char name[LAC_RECORDING_NAME];
            (void)snprintf(name, sizeof name, LAC_RECORDING_COMMENT, e->name);
            LAC_TRY(lac_recording_text(r, name, e->comment, err));
        }
    }
out:
    return status;
}

// Position and pressure of the contact cells.
static lac_status put_cells(lac_recording *r, const lac_domain *domain, lac_error *err)
{
    static const char *const what[][3] = {
        {"x", "m", "position of the cell's centre along x"},
        {"y", "m", "position of the cell's centre along y"},
        {"pressure", "Pa", "normal pressure on each contact cell"}};
    lac_status status = LAC_OK;
    for (size_t i = 0; i < 3; i++) {
        LAC_TRY(define(r, what[i][0], what[i][1], what[i][2], "cell", err));
        for (size_t c = 0; c < domain->n; c++) {
            const lac_grid *g = &domain->grid;
            double place[3] = {((double)(domain->index[c] % g->nx) + 0.5) * g->dx,
                               ((double)(domain->index[c] / g->nx) + 0.5) * g->dy,
                               domain->pressure[c]};
            LAC_TRY(append(&r->variable[r->count - 1], &place[i], 1, err));
        }
    }
out:
    return status;
}

static lac_status put_levels(lac_recording *r, const lac_recording_def *def, lac_error *err)
{
    lac_status status = LAC_OK;
    LAC_TRY(define(r, "block_size", "m", "side of a block of this level along x", "level", err));
    LAC_TRY(define(r, "n_tot", "1", "blocks of this level that hold a contact cell", "level", err));
    for (size_t l = 0; l <= lac_hierarchy_levels(def->hierarchy); l++) {
        double side = ldexp(def->domain->grid.dx, (int)l);
        double blocks = (double)lac_hierarchy_blocks(def->hierarchy, l);
        LAC_TRY(append(&r->variable[r->count - 2], &side, 1, err));
        LAC_TRY(append(&r->variable[r->count - 1], &blocks, 1, err));
    }
    const lac_transfer *transfer = def->transfer;
    if (transfer == NULL || transfer->kind->blocks == NULL) {
        goto out;
    }
    LAC_TRY(define(r, "hierarchy_stiffness", "Pa m-1",
                   "stiffness k_l of the hierarchy at this level", "level", err));
    for (size_t l = 0; l <= lac_hierarchy_levels(def->hierarchy); l++) {
        const bool all = l == lac_hierarchy_levels(def->hierarchy); // one block: none to resist
        const double k = all ? NAN : transfer->kind->stiffness(transfer->state, l);
        LAC_TRY(append(&r->variable[r->count - 1], &k, 1, err));
    }
out:
    return status;
}

lac_status lac_recording_create(const lac_recording_def *def, lac_recording **out, lac_error *err)
{
    lac_status status = LAC_OK;
    *out = NULL;
    lac_recording *r = calloc(1, sizeof *r);
    if (r == NULL) {
        return lac_fail_memory(err);
    }
    LAC_TRY(define_columns(r, LAC_COLUMNS, lac_columns, "time", err));
    LAC_TRY(define_fields(r, def, err));
    LAC_TRY(define_extras(r, def, err));
    r->events = r->count;
    if (def->events) {
        LAC_TRY(define_columns(r, LAC_EVENT_COLUMNS, lac_event_columns, "event", err));
    }
    r->cells = def->domain != NULL ? def->domain->n : 0;
    const bool whole = def->domain != NULL && !def->passing;
    LAC_TRY(whole ? put_cells(r, def->domain, err) : LAC_OK);
    LAC_TRY(whole && def->hierarchy != NULL ? put_levels(r, def, err) : LAC_OK);
    *out = r;
    r = NULL;
out:
    lac_recording_free(r);
    return status;
}

// A column's value in a row or an event, as a real; NaN where a file has it missing.
static double value_of(const lac_column *column, const void *row)
{
    const char *at = (const char *)row + column->offset;
    double real;
    int64_t integer;
    if (column->var.type == NC_DOUBLE) {
        memcpy(&real, at, sizeof real);
        return real;
    }
    memcpy(&integer, at, sizeof integer);
    return integer == 0 && column->var.fill ? NAN : (double)integer;
}

static lac_status put_extras(lac_recording *r, const double *values, lac_error *err)
{
    lac_status status = LAC_OK;
    for (size_t i = 0; i < r->extras; i++) {
        for (size_t k = 0; k < r->width[i]; k++) {
            double value = values != NULL ? *values++ : NAN;
            LAC_TRY(append(&r->variable[r->extra + i], &value, 1, err));
        }
    }
out:
    return status;
}

// Back to `n` records: what memory did not suffice for is missing in all columns.
static void drop_record(lac_recording *r, size_t n)
{
    for (size_t c = 0; c < LAC_COLUMNS; c++) {
        r->variable[c].seen.count = n;
    }
    for (size_t i = 0; i < r->extras; i++) {
        if (r->width[i] > 0) {
            r->variable[r->extra + i].seen.count = n * r->width[i];
        }
    }
}

static lac_status put_record(void *context, const lac_record *record, lac_error *err)
{
    lac_recording *r = context;
    const size_t n = r->variable[0].seen.count;
    const lac_row row = {.time = record->time_origin + record->time_local,
                         .apparent_friction = record->seen.shear_force / record->seen.normal_force,
                         .record = *record};
    lac_status status = LAC_OK;
    // As in a file: the same instant again says nothing new.
    if (r->has_last && record->time_origin == r->last_origin &&
        record->time_local == r->last_local) {
        return LAC_OK;
    }
    for (size_t c = 0; c < LAC_COLUMNS; c++) {
        double value = value_of(&lac_columns[c], &row);
        LAC_TRY(append(&r->variable[c], &value, 1, err));
    }
    LAC_TRY(put_extras(r, record->extra, err));
    lac_recording_resume(r, record->time_origin, record->time_local);
out:
    if (status != LAC_OK) {
        drop_record(r, n);
    }
    return status;
}

static lac_status put_snapshot(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    lac_recording *r = context;
    lac_status status = LAC_OK;
    if (r->wanted == 0) {
        return LAC_OK;
    }
    variable *v = &r->variable[r->fields];
    const variable *first = v;
    const size_t n = v->seen.count;
    LAC_TRY(append(v, &snapshot->time, 1, err));
    for (size_t f = 0; f < LAC_FIELDS; f++) {
        const double *values;
        memcpy(&values, (const char *)snapshot + lac_fields[f].offset, sizeof values);
        if ((r->wanted & lac_fields[f].flag) != 0) {
            LAC_TRY(append(++v, values, r->cells, err));
        }
    }
out:
    for (; status != LAC_OK && v >= first; v--) {
        v->seen.count = v == first ? n : n * r->cells; // none of it
    }
    return status;
}

static lac_status put_event(void *context, const lac_event *event, lac_error *err)
{
    lac_recording *r = context;
    const size_t n = r->variable[r->events].seen.count;
    lac_status status = LAC_OK;
    for (size_t c = 0; c < LAC_EVENT_COLUMNS; c++) {
        double value = c == LAC_COLUMN_TIME ? event->time_origin + event->time_local
                                            : value_of(&lac_event_columns[c], event);
        LAC_TRY(append(&r->variable[r->events + c], &value, 1, err));
    }
out:
    for (size_t c = 0; status != LAC_OK && c < LAC_EVENT_COLUMNS; c++) {
        r->variable[r->events + c].seen.count = n;
    }
    return status;
}

lac_status lac_recording_once(lac_recording *recording, const double *once, lac_error *err)
{
    lac_status status = LAC_OK;
    for (size_t i = 0; i < recording->extras; i++) {
        variable *v = &recording->variable[recording->extra + i];
        if (v->seen.dimensions[0] == '\0') {
            v->seen.count = 0;
            LAC_TRY(append(v, once++, 1, err));
        }
    }
out:
    return status;
}

static lac_status put_once(void *context, const double *once, lac_error *err)
{
    return lac_recording_once(context, once, err);
}

lac_sink lac_recording_sink(lac_recording *recording)
{
    return (lac_sink){.size = sizeof(lac_sink),
                      .context = recording,
                      .record = put_record,
                      .snapshot = put_snapshot,
                      .event = put_event,
                      .once = put_once};
}

bool lac_recording_at(const lac_recording *recording, size_t index, lac_recorded *out)
{
    if (index >= recording->count) {
        return false;
    }
    *out = recording->variable[index].seen;
    return true;
}

bool lac_recording_find(const lac_recording *recording, const char *name, lac_recorded *out)
{
    for (size_t i = 0; lac_recording_at(recording, i, out); i++) {
        if (strcmp(out->name, name) == 0) {
            return true;
        }
    }
    return false;
}

static named_text *find_text(const lac_recording *recording, const char *name)
{
    for (size_t i = 0; i < recording->texts; i++) {
        if (strcmp(recording->text[i].name, name) == 0) {
            return &recording->text[i];
        }
    }
    return NULL;
}

static named_text *add_text(lac_recording *recording, const char *name)
{
    const size_t n = recording->texts;
    named_text *grown = realloc(recording->text, (n + 1) * sizeof *grown);
    char *own = strdup(name);
    recording->text = grown != NULL ? grown : recording->text;
    if (grown == NULL || own == NULL) {
        free(own);
        return NULL;
    }
    grown[n] = (named_text){.name = own};
    recording->texts = n + 1;
    return &grown[n];
}

lac_status lac_recording_text(lac_recording *recording, const char *name, const char *text,
                              lac_error *err)
{
    named_text *place = find_text(recording, name);
    place = place != NULL ? place : add_text(recording, name);
    char *copy = place != NULL ? strdup(text) : NULL;
    if (copy == NULL) {
        return lac_fail_memory(err);
    }
    free(place->text);
    place->text = copy;
    return LAC_OK;
}

const char *lac_recording_text_of(const lac_recording *recording, const char *name)
{
    const named_text *found = find_text(recording, name);
    return found != NULL ? found->text : NULL;
}

lac_status lac_recording_append(lac_recording *recording, size_t index, const double *values,
                                size_t n, lac_error *err)
{
    return append(&recording->variable[index], values, n, err);
}

lac_status lac_recording_reserve(lac_recording *recording, const lac_recording *from, size_t index,
                                 lac_error *err)
{
    variable *v = &recording->variable[index];
    return v->seen.count > 0 ? make_room(v, from->variable[index].seen.count, err) : LAC_OK;
}

void lac_recording_pour(lac_recording *recording, lac_recording *from, size_t index)
{
    variable *v = &recording->variable[index], *of = &from->variable[index];
    const variable old = *v;
    if (old.seen.count > 0) {
        memcpy(v->values + old.seen.count, of->values, of->seen.count * sizeof *v->values);
        free(of->values);
    } else {
        free(old.values);
        v->seen.values = v->values = of->values;
        v->room = of->room;
    }
    v->seen.count += of->seen.count;
    of->seen.values = of->values = NULL;
    of->seen.count = of->room = 0;
}

void lac_recording_resume(lac_recording *recording, double origin, double local)
{
    recording->has_last = true;
    recording->last_origin = origin;
    recording->last_local = local;
}

void lac_recording_cut(lac_recording *recording, size_t index, size_t count)
{
    recording->variable[index].seen.count = count;
}

double *lac_recording_values(lac_recording *recording, size_t index)
{
    return recording->variable[index].values;
}
