// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as what `lacuna watch` is told and sent: what is before a byte 1 is the fleet's file,
// the rest the stream. Sent in pieces it comes to the same lines and counts as sent at once, or it
// is refused with a message.
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "watch/watch.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { PIECE = 7 };

static void require(bool sound)
{
    if (!sound) {
        abort();
    }
}

// What came of one sending.
typedef struct outcome {
    lac_status status;
    lac_watch_counts counts;
    char *said;
    size_t length;
} outcome;

static outcome send_all(const lac_fleet *fleet, const lac_units *units, const char *bytes,
                        size_t size, size_t piece)
{
    outcome o = {.status = LAC_OK};
    lac_error err = {""};
    lac_watch *watch = NULL;
    lac_watch_def def = {.fleet = fleet, .units = units, .forecast = lac_forecast_default()};
    def.forecast.window_count = (size_t)fleet->window_count;
    def.out = open_memstream(&o.said, &o.length);
    require(def.out != NULL);
    o.status = lac_watch_create(&def, &watch, &err);
    for (size_t i = 0; o.status == LAC_OK && i < size; i += piece) {
        o.status = lac_watch_stream(watch, bytes + i, piece < size - i ? piece : size - i, &err);
    }
    if (o.status == LAC_OK) {
        o.counts = lac_watch_count(watch);
    } else {
        require(o.status == LAC_EINPUT && err.message[0] != '\0');
    }
    lac_watch_free(watch);
    require(fclose(def.out) == 0);
    return o;
}

static void check_stream(const lac_fleet *fleet, const lac_units *units, const char *bytes,
                         size_t size)
{
    outcome whole = send_all(fleet, units, bytes, size, size + 1);
    outcome pieces = send_all(fleet, units, bytes, size, PIECE);
    require(whole.status == pieces.status && whole.length == pieces.length &&
            memcmp(whole.said, pieces.said, whole.length) == 0 &&
            whole.counts.lines == pieces.counts.lines && whole.counts.bad == pieces.counts.bad);
    require(whole.counts.stations <= (size_t)fleet->most);
    free(whole.said);
    free(pieces.said);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static lac_units *units; // reading the database takes longer than all the rest
    if (units == NULL) {
        require(lac_units_create(&units, NULL) == LAC_OK);
    }
    const uint8_t *end = size > 0 ? memchr(data, 1, size) : NULL;
    if (end == NULL) {
        return 0;
    }
    char path[] = "/tmp/fuzz_stream_XXXXXX";
    const int fd = mkstemp(path);
    const ssize_t told = end - data;
    require(fd >= 0 && write(fd, data, (size_t)told) == told && close(fd) == 0);
    lac_error err = {""};
    lac_fleet *fleet = NULL;
    const lac_status status = lac_fleet_read(path, units, &fleet, &err);
    (void)remove(path);
    if (status == LAC_OK) {
        check_stream(fleet, units, (const char *)end + 1, size - (size_t)told - 1);
    } else {
        require(status == LAC_EINPUT && fleet == NULL && err.message[0] != '\0');
    }
    lac_fleet_free(fleet);
    return 0;
}
