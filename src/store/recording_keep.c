// SPDX-License-Identifier: GPL-3.0-or-later
// A recording that is thinned, handed on, or begun with what a file holds.
#include <stdlib.h>
#include <string.h>

#include "store/recording_internal.h"
#include "store/store_file.h"

// Each dimension along which a run goes on has a variable that tells its times.
static const char *const axes[][2] = {
    {"time", "time"}, {"snapshot", "snapshot_time"}, {"event", "event_time"}};
enum { AXES = sizeof axes / sizeof *axes, SNAPSHOTS = 1, LOADED_SNAPSHOTS = 40 };

static bool runs_over(const lac_recorded *seen, const char *dimension)
{
    const size_t length = strlen(dimension);
    return strncmp(seen->dimensions, dimension, length) == 0 &&
           (seen->dimensions[length] == '\0' || seen->dimensions[length] == ' ');
}

// Places along a dimension.
static size_t places(const lac_recording *recording, const char *dimension)
{
    lac_recorded seen;
    for (size_t a = 0; a < AXES; a++) {
        if (strcmp(axes[a][0], dimension) == 0 &&
            lac_recording_find(recording, axes[a][1], &seen)) {
            return seen.count;
        }
    }
    return 0;
}

// The dimension along which a run adds to a variable as it goes on; NULL: it does not.
static const char *grows_along(const lac_recorded *seen)
{
    for (size_t a = 0; a < AXES; a++) {
        if (runs_over(seen, axes[a][0])) {
            return axes[a][0];
        }
    }
    return NULL;
}

size_t lac_recorded_places(const lac_recording *recording, const lac_recorded *seen)
{
    const char *along = grows_along(seen);
    return along != NULL ? places(recording, along) : seen->dimensions[0] == '\0' ? 1 : seen->count;
}

static size_t compact(double *values, size_t n, size_t width, const uint8_t *keep)
{
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        if (keep[i]) {
            memmove(values + kept++ * width, values + i * width, width * sizeof *values);
        }
    }
    return kept * width;
}

void lac_recording_thin(lac_recording *recording, const char *dimension, const uint8_t *keep)
{
    const size_t n = places(recording, dimension);
    lac_recorded seen;
    for (size_t v = 0; n > 0 && lac_recording_at(recording, v, &seen); v++) {
        if (runs_over(&seen, dimension)) {
            double *values = lac_recording_values(recording, v);
            lac_recording_cut(recording, v, compact(values, n, seen.count / n, keep));
        }
    }
}

lac_status lac_recording_move(lac_recording *recording, lac_recording *from, lac_error *err)
{
    lac_recorded seen;
    lac_status status = LAC_OK;
    for (size_t v = 0; status == LAC_OK && lac_recording_at(from, v, &seen); v++) {
        status =
            grows_along(&seen) != NULL ? lac_recording_reserve(recording, from, v, err) : LAC_OK;
    }
    for (size_t v = 0; lac_recording_at(from, v, &seen); v++) {
        if (grows_along(&seen) != NULL && status != LAC_OK) {
            lac_recording_cut(from, v, 0);
        } else if (grows_along(&seen) != NULL && seen.count > 0) {
            lac_recording_pour(recording, from, v);
        }
    }
    return status;
}

static lac_status missing(const char *name, lac_error *err)
{
    return lac_fail(err, LAC_EIO, "%s is missing or shorter than its dimension", name);
}

static lac_status load(lac_recording *recording, size_t v, const char *name, size_t n,
                       const lac_stored_file *file, lac_error *err)
{
    lac_stored_values from = {0};
    lac_status status;
    LAC_TRY(lac_stored_file_values(file, name, &from, err));
    LAC_TRY(from.value != NULL && from.n >= n ? LAC_OK : missing(name, err));
    LAC_TRY(lac_recording_append(recording, v, from.value, n * from.width, err));
out:
    lac_stored_values_clear(&from);
    return status;
}

// Some snapshots, evenly many, and the last: all could be more than there is memory.
static lac_status load_some(lac_recording *recording, size_t v, const char *name, size_t n,
                            const lac_stored_file *file, lac_error *err)
{
    const size_t stride = n / LOADED_SNAPSHOTS + 1;
    lac_stored_values from = {0};
    lac_status status = LAC_OK;
    for (size_t i = (n - 1) % stride; i < n; i += stride) {
        lac_stored_values_clear(&from);
        LAC_TRY(lac_stored_file_row(file, name, (ptrdiff_t)i, &from, err));
        LAC_TRY(from.value != NULL ? LAC_OK : missing(name, err));
        LAC_TRY(lac_recording_append(recording, v, from.value, from.width, err));
    }
out:
    lac_stored_values_clear(&from);
    return status;
}

static lac_status load_axis(lac_recording *recording, size_t axis, size_t n,
                            const lac_stored_file *file, lac_error *err)
{
    lac_recorded seen;
    lac_status status = LAC_OK;
    for (size_t v = 0; n > 0 && lac_recording_at(recording, v, &seen); v++) {
        if (runs_over(&seen, axes[axis][0])) {
            LAC_TRY(axis == SNAPSHOTS ? load_some(recording, v, seen.name, n, file, err)
                                      : load(recording, v, seen.name, n, file, err));
        }
    }
out:
    return status;
}

lac_status lac_recording_load(lac_recording *recording, const char *path,
                              const lac_kept_checkpoint *checkpoint, lac_error *err)
{
    const uint64_t counts[AXES] = {checkpoint->records, checkpoint->snapshots, checkpoint->events};
    lac_stored_file *file = NULL;
    lac_recorded origin, local;
    lac_status status;
    LAC_TRY(lac_stored_file_open(path, &file, err));
    for (size_t a = 0; a < AXES; a++) {
        LAC_TRY(load_axis(recording, a, (size_t)counts[a], file, err));
    }
    if (lac_recording_find(recording, "time_origin", &origin) && origin.count > 0 &&
        lac_recording_find(recording, "time_local", &local)) {
        lac_recording_resume(recording, origin.values[origin.count - 1],
                             local.values[local.count - 1]);
    }
out:
    lac_stored_file_close(file);
    return status;
}
