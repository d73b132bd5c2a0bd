// SPDX-License-Identifier: GPL-3.0-or-later
// ISO 25178-71 .sdf, versions 1 and 2, and its forerunners BCR and NIST: a header, the heights as
// numbers of zscale, profile after profile in the order of rising y, a trailer.
#include "surface/read.h"

// Binary headers: 32-bit counts take four bytes more; Olympus writes eight more.
enum { BINARY_HEADER = 81, WIDE_COUNTS = 4, OLYMPUS = 8, TYPES = 8 };

// Data types by their number in the header.
static const lac_number_type types[TYPES] = {
    {1, 'u', false}, {2, 'u', false}, {4, 'u', false}, {4, 'f', false},
    {1, 'i', false}, {2, 'i', false}, {4, 'i', false}, {8, 'f', false},
};

typedef struct sdf {
    uint64_t nx, ny, type;
    double dx, dy, dz, compression, check;
} sdf;

static bool is_sdf(const lac_bytes *bytes)
{
    static const char *const versions[] = {"ISO-1.0", "ISO-2.0", "BCR-1.0", "BCR-0.0", "NIST-1."};
    const lac_bytes version = {bytes->path, bytes->data + 1, bytes->size > 0 ? bytes->size - 1 : 0};
    bool known = false;
    for (size_t i = 0; i < sizeof versions / sizeof versions[0]; i++) {
        known = known || lac_bytes_begin(&version, versions[i]);
    }
    return known && (bytes->data[0] == 'a' || bytes->data[0] == 'b');
}

static lac_status check_header(const lac_bytes *bytes, const sdf *file, lac_height_map *map,
                               lac_error *err)
{
    LAC_FAIL_IF(!(file->dx > 0.0 && file->dy > 0.0 && file->dz > 0.0) ||
                    !isfinite(file->dx + file->dy + file->dz),
                err, LAC_EINPUT,
                "%s: Xscale, Yscale and Zscale must be given and > 0 m, not %g, %g and %g",
                bytes->path, file->dx, file->dy, file->dz);
    LAC_FAIL_IF(file->compression != 0, err, LAC_EINPUT, "%s: Compression must be 0, not %g",
                bytes->path, file->compression);
    LAC_FAIL_IF(file->check != 0, err, LAC_EINPUT, "%s: CheckType must be 0, not %g", bytes->path,
                file->check);
    LAC_FAIL_IF(file->type >= TYPES, err, LAC_EINPUT, "%s: DataType must be 0 to 7, not %llu",
                bytes->path, (unsigned long long)file->type);
    map->dx = file->dx;
    map->dy = file->dy;
    memcpy(map->lateral_unit, "m", 2);
    memcpy(map->height_unit, "m", 2);
    return LAC_OK;
}

// The value that stands for no measurement: NaN, the largest or least float, the least of signed
// integers, the largest of unsigned ones of more than a byte.
static bool is_invalid(double value, lac_number_type type)
{
    if (type.kind == 'f') {
        return !(fabs(value) < (type.width == 4 ? 0x1.fffffep127 : 0x1.fffffffffffffp1023));
    }
    int bits = (int)(8 * type.width);
    return type.kind == 'i' ? value == -ldexp(1.0, bits - 1)
                            : type.width > 1 && value == ldexp(1.0, bits) - 1.0;
}

static lac_status read_binary(const lac_bytes *bytes, lac_height_map *map, lac_error *err)
{
    bool wide = lac_bytes_begin(bytes, "bISO-2");
    size_t header = wide ? BINARY_HEADER + WIDE_COUNTS : BINARY_HEADER;
    LAC_FAIL_IF(bytes->size < header, err, LAC_EINPUT,
                "%s: byte %zu: the file ends inside its header of %zu bytes", bytes->path,
                bytes->size, header);
    const lac_number_type count = types[wide ? 2 : 1];
    const lac_number_type real = types[7];
    const unsigned char *at = bytes->data + 42 + 2 * count.width; // behind the counts
    sdf file = {
        .nx = (uint64_t)lac_bytes_number(at - 2 * count.width, count),
        .ny = (uint64_t)lac_bytes_number(at - count.width, count),
        .dx = lac_bytes_number(at, real),
        .dy = lac_bytes_number(at + 8, real),
        .dz = lac_bytes_number(at + 16, real),
        .compression = at[32],
        .type = at[33],
        .check = at[34],
    };
    LAC_TRY_RETURN(check_header(bytes, &file, map, err));
    lac_number_type type = types[file.type];
    size_t most = (bytes->size - header) / type.width;
    LAC_TRY_RETURN(lac_map_size(map, bytes->path, file.nx, file.ny, most, err));
    size_t n = map->nx * map->ny;
    bool olympus =
        lac_bytes_begin(bytes, "bISO-1") && bytes->size == header + n * type.width + OLYMPUS;
    const unsigned char *data = bytes->data + header + (olympus ? OLYMPUS : 0);
    for (size_t i = 0; i < n; i++) {
        double value = lac_bytes_number(data + i * type.width, type);
        map->heights[i] = is_invalid(value, type) ? (double)NAN : value * file.dz;
    }
    return LAC_OK;
}

static lac_status take_value(const lac_scan *scan, lac_word key, lac_word value, sdf *file,
                             lac_error *err)
{
    const lac_field fields[] = {
        {"NumPoints", .count = &file->nx},     {"NumProfiles", .count = &file->ny},
        {"Xscale", .length = &file->dx},       {"Yscale", .length = &file->dy},
        {"Zscale", .length = &file->dz},       {"Compression", .number = &file->compression},
        {"CheckType", .number = &file->check},
    };
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        if (lac_word_is(key, fields[i].key)) {
            return lac_scan_field(scan, &fields[i], value, err);
        }
    }
    return LAC_OK;
}

// `key = value` or `key value`; false where there is no value.
static bool split(lac_word line, lac_word *key, lac_word *value)
{
    lac_scan rest = {.at = line.text, .end = line.text + line.length};
    const char *equals = memchr(line.text, '=', line.length);
    if (equals != NULL) {
        lac_scan part = {.at = line.text, .end = equals};
        *key = lac_scan_rest(&part);
        rest.at = equals + 1;
    } else if (!lac_scan_word(&rest, key)) {
        return false;
    }
    *value = lac_scan_rest(&rest);
    return equals != NULL || value->length > 0;
}

// Lines `key = value` up to one of a star alone; remarks begin with a semicolon.
static lac_status read_header(lac_scan *scan, sdf *file, lac_error *err)
{
    lac_status status = LAC_OK;
    while (lac_scan_line(scan)) {
        lac_word line = lac_scan_rest(scan);
        lac_word key = {0};
        lac_word value = {0};
        if (lac_word_is(line, "*")) {
            return LAC_OK;
        }
        if (line.length == 0 || line.text[0] == ';') {
            continue;
        }
        if (!split(line, &key, &value)) {
            char shown[40];
            return lac_fail(err, LAC_EINPUT, "%s:%zu: \"%s\" is neither key = value nor *",
                            scan->path, scan->line, lac_word_show(line, shown, sizeof shown));
        }
        LAC_TRY(take_value(scan, key, value, file, err));
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
    lac_scan scan = lac_scan_begin(bytes);
    lac_word word;
    sdf file = {.nx = 0};
    lac_scan body = scan; // the first line has a point
    (void)lac_scan_line(&body);
    lac_scan_decimal(&body, ";");
    scan.decimal = body.decimal;
    LAC_TRY_RETURN(read_header(&scan, &file, err));
    LAC_TRY_RETURN(check_header(bytes, &file, map, err));
    size_t most = (size_t)(scan.end - scan.at) / 2 + 1;
    LAC_TRY_RETURN(lac_map_size(map, bytes->path, file.nx, file.ny, most, err));
    for (size_t i = 0; i < map->nx * map->ny; i++) {
        LAC_FAIL_IF(
            !next_word(&scan, &word), err, LAC_EINPUT,
            "%s:%zu: the heights end after %zu; must be NumPoints x NumProfiles = %zu x %zu",
            bytes->path, scan.line, i, map->nx, map->ny);
        double value = (double)NAN;
        if (!lac_word_is(word, "BAD")) {
            LAC_TRY_RETURN(lac_scan_number(&scan, word, &value, err));
        }
        map->heights[i] = value * file.dz;
    }
    if (next_word(&scan, &word)) {
        char shown[40];
        LAC_TRY_RETURN(lac_fail(
            err, LAC_EINPUT,
            "%s:%zu: \"%s\" comes after all NumPoints x NumProfiles = %zu x %zu heights; must be *",
            bytes->path, scan.line, lac_word_show(word, shown, sizeof shown), map->nx, map->ny));
    }
    return LAC_OK;
}

static lac_status read_sdf(const lac_bytes *bytes, lac_height_map *map, lac_error *err)
{
    return bytes->data[0] == 'a' ? read_text(bytes, map, err) : read_binary(bytes, map, err);
}

const lac_map_format lac_map_sdf = {"ISO 25178-71", is_sdf, read_sdf};
