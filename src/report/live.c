// SPDX-License-Identifier: GPL-3.0-or-later
// Memory that stays bounded while a run goes on and its page is open.
#include <stdlib.h>

#include "report/run.h"

enum {
    MOST_RECORDS = 60000,
    BUCKETS = 1000, // leaves 36 000 records at most
    MOST_SHOTS = 80,
    FEWEST_SHOTS = 6,
    SHOT_BYTES = 1 << 28
};

static const double *values_of(const lac_recording *recording, const char *name, size_t *n)
{
    *n = lac_dataset_count(lac_recording_dataset(recording), name);
    return lac_dataset_array(lac_recording_dataset(recording), name);
}

// Snapshots that are kept at most: of large joints fewer.
static size_t most_shots(const lac_recording *recording)
{
    static const char *const fields[] = {"cell_slip", "cell_slip_rate", "cell_state",
                                         "cell_traction"};
    size_t values = 0, n, shots;
    (void)values_of(recording, "snapshot_time", &shots);
    for (size_t f = 0; f < sizeof fields / sizeof *fields; f++) {
        (void)values_of(recording, fields[f], &n);
        values += n;
    }
    const size_t each = shots > 0 ? values / shots * sizeof(double) : 0;
    const size_t most = each > 0 ? SHOT_BYTES / each : MOST_SHOTS;
    return most < FEWEST_SHOTS ? FEWEST_SHOTS : most < MOST_SHOTS ? most : MOST_SHOTS;
}

static void mark_records(const lac_recording *recording, size_t n, const double *time,
                         const double *before, uint8_t *keep)
{
    static const char *const watched[] = {
        "slip_rate",        "max_slip_rate",          "apparent_friction",
        "shear_force",      "effective_normal_force", "step_size",
        "balance_residual", "slip_fraction"};
    enum { WATCHED = sizeof watched / sizeof *watched };
    const double *column[WATCHED];
    for (size_t c = 0, same; c < WATCHED; c++) {
        column[c] = values_of(recording, watched[c], &same);
    }
    (void)lac_page_thin(n, time, before, BUCKETS, WATCHED, column, keep);
}

// Keeps about so many of the snapshots, or of the records where that is 0.
static lac_status thin(lac_recording *recording, size_t shots, lac_error *err)
{
    size_t n, same;
    const double *time = values_of(recording, shots > 0 ? "snapshot_time" : "time", &n);
    const double *origin = shots > 0 ? time : values_of(recording, "time_origin", &same);
    const double *local = shots > 0 ? NULL : values_of(recording, "time_local", &same);
    if (n <= (shots > 0 ? shots : MOST_RECORDS)) {
        return LAC_OK;
    }
    double *before = malloc(n * sizeof *before);
    uint8_t *keep = malloc(n);
    const bool room = before != NULL && keep != NULL;
    for (size_t i = 0; room && i < n; i++) {
        before[i] = (origin[n - 1] - origin[i]) + (local != NULL ? local[n - 1] - local[i] : 0.0);
    }
    if (room && shots > 0) { // down to two thirds, so that not every new one costs this
        lac_page_thin_to(n, time, before, shots, 2 * shots / 3, keep);
    } else if (room) {
        mark_records(recording, n, time, before, keep);
    }
    if (room) {
        lac_recording_thin(recording, shots > 0 ? "snapshot" : "time", keep);
    }
    free(before);
    free(keep);
    return room ? LAC_OK : lac_fail_memory(err);
}

lac_status lac_page_thin_recording(lac_recording *recording, lac_error *err)
{
    const lac_status status = thin(recording, 0, err);
    return status == LAC_OK ? thin(recording, most_shots(recording), err) : status;
}
