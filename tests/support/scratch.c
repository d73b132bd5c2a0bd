// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/scratch.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void require(int ok, const char *what)
{
    if (!ok) {
        perror(what);
        exit(1);
    }
}

void scratch_create(scratch *s)
{
    memset(s, 0, sizeof *s);
    (void)snprintf(s->folder, sizeof s->folder, "/tmp/lacuna_test_XXXXXX");
    require(mkdtemp(s->folder) != NULL, s->folder);
}

const char *scratch_path(scratch *s, const char *name)
{
    char *path = s->path[s->next++ % 8];
    size_t folder = strlen(s->folder);
    require(folder + strlen(name) + 2 < sizeof s->path[0], name);
    memcpy(path, s->folder, folder);
    path[folder] = '/';
    memcpy(path + folder + 1, name, strlen(name) + 1);
    return path;
}

size_t scratch_count(const scratch *s)
{
    size_t count = 0;
    DIR *folder = opendir(s->folder);
    require(folder != NULL, s->folder);
    for (struct dirent *e = readdir(folder); e != NULL; e = readdir(folder)) {
        count += strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0;
    }
    (void)closedir(folder);
    return count;
}

void scratch_remove(scratch *s)
{
    DIR *folder = opendir(s->folder);
    require(folder != NULL, s->folder);
    for (struct dirent *e = readdir(folder); e != NULL; e = readdir(folder)) {
        if (strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0) {
            (void)unlinkat(dirfd(folder), e->d_name, 0);
        }
    }
    (void)closedir(folder);
    (void)rmdir(s->folder);
}

const char *scratch_write(scratch *s, const char *name, const void *bytes, size_t size)
{
    const char *path = scratch_path(s, name);
    FILE *file = fopen(path, "wb");
    require(file != NULL, path);
    require(fwrite(bytes, 1, size, file) == size, path);
    require(fclose(file) == 0, path);
    return path;
}

unsigned char *scratch_read(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    require(file != NULL, path);
    require(fseek(file, 0, SEEK_END) == 0, path);
    long length = ftell(file);
    require(length >= 0 && fseek(file, 0, SEEK_SET) == 0, path);
    *size = (size_t)length;
    unsigned char *bytes = malloc(*size + 1);
    require(bytes != NULL, path);
    require(fread(bytes, 1, *size, file) == *size, path);
    (void)fclose(file);
    return bytes;
}
