/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "store/recording.h"

/// Numbers of a variable, missing ones NaN.
typedef struct lac_stored_values {
    double *value; ///< [n][width]; owned; NULL: the file has no such variable
    size_t n;      ///< along its first dimension; 1 where it has none
    size_t width;  ///< all others multiplied
} lac_stored_values;

/// Frees the values; nothing read is fine.
void lac_stored_values_clear(lac_stored_values *values);

/// A file of Lacuna that is read piece by piece: looked through and opened once.
typedef struct lac_stored_file lac_stored_file;

/// LAC_EIO: not a Lacuna file, damaged, or being written.
lac_status lac_stored_file_open(const char *path, lac_stored_file **out, lac_error *err);

/// A run that is kept in memory, read as its file would be. It must outlive what is opened here,
/// and not change while it is read.
lac_status lac_stored_file_of(const lac_recording *recording, lac_stored_file **out,
                              lac_error *err);

/// Whether the writer of a file was stopped before it had closed it, and FILE.journal has all that
/// was synced. The readers here then read a copy that is whole, made beside the file, or in /tmp
/// where that folder cannot be written; other programs cannot. The file does not change.
/// @return false also where somebody is writing it
bool lac_store_is_cut(const char *path);

/// What damage to the journal of a file that was not closed takes away. What a stopped write leaves
/// at its end is none.
typedef struct lac_store_loss {
    bool damaged;     ///< else nothing is lost
    uint64_t at;      ///< the first byte of the journal that cannot be read; 0: none of it can
    uint64_t unread;  ///< bytes from there on
    uint64_t records; ///< those that the journal gives all the same
    int64_t own;      ///< those that the file shows without it; -1: it cannot be opened
} lac_store_loss;

/// Whether the journal of a file is damaged. The readers then read the file itself where that shows
/// at least as many records as what is left of the journal gives, else the latter.
/// @return false also where somebody is writing it
bool lac_store_is_damaged(const char *path, lac_store_loss *loss);

/// Makes such a file whole, so that every program can read it, in place: by a copy and rename. Its
/// journal is removed, unless it is damaged. `status` stays what it was.
/// @param mended  false: nothing was to be done
/// @return LAC_OK; LAC_EIO (not a Lacuna file, damaged, being written, full disk; the file shows
///         more records than its damaged journal gives); LAC_ENOMEM
lac_status lac_store_mend(const char *path, bool *mended, lac_error *err);

/// Closes it; NULL is fine.
void lac_stored_file_close(lac_stored_file *file);

/// A whole variable of any dimensions; one that is not there is no error. The caller clears `out`.
lac_status lac_stored_file_values(const lac_stored_file *file, const char *variable,
                                  lac_stored_values *out, lac_error *err);

/// The same of one place along the first dimension, the cells of a snapshot; LAC_EINPUT: there is
/// none.
lac_status lac_stored_file_row(const lac_stored_file *file, const char *variable, ptrdiff_t row,
                               lac_stored_values *out, lac_error *err);

/// A variable over time of a run, of the records that are whole.
/// @return LAC_OK; LAC_EIO (no such variable, damaged); LAC_ENOMEM
lac_status lac_stored_file_series(const lac_stored_file *file, const char *variable,
                                  lac_stored_values *out, lac_error *err);

/// A text attribute of a variable, or with NULL of the file.
/// @param text  "" where there is none, or where it is longer than the room
/// @return whether there is one
bool lac_stored_file_text(const lac_stored_file *file, const char *variable, const char *attribute,
                          char *text, size_t size);

/// An attribute of one number, the same; NaN where there is none.
double lac_stored_file_number(const lac_stored_file *file, const char *variable,
                              const char *attribute);

/// Name of a variable, in the order of the file.
/// @param index  from 0
/// @return false past the last one, or where the name is longer than the room for it
bool lac_stored_file_variable(const lac_stored_file *file, size_t index, char *name, size_t size);

enum { LAC_STORED_RANK = 4, LAC_STORED_NAME = 64 };

/// A dimension of a variable.
typedef struct lac_stored_dim {
    char name[LAC_STORED_NAME];
    size_t length;
} lac_stored_dim;

/// What a variable of a file runs over.
typedef struct lac_stored_shape {
    size_t rank;
    lac_stored_dim dim[LAC_STORED_RANK]; ///< [rank]; of characters without their number
    size_t count;                        ///< values in all
    bool text, strings;                  ///< texts: rows of characters, or strings
    size_t width;                        ///< of such a row
} lac_stored_shape;

/// The shape of a variable of a file (not of a run in memory).
/// @return LAC_OK; LAC_EIO (no such variable, more dimensions or longer names than these, damaged)
lac_status lac_stored_file_shape(const lac_stored_file *file, const char *variable,
                                 lac_stored_shape *out, lac_error *err);

/// The values of a variable of texts. @param out  [shape->count] to be freed, as one piece
/// @return LAC_OK; LAC_EIO (damaged); LAC_ENOMEM
lac_status lac_stored_file_texts(const lac_stored_file *file, const char *variable,
                                 const lac_stored_shape *shape, char ***out, lac_error *err);

/// Name of an attribute of a variable, or with NULL of the file, in the order of the file.
/// @param index  from 0
/// @return false past the last one, where the name is longer than the room for it, and of a run in
///         memory
bool lac_stored_file_attribute(const lac_stored_file *file, const char *variable, size_t index,
                               char *name, size_t size);
