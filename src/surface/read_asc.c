// SPDX-License-Identifier: GPL-3.0-or-later
// ESRI ASCII grid: keys with one value each, then the rows, the one of the largest y first.
#include "surface/read.h"

// Keys of the header.
enum { NCOLS, NROWS, CELLSIZE, DX, DY, NODATA, XLLCORNER, YLLCORNER, XLLCENTER, YLLCENTER, KEYS };

static const char *const keys[KEYS] = {"ncols",     "nrows",        "cellsize",  "dx",
                                       "dy",        "NODATA_value", "xllcorner", "yllcorner",
                                       "xllcenter", "yllcenter"};

typedef struct asc {
    lac_scan scan;
    uint64_t count[2];  ///< columns, rows
    double value[KEYS]; ///< NaN where absent
    size_t line[KEYS];  ///< 0 where absent
    size_t lines;       ///< of numbers
    size_t width;       ///< numbers in each of them
    bool uneven;        ///< they hold different counts
} asc;

// What stands for no data where the header does not say.
static const double usual_nodata = -9999.0;

static int key_of(lac_word word)
{
    for (int k = 0; k < KEYS; k++) {
        if (lac_word_is(word, keys[k])) {
            return k;
        }
    }
    return lac_word_is(word, "nodata") ? NODATA : -1;
}

static bool is_asc(const lac_bytes *bytes)
{
    lac_scan scan = lac_scan_begin(bytes);
    lac_word word;
    return (lac_scan_word(&scan, &word) || (lac_scan_line(&scan) && lac_scan_word(&scan, &word))) &&
           key_of(word) >= 0;
}

static lac_status take_value(asc *file, int key, lac_error *err)
{
    lac_word word, more;
    lac_scan *scan = &file->scan;
    LAC_FAIL_IF(file->line[key] != 0, err, LAC_EINPUT, "%s:%zu: %s stands in line %zu already",
                scan->path, scan->line, keys[key], file->line[key]);
    LAC_FAIL_IF(!lac_scan_word(scan, &word) || lac_scan_word(scan, &more), err, LAC_EINPUT,
                "%s:%zu: %s must have one value", scan->path, scan->line, keys[key]);
    file->line[key] = scan->line;
    bool count = key == NCOLS || key == NROWS;
    bool length = key == CELLSIZE || key == DX || key == DY;
    const lac_field field = {.key = keys[key],
                             .count = count ? &file->count[key] : NULL,
                             .length = length ? &file->value[key] : NULL,
                             .number = &file->value[key]};
    return lac_scan_field(scan, &field, word, err);
}

static bool begins_number(lac_word word)
{
    return strchr("0123456789+-.", word.text[0]) != NULL || lac_word_is(word, "nan") ||
           lac_word_is(word, "na");
}

// The header up to the first line of numbers.
static lac_status read_header(asc *file, lac_error *err)
{
    lac_scan *scan = &file->scan;
    char shown[40];
    for (;;) {
        lac_scan before = *scan;
        lac_word word;
        bool any = lac_scan_word(scan, &word);
        int key = any ? key_of(word) : -1;
        if (any && key < 0 && (begins_number(word) || file->line[NCOLS] * file->line[NROWS] > 0)) {
            *scan = before;
            return LAC_OK;
        }
        LAC_FAIL_IF(any && key < 0, err, LAC_EINPUT,
                    "%s:%zu: \"%s\" is no key of an ESRI ASCII grid: ncols, nrows, xllcorner, "
                    "yllcorner, xllcenter, yllcenter, cellsize, dx, dy, NODATA_value",
                    scan->path, scan->line, lac_word_show(word, shown, sizeof shown));
        LAC_TRY_RETURN(any ? take_value(file, key, err) : LAC_OK);
        if (!lac_scan_line(scan)) {
            return LAC_OK;
        }
    }
}

static lac_status check_header(const asc *file, lac_height_map *map, lac_error *err)
{
    const char *path = file->scan.path;
    bool pair = file->line[DX] > 0 && file->line[DY] > 0;
    for (int k = NCOLS; k <= NROWS; k++) {
        LAC_FAIL_IF(file->line[k] == 0, err, LAC_EINPUT, "%s:%zu: the header ends without %s", path,
                    file->scan.line, keys[k]);
    }
    LAC_FAIL_IF(file->line[CELLSIZE] == 0 && !pair, err, LAC_EINPUT,
                "%s:%zu: the header ends without cellsize, or dx and dy", path, file->scan.line);
    LAC_FAIL_IF(file->line[CELLSIZE] > 0 && (file->line[DX] > 0 || file->line[DY] > 0), err,
                LAC_EINPUT, "%s:%zu: must have either cellsize or dx and dy, not both", path,
                file->line[CELLSIZE]);
    map->dx = pair ? file->value[DX] : file->value[CELLSIZE];
    map->dy = pair ? file->value[DY] : file->value[CELLSIZE];
    map->x = isnan(file->value[XLLCENTER]) ? file->value[XLLCORNER] + 0.5 * map->dx
                                           : file->value[XLLCENTER];
    map->y = isnan(file->value[YLLCENTER]) ? file->value[YLLCORNER] + 0.5 * map->dy
                                           : file->value[YLLCENTER];
    return LAC_OK;
}

// The numbers of one line. Rows need not end where lines end: ncols alone says where they do.
static lac_status read_line(asc *file, lac_height_map *map, size_t *count, lac_error *err)
{
    lac_scan *scan = &file->scan;
    lac_word word;
    size_t before = *count;
    while (lac_scan_word(scan, &word)) {
        char shown[40];
        LAC_FAIL_IF(*count == map->nx * map->ny, err, LAC_EINPUT,
                    "%s:%zu: \"%s\" comes after all ncols x nrows = %zu x %zu numbers", scan->path,
                    scan->line, lac_word_show(word, shown, sizeof shown), map->nx, map->ny);
        double value = NAN;
        LAC_TRY_RETURN(lac_scan_number(scan, word, &value, err));
        map->heights[(*count)++] = value == file->value[NODATA] ? (double)NAN : value;
    }
    if (*count > before) {
        file->uneven = file->uneven || (file->lines > 0 && file->width != *count - before);
        file->width = *count - before;
        file->lines++;
    }
    return LAC_OK;
}

// Lines of one length that are no rows, nor parts of one, nor several: a wrong header.
static lac_status check_lines(const asc *file, const lac_height_map *map, lac_error *err)
{
    size_t width = file->width;
    bool exchanged = width == map->ny && file->lines == map->nx && map->nx != map->ny;
    bool rows = map->nx % width == 0 || width % map->nx == 0;
    if (file->uneven || file->lines < 2 || (rows && !exchanged)) {
        return LAC_OK;
    }
    return lac_fail(err, LAC_EINPUT,
                    "%s: its %zu lines hold %zu numbers each, which are no rows of ncols = %zu%s",
                    file->scan.path, file->lines, width, map->nx,
                    exchanged ? ": ncols and nrows are exchanged" : "");
}

static lac_status read_asc(const lac_bytes *bytes, lac_height_map *map, lac_error *err)
{
    size_t count = 0;
    asc file = {.scan = lac_scan_begin(bytes)};
    for (int k = 0; k < KEYS; k++) {
        file.value[k] = (double)NAN;
    }
    lac_scan_decimal(&file.scan, "");
    LAC_TRY_RETURN(read_header(&file, err));
    if (file.line[NODATA] == 0) {
        file.value[NODATA] = usual_nodata;
    }
    LAC_TRY_RETURN(check_header(&file, map, err));
    // a number takes two bytes at least, its blank included
    size_t most = (size_t)(file.scan.end - file.scan.at) / 2 + 1;
    LAC_TRY_RETURN(lac_map_size(map, bytes->path, file.count[NCOLS], file.count[NROWS], most, err));
    do {
        LAC_TRY_RETURN(read_line(&file, map, &count, err));
    } while (lac_scan_line(&file.scan));
    LAC_FAIL_IF(count < map->nx * map->ny, err, LAC_EINPUT,
                "%s:%zu: the file ends after %zu numbers; must have ncols x nrows = %zu x %zu",
                bytes->path, file.scan.line, count, map->nx, map->ny);
    LAC_TRY_RETURN(check_lines(&file, map, err));
    lac_map_flip(map);
    return LAC_OK;
}

const lac_map_format lac_map_asc = {"ESRI ASCII grid", is_asc, read_asc};
