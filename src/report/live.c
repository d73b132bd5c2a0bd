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

// Times before the last one; the caller frees.
static double *times_before(size_t n, const double *origin, const double *local)
{
    double *before = malloc((n > 0 ? n : 1) * sizeof *before);
    for (size_t i = 0; before != NULL && i < n; i++) {
        before[i] = (origin[n - 1] - origin[i]) + (local != NULL ? local[n - 1] - local[i] : 0.0);
    }
    return before;
}

static const double *values_of(const lac_recording *recording, const char *name, size_t *n)
{
    lac_recorded seen;
    const bool there = lac_recording_find(recording, name, &seen);
    *n = there ? seen.count : 0;
    return there ? seen.values : NULL;
}

static lac_status thin_records(lac_recording *recording, lac_error *err)
{
    static const char *const watched[] = {
        "slip_rate",        "max_slip_rate",          "apparent_friction",
        "shear_force",      "effective_normal_force", "step_size",
        "balance_residual", "slip_fraction"};
    enum { WATCHED = sizeof watched / sizeof *watched };
    const double *column[WATCHED];
    size_t n, same;
    const double *time = values_of(recording, "time", &n);
    if (n <= MOST_RECORDS) {
        return LAC_OK;
    }
    for (size_t c = 0; c < WATCHED; c++) {
        column[c] = values_of(recording, watched[c], &same);
    }
    double *before = times_before(n, values_of(recording, "time_origin", &same),
                                  values_of(recording, "time_local", &same));
    uint8_t *keep = malloc(n);
    const bool room = before != NULL && keep != NULL;
    if (room) {
        (void)lac_page_thin(n, time, before, BUCKETS, WATCHED, column, keep);
        lac_recording_thin(recording, "time", keep);
    }
    free(before);
    free(keep);
    return room ? LAC_OK : lac_fail_memory(err);
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

static lac_status thin_snapshots(lac_recording *recording, lac_error *err)
{
    const size_t most = most_shots(recording);
    size_t n, buckets = most / 2;
    const double *time = values_of(recording, "snapshot_time", &n);
    if (n <= most) {
        return LAC_OK;
    }
    double *before = times_before(n, time, NULL);
    uint8_t *keep = malloc(n);
    const bool room = before != NULL && keep != NULL;
    // Down to two thirds, so that not every new one costs this.
    while (room && buckets > 1 &&
           lac_page_thin(n, time, before, buckets, 0, NULL, keep) > 2 * most / 3) {
        buckets--;
    }
    if (room) {
        lac_recording_thin(recording, "snapshot", keep);
    }
    free(before);
    free(keep);
    return room ? LAC_OK : lac_fail_memory(err);
}

lac_status lac_report_thin(lac_recording *recording, lac_error *err)
{
    const lac_status status = thin_records(recording, err);
    return status == LAC_OK ? thin_snapshots(recording, err) : status;
}
