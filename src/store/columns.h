/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_STORE_COLUMNS_H
#define LACUNA_STORE_COLUMNS_H

#include "store/nc.h"

/// A record with what follows from it.
typedef struct lac_row {
    double time;              ///< origin + local [s]
    double apparent_friction; ///< Q/P [1]
    lac_record record;
} lac_row;

/// One variable over time: what it is and where it stands in a row. Its type there is double for
/// NC_DOUBLE and int64_t for the integers.
typedef struct lac_column {
    lac_nc_var var;
    size_t offset;
} lac_column;

/// One field of the cells: what it is, who asks for it and where it stands in a snapshot.
typedef struct lac_field {
    lac_nc_var var;
    unsigned flag;
    size_t offset;
} lac_field;

enum { LAC_COLUMNS = 14, LAC_FIELDS = 4, LAC_EVENT_COLUMNS = 10, LAC_COLUMN_TIME = 0 };

extern const lac_column lac_columns[LAC_COLUMNS]; ///< `time` is the first
extern const lac_field lac_fields[LAC_FIELDS];
/// Offsets are those in a lac_event; `event_time` is the first and wants its origin added.
extern const lac_column lac_event_columns[LAC_EVENT_COLUMNS];

#endif
