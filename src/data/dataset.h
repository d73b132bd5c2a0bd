/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_DATA_DATASET_H
#define LACUNA_DATA_DATASET_H

#include <stdint.h>

#include "data/json.h"
#include "lacuna/dataset.h"

enum {
    LAC_MOST_ROWS = 256, ///< of a dataset
    LAC_JSON_NAME = 64   ///< bytes of a part of a path in JSON
};

typedef struct lac_dim {
    lac_extent extent;
    lac_text_getter label; ///< NULL: its places have no names
    const void *of;
} lac_dim;

/// A row and what it is laid on.
typedef struct lac_entry {
    const lac_variable *row;
    const char *over;
    size_t stride;
    bool pointers;
    const void *of;
    lac_named named; ///< owned texts; without a name: the row's
    lac_laid attributes;
} lac_entry;

struct lac_dataset {
    const char *summary;
    lac_clock clock;
    double start;
    size_t dims, entries, room;
    lac_dim *dim;
    lac_entry *entry;
};

/// Its dimensions. @return how many
size_t lac_entry_dims(const lac_dataset *dataset, const lac_entry *entry,
                      const lac_dim *dim[LAC_MOST_DIMS]);

/// One value, text, and whether it is there. @param place  of all its values
double lac_entry_number(const lac_entry *entry, const size_t *at, size_t place);
const char *lac_entry_text(const lac_entry *entry, const size_t *at, char room[LAC_TEXT_ROOM]);
bool lac_entry_is_text(const lac_entry *entry);
bool lac_entry_has(const lac_entry *entry, const size_t *at);

/// Writes the members that have a place in JSON into an object that is open.
void lac_dataset_json(const lac_dataset *dataset, lac_json *json);

#endif
