/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "store/nc.h"

enum { LAC_MOST_GROWING = 3, LAC_ONCE = LAC_MOST_GROWING };

/// A variable of a dataset, and the values of it that are in memory.
typedef struct lac_column {
    lac_item item;
    size_t along; ///< which of the dimensions that grow; LAC_ONCE: none
    double *values;
    size_t count, room;
    char **text;      ///< [item.count] of texts, in a recording; owned, as one piece
    int file, id;     ///< the file's or its group's, and its own there
    lac_variable row; ///< in a recording: how it is read, and its path in JSON
    char json[80];
} lac_column;

/// A dimension that grows.
typedef struct lac_growth {
    const char *name;
    bool cells;     ///< some along it are LAC_CELLS
    size_t places;  ///< in memory
    size_t written; ///< in a file
} lac_growth;

/// The variables of a dataset, those of one value that are attributes in a file left out, in its
/// order; memory for what is put into them place by place.
typedef struct lac_columns {
    size_t n;
    lac_column *column;
    size_t growing;
    lac_growth growth[LAC_MOST_GROWING];
} lac_columns;

/// @param columns  {0}; to be cleared whatever the status
lac_status lac_columns_create(const lac_dataset *dataset, lac_columns *columns, lac_error *err);
void lac_columns_clear(lac_columns *columns);

/// Whether an item is an attribute of a file.
bool lac_item_is_global(const lac_item *item);

/// The dimension of a name that grows; LAC_ONCE: none.
size_t lac_columns_along(const lac_columns *columns, const char *dim);

/// Room for `n` values more.
lac_status lac_column_reserve(lac_column *column, size_t n, lac_error *err);

/// Adds what the dataset holds now to all variables along a dimension, or to none.
/// @param but    flags of those that are left out
/// @param lacks  becomes the name of one that is no number and has to be: LAC_ENUMERIC without
///               words, and nothing is added; NULL: it is not looked for
lac_status lac_columns_put(lac_columns *columns, size_t along, unsigned but, const char **lacks,
                           lac_error *err);

/// A dataset on its way into a file: what does not grow at once, the rest place by place.
typedef struct lac_writer {
    const lac_nc *file; ///< set by the caller, as are
    const lac_dataset *dataset;
    bool single;        ///< LAC_ROUGH ones are written as floats
    int deflate;        ///< level of LAC_CELLS ones that grow, 0 to 9
    size_t chunk;       ///< places a chunk along dimensions that grow
    size_t batch;       ///< places kept in memory at most
    size_t first, part; ///< cells that are put now, and how many; 0: all
    char unit[64];      ///< of times
    lac_clock clock;
    double shift; ///< what the unit's whole second leaves of the start [s]
    lac_columns columns;
    size_t pending; ///< given to netCDF and not yet synced [bytes]
} lac_writer;

/// Defines all variables, and writes those that neither grow nor come late. LAC_EINPUT: no date can
/// be the start.
lac_status lac_writer_begin(lac_writer *writer, lac_error *err);

/// Adds what the dataset holds now along a dimension that grows; nothing where it has none of that
/// name. @param lacks  as above
lac_status lac_writer_put(lac_writer *writer, const char *dim, const char **lacks, lac_error *err);

/// Writes cells first ... first + n - 1 of what the dataset holds of them now; lac_writer_put with
/// the rest makes it a place.
lac_status lac_writer_put_part(lac_writer *writer, const char *dim, size_t first, size_t n,
                               lac_error *err);

/// Writes values of places along the dimension of a column at once; what is missing is filled in.
lac_status lac_writer_put_values(const lac_writer *writer, const lac_column *column, size_t first,
                                 size_t n, double *values, lac_error *err);

/// Writes those of LAC_LATE that do not grow.
lac_status lac_writer_put_late(lac_writer *writer, lac_error *err);

/// Places along a dimension so far.
size_t lac_writer_places(const lac_writer *writer, const char *dim);

/// Gives netCDF what is in memory, in the order of the dimensions.
lac_status lac_writer_flush(lac_writer *writer, lac_error *err);

/// The same, and brings all to the file.
lac_status lac_writer_sync(lac_writer *writer, lac_error *err);

void lac_writer_clear(lac_writer *writer);

/// Sets the unit of times. LAC_EINPUT: no date can be the start.
lac_status lac_writer_clock(lac_writer *writer, lac_error *err);

/// Where an attribute of a variable goes: a text or, with n > 0, numbers of a type.
typedef lac_status lac_put_numbers(void *to, const char *name, const char *text, size_t n,
                                   const double *number, nc_type type, lac_error *err);

/// Puts the attributes of a variable but its _Encoding; of the writer nothing else than what it
/// says of times and floats counts.
lac_status lac_writer_attributes(const lac_writer *writer, const lac_item *item,
                                 lac_put_numbers *put, void *to, lac_error *err);

/// Who is told attributes: a caller, or with `told` a dataset that keeps them.
typedef struct lac_teller {
    lac_attribute_told tell;
    void *context;
    lac_dataset *keep; ///< NULL: nobody
    const char *of;    ///< the variable whose they are; NULL: the whole
} lac_teller;
lac_put_numbers lac_tell_numbers;

/// Tells those of the whole. @param ending  more that it has; NULL
lac_status lac_tell_whole(lac_teller *teller, const lac_dataset *dataset,
                          const struct lac_provenance *made, const lac_dataset *ending,
                          lac_error *err);

/// Tells those of a variable. @param single  LAC_ROUGH ones are floats
lac_status lac_tell_variable(lac_teller *teller, const lac_dataset *dataset, const lac_item *item,
                             bool single, lac_error *err);

/// The netCDF type of an item.
nc_type lac_writer_type(const lac_writer *writer, const lac_item *item);

/// Defines one variable with its attributes.
lac_status lac_writer_define(const lac_writer *writer, lac_column *column, lac_error *err);

/// The longest of the texts of an item, at least 1 [bytes].
size_t lac_item_longest_text(const lac_item *item);

/// Where an attribute of the whole goes: a text or, where that is NULL, a number; NaN: it is
/// missing.
typedef lac_status lac_put_attribute(void *to, const char *name, const char *text, double number,
                                     bool whole, lac_error *err);
lac_put_attribute lac_nc_put_attribute;        ///< into a lac_nc
lac_put_attribute lac_recording_put_attribute; ///< into a lac_recording, as a text

/// Puts the attributes that every file of Lacuna carries.
lac_status lac_provenance_put(const lac_provenance *of, const char *summary, lac_put_attribute *put,
                              void *to, lac_error *err);

/// Puts the attributes that a dataset has for its file. @param late  those of LAC_LATE, or all
/// others
lac_status lac_dataset_put_attributes(const lac_dataset *dataset, bool late, lac_put_attribute *put,
                                      void *to, lac_error *err);
