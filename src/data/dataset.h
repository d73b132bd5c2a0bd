/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "data/json.h"
#include "lacuna/dataset.h"

enum {
    LAC_MOST_DIMS = 3,  ///< of a variable
    LAC_TEXT_ROOM = 512 ///< bytes that a text made on demand may take
};

/// One value of a result. NaN and infinity are missing.
/// @param of  what the table was laid on; where that is many, the one that the value is of
/// @param at  [rank + 1] its place along each dimension but those that many are along; behind them
///            `which` of lac_named
typedef double (*lac_getter)(const void *of, const size_t *at);

/// The same of a text. @param room  for one that is made here @return NULL: missing
typedef const char *(*lac_text_getter)(const void *of, const size_t *at, char room[LAC_TEXT_ROOM]);

/// Where a value stands, if no getter gives it; of a row over dimensions the first of an array.
typedef enum lac_held {
    LAC_HELD_NOT = 0,
    LAC_HELD_REAL,  ///< a double
    LAC_HELD_COUNT, ///< a size_t; SIZE_MAX: missing
    LAC_HELD_INT64, ///< an int64_t; INT64_MIN: missing
    LAC_HELD_INT,   ///< an int, an enum
    LAC_HELD_BOOL,  ///< a bool
    LAC_HELD_TEXT,  ///< a const char *
    LAC_HELD_CHARS, ///< an array of char; with LAC_MISSING "" is missing
    LAC_HELD_REALS, ///< a const double * to all values (of one of many, or of one place of what
                    ///< grows); NULL: the variable is left out
    LAC_HELD_BYTES, ///< the same, a const uint8_t *, bytes in a file
} lac_held;

enum {
    LAC_MISSING = 1,    ///< may be missing: has a _FillValue in a file
    LAC_TIME = 2,       ///< a time: in a file on the clock of the dataset
    LAC_WHOLE = 4,      ///< an integer in a file
    LAC_SINGLE = 8,     ///< of one value and yet a variable of a file; else a global attribute
    LAC_CHARS = 16,     ///< texts as rows of characters, which old readers take
    LAC_MEANINGS = 32,  ///< texts as the meanings of the numbers 0, 1 ...
    LAC_TRUTH = 64,     ///< 0 or 1, in JSON false or true
    LAC_EMPTY = 128,    ///< in a file also without values, its dimension without end
    LAC_FILLED = 256,   ///< never missing, and yet has a _FillValue in a file
    LAC_LONG = 512,     ///< with LAC_WHOLE: of 64 bits
    LAC_ROUGH = 1024,   ///< may be written as floats
    LAC_CELLS = 2048,   ///< over many cells: compressed, and written place by place, not in batches
    LAC_LATE = 4096,    ///< its values are known only after it is defined
    LAC_NUMERAL = 8192, ///< texts that may be numbers, and are written as such in JSON
    LAC_DATE = 16384, ///< a time, told as a date on the dataset's clock; missing where it has none
    LAC_FLOAT = 32768 ///< floats in a file
};

/// One variable of a result, all that is told of it: a row of a const table.
typedef struct lac_variable {
    const char *name; ///< in a file, "group/name" in a group of it; NULL: it is in none
    const char *json; ///< where it stands in JSON: "sampler/steps"; "levels[]/n_tot" with a list
                      ///< over the next of its dimensions, "powers{}" with an object of its labels;
                      ///< rows of the same path make a list; NULL: it stands in none
    const char *unit; ///< SI; NULL: 1
    const char *long_name, *comment, *coordinates;
    const char *cell_methods, *cell_measures, *standard_name, *axis; ///< as CF has them; NULL: none
    const char *meanings; ///< what its values 0, 1 ... mean, a word each; NULL: they are numbers
    const char *dims;     ///< in order, between spaces, the last fastest; NULL: the table's. In a
                          ///< file each is called what stands behind a "/"
    lac_getter value;     ///< either of these, or what is held
    lac_text_getter text; ///< of a text
    lac_held held;
    unsigned flags;           ///< LAC_MISSING | ...
    size_t offset;            ///< of what is held [bytes]
    const char *const *names; ///< what its values 0, 1 ... are told as; NULL: they are numbers
    lac_text_getter label;    ///< names the places of its last dimension, where `json` ends in {}
    bool (*has)(const void *of, const size_t *at); ///< false: it is left out, and null where it is
                                                   ///< the first of an object in JSON; NULL: true
} lac_variable;

/// What a result is made of.
typedef struct lac_variables {
    const lac_variable *row;
    size_t rows;
    const char *over; ///< dimensions of rows that name none; "": one value
    size_t stride;    ///< of many that it is laid on, along `over`, at least one dimension and at
                      ///< most two [bytes]; 0: it is laid on one
    bool pointers;    ///< it is laid on pointers to many
} lac_variables;

/// @param summary  one sentence on what it is, for a file
lac_status lac_dataset_create(const char *summary, lac_dataset **out, lac_error *err);

/// Length of a dimension that grows: variables over it, the first of theirs, have at any time the
/// values of one place, which is written before the next.
#define LAC_GROWS SIZE_MAX

/// A dimension. Variables over one of length 0 are left out of a file, but for LAC_EMPTY.
typedef struct lac_extent {
    const char *name;
    size_t length;
} lac_extent;

/// Adds dimensions, before the variables over them.
lac_status lac_dataset_dims(lac_dataset *dataset, const lac_extent *extent, size_t n,
                            lac_error *err);

/// What times count from in a file.
typedef enum lac_clock {
    LAC_CLOCK_NONE = 0, ///< from the results' own zero
    LAC_CLOCK_START,    ///< the same, which is a date
    LAC_CLOCK_1970,     ///< results and file count from 1970
    LAC_CLOCK_DATE      ///< from LAC_CLOCK_START's date to the microsecond, as CF has time
} lac_clock;

/// A table and the result that it is laid on, which must outlive the dataset.
typedef struct lac_laid {
    lac_variables table;
    const void *of; ///< NULL: all of it is missing, and null in JSON
} lac_laid;

/// Adds the variables of tables.
/// @return LAC_OK; LAC_EINPUT (a row names a dimension that was not added, or too many; a name in
///         JSON is longer than 63 bytes; more than 320 variables in all); LAC_ENOMEM
lac_status lac_dataset_add(lac_dataset *dataset, const lac_laid *laid, size_t n, lac_error *err);

/// A variable whose name the result gives.
typedef struct lac_named {
    const char *name, *long_name, *unit, *comment; ///< copied
    size_t which;                                  ///< handed to its getters behind the places
    const char *cell_methods;                      ///< copied
} lac_named;

/// Adds one. @param row  all else that is told of it
lac_status lac_dataset_add_named(lac_dataset *dataset, const lac_variable *row,
                                 const lac_named *named, const void *of, lac_error *err);

/// Gives the variable that was added last, if any, attributes in a file.
/// @param laid  rows of one value, with the variable's `which`
void lac_dataset_attributes(lac_dataset *dataset, const lac_laid *laid);

/// One variable as it is asked for. It holds until the dataset is freed or added to.
typedef struct lac_item {
    const lac_variable *row;
    const char *name, *long_name, *unit;       ///< the row's
    size_t rank, length[LAC_MOST_DIMS], count; ///< count: values in all, or of one place
    const char *dim[LAC_MOST_DIMS];            ///< names
    const char *dims;                          ///< all of them, between spaces
    bool is_text;
    size_t next;                   ///< for lac_dataset_next
    const struct lac_entry *entry; ///< for what follows
} lac_item;

/// The next variable that is in a file: what is not there and what runs over an empty dimension is
/// skipped. @param item  {0} at first
/// @return false: there is none
bool lac_dataset_next(const lac_dataset *dataset, lac_item *item);

/// The variable of a name.
/// @return false: there is none
bool lac_dataset_find(const lac_dataset *dataset, const char *name, lac_item *item);

/// All values of a variable. @param out  [item->count] NaN or infinite: missing
void lac_item_values(const lac_item *item, double *out);

/// The array that holds all its values as they are, in their order, doubles or bytes; NULL: they
/// are in none.
const void *lac_item_array(const lac_item *item);

/// One of its texts. @param place  of item->count @return NULL: missing
const char *lac_item_text(const lac_item *item, size_t place, char room[LAC_TEXT_ROOM]);

/// An attribute of a variable: a text or, where that is NULL, a number.
typedef struct lac_attribute {
    const char *name, *text;
    double number;
    char room[LAC_TEXT_ROOM]; ///< of a text that is made on demand
    size_t next;              ///< for lac_item_next_attribute
} lac_attribute;

/// The next attribute of a variable beyond those of its row; one that is missing is skipped.
/// @param attribute  {0} at first
/// @return false: there is none
bool lac_item_next_attribute(const lac_item *item, lac_attribute *attribute);

enum {
    LAC_MOST_ROWS = 320, ///< of a dataset
    LAC_JSON_NAME = 64   ///< bytes of a part of a path in JSON
};

/// A row and what it is laid on.
typedef struct lac_entry {
    const lac_variable *row;
    const char *over;
    size_t stride;
    bool pointers;
    const void *of;
    const lac_dataset *dataset;
    size_t own, second;  ///< dimensions that many are along; length of the second of them
    lac_variable *named; ///< the row, owned, the result giving its texts; NULL: the table's
    size_t which;
    lac_laid attributes;
} lac_entry;

/// An attribute that was kept, or with no name the type of a variable.
typedef struct lac_told {
    struct lac_told *next;
    const char *of, *name, *text; ///< of: NULL: the whole
    size_t n;
    bool whole;
    double number[];
} lac_told;

struct lac_dataset {
    const char *summary;
    lac_clock clock; ///< of its times in a file
    double start;    ///< [s] since 1970 of the results' time 0; for LAC_CLOCK_START and _DATE
    size_t dims, dim_room, entries, room;
    lac_extent *dim;
    lac_entry *entry;
    void *result; ///< that it is of, if it is its own
    void (*release)(void *result);
    const struct lac_provenance *made; ///< from what, where the result knows
    lac_told *told; ///< what its file would say, kept as what it is of may be gone; NULL: asked
};

/// Hands the result over to its dataset, which frees it with itself.
/// @param made  within the result; NULL: not known
void lac_dataset_keep(lac_dataset *dataset, void *result, void (*release)(void *result),
                      const struct lac_provenance *made);

/// Its dimensions. @return how many
size_t lac_entry_dims(const lac_dataset *dataset, const lac_entry *entry,
                      const lac_extent *dim[LAC_MOST_DIMS]);

/// One value, text, and whether it is there. @param place  of all its values
double lac_entry_number(const lac_entry *entry, const size_t *at, size_t place);
const char *lac_entry_text(const lac_entry *entry, const size_t *at, char room[LAC_TEXT_ROOM]);
bool lac_entry_is_text(const lac_entry *entry);
const char *lac_entry_label(const lac_entry *entry, const size_t *at, char room[LAC_TEXT_ROOM]);
bool lac_entry_has(const lac_entry *entry, const size_t *at);

/// Writes the members that have a place in JSON into an object that is open.
void lac_dataset_json(const lac_dataset *dataset, lac_json *json);
