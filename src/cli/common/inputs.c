// SPDX-License-Identifier: GPL-3.0-or-later
// The files that a case reads.
#include "cli/common/inputs.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/archive.h"

static bool is_same(const char *path, const struct stat *file)
{
    struct stat one;
    return path != NULL && stat(path, &one) == 0 && one.st_dev == file->st_dev &&
           one.st_ino == file->st_ino;
}

bool cli_inputs_has(const cli_request *request, const lac_case *c, const struct stat *file)
{
    const char *const named[] = {
        request->argument[0], request->argument[1],        request->compare,
        request->fit,         request->forecast.case_file, c != NULL ? c->path : NULL};
    char **path;
    bool found = false;
    for (size_t i = 0; i < sizeof named / sizeof *named; i++) {
        found |= is_same(named[i], file);
    }
    for (size_t i = 0; c != NULL && (path = lac_case_file(c, i)) != NULL; i++) {
        found |= is_same(*path, file);
    }
    return found;
}

// FNV-1a; 0 where the file cannot be read, which the run then says, or is a pipe, whose content
// would be gone.
static uint64_t sum_file(const char *path)
{
    struct stat info;
    if (stat(path, &info) != 0 || !S_ISREG(info.st_mode)) {
        return 0;
    }
    unsigned char block[1 << 14];
    uint64_t sum = LAC_SUM_OF_NOTHING;
    size_t got = 0;
    FILE *file = fopen(path, "rb");
    while (file != NULL && (got = fread(block, 1, sizeof block, file)) > 0) {
        sum = lac_sum_bytes(sum, block, got);
    }
    bool whole = file != NULL && ferror(file) == 0;
    if (file != NULL) {
        (void)fclose(file);
    }
    return whole ? sum : 0;
}

char *cli_inputs_sums(const lac_case *c)
{
    char *sums = NULL, **path;
    size_t size = 0;
    FILE *text = open_memstream(&sums, &size);
    if (text == NULL) {
        return NULL;
    }
    for (size_t i = 0; (path = lac_case_file(c, i)) != NULL; i++) {
        const char *slash = strrchr(*path, '/');
        (void)fprintf(text, "%s  %s: %016" PRIx64 "\n", i == 0 ? "files:\n" : "",
                      slash != NULL ? slash + 1 : *path, sum_file(*path));
    }
    bool good = ferror(text) == 0;
    if (fclose(text) != 0 || !good) {
        free(sums);
        return NULL;
    }
    return sums;
}
