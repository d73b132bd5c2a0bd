// SPDX-License-Identifier: GPL-3.0-or-later
// Variables of a dataset as arrays that grow place by place: a run in memory, and what is yet to be
// written of one.
#include "store/columns.h"
#include "base/fail.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

void lac_columns_clear(lac_columns *columns)
{
    for (size_t i = 0; i < columns->n; i++) {
        free(columns->column[i].values);
    }
    free(columns->column);
    *columns = (lac_columns){0};
}

bool lac_item_is_global(const lac_item *item)
{
    return item->rank == 0 && (item->row->flags & LAC_SINGLE) == 0;
}

size_t lac_columns_along(const lac_columns *columns, const char *dim)
{
    size_t along = 0;
    while (along < LAC_MOST_GROWING &&
           (columns->growth[along].name == NULL || strcmp(columns->growth[along].name, dim) != 0)) {
        along++;
    }
    return along;
}

// The dimension along which an item grows, noted where it is new.
static size_t find_growth(lac_columns *columns, const lac_item *item)
{
    if (item->rank == 0 || item->length[0] != LAC_GROWS) {
        return LAC_ONCE;
    }
    const size_t known = lac_columns_along(columns, item->dim[0]);
    size_t along = 0;
    while (known == LAC_ONCE && columns->growth[along].name != NULL) {
        assert(along + 1 < LAC_MOST_GROWING);
        along++;
    }
    along = known != LAC_ONCE ? known : along;
    columns->growth[along].name = item->dim[0];
    return along;
}

lac_column *lac_columns_add(lac_columns *columns, const lac_item *item)
{
    lac_column *column = &columns->column[columns->n++];
    *column = (lac_column){.item = *item, .along = find_growth(columns, item)};
    return column;
}

lac_status lac_columns_create(const lac_dataset *dataset, size_t more, lac_columns *columns,
                              lac_error *err)
{
    lac_item item = {0};
    columns->column = calloc(dataset->entries + more + 1, sizeof *columns->column);
    LAC_FAIL_MEMORY_IF(columns->column == NULL, err);
    while (lac_dataset_next(dataset, &item)) {
        if (!lac_item_is_global(&item)) {
            (void)lac_columns_add(columns, &item);
        }
    }
    return LAC_OK;
}

lac_status lac_column_reserve(lac_column *column, size_t n, lac_error *err)
{
    if (column->room - column->count < n) {
        const size_t room = column->count + n + column->room; // at least doubled
        double *grown = realloc(column->values, room * sizeof *grown);
        LAC_FAIL_MEMORY_IF(grown == NULL, err);
        column->values = grown;
        column->room = room;
    }
    return LAC_OK;
}

lac_status lac_columns_put(lac_columns *columns, size_t along, unsigned but, lac_error *err)
{
    lac_column *end = columns->column + columns->n;
    lac_status status = LAC_OK;
    for (lac_column *c = columns->column; c < end && status == LAC_OK; c++) {
        if (c->along == along && (c->item.row->flags & but) == 0) {
            status = lac_column_reserve(c, c->item.count, err);
        }
    }
    if (status != LAC_OK || along == LAC_ONCE) {
        return status;
    }
    for (lac_column *c = columns->column; c < end; c++) {
        if (c->along == along && (c->item.row->flags & but) == 0) {
            lac_item_values(&c->item, c->values + c->count);
            c->count += c->item.count;
        }
    }
    columns->growth[along].places++;
    return LAC_OK;
}
