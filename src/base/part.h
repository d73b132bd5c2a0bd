/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_BASE_PART_H
#define LACUNA_BASE_PART_H

#include <stdbool.h>

/// The name under which this process builds a file: `.NAME.lacuna-PID.part` in the same folder.
/// @param path  where the file will be
/// @return to be freed; NULL where memory is short
char *lac_part_name(const char *path);

/// Removes what processes that are no more have left of files for that path: their number is not
/// in use and nobody holds HDF5's lock on the file, as one on another machine would.
void lac_part_sweep(const char *path);

/// Gives a file that is whole its name, as one step.
/// @param force  takes the name from a file that bears it; else that is EEXIST
/// @return 0; -1 with errno
int lac_part_publish(const char *part, const char *path, bool force);

/// Whether somebody writes a file: HDF5 then holds a lock on it.
/// @param folder  that the path is relative to, or AT_FDCWD
bool lac_part_locked(int folder, const char *path);

#endif
