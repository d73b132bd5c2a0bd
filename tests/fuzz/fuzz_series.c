// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a monitoring file: read into a sound series, or refused with a message.
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "base/units.h"
#include "series/motion.h"
#include "series/text.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool sound)
{
    if (!sound) {
        abort();
    }
}

// Whatever was read is a motion.
static void check_motion(const lac_series *s)
{
    static const lac_motion_def defs[] = {
        {0},
        {.smoothing = LAC_SMOOTH_AVERAGE, .points = 3},
        {.smoothing = LAC_SMOOTH_WINDOW, .window = 86400.0},
        {.smoothing = LAC_SMOOTH_SAVGOL, .points = 5, .order = 2},
    };
    const lac_readings readings = {.n = s->n,
                                   .time = s->time,
                                   .displacement = s->displacement,
                                   .velocity = s->velocity,
                                   .sigma = s->sigma};
    for (size_t k = 0; k < sizeof defs / sizeof *defs; k++) {
        lac_motion *m = NULL;
        require(lac_motion_create(&defs[k], &readings, &m, NULL) == LAC_OK);
        require(m->n + m->outliers <= s->n && m->velocities <= s->n);
        lac_motion_free(m);
    }
}

static void check_series(const lac_series *s)
{
    require(s->n > 0);
    check_motion(s);
    for (size_t i = 0; i < s->n; i++) {
        require(isfinite(s->time[i]) && (i == 0 || s->time[i] > s->time[i - 1]));
        require(!isinf(s->displacement[i]) && !isinf(s->velocity[i]) && s->line[i] > 1);
        require(s->sigma == NULL || isnan(s->sigma[i]) || s->sigma[i] > 0.0);
    }
}

static void read_bytes(const uint8_t *data, size_t size, const lac_units *units,
                       const char *time_format, const char *sigma)
{
    const lac_series_def def = {.path = "fuzz.csv",
                                .time = sigma == NULL ? "t" : NULL,
                                .time_format = time_format,
                                .sigma = sigma,
                                .sigma_unit = "mm",
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
    read_bytes(data, size, units, NULL, NULL);
    read_bytes(data, size, units, "%d/%m/%y %I:%M:%S %p %z", NULL);
    read_bytes(data, size, units, "%Y %b %j", NULL);
    read_bytes(data, size, units, "days since 2015-06-07", "s");
    return 0;
}
