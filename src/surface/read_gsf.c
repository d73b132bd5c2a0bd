// SPDX-License-Identifier: GPL-3.0-or-later
// Gwyddion Simple Field 1.0: lines `key = value`, NULs to a multiple of four bytes, then 32-bit
// little-endian floats, the row of the largest y first.
#include "surface/read.h"

static const char magic[] = "Gwyddion Simple Field";

typedef struct gsf {
    lac_scan scan;
    uint64_t nx, ny;
    double lx, ly; ///< NaN where absent
    double x, y;   ///< of the corner; NaN where absent
} gsf;

static bool is_gsf(const lac_bytes *bytes) { return lac_bytes_begin(bytes, magic); }

// One line of the header; keys that say nothing of the heights pass by.
static lac_status take_line(gsf *file, lac_word line, lac_height_map *map, lac_error *err)
{
    const lac_scan *scan = &file->scan;
    const char *equals = memchr(line.text, '=', line.length);
    if (line.length == 0) {
        return LAC_OK;
    }
    if (equals == NULL) {
        char shown[40];
        return lac_fail(err, LAC_EINPUT, "%s:%zu: \"%s\" is not key = value", scan->path,
                        scan->line, lac_word_show(line, shown, sizeof shown));
    }
    lac_scan part = {.at = line.text, .end = equals};
    lac_word key = lac_scan_rest(&part);
    part = (lac_scan){.at = equals + 1, .end = line.text + line.length};
    lac_word value = lac_scan_rest(&part);
    const lac_field fields[] = {
        {"XRes", .count = &file->nx},           {"YRes", .count = &file->ny},
        {"XReal", .length = &file->lx},         {"YReal", .length = &file->ly},
        {"XOffset", .number = &file->x},        {"YOffset", .number = &file->y},
        {"XYUnits", .unit = map->lateral_unit}, {"ZUnits", .unit = map->height_unit},
    };
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        if (lac_word_is(key, fields[i].key)) {
            return lac_scan_field(scan, &fields[i], value, err);
        }
    }
    return LAC_OK;
}

static lac_status read_header(gsf *file, lac_height_map *map, lac_error *err)
{
    lac_scan *scan = &file->scan;
    while (lac_scan_line(scan)) {
        LAC_TRY_RETURN(take_line(file, lac_scan_rest(scan), map, err));
    }
    LAC_FAIL_IF(file->nx == 0 || file->ny == 0, err, LAC_EINPUT,
                "%s:%zu: the header ends without %s", scan->path, scan->line,
                file->nx == 0 ? "XRes" : "YRes");
    return LAC_OK;
}

static lac_status read_gsf(const lac_bytes *bytes, lac_height_map *map, lac_error *err)
{
    static const lac_number_type type = {4, 'f', false};
    gsf file = {.scan = lac_scan_begin(bytes),
                .lx = (double)NAN,
                .ly = (double)NAN,
                .x = (double)NAN,
                .y = (double)NAN};
    const char *nul = memchr(bytes->data, '\0', bytes->size);
    LAC_FAIL_IF(nul == NULL, err, LAC_EINPUT,
                "%s: byte %zu: the file ends without the NUL that closes the header", bytes->path,
                bytes->size);
    file.scan.end = nul;
    LAC_TRY_RETURN(read_header(&file, map, err));
    size_t header = (size_t)(nul - (const char *)bytes->data);
    size_t start = header + 4 - header % 4;
    LAC_TRY_RETURN(lac_map_fill(map, bytes, (uint64_t[]){file.nx, file.ny}, start, type, false,
                                "heights", err));
    lac_map_flip(map);
    map->dx = file.lx / (double)map->nx;
    map->dy = file.ly / (double)map->ny;
    map->x = file.x + 0.5 * map->dx;
    map->y = file.y + 0.5 * map->dy;
    return LAC_OK;
}

const lac_map_format lac_map_gsf = {"Gwyddion Simple Field", is_gsf, read_gsf};
