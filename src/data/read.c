// SPDX-License-Identifier: GPL-3.0-or-later
// A dataset as users of the library read it: variables by their names.
#include "base/ask.h"
#include "base/temp_file.h"
#include "data/dataset.h"

// The variable of a name; one of no values where there is none.
static lac_item find(const lac_dataset *dataset, const char *name)
{
    lac_item item = {0};
    const bool found = dataset != NULL && name != NULL && lac_dataset_find(dataset, name, &item);
    return found ? item : (lac_item){0};
}

const char *lac_dataset_name(const lac_dataset *dataset, size_t index)
{
    lac_item item = {0};
    bool found = dataset != NULL;
    for (size_t i = 0; i <= index && found; i++) {
        found = lac_dataset_next(dataset, &item);
    }
    return found ? item.name : NULL;
}

const char *lac_dataset_unit(const lac_dataset *dataset, const char *name)
{
    const lac_item item = find(dataset, name);
    const char *without = item.row != NULL && (item.row->flags & LAC_TIME) != 0 ? "s" : "1";
    return item.name == NULL || item.unit != NULL ? item.unit : without;
}

const char *lac_dataset_long_name(const lac_dataset *dataset, const char *name)
{
    return find(dataset, name).long_name;
}

const char *lac_dataset_dim(const lac_dataset *dataset, const char *name, size_t index,
                            size_t *length)
{
    const lac_item item = find(dataset, name);
    const bool there = index < item.rank;
    if (length != NULL) {
        *length = there ? item.length[index] : 0;
    }
    return there ? item.dim[index] : NULL;
}

bool lac_dataset_is_text(const lac_dataset *dataset, const char *name)
{
    return find(dataset, name).is_text;
}

size_t lac_dataset_count(const lac_dataset *dataset, const char *name)
{
    return find(dataset, name).count;
}

const double *lac_dataset_array(const lac_dataset *dataset, const char *name)
{
    const lac_item item = find(dataset, name);
    return item.name != NULL && item.row->held == LAC_HELD_REALS ? lac_item_array(&item) : NULL;
}

// A variable that there must be, of numbers or of texts.
static lac_status ask(const lac_dataset *dataset, const char *name, bool text, lac_item *out,
                      lac_error *err)
{
    *out = find(dataset, name);
    LAC_FAIL_IF(out->name == NULL, err, LAC_EINPUT, "dataset: has no variable \"%s\"", name);
    return out->is_text == text ? LAC_OK
                                : lac_fail(err, LAC_EINPUT, "dataset: %s: holds %s", name,
                                           text ? "numbers, no texts" : "texts, no numbers");
}

lac_status lac_dataset_values(const lac_dataset *dataset, const char *name, size_t n, double *out,
                              lac_error *err)
{
    lac_item item;
    LAC_TRY_RETURN(LAC_NEED(err, dataset, name, out));
    LAC_TRY_RETURN(ask(dataset, name, false, &item, err));
    LAC_FAIL_IF(item.count != n, err, LAC_EINPUT, "dataset: %s: has %zu values, asked for %zu",
                name, item.count, n);
    lac_item_values(&item, out);
    return LAC_OK;
}

lac_status lac_dataset_text(const lac_dataset *dataset, const char *name, size_t place, char *text,
                            size_t size, lac_error *err)
{
    char room[LAC_TEXT_ROOM];
    lac_item item;
    LAC_TRY_RETURN(LAC_NEED(err, dataset, name, text));
    LAC_TRY_RETURN(ask(dataset, name, true, &item, err));
    LAC_FAIL_IF(place >= item.count, err, LAC_EINPUT, "dataset: %s: has %zu texts, none at %zu",
                name, item.count, place);
    const char *found = lac_item_text(&item, place, room);
    const size_t length = found != NULL ? strlen(found) : 0;
    LAC_FAIL_IF(length >= size, err, LAC_EINPUT, "dataset: %s: takes %zu bytes, not %zu", name,
                length + 1, size);
    memcpy(text, found != NULL ? found : "", length + 1);
    return LAC_OK;
}

lac_status lac_dataset_to_json(const lac_dataset *dataset, char **text, lac_error *err)
{
    size_t size = 0;
    LAC_TRY_RETURN(LAC_NEED(err, dataset, text));
    *text = NULL;
    lac_json json = {.out = open_memstream(text, &size)};
    LAC_FAIL_MEMORY_IF(json.out == NULL, err);
    lac_json_open(&json, NULL, '{');
    lac_dataset_json(dataset, &json);
    lac_json_close(&json, '}');
    return lac_text_made(json.out, text) != NULL ? LAC_OK : lac_fail_memory(err);
}
