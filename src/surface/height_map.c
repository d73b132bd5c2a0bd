// SPDX-License-Identifier: GPL-3.0-or-later
// A file of heights: read whole, recognised by its content, checked.
#include <locale.h>
#include <sys/stat.h>

#include "surface/read.h"

// 2 GiB of heights, and the longest text that holds them.
static const uint64_t most_heights = UINT64_C(1) << 28;
static const uint64_t most_bytes = UINT64_C(1) << 33;

static const lac_map_format *const formats[] = {
    &lac_map_npy, &lac_map_gsf, &lac_map_sdf, &lac_map_netcdf, &lac_map_asc, &lac_map_xyz,
};

bool lac_bytes_begin(const lac_bytes *bytes, const char *word)
{
    size_t n = strlen(word);
    return bytes->size >= n && memcmp(bytes->data, word, n) == 0;
}

// IEEE 754 binary16: a sign, five bits of exponent, ten of fraction.
static double half_number(unsigned bits)
{
    int exponent = (int)(bits >> 10 & 0x1fU);
    double fraction = (double)(bits & 0x3ffU);
    double size;
    if (exponent == 0x1f) {
        size = fraction == 0.0 ? (double)INFINITY : (double)NAN;
    } else {
        size = exponent == 0 ? ldexp(fraction, -24) : ldexp(1024.0 + fraction, exponent - 25);
    }
    return (bits & 0x8000U) != 0 ? -size : size;
}

double lac_bytes_number(const unsigned char *data, lac_number_type type)
{
    uint64_t bits = 0;
    for (size_t i = 0; i < type.width; i++) {
        size_t at = type.big_endian ? i : type.width - 1 - i;
        bits = bits << 8 | data[at];
    }
    if (type.kind == 'f' && type.width == 2) {
        return half_number((unsigned)bits);
    }
    if (type.kind == 'f' && type.width == 4) {
        uint32_t half = (uint32_t)bits;
        float value;
        memcpy(&value, &half, sizeof value);
        return (double)value;
    }
    if (type.kind == 'f') {
        double value;
        memcpy(&value, &bits, sizeof value);
        return value;
    }
    if (type.kind == 'u') {
        return (double)bits;
    }
    uint64_t sign = UINT64_C(1) << (8 * type.width - 1);
    // the two's complement of a number of this width
    return (bits & sign) != 0 ? -(double)((sign << 1) - bits) : (double)bits;
}

lac_status lac_map_size(lac_height_map *map, const char *path, uint64_t nx, uint64_t ny,
                        size_t most, lac_error *err)
{
    uint64_t n = 0;
    LAC_FAIL_IF(nx == 0 || ny == 0, err, LAC_EINPUT,
                "%s: %llu x %llu heights; must be at least one in x and y", path,
                (unsigned long long)nx, (unsigned long long)ny);
    LAC_FAIL_IF(__builtin_mul_overflow(nx, ny, &n) || n > most_heights, err, LAC_EINPUT,
                "%s: %llu x %llu heights; at most %llu are read", path, (unsigned long long)nx,
                (unsigned long long)ny, (unsigned long long)most_heights);
    LAC_FAIL_IF(n > most, err, LAC_EINPUT,
                "%s: it says %llu x %llu = %llu heights, but its bytes hold at most %zu: cut "
                "short, or a wrong count",
                path, (unsigned long long)nx, (unsigned long long)ny, (unsigned long long)n, most);
    map->heights = malloc((size_t)n * sizeof *map->heights);
    LAC_FAIL_MEMORY_IF(map->heights == NULL, err);
    map->nx = (size_t)nx;
    map->ny = (size_t)ny;
    return LAC_OK;
}

lac_status lac_map_fill(lac_height_map *map, const lac_bytes *bytes, const uint64_t size[2],
                        size_t start, lac_number_type type, bool fortran, const char *what,
                        lac_error *err)
{
    size_t left = bytes->size > start ? bytes->size - start : 0;
    LAC_TRY_RETURN(lac_map_size(map, bytes->path, size[0], size[1], left / type.width, err));
    size_t n = map->nx * map->ny;
    LAC_FAIL_IF(left != n * type.width, err, LAC_EINPUT,
                "%s: byte %zu: the file goes on behind its %zu x %zu %s", bytes->path,
                start + n * type.width, map->nx, map->ny, what);
    for (size_t i = 0; i < n; i++) {
        size_t at = fortran ? i % map->nx * map->ny + i / map->nx : i;
        map->heights[i] = lac_bytes_number(bytes->data + start + at * type.width, type);
    }
    return LAC_OK;
}

void lac_map_flip(lac_height_map *map)
{
    for (size_t low = 0, high = map->ny - 1; low < high; low++, high--) {
        double *a = map->heights + low * map->nx;
        double *b = map->heights + high * map->nx;
        for (size_t i = 0; i < map->nx; i++) {
            double swapped = a[i];
            a[i] = b[i];
            b[i] = swapped;
        }
    }
}

static lac_status count_masked(lac_height_map *map, const char *path, lac_error *err)
{
    size_t n = map->nx * map->ny;
    for (size_t i = 0; i < n; i++) {
        LAC_FAIL_IF(isinf(map->heights[i]), err, LAC_EINPUT,
                    "%s: the height in column %zu of row %zu (from the smallest y) is infinite; "
                    "must be finite, or NaN where there is none",
                    path, i % map->nx + 1, i / map->nx + 1);
        map->masked += isnan(map->heights[i]) ? 1 : 0;
    }
    LAC_FAIL_IF(map->masked == n, err, LAC_EINPUT, "%s: all %zu heights are missing", path, n);
    return LAC_OK;
}

static lac_status recognise(const lac_bytes *bytes, const lac_map_format **format, lac_error *err)
{
    LAC_FAIL_IF(bytes->size == 0, err, LAC_EINPUT, "%s: is empty", bytes->path);
    LAC_FAIL_IF(lac_bytes_begin(bytes, "\xff\xfe") || lac_bytes_begin(bytes, "\xfe\xff"), err,
                LAC_EINPUT, "%s: is text in UTF-16; must be UTF-8 or ASCII", bytes->path);
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        if (formats[i]->is(bytes)) {
            *format = formats[i];
            return LAC_OK;
        }
    }
    return lac_fail(err, LAC_EINPUT,
                    "%s: is none of the formats read: .npy, ESRI ASCII grid (.asc), .xyz, Gwyddion "
                    ".gsf, ISO 25178-71 .sdf, netCDF",
                    bytes->path);
}

lac_status lac_height_map_parse(const lac_bytes *bytes, lac_height_map **out, lac_error *err)
{
    lac_status status;
    const lac_map_format *format = NULL;
    locale_t callers = (locale_t)0;
    lac_height_map *map = *out = calloc(1, sizeof *map);
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (map == NULL || plain == (locale_t)0) {
        LAC_TRY(lac_fail_memory(err));
    }
    callers = uselocale(plain);
    map->dx = map->dy = map->x = map->y = (double)NAN;
    LAC_TRY(recognise(bytes, &format, err));
    map->format = format->name;
    LAC_TRY(format->read(bytes, map, err));
    LAC_TRY(count_masked(map, bytes->path, err));
out:
    if (callers != (locale_t)0) {
        (void)uselocale(callers);
    }
    if (plain != (locale_t)0) {
        freelocale(plain);
    }
    LAC_MADE(status, out, lac_height_map_free);
}

// What is there, whatever size the file system claims.
static lac_status read_stream(FILE *stream, const char *path, unsigned char **data, size_t *size,
                              lac_error *err)
{
    size_t capacity = 0;
    do {
        if (*size == capacity) {
            capacity = capacity > 0 ? 2 * capacity : 1 << 16;
            unsigned char *more = capacity <= 2 * most_bytes ? realloc(*data, capacity) : NULL;
            LAC_FAIL_MEMORY_IF(more == NULL, err);
            *data = more;
        }
        *size += fread(*data + *size, 1, capacity - *size, stream);
    } while (*size == capacity && *size <= most_bytes);
    LAC_FAIL_IF(ferror(stream), err, LAC_EIO, "%s: %s", path, strerror(errno));
    LAC_FAIL_IF(*size > most_bytes, err, LAC_EINPUT,
                "%s: is longer than the %llu bytes that are read", path,
                (unsigned long long)most_bytes);
    return LAC_OK;
}

lac_status lac_height_map_read(const char *path, lac_height_map **map, lac_error *err)
{
    lac_status status;
    struct stat info;
    FILE *stream = NULL;
    unsigned char *data = NULL;
    size_t size = 0;
    *map = NULL;
    LAC_LEAVE_IF(stat(path, &info) != 0, err, LAC_EIO, "%s: %s", path, strerror(errno));
    // a pipe could keep us waiting for ever
    LAC_LEAVE_IF(!S_ISREG(info.st_mode), err, LAC_EIO, "%s: is no file", path);
    stream = fopen(path, "rb");
    LAC_LEAVE_IF(stream == NULL, err, LAC_EIO, "%s: %s", path, strerror(errno));
    LAC_TRY(read_stream(stream, path, &data, &size, err));
    LAC_TRY(lac_height_map_parse(&(lac_bytes){path, data, size}, map, err));
out:
    free(data);
    if (stream != NULL) {
        (void)fclose(stream);
    }
    return status;
}

void lac_height_map_free(lac_height_map *map)
{
    if (map != NULL) {
        free(map->heights);
        free(map);
    }
}
