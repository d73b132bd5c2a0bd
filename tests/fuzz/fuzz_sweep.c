// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as what a sweep is asked for: a line KEY=VALUES for each --over, then, behind a byte 1,
// the CSV of --table. Each member of what is planned is a case that reads, or is refused with a
// message; the same bytes plan the same members.
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "sweep/sweep.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { OVERS = 8, LOOKED_AT = 20 };

static const char base[] = "lacuna: 1\n"
                           "interface: {size: 10 m, cells: 4, contact: full}\n"
                           "material: {shear_modulus: 10 GPa, poisson: 0.25, density: 2700 kg/m3}\n"
                           "load: {normal: {pressure: 1 MPa}, shear: [{ratio: 0.6}]}\n"
                           "friction: {aging: {f0: 0.6, a: 0.01, b: 0.015, dc: 1 mm, v0: 1 um/s}}\n"
                           "initial: {slip_rate: 1 cm/week}\n"
                           "time: {end: 10 day}\n";

static void require(bool sound)
{
    if (!sound) {
        abort();
    }
}

// A file of these bytes. @param path  ends in XXXXXX
static void write_file(char *path, const void *bytes, size_t size)
{
    const int fd = mkstemp(path);
    require(fd >= 0 && write(fd, bytes, size) == (ssize_t)size && close(fd) == 0);
}

static void check_members(lac_sweep *sweep)
{
    lac_error err = {""};
    require(sweep->members > 0 && sweep->params <= LAC_SWEEP_AXES);
    for (size_t m = 0; m < sweep->members && m < LOOKED_AT; m++) {
        const lac_case *c = NULL;
        for (size_t p = 0; p < sweep->params; p++) {
            char text[LAC_SWEEP_KEY];
            require(!isinf(lac_sweep_value(sweep, p, m)));
            require(lac_sweep_text(sweep, p, m, text, sizeof text) != NULL);
        }
        const lac_status status = lac_sweep_case(sweep, m, &c, &err);
        require(status == LAC_OK ? c != NULL : status == LAC_EINPUT && err.message[0] != '\0');
    }
}

static uint64_t plan(const lac_sweep_request *request)
{
    lac_error err = {""};
    lac_sweep *sweep = NULL;
    const lac_status status = lac_sweep_create(request, &sweep, &err);
    uint64_t mark = 0;
    if (status == LAC_OK) {
        check_members(sweep);
        mark = sweep->mark;
    } else {
        require(status == LAC_EINPUT && sweep == NULL && err.message[0] != '\0');
    }
    lac_sweep_free(sweep);
    return mark;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char path[] = "/tmp/fuzz_sweep_XXXXXX";
    if (strstr(path, "XXXXXX") != NULL) {
        write_file(path, base, sizeof base - 1);
    }
    char *text = malloc(size + 1), *next = text;
    require(text != NULL);
    memcpy(text, data, size);
    text[size] = '\0';
    char *rows = memchr(text, 1, size), table[] = "/tmp/fuzz_table_XXXXXX";
    if (rows != NULL) {
        *rows = '\0';
        write_file(table, rows + 1, size - (size_t)(rows + 1 - text));
    }
    const char *over[OVERS];
    lac_sweep_request request = {
        .path = path, .over = over, .until = NAN, .seed = 1, .table = rows != NULL ? table : NULL};
    while (request.varied < OVERS && (over[request.varied] = strsep(&next, "\n")) != NULL) {
        request.varied += over[request.varied][0] != '\0' ? 1 : 0;
    }
    request.members = size % 3 == 0 ? 5 : 0; // what is drawn needs a number
    require(plan(&request) == plan(&request));
    if (rows != NULL) {
        (void)remove(table);
    }
    free(text);
    return 0;
}
