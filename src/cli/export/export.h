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

enum { CLI_STATION_VALUES = 7 };

/// A run's points as stations.
typedef struct cli_stations {
    lac_stored_values value[CLI_STATION_VALUES]; ///< time, slip ...: export_stations.c has the list
    char **name;                                 ///< [count]
    size_t count;
    double eta; ///< of radiation damping [Pa s/m]
} cli_stations;

/// Reads them; `s` is empty before, and to be cleared also where it fails.
/// @return LAC_OK; LAC_EINPUT (no points, no full contact ...); LAC_EIO; LAC_ENOMEM
lac_status cli_stations_read(const cli_tables *e, cli_stations *s, lac_error *err);
void cli_stations_clear(cli_stations *s);

/// Writes one: a header, and a row of five columns for each record.
void cli_stations_write(const cli_tables *e, const cli_stations *s, size_t which, FILE *out);

/// Writes the attributes of the file, a row each.
void cli_export_attributes(const cli_tables *e, FILE *out, char *room, size_t size);
