/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

/// The name under which this process builds a file: `.NAME.lacuna-PID.part` in the same folder.
/// @param path  where the file will be
/// @return to be freed; NULL where memory is short
char *lac_temp_file_name(const char *path);

/// Length of the folder in a path, its slash included; 0: the current one.
size_t lac_folder_length(const char *path);

/// The last part of a path: the name of a file, or of a variable in its group.
const char *lac_path_last(const char *path);

/// The folder of a path, its slash included; "./". @return to be freed; NULL: memory is short
char *lac_folder_of(const char *path);

/// Texts one behind the other, what is between them left out where the first is empty.
/// @return to be freed; NULL where memory is short
char *lac_text_join(const char *first, const char *between, const char *second);

/// Writes all of it. @return false with errno
bool lac_temp_file_write(int fd, const void *bytes, size_t size);

/// Makes a file of bytes and more, which are on the disk then, where none is. @return false with
/// errno
bool lac_temp_file_fill(const char *part, const void *bytes, size_t size, const void *more,
                        size_t more_size);

/// Makes names that were given or taken in the folder of `path` last.
void lac_temp_file_sync_folder(const char *path);

/// Holds a file whose name is to be taken, so that one process at a time does so; no lock that
/// readers or writers would see. Another that holds it is waited for, at most a second; false where
/// it goes on. @param held  to be closed
bool lac_temp_file_hold(const char *path, int *held);

/// Closes what is open (-1: nothing); errno stays.
void lac_temp_file_close(int fd);

/// Removes what processes that are no more have left of files for that path: their number is not
/// in use and nobody holds HDF5's lock on the file, as one on another machine would.
void lac_temp_file_sweep(const char *path);

/// Gives a file that is whole its name, as one step.
/// @param force  takes the name from a file that bears it; else that is EEXIST
/// @return 0; -1 with errno
int lac_temp_file_publish(const char *part, const char *path, bool force);

/// Whether somebody writes a file: HDF5 then holds a lock on it.
/// @param folder  that the path is relative to, or AT_FDCWD
bool lac_temp_file_locked(int folder, const char *path);

/// Ends a text that open_memstream makes. @return it; NULL: memory was short, and it is freed
char *lac_text_made(FILE *out, char **text);

/// Writes a file that is never half there: under another name first, as a netCDF file.
/// Where `path` is a symbolic link, what it leads to is replaced; a device or a pipe never is.
/// @param force  replaces a file that is there
lac_status lac_write_bytes(const char *path, const void *bytes, size_t size, bool force,
                           lac_error *err);
lac_status lac_write_text(const char *path, const char *text, bool force, lac_error *err);
