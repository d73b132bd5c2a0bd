/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "data/dataset.h"

enum { LAC_MOST_GROWING = 3, LAC_ONCE = LAC_MOST_GROWING };

/// A variable of a dataset, and the values of it that are in memory.
typedef struct lac_column {
    lac_item item;
    size_t along; ///< which of the dimensions that grow; LAC_ONCE: none
    double *values;
    size_t count, room;
    int id;           ///< in a file
    lac_variable row; ///< in a recording: how it is read, and its path in JSON
    char json[80];
} lac_column;

/// A dimension that grows.
typedef struct lac_growth {
    const char *name;
    size_t places;  ///< in memory
    size_t written; ///< in a file
} lac_growth;

/// The variables of a dataset, those of one value that are attributes in a file left out, in its
/// order; memory for what is put into them place by place.
typedef struct lac_columns {
    size_t n;
    lac_column *column;
    lac_growth growth[LAC_MOST_GROWING];
} lac_columns;

/// @param more     room for so many that lac_columns_add adds
/// @param columns  {0}; to be cleared whatever the status
lac_status lac_columns_create(const lac_dataset *dataset, size_t more, lac_columns *columns,
                              lac_error *err);
void lac_columns_clear(lac_columns *columns);

/// Whether an item is an attribute of a file.
bool lac_item_is_global(const lac_item *item);

/// One more, for which there is room.
lac_column *lac_columns_add(lac_columns *columns, const lac_item *item);

/// The dimension of a name that grows; LAC_ONCE: none.
size_t lac_columns_along(const lac_columns *columns, const char *dim);

/// Room for `n` values more.
lac_status lac_column_reserve(lac_column *column, size_t n, lac_error *err);

/// Adds what the dataset holds now to all variables along a dimension, or to none.
/// @param but  flags of those that are left out
lac_status lac_columns_put(lac_columns *columns, size_t along, unsigned but, lac_error *err);
