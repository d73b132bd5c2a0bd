// SPDX-License-Identifier: GPL-3.0-or-later
// What a result is made of: named variables, each with a row that tells of it and a way to its
// values.
#include "data/dataset.h"

#include "base/date.h"

lac_status lac_dataset_create(const char *summary, lac_dataset **out, lac_error *err)
{
    *out = calloc(1, sizeof **out);
    LAC_FAIL_MEMORY_IF(*out == NULL, err);
    (*out)->summary = summary;
    return LAC_OK;
}

void lac_dataset_free(lac_dataset *dataset)
{
    if (dataset == NULL) {
        return;
    }
    for (size_t i = 0; i < dataset->entries; i++) {
        free(dataset->entry[i].named);
    }
    free(dataset->entry);
    free(dataset->dim);
    for (lac_told *told = dataset->told, *next; told != NULL; told = next) {
        next = told->next;
        free(told);
    }
    if (dataset->release != NULL) {
        dataset->release(dataset->result);
    }
    free(dataset);
}

void lac_dataset_keep(lac_dataset *dataset, void *result, void (*release)(void *result),
                      const struct lac_provenance *made)
{
    dataset->result = result;
    dataset->release = release;
    dataset->made = made;
}

lac_status lac_dataset_dims(lac_dataset *dataset, const lac_extent *extent, size_t n,
                            lac_error *err)
{
    LAC_TRY_RETURN(lac_grow((void *)&dataset->dim, &dataset->dim_room, dataset->dims + n,
                            sizeof *dataset->dim, err));
    for (size_t i = 0; i < n; i++) {
        dataset->dim[dataset->dims++] = extent[i];
    }
    return LAC_OK;
}

static lac_extent *find_dim(const lac_dataset *dataset, const char *name, size_t size)
{
    for (size_t i = 0; i < dataset->dims; i++) {
        const char *own = dataset->dim[i].name;
        if (strlen(own) == size && memcmp(own, name, size) == 0) {
            return &dataset->dim[i];
        }
    }
    return NULL;
}

static const char *dims_of(const lac_entry *entry)
{
    return entry->row->dims != NULL ? entry->row->dims : entry->over;
}

// Whether all that the row names is there, and short enough for those who walk it.
static lac_status check_row(const lac_dataset *dataset, const lac_entry *entry, lac_error *err)
{
    size_t rank = 0;
    const char *name = entry->row->name != NULL ? entry->row->name : "";
    for (const char *at = dims_of(entry); *at != '\0'; at += at[0] == ' ') {
        const size_t size = strcspn(at, " ");
        LAC_FAIL_IF(find_dim(dataset, at, size) == NULL || ++rank > LAC_MOST_DIMS, err, LAC_EINPUT,
                    "dataset: %s: \"%s\" is no dimension, or one too many", name, at);
        at += size;
    }
    for (const char *at = entry->row->json; at != NULL && *at != '\0'; at += at[0] == '/') {
        const size_t size = strcspn(at, "/");
        LAC_FAIL_IF(size >= LAC_JSON_NAME, err, LAC_EINPUT, "dataset: \"%s\" is too long a path",
                    at);
        at += size;
    }
    return dataset->entries < LAC_MOST_ROWS
               ? LAC_OK
               : lac_fail(err, LAC_EINPUT, "dataset: more than %d variables", LAC_MOST_ROWS);
}

static lac_status add_entry(lac_dataset *dataset, const lac_entry *entry, lac_error *err)
{
    LAC_TRY_RETURN(check_row(dataset, entry, err));
    LAC_TRY_RETURN(lac_grow((void *)&dataset->entry, &dataset->room, dataset->entries + 1,
                            sizeof *dataset->entry, err));
    dataset->entry[dataset->entries++] = *entry;
    return LAC_OK;
}

lac_status lac_dataset_add(lac_dataset *dataset, const lac_laid *laid, size_t n, lac_error *err)
{
    for (size_t k = 0; k < n; k++) {
        const lac_variables *table = &laid[k].table;
        for (size_t i = 0; i < table->rows; i++) {
            const size_t first = strcspn(table->over, " ");
            const bool two = table->over[first] != '\0';
            const lac_extent *second =
                two ? find_dim(dataset, table->over + first + 1, strlen(table->over + first + 1))
                    : NULL;
            const bool many = table->stride > 0 || table->pointers;
            const lac_entry entry = {.row = &table->row[i],
                                     .over = table->over,
                                     .stride = table->stride,
                                     .pointers = table->pointers,
                                     .of = laid[k].of,
                                     .dataset = dataset,
                                     .own = !many ? 0
                                            : two ? 2
                                                  : 1,
                                     .second = second != NULL ? second->length : 0};
            LAC_TRY_RETURN(add_entry(dataset, &entry, err));
        }
    }
    return LAC_OK;
}

static size_t size_of(const char *text) { return text != NULL ? strlen(text) + 1 : 0; }

// Puts a text behind those that are there.
static const char *add_text(char **end, const char *text)
{
    const char *own = text != NULL ? memcpy(*end, text, size_of(text)) : NULL;
    *end += size_of(text);
    return own;
}

lac_status lac_dataset_add_named(lac_dataset *dataset, const lac_variable *row,
                                 const lac_named *named, const void *of, lac_error *err)
{
    lac_variable *own =
        malloc(sizeof *own + size_of(named->name) + size_of(named->long_name) +
               size_of(named->unit) + size_of(named->comment) + size_of(named->cell_methods));
    LAC_FAIL_MEMORY_IF(own == NULL, err);
    char *end = (char *)(own + 1);
    *own = *row;
    own->name = add_text(&end, named->name);
    own->long_name = add_text(&end, named->long_name);
    own->unit = add_text(&end, named->unit);
    own->comment = add_text(&end, named->comment);
    own->cell_methods = add_text(&end, named->cell_methods);
    const lac_entry entry = {
        .row = own, .over = "", .of = of, .dataset = dataset, .named = own, .which = named->which};
    const lac_status status = add_entry(dataset, &entry, err);
    if (status != LAC_OK) {
        free(own);
    }
    return status;
}

void lac_dataset_attributes(lac_dataset *dataset, const lac_laid *laid)
{
    if (dataset->entries > 0) {
        dataset->entry[dataset->entries - 1].attributes = *laid;
    }
}

size_t lac_entry_dims(const lac_dataset *dataset, const lac_entry *entry,
                      const lac_extent *dim[LAC_MOST_DIMS])
{
    const char *at = dims_of(entry);
    size_t rank = 0;
    for (; *at != '\0'; at += at[0] == ' ') {
        const size_t size = strcspn(at, " ");
        dim[rank++] = find_dim(dataset, at, size);
        at += size;
    }
    return rank;
}

// What a value is of: that one of many.
static const void *one_of(const lac_entry *entry, const size_t *at)
{
    const void *from = entry->of;
    const size_t index = entry->own == 0   ? 0
                         : entry->own == 1 ? at[0]
                                           : at[0] * entry->second + at[1];
    if (entry->pointers) {
        memcpy(&from, (const char *)entry->of + index * sizeof from, sizeof from);
    }
    return (const char *)from + index * entry->stride;
}

static const char *held(const lac_entry *entry, const size_t *at)
{
    return (const char *)one_of(entry, at) + entry->row->offset;
}

// Where the values are that are held as one array; NULL: there is none.
static const void *array(const lac_entry *entry, const size_t *at)
{
    const void *values = NULL;
    if (entry->of != NULL) {
        memcpy(&values, held(entry, at), sizeof values);
    }
    return values;
}

static double held_number(const lac_entry *entry, const size_t *at, size_t place)
{
    const void *from = held(entry, at);
    switch (entry->row->held) {
    case LAC_HELD_REAL:
        return ((const double *)from)[place];
    case LAC_HELD_COUNT: {
        const size_t count = ((const size_t *)from)[place];
        return count != SIZE_MAX ? (double)count : NAN;
    }
    case LAC_HELD_INT64: {
        const int64_t integer = ((const int64_t *)from)[place];
        return integer != INT64_MIN ? (double)integer : NAN;
    }
    case LAC_HELD_INT:
        return ((const int *)from)[place];
    case LAC_HELD_BOOL:
        return ((const bool *)from)[place] ? 1.0 : 0.0;
    case LAC_HELD_REALS:
        return ((const double *)array(entry, at))[place];
    case LAC_HELD_BYTES:
        return ((const uint8_t *)array(entry, at))[place];
    default:
        return NAN;
    }
}

double lac_entry_number(const lac_entry *entry, const size_t *at, size_t place)
{
    if (entry->of == NULL) {
        return NAN;
    }
    return entry->row->value != NULL ? entry->row->value(one_of(entry, at), at + entry->own)
                                     : held_number(entry, at, place);
}

bool lac_entry_is_text(const lac_entry *entry)
{
    const lac_variable *row = entry->row;
    return row->text != NULL || row->held == LAC_HELD_TEXT || row->held == LAC_HELD_CHARS ||
           row->names != NULL || (row->flags & LAC_DATE) != 0;
}

const char *lac_entry_text(const lac_entry *entry, const size_t *at, char room[LAC_TEXT_ROOM])
{
    const lac_variable *row = entry->row;
    const char *text = NULL;
    if (entry->of == NULL) {
        return NULL;
    }
    if (row->text != NULL) {
        return row->text(one_of(entry, at), at + entry->own, room);
    }
    if (row->names != NULL || (row->flags & LAC_DATE) != 0) {
        const lac_dataset *d = entry->dataset;
        const double number = lac_entry_number(entry, at, 0);
        const bool dated = d->clock != LAC_CLOCK_NONE && isfinite(number);
        text = row->names != NULL ? row->names[(size_t)number]
               : dated            ? lac_date_format(d->start + number, room, LAC_TEXT_ROOM)
                                  : "";
        return row->names != NULL || text[0] != '\0' ? text : NULL;
    }
    if (row->held == LAC_HELD_CHARS) {
        text = held(entry, at);
        return (row->flags & LAC_MISSING) != 0 && text[0] == '\0' ? NULL : text;
    }
    memcpy(&text, held(entry, at), sizeof text);
    return text;
}

const char *lac_entry_label(const lac_entry *entry, const size_t *at, char room[LAC_TEXT_ROOM])
{
    return entry->row->label(one_of(entry, at), at + entry->own, room);
}

static bool is_array(const lac_variable *row)
{
    return row->held == LAC_HELD_REALS || row->held == LAC_HELD_BYTES;
}

bool lac_entry_has(const lac_entry *entry, const size_t *at)
{
    const lac_variable *row = entry->row;
    return entry->of != NULL &&
           (row->has == NULL || row->has(one_of(entry, at), at + entry->own)) &&
           (!is_array(row) || (row->flags & LAC_LATE) != 0 || array(entry, at) != NULL);
}

// The next place, the last dimension fastest.
static void step(const lac_item *item, size_t *at)
{
    for (size_t d = item->rank; d-- > 0;) {
        if (++at[d] < item->length[d]) {
            return;
        }
        at[d] = 0;
    }
}

// Whether an entry is there for a file; if so, what it is.
static bool describe(const lac_dataset *dataset, const lac_entry *entry, lac_item *out)
{
    const lac_extent *dim[LAC_MOST_DIMS];
    size_t first[LAC_MOST_DIMS + 1] = {0};
    const size_t next = out->next;
    const lac_variable *row = entry->row;
    bool there = true;
    *out = (lac_item){.row = row,
                      .name = row->name,
                      .long_name = row->long_name,
                      .unit = row->unit,
                      .rank = lac_entry_dims(dataset, entry, dim),
                      .count = 1,
                      .dims = dims_of(entry),
                      .is_text = lac_entry_is_text(entry),
                      .next = next,
                      .entry = entry};
    for (size_t d = 0; d < out->rank; d++) {
        out->dim[d] = dim[d]->name;
        out->length[d] = dim[d]->length;
        out->count *= dim[d]->length != LAC_GROWS ? dim[d]->length : 1;
        there = there && (dim[d]->length > 0 || (row->flags & LAC_EMPTY) != 0);
    }
    first[out->rank] = entry->which;
    return out->name != NULL && there && lac_entry_has(entry, first);
}

bool lac_dataset_next(const lac_dataset *dataset, lac_item *item)
{
    while (item->next < dataset->entries) {
        const lac_entry *entry = &dataset->entry[item->next++];
        if (describe(dataset, entry, item)) {
            return true;
        }
    }
    return false;
}

bool lac_dataset_find(const lac_dataset *dataset, const char *name, lac_item *item)
{
    *item = (lac_item){0};
    while (lac_dataset_next(dataset, item)) {
        if (strcmp(item->name, name) == 0) {
            return true;
        }
    }
    return false;
}

void lac_item_values(const lac_item *item, double *out)
{
    size_t at[LAC_MOST_DIMS + 1] = {0};
    at[item->rank] = item->entry->which;
    size_t each = 1; // values of one of many
    for (size_t d = item->entry->own; d < item->rank; d++) {
        each *= item->length[d] != LAC_GROWS ? item->length[d] : 1;
    }
    for (size_t i = 0; i < item->count; i++) {
        out[i] = lac_entry_number(item->entry, at, i % each);
        step(item, at);
    }
}

const void *lac_item_array(const lac_item *item)
{
    const size_t first[] = {0};
    return is_array(item->row) && item->entry->own == 0 ? array(item->entry, first) : NULL;
}

const char *lac_item_text(const lac_item *item, size_t place, char room[LAC_TEXT_ROOM])
{
    size_t at[LAC_MOST_DIMS + 1] = {0};
    for (size_t d = item->rank; d-- > 0; place /= item->length[d]) {
        at[d] = place % item->length[d];
    }
    at[item->rank] = item->entry->which;
    return lac_entry_text(item->entry, at, room);
}

bool lac_item_next_attribute(const lac_item *item, lac_attribute *attribute)
{
    const lac_laid *laid = &item->entry->attributes;
    const size_t at[] = {item->entry->which, 0};
    while (laid->of != NULL && attribute->next < laid->table.rows) {
        const lac_entry own = {.row = &laid->table.row[attribute->next++],
                               .stride = laid->table.stride,
                               .own = laid->table.stride > 0 ? 1 : 0,
                               .dataset = item->entry->dataset,
                               .of = laid->of};
        const bool is_text = lac_entry_is_text(&own);
        attribute->name = own.row->name;
        attribute->text = is_text ? lac_entry_text(&own, at, attribute->room) : NULL;
        attribute->number = is_text ? NAN : lac_entry_number(&own, at, 0);
        if (own.row->name != NULL && (attribute->text != NULL || isfinite(attribute->number))) {
            return true;
        }
    }
    return false;
}
