// SPDX-License-Identifier: GPL-3.0-or-later
// NumPy's .npy, versions 1 to 3: magic, length of the header, a Python dictionary, the array.
#include "surface/read.h"

enum { HEADER_MOST = 4096 };

typedef struct npy {
    char header[HEADER_MOST];
    size_t data; ///< byte where the array begins
    lac_number_type type;
    bool fortran;
    uint64_t size[2]; ///< along x and y
} npy;

static bool is_npy(const lac_bytes *bytes) { return lac_bytes_begin(bytes, "\x93NUMPY"); }

static lac_status take_header(const lac_bytes *bytes, npy *file, lac_error *err)
{
    unsigned version = bytes->size > 6 ? bytes->data[6] : 0;
    size_t start = version == 1 ? 10 : 12;
    LAC_FAIL_IF(bytes->size < 12, err, LAC_EINPUT,
                "%s: byte %zu: the file ends inside the .npy header", bytes->path, bytes->size);
    LAC_FAIL_IF(version < 1 || version > 3, err, LAC_EINPUT,
                "%s: byte 6: .npy version %u; must be 1, 2 or 3", bytes->path, version);
    lac_number_type length_type = {version == 1 ? 2 : 4, 'u', false};
    double length = lac_bytes_number(bytes->data + 8, length_type);
    LAC_FAIL_IF(
        length >= HEADER_MOST || (size_t)length > bytes->size - start, err, LAC_EINPUT,
        "%s: byte 8: a header of %.0f bytes; must end within the file and be shorter than %d",
        bytes->path, length, HEADER_MOST);
    memcpy(file->header, bytes->data + start, (size_t)length);
    file->header[(size_t)length] = '\0';
    file->data = start + (size_t)length;
    return LAC_OK;
}

// Where the value of a key begins; NULL where there is none.
static const char *value_of(const npy *file, const char *key)
{
    const char *at = strstr(file->header, key);
    at = at != NULL ? strchr(at + strlen(key), ':') : NULL;
    return at != NULL ? at + 1 + strspn(at + 1, " ") : NULL;
}

static lac_status take_type(const lac_bytes *bytes, npy *file, lac_error *err)
{
    const char *descr = value_of(file, "'descr'");
    char order = 0, kind = 0, width = 0;
    if (descr != NULL && strlen(descr) > 5 && descr[0] == '\'' && descr[4] == '\'') {
        order = descr[1];
        kind = descr[2];
        width = descr[3];
    }
    bool sound = strchr("<>|=", order) != NULL && order != 0 && kind != 0 && width != 0 &&
                 strchr(kind == 'f' ? "248" : "1248", width) != NULL && strchr("fiu", kind) != NULL;
    if (!sound) {
        int shown = descr != NULL ? (int)strcspn(descr, "}\n") : 0;
        return lac_fail(
            err, LAC_EINPUT,
            "%s: byte 10: the type %.*s; must be 'descr' of f2 to f8, i1 to i8 or u1 to u8",
            bytes->path, shown < 40 ? shown : 40, descr != NULL ? descr : "");
    }
    file->type = (lac_number_type){(size_t)(width - '0'), kind, order == '>'};
    return LAC_OK;
}

// One or two numbers between parentheses.
static lac_status take_shape(const lac_bytes *bytes, npy *file, lac_error *err)
{
    const char *at = value_of(file, "'shape'");
    uint64_t side[2] = {0, 0};
    size_t sides = 0;
    bool sound = at != NULL && *at == '(';
    for (at = sound ? at + 1 : ""; sound && *at != ')'; at += strspn(at, ", L")) {
        char *end = NULL;
        sound = *at >= '0' && *at <= '9' && sides < 2;
        if (sound) {
            side[sides++] = strtoull(at, &end, 10);
            at = end;
        }
    }
    LAC_FAIL_IF(!sound || sides == 0, err, LAC_EINPUT,
                "%s: byte 10: the shape of the array is not (rows, columns) or (columns,)",
                bytes->path);
    file->size[0] = side[sides - 1];
    file->size[1] = sides == 2 ? side[0] : 1;
    const char *order = value_of(file, "'fortran_order'");
    file->fortran = order != NULL && strncmp(order, "True", 4) == 0;
    LAC_FAIL_IF(order == NULL || (!file->fortran && strncmp(order, "False", 5) != 0), err,
                LAC_EINPUT, "%s: byte 10: fortran_order must be given as True or False",
                bytes->path);
    return LAC_OK;
}

static lac_status read_npy(const lac_bytes *bytes, lac_height_map *map, lac_error *err)
{
    npy file = {.data = 0};
    LAC_TRY_RETURN(take_header(bytes, &file, err));
    LAC_TRY_RETURN(take_type(bytes, &file, err));
    LAC_TRY_RETURN(take_shape(bytes, &file, err));
    return lac_map_fill(map, bytes, file.size, file.data, file.type, file.fortran, "numbers", err);
}

const lac_map_format lac_map_npy = {"npy", is_npy, read_npy};
