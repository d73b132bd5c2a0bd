/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "store/store_file.h"

/// A variable of a file, as it may stand in a table.
typedef struct cli_variable {
    char name[LAC_STORED_NAME];
    lac_stored_shape shape;
    bool wanted;
} cli_variable;

/// The variables of a file.
typedef struct cli_tables {
    const lac_stored_file *file;
    cli_variable *variable; ///< [count] owned
    size_t count;
} cli_tables;

/// Whether two variables run over the same, and so share a table.
bool cli_export_share(const lac_stored_shape *a, const lac_stored_shape *b);

/// Writes a table: coordinates of its rows, then all wanted variables of that shape. A time that is
/// a date has it beside it in words, so has a number that stands for a word.
/// @param columns  how many it has
lac_status cli_export_write(const cli_tables *e, const lac_stored_shape *shape, FILE *out,
                            size_t *columns, lac_error *err);

/// Writes the attributes of the file, a row each.
void cli_export_attributes(const cli_tables *e, FILE *out, char *room, size_t size);
