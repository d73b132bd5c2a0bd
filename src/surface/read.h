/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stdint.h>

#include "surface/surface.h"

/// A file in memory: every reader works on bytes at hand, never on what a header promises.
typedef struct lac_bytes {
    const char *path; ///< for messages
    const unsigned char *data;
    size_t size;
} lac_bytes;

/// One format: recognised by its content.
typedef struct lac_map_format {
    const char *name;
    bool (*is)(const lac_bytes *bytes);
    /// Fills a map that is zero but for spacings and a place of NaN.
    lac_status (*read)(const lac_bytes *bytes, lac_height_map *map, lac_error *err);
} lac_map_format;

extern const lac_map_format lac_map_npy, lac_map_asc, lac_map_xyz, lac_map_gsf, lac_map_sdf,
    lac_map_netcdf;

/// Reads as lac_height_map_read from memory (the fuzzer's way in).
lac_status lac_height_map_parse(const lac_bytes *bytes, lac_height_map **map, lac_error *err);

/// Gives a map its size, and room for its heights.
/// @param most  heights that the bytes at hand can hold
lac_status lac_map_size(lac_height_map *map, const char *path, uint64_t nx, uint64_t ny,
                        size_t most, lac_error *err);

/// Turns the rows of a map around, where a file begins with the largest y.
void lac_map_flip(lac_height_map *map);

/// How a number is stored.
typedef struct lac_number_type {
    size_t width; ///< bytes
    char kind;    ///< 'f', 'i' (signed) or 'u'
    bool big_endian;
} lac_number_type;

/// A stored number; `data` needs no alignment.
double lac_bytes_number(const unsigned char *data, lac_number_type type);

/// Gives a map its size and its heights, which are the rest of the file from byte `start` on.
/// @param fortran  columns follow each other, not rows
/// @param what     the numbers are called in messages
lac_status lac_map_fill(lac_height_map *map, const lac_bytes *bytes, const uint64_t size[2],
                        size_t start, lac_number_type type, bool fortran, const char *what,
                        lac_error *err);

/// Whether the content begins with a word.
bool lac_bytes_begin(const lac_bytes *bytes, const char *word);
