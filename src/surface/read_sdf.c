// SPDX-License-Identifier: GPL-3.0-or-later
// ISO 25178-71 .sdf (and its forerunner BCR): a header, the heights as numbers of zscale, a
// trailer.
#include <math.h>
#include <string.h>

#include "surface/scan.h"

enum { BINARY_HEADER = 81, TYPES = 8 };

// Data types by their number in the header.
static const lac_number_type types[TYPES] = {
    {1, 'u', false}, {2, 'u', false}, {4, 'u', false}, {4, 'f', false},
    {1, 'i', false}, {2, 'i', false}, {4, 'i', false}, {8, 'f', false},
};

typedef struct sdf {
    uint64_t nx, ny, compression, type;
    double dx, dy, dz;
} sdf;

static bool is_sdf(const lac_bytes *bytes)
{
    return lac_bytes_begin(bytes, "aISO-1.0") || lac_bytes_begin(bytes, "bISO-1.0") ||
           lac_bytes_begin(bytes, "aBCR-1.0") || lac_bytes_begin(bytes, "bBCR-1.0");
}

static lac_status check_header(const lac_bytes *bytes, const sdf *file, lac_height_map *map,
                               lac_error *err)
{
    if (!(file->dx > 0.0 && file->dy > 0.0 && file->dz > 0.0) ||
        !isfinite(file->dx + file->dy + file->dz)) {
        return lac_fail(err, LAC_EINPUT,
                        "%s: Xscale, Yscale and Zscale must be given and > 0 m, not %g, %g and %g",
                        bytes->path, file->dx, file->dy, file->dz);
    }
    if (file->compression != 0) {
        return lac_fail(err, LAC_EINPUT, "%s: Compression must be 0, not %llu", bytes->path,
                        (unsigned long long)file->compression);
    }
    if (file->type >= TYPES) {
        return lac_fail(err, LAC_EINPUT, "%s: DataType must be 0 to 7, not %llu", bytes->path,
                        (unsigned long long)file->type);
    }
    map->dx = file->dx;
    map->dy = file->dy;
    memcpy(map->lateral_unit, "m", 2);
    memcpy(map->height_unit, "m", 2);
    return LAC_OK;
}

// The value that stands for no measurement: NaN, the largest float, the least of signed integers.
static bool is_invalid(double value, lac_number_type type)
{
    if (type.kind == 'f') {
        return !(fabs(value) < (type.width == 4 ? 0x1.fffffep127 : 0x1.fffffffffffffp1023));
    }
    return type.kind == 'i' && value == -ldexp(1.0, (int)(8 * type.width) - 1);
}

static lac_status read_binary(const lac_bytes *bytes, lac_height_map *map, lac_error *err)
{
    lac_status status;
    if (bytes->size < BINARY_HEADER) {
        return lac_fail(err, LAC_EINPUT,
                        "%s: byte %zu: the file ends inside its header of %d bytes", bytes->path,
                        bytes->size, BINARY_HEADER);
    }
    const unsigned char *at = bytes->data;
    const lac_number_type count = types[1];
    const lac_number_type real = types[7];
    sdf file = {
        .nx = (uint64_t)lac_bytes_number(at + 42, count),
        .ny = (uint64_t)lac_bytes_number(at + 44, count),
        .dx = lac_bytes_number(at + 46, real),
        .dy = lac_bytes_number(at + 54, real),
        .dz = lac_bytes_number(at + 62, real),
        .compression = at[78],
        .type = at[79],
    };
    LAC_TRY(check_header(bytes, &file, map, err));
    lac_number_type type = types[file.type];
    size_t most = (bytes->size - BINARY_HEADER) / type.width;
    LAC_TRY(lac_map_size(map, bytes->path, file.nx, file.ny, most, err));
    for (size_t i = 0; i < map->nx * map->ny; i++) {
        double value = lac_bytes_number(at + BINARY_HEADER + i * type.width, type);
        map->heights[i] = is_invalid(value, type) ? (double)NAN : value * file.dz;
    }
out:
    return status;
}

static lac_status take_value(const lac_scan *scan, lac_word key, lac_word value, sdf *file,
                             lac_error *err)
{
    double number = 0.0;
    lac_status status = LAC_OK;
    if (lac_word_is(key, "NumPoints")) {
        return lac_scan_count(scan, "NumPoints", value, &file->nx, err);
    }
    if (lac_word_is(key, "NumProfiles")) {
        return lac_scan_count(scan, "NumProfiles", value, &file->ny, err);
    }
    if (lac_word_is(key, "Xscale")) {
        return lac_scan_length(scan, "Xscale", value, &file->dx, err);
    }
    if (lac_word_is(key, "Yscale")) {
        return lac_scan_length(scan, "Yscale", value, &file->dy, err);
    }
    if (lac_word_is(key, "Zscale")) {
        return lac_scan_length(scan, "Zscale", value, &file->dz, err);
    }
    if (lac_word_is(key, "Compression")) {
        status = lac_scan_number(scan, value, &number, err);
        file->compression = number == 0.0 ? 0 : 1;
    }
    return status;
}

// Lines `key = value` up to one of a star alone.
static lac_status read_header(lac_scan *scan, sdf *file, lac_error *err)
{
    lac_status status = LAC_OK;
    while (lac_scan_line(scan)) {
        lac_word line = lac_scan_rest(scan);
        const char *equals = line.length > 0 ? memchr(line.text, '=', line.length) : NULL;
        if (lac_word_is(line, "*")) {
            return LAC_OK;
        }
        if (line.length == 0) {
            continue;
        }
        if (equals == NULL) {
            char shown[40];
            return lac_fail(err, LAC_EINPUT, "%s:%zu: \"%s\" is neither key = value nor *",
                            scan->path, scan->line, lac_word_show(line, shown, sizeof shown));
        }
        lac_scan part = {.at = line.text, .end = equals};
        lac_word key = lac_scan_rest(&part);
        part = (lac_scan){.at = equals + 1, .end = line.text + line.length};
        LAC_TRY(take_value(scan, key, lac_scan_rest(&part), file, err));
    }
    status = lac_fail(err, LAC_EINPUT, "%s:%zu: the file ends without the * that closes the header",
                      scan->path, scan->line);
out:
    return status;
}

// The next number of the text, over the ends of lines; false at a star or the end.
static bool next_word(lac_scan *scan, lac_word *word)
{
    while (!lac_scan_word(scan, word)) {
        if (!lac_scan_line(scan)) {
            return false;
        }
    }
    return !lac_word_is(*word, "*");
}

static lac_status read_text(const lac_bytes *bytes, lac_height_map *map, lac_error *err)
{
    lac_status status;
    lac_scan scan = lac_scan_begin(bytes);
    lac_word word;
    sdf file = {.nx = 0};
    LAC_TRY(read_header(&scan, &file, err));
    LAC_TRY(check_header(bytes, &file, map, err));
    size_t most = (size_t)(scan.end - scan.at) / 2 + 1;
    LAC_TRY(lac_map_size(map, bytes->path, file.nx, file.ny, most, err));
    for (size_t i = 0; i < map->nx * map->ny; i++) {
        if (!next_word(&scan, &word)) {
            LAC_TRY(lac_fail(err, LAC_EINPUT,
                             "%s:%zu: the heights end after %zu; must be NumPoints x NumProfiles = "
                             "%zu x %zu",
                             bytes->path, scan.line, i, map->nx, map->ny));
        }
        double value = (double)NAN;
        if (!lac_word_is(word, "BAD")) {
            LAC_TRY(lac_scan_number(&scan, word, &value, err));
        }
        map->heights[i] = value * file.dz;
    }
    if (next_word(&scan, &word)) {
        char shown[40];
        LAC_TRY(lac_fail(err, LAC_EINPUT,
                         "%s:%zu: \"%s\" comes after all NumPoints x NumProfiles = %zu x %zu "
                         "heights; must be *",
                         bytes->path, scan.line, lac_word_show(word, shown, sizeof shown), map->nx,
                         map->ny));
    }
out:
    return status;
}

static lac_status read_sdf(const lac_bytes *bytes, lac_height_map *map, lac_error *err)
{
    return bytes->data[0] == 'a' ? read_text(bytes, map, err) : read_binary(bytes, map, err);
}

const lac_map_format lac_map_sdf = {"ISO 25178-71", is_sdf, read_sdf};
