// SPDX-License-Identifier: GPL-3.0-or-later
// A run kept in memory. Its variables are those that a file would have, from the same tables.
#include "store/recording.h"

#include "data/describe.h"
#include "run/describe.h"
#include "store/writer.h"

enum { LOADED_SNAPSHOTS = 40 };

// A text of the whole, with what it replaced.
typedef struct named_text {
    struct named_text *older;
    const char *text; // behind the name
    char name[];
} named_text;

struct lac_recording {
    lac_run_place place; // what is put out now
    lac_dataset *dataset;
    lac_columns columns;
    lac_dataset *kept; // laid on the columns; NULL: handed out
    bool has_last;
    double last_origin, last_local;
    named_text *newest;
};

void lac_recording_free(lac_recording *recording)
{
    if (recording == NULL) {
        return;
    }
    for (named_text *at = recording->newest, *older; at != NULL; at = older) {
        older = at->older;
        free(at);
    }
    lac_dataset_free(recording->kept);
    lac_columns_clear(&recording->columns);
    lac_dataset_free(recording->dataset);
    free(recording);
}

static lac_status append(lac_column *c, const double *values, size_t n, lac_error *err)
{
    LAC_TRY_RETURN(lac_column_reserve(c, n, err));
    memcpy(c->values + c->count, values, n * sizeof *values);
    c->count += n;
    return LAC_OK;
}

// The dimensions that grow are as long as what there is along them.
static void measure(lac_recording *r)
{
    for (lac_extent *dim = r->kept->dim; dim < r->kept->dim + r->kept->dims; dim++) {
        const size_t along = lac_columns_along(&r->columns, dim->name);
        dim->length = along != LAC_ONCE          ? r->columns.growth[along].places
                      : dim->length == LAC_GROWS ? 0
                                                 : dim->length;
    }
}

// What is put out now joins what there is, if the run has such a dimension.
static lac_status put(lac_recording *r, const char *dim, lac_error *err)
{
    const size_t along = lac_columns_along(&r->columns, dim);
    const lac_status status =
        along != LAC_ONCE ? lac_columns_put(&r->columns, along, 0, NULL, err) : LAC_OK;
    measure(r);
    return status;
}

// Copies of the texts of a column, which the result that they are of need not outlive.
static lac_status keep_texts(lac_column *c, lac_error *err)
{
    const size_t width = lac_item_longest_text(&c->item) + 1;
    char room[LAC_TEXT_ROOM];
    c->text = malloc(c->item.count * (sizeof *c->text + width));
    LAC_FAIL_MEMORY_IF(c->text == NULL, err);
    for (size_t i = 0; i < c->item.count; i++) {
        const char *text = lac_item_text(&c->item, i, room);
        c->text[i] = (char *)(c->text + c->item.count) + i * width;
        (void)snprintf(c->text[i], width, "%s", text != NULL ? text : "");
    }
    return LAC_OK;
}

LAC_TEXT_GETTER(kept_text, const lac_column *c = of, c->text[at[0]])

// A column as a variable that is read.
static lac_status show(lac_recording *r, lac_column *c, lac_error *err)
{
    const lac_laid laid = {{.row = &c->row, .rows = 1, .over = ""}, c};
    (void)snprintf(c->json, sizeof c->json, "%s", c->item.name);
    for (size_t d = 0; d < c->item.rank; d++) {
        lac_append(c->json, sizeof c->json, "[]");
    }
    c->row = (lac_variable){.name = c->item.name,
                            .json = c->json,
                            .unit = c->item.unit,
                            .long_name = c->item.long_name,
                            .comment = c->item.row->comment,
                            .dims = c->item.dims,
                            .held = LAC_HELD_REALS,
                            .offset = offsetof(lac_column, values),
                            .flags = LAC_MISSING | LAC_EMPTY};
    if (c->item.is_text) {
        c->row.held = LAC_HELD_NOT;
        c->row.text = kept_text;
        LAC_TRY_RETURN(keep_texts(c, err));
    }
    LAC_TRY_RETURN(lac_column_reserve(c, 1, err)); // an array also where it is empty
    c->values[0] = NAN;
    return lac_dataset_add(r->kept, &laid, 1, err);
}

// All that the dataset holds now of what does not grow, known at the beginning or late.
static lac_status take_fixed(lac_recording *r, unsigned late, lac_error *err)
{
    for (lac_column *c = r->columns.column; c < r->columns.column + r->columns.n; c++) {
        if (c->along == LAC_ONCE && (c->item.row->flags & LAC_LATE) == late) {
            c->count = 0;
            LAC_TRY_RETURN(lac_column_reserve(c, c->item.count, err));
            lac_item_values(&c->item, c->values);
            c->count = c->item.count;
        }
    }
    return LAC_OK;
}

lac_status lac_recording_create(const lac_recording_def *def, lac_recording **out, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_recording *r = *out = calloc(1, sizeof *r);
    LAC_FAIL_MEMORY_IF(r == NULL, err);
    r->place.of = *def;
    LAC_TRY(lac_run_describe(&r->place, &r->dataset, err));
    LAC_TRY(lac_columns_create(r->dataset, &r->columns, err));
    LAC_TRY(lac_dataset_create("A run of a creeping joint.", &r->kept, err));
    LAC_TRY(lac_dataset_dims(r->kept, r->dataset->dim, r->dataset->dims, err));
    measure(r);
    for (lac_column *c = r->columns.column; c < r->columns.column + r->columns.n; c++) {
        const bool shown = !def->passing || c->along != LAC_ONCE; // what is handed on grows
        LAC_TRY(shown ? show(r, c, err) : LAC_OK);
    }
    if (!def->passing) {
        LAC_TRY(take_fixed(r, 0, err));
        LAC_TRY(lac_dataset_put_attributes(r->dataset, false, lac_recording_put_attribute, r, err));
    }
out:
    LAC_MADE(status, out, lac_recording_free);
}

static lac_status put_record(void *context, const lac_record *record, lac_error *err)
{
    lac_recording *r = context;
    // As in a file: the same instant again says nothing new.
    if (r->has_last && record->time_origin == r->last_origin &&
        record->time_local == r->last_local) {
        return LAC_OK;
    }
    lac_run_place_record(&r->place, record);
    LAC_TRY_RETURN(put(r, "time", err));
    r->has_last = true;
    r->last_origin = record->time_origin;
    r->last_local = record->time_local;
    return LAC_OK;
}

static lac_status put_snapshot(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    lac_recording *r = context;
    r->place.snapshot = *snapshot;
    return put(r, "snapshot", err);
}

static lac_status put_event(void *context, const lac_event *event, lac_error *err)
{
    lac_recording *r = context;
    r->place.event = *event;
    return put(r, "event", err);
}

static lac_status put_once(void *context, const double *once, lac_error *err)
{
    lac_recording *recording = context;
    recording->place.once = once;
    const lac_status status = take_fixed(recording, LAC_LATE, err);
    recording->place.once = NULL;
    return status;
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

const lac_dataset *lac_recording_dataset(const lac_recording *recording) { return recording->kept; }

static void release(void *recording) { lac_recording_free(recording); }

lac_dataset *lac_recording_hand_out(lac_recording *recording)
{
    lac_dataset *kept = recording->kept;
    recording->kept = NULL;
    lac_dataset_keep(kept, recording, release, NULL);
    return kept;
}

lac_status lac_recording_text(lac_recording *recording, const char *name, const char *text,
                              lac_error *err)
{
    const size_t size = strlen(name) + 1;
    named_text *own = malloc(sizeof *own + size + strlen(text) + 1);
    LAC_FAIL_MEMORY_IF(own == NULL, err);
    own->older = recording->newest;
    own->text = memcpy(own->name + size, text, strlen(text) + 1);
    memcpy(own->name, name, size);
    recording->newest = own;
    return LAC_OK;
}

const char *lac_recording_text_of(const lac_recording *recording, const char *name)
{
    const named_text *at = recording->newest;
    while (at != NULL && strcmp(at->name, name) != 0) {
        at = at->older;
    }
    return at != NULL ? at->text : NULL;
}

lac_status lac_recording_conclude(lac_recording *recording, const lac_provenance *provenance,
                                  const char *status, const lac_run_result *result, bool single,
                                  lac_error *err)
{
    const lac_columns *all = &recording->columns;
    const lac_run_ending ending = {.result = result,
                                   .status = status,
                                   .dated = recording->place.of.dated,
                                   .start_date = recording->place.of.start_date,
                                   .wall_time = NAN,
                                   .now = NAN};
    lac_teller teller = {.keep = recording->kept};
    lac_dataset *end = NULL;
    lac_status told = lac_run_ending_describe(&ending, &end, err);
    told =
        told == LAC_OK ? lac_tell_whole(&teller, recording->dataset, provenance, end, err) : told;
    for (size_t i = 0; i < all->n && told == LAC_OK; i++) {
        teller.of = all->column[i].item.name;
        told = lac_tell_variable(&teller, recording->dataset, &all->column[i].item, single, err);
    }
    lac_dataset_free(end);
    return told;
}

static size_t compact(double *values, size_t n, size_t width, const uint8_t *keep)
{
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        if (keep[i]) {
            memmove(values + kept++ * width, values + i * width, width * sizeof *values);
        }
    }
    return kept;
}

void lac_recording_thin(lac_recording *recording, const char *dimension, const uint8_t *keep)
{
    lac_columns *all = &recording->columns;
    const size_t along = lac_columns_along(all, dimension);
    const size_t n = along != LAC_ONCE ? all->growth[along].places : 0;
    for (lac_column *c = all->column; n > 0 && c < all->column + all->n; c++) {
        if (c->along == along) {
            all->growth[along].places = compact(c->values, n, c->item.count, keep);
            c->count = all->growth[along].places * c->item.count;
        }
    }
    measure(recording);
}

// Moves values behind those of another; where there are none, the arrays change places.
static void pour(lac_column *to, lac_column *from)
{
    const lac_column own = *to;
    if (own.count > 0) {
        memcpy(to->values + own.count, from->values, from->count * sizeof *from->values);
    } else {
        to->values = from->values;
        to->room = from->room;
        from->values = own.values;
        from->room = own.room;
    }
    to->count += from->count;
}

lac_status lac_recording_move(lac_recording *recording, lac_recording *from, lac_error *err)
{
    lac_columns *into = &recording->columns, *of = &from->columns;
    lac_column *to = into->column, *end = of->column + of->n;
    lac_status status = LAC_OK;
    // Of recordings of one def all that grows stands at the same places.
    for (lac_column *own = of->column; status == LAC_OK && own < end; own++, to++) {
        const bool both = own->along != LAC_ONCE && to->count > 0;
        status = both ? lac_column_reserve(to, own->count, err) : LAC_OK;
    }
    to = into->column;
    for (lac_column *own = of->column; own < end; own++, to++) {
        if (own->along != LAC_ONCE && status == LAC_OK) {
            pour(to, own);
        }
        own->count = own->along != LAC_ONCE ? 0 : own->count;
    }
    for (size_t along = 0; along < LAC_MOST_GROWING; along++) {
        into->growth[along].places += status == LAC_OK ? of->growth[along].places : 0;
        of->growth[along].places = 0;
    }
    measure(recording);
    measure(from);
    return status;
}

// What a file holds of a variable: all, or some places, evenly many, and the last.
static lac_status load(lac_column *c, size_t n, size_t stride, const lac_stored_file *file,
                       lac_error *err)
{
    const char *name = c->item.name;
    const bool all = stride == 1;
    lac_stored_values from = {0};
    lac_status status = LAC_OK;
    for (size_t i = (n - 1) % stride; i < n; i += all ? n : stride) {
        lac_stored_values_clear(&from);
        LAC_TRY(all ? lac_stored_file_values(file, name, &from, err)
                    : lac_stored_file_row(file, name, (ptrdiff_t)i, &from, err));
        LAC_LEAVE_IF(from.value == NULL || (all && from.n < n), err, LAC_EIO,
                     "%s is missing or shorter than its dimension", name);
        LAC_TRY(append(c, from.value, (all ? n : 1) * from.width, err));
    }
out:
    lac_stored_values_clear(&from);
    return status;
}

static lac_status load_axis(lac_columns *all, const char *dim, size_t n, size_t most,
                            const lac_stored_file *file, lac_error *err)
{
    const size_t along = lac_columns_along(all, dim);
    const size_t stride = most > 0 ? n / most + 1 : 1;
    for (lac_column *c = all->column; n > 0 && c < all->column + all->n; c++) {
        if (along != LAC_ONCE && c->along == along) {
            LAC_TRY_RETURN(load(c, n, stride, file, err));
            all->growth[along].places = c->count / c->item.count;
        }
    }
    return LAC_OK;
}

lac_status lac_recording_load(lac_recording *recording, const char *path,
                              const lac_checkpoint_file *checkpoint, lac_error *err)
{
    lac_columns *all = &recording->columns;
    lac_stored_file *file = NULL;
    lac_status status;
    LAC_TRY(lac_stored_file_open(path, &file, err));
    LAC_TRY(load_axis(all, "time", (size_t)checkpoint->records, 0, file, err));
    // All snapshots could be more than there is memory.
    LAC_TRY(load_axis(all, "snapshot", (size_t)checkpoint->snapshots, LOADED_SNAPSHOTS, file, err));
    LAC_TRY(load_axis(all, "event", (size_t)checkpoint->events, 0, file, err));
    measure(recording);
    const size_t n = lac_dataset_count(recording->kept, "time_origin");
    recording->has_last = n > 0;
    if (n > 0) {
        recording->last_origin = lac_dataset_array(recording->kept, "time_origin")[n - 1];
        recording->last_local = lac_dataset_array(recording->kept, "time_local")[n - 1];
    }
out:
    lac_stored_file_close(file);
    return status;
}
