/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_SCRATCH_H
#define LACUNA_TESTS_SCRATCH_H

#include <stddef.h>

/// A folder of the test's own under the temporary folder.
typedef struct scratch {
    char folder[64];
    char path[8][128]; ///< the last eight paths made
    unsigned next;
} scratch;

/// Makes the folder; stops the program where it cannot.
void scratch_create(scratch *s);

/// Removes the folder with the files in it.
void scratch_remove(scratch *s);

/// A path in the folder; valid for the next seven calls.
const char *scratch_path(scratch *s, const char *name);

/// Writes a file and gives its path.
const char *scratch_write(scratch *s, const char *name, const void *bytes, size_t size);

/// Reads a file whole; the caller frees. Stops the program where it cannot.
unsigned char *scratch_read(const char *path, size_t *size);

/// Files in the folder, hidden ones included.
size_t scratch_count(const scratch *s);

#endif
