// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a monitoring file: read into a sound series, or refused with a message.
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "base/units.h"
#include "series/text.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool sound)
{
    if (!sound) {
        abort();
    }
}

static void check_series(const lac_series *s)
{
    require(s->n > 0);
    for (size_t i = 0; i < s->n; i++) {
        require(isfinite(s->time[i]) && (i == 0 || s->time[i] > s->time[i - 1]));
        require(!isinf(s->displacement[i]) && !isinf(s->velocity[i]) && s->line[i] > 1);
    }
}

static void read_bytes(const uint8_t *data, size_t size, const lac_units *units)
{
    const lac_series_def def = {.path = "fuzz.csv",
                                .time = "t",
                                .displacement = "d",
                                .displacement_unit = "mm",
                                .velocity = "v",
                                .velocity_unit = "cm/day"};
    lac_series *series = NULL;
    lac_error err = {{0}};
    // an empty buffer is no stream
    FILE *stream =
        size > 0 ? fmemopen((void *)(uintptr_t)data, size, "rb") : fopen("/dev/null", "rb");
    if (stream == NULL) {
        return;
    }
    lac_status status = lac_series_read_stream(stream, &def, units, &series, &err);
    if (status == LAC_OK) {
        check_series(series);
    } else {
        require(status == LAC_EINPUT && series == NULL && err.message[0] != '\0');
    }
    lac_series_free(series);
    (void)fclose(stream);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static lac_units *units; // reading the database takes longer than all the rest
    if (units == NULL) {
        require(lac_units_create(&units, NULL) == LAC_OK);
    }
    read_bytes(data, size, units);
    return 0;
}
