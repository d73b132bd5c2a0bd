// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/height_files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const double known_heights[6] = {1, 2, 3, 4, 5, 6};

size_t heights_npy(unsigned char *file, const char *header, const void *data, size_t size)
{
    memcpy(file, "\x93NUMPY\x01\x00\x76\x00", 10);
    memset(file + 10, ' ', 118);
    memcpy(file + 10, header, strlen(header));
    file[127] = '\n';
    memcpy(file + 128, data, size);
    return 128 + size;
}

size_t heights_gsf(unsigned char *file, const char *header, size_t heights)
{
    static const float rows[6] = {4, 5, 6, 1, 2, 3};
    size_t n = strlen(header);
    size_t start = n + 4 - n % 4;
    memset(file, 0, start);
    memcpy(file, header, n);
    memcpy(file + start, rows, heights * sizeof(float));
    return start + heights * sizeof(float);
}

size_t heights_sdf(unsigned char *file, const char *version, unsigned type, const void *data,
                   size_t size)
{
    const double scales[4] = {1e-3, 2e-3, 0.5, -1.0};
    size_t count = strcmp(version, "bISO-2.0") == 0 ? 4 : 2;
    unsigned char *at = file + 42;
    memset(file, ' ', 42);
    memcpy(file, version, 8);
    memset(at, 0, 2 * count);
    at[0] = 3;
    at[count] = 2;
    at += 2 * count;
    memcpy(at, scales, 32);
    at[32] = 0;
    at[33] = (unsigned char)type;
    at[34] = 0;
    memcpy(at + 35, data, size);
    return (size_t)(at - file) + 35 + size;
}

const lac_surface_source *surface_source(const char *name)
{
    for (size_t i = 0; lac_surface_source_get(i) != NULL; i++) {
        if (strcmp(lac_surface_source_get(i)->info.name, name) == 0) {
            return lac_surface_source_get(i);
        }
    }
    (void)fprintf(stderr, "no surface source is named %s\n", name);
    exit(1);
}
