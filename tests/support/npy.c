// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/npy.h"

#include <stdio.h>
#include <string.h>

int npy_read(const char *path, size_t n, double *values)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        return -1;
    }
    unsigned char head[10];
    char text[4096] = "";
    int status = -1;
    if (fread(head, 1, sizeof head, file) != sizeof head || memcmp(head, "\x93NUMPY\1", 7) != 0) {
        goto out;
    }
    size_t length = head[8] + 256U * head[9];
    if (length >= sizeof text || fread(text, 1, length, file) != length) {
        goto out;
    }
    if (strstr(text, "'<f8'") == NULL || strstr(text, "'fortran_order': False") == NULL) {
        goto out;
    }
    status = fread(values, sizeof *values, n, file) == n && fgetc(file) == EOF ? 0 : -1;
out:
    (void)fclose(file);
    return status;
}
