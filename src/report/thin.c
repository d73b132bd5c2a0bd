// SPDX-License-Identifier: GPL-3.0-or-later
// The records that a page draws: extremes in equal spans of time, and of its log before the end;
// and by these memory that stays bounded while a run goes on and its page is open.
#include "report/run.h"

enum { FEW = 1500 };

// An axis: times, or the logarithm of the times before the end, turned round.
typedef struct axis {
    const double *value;
    bool logarithm;
    double least, most; // of what has a logarithm
    double width;       // of a bucket; 0: there is one
} axis;

static double bucket_of(const axis *a, size_t i)
{
    double v = a->value[i];
    double place =
        !a->logarithm ? v - a->value[0] : log(a->most) - log(v > a->least ? v : a->least);
    return a->width > 0.0 ? floor(place / a->width) : 0.0;
}

static void mark_extremes(const double *v, size_t from, size_t to, uint8_t *keep)
{
    size_t least = SIZE_MAX, greatest = SIZE_MAX;
    for (size_t i = from; i < to; i++) {
        if (!isnan(v[i])) {
            least = least == SIZE_MAX || v[i] < v[least] ? i : least;
            greatest = greatest == SIZE_MAX || v[i] > v[greatest] ? i : greatest;
        }
    }
    if (least != SIZE_MAX) {
        keep[least] = keep[greatest] = 1;
    }
}

static void mark_axis(size_t n, const axis *a, size_t columns, const double *const *column,
                      uint8_t *keep)
{
    for (size_t from = 0, to; from < n; from = to) {
        const double bucket = bucket_of(a, from);
        for (to = from + 1; to < n && !(bucket_of(a, to) > bucket);) {
            to++;
        }
        keep[from] = keep[to - 1] = 1;
        for (size_t c = 0; c < columns; c++) {
            if (column[c] != NULL) {
                mark_extremes(column[c], from, to, keep);
            }
        }
    }
}

static axis even_decades(size_t n, const double *before, size_t buckets)
{
    while (n > 1 && !(before[n - 1] > 0.0)) {
        n--;
    }
    const double least = before[n - 1] > 0.0 ? before[n - 1] : 1.0;
    const double most = before[0] > least ? before[0] : least;
    return (axis){.value = before,
                  .logarithm = true,
                  .least = least,
                  .most = most,
                  .width = log(most / least) / (double)buckets};
}

size_t lac_page_thin(size_t n, const double *time, const double *before, size_t buckets,
                     size_t columns, const double *const *column, uint8_t *keep)
{
    const size_t few = buckets * 3 < FEW ? buckets * 3 : FEW;
    size_t kept = 0;
    memset(keep, n <= few, n);
    if (n > few) {
        const axis times = {.value = time, .width = (time[n - 1] - time[0]) / (double)buckets};
        const axis decades = even_decades(n, before, buckets);
        mark_axis(n, &times, columns, column, keep);
        mark_axis(n, &decades, columns, column, keep);
    }
    for (size_t i = 0; i < n; i++) {
        kept += keep[i];
    }
    return kept;
}

void lac_page_thin_to(size_t n, const double *time, const double *before, size_t most, size_t goal,
                      uint8_t *keep)
{
    size_t buckets = most / 2;
    while (lac_page_thin(n, time, before, buckets, 0, NULL, keep) > goal && buckets > 1) {
        buckets--;
    }
}

enum { MOST_RECORDS = 60000, MOST_SHOTS = 80, FEWEST_SHOTS = 6, SHOT_BYTES = 1 << 28 };

static const double *values_of(const lac_recording *recording, const char *name, size_t *n)
{
    *n = lac_dataset_count(lac_recording_dataset(recording), name);
    return lac_dataset_array(lac_recording_dataset(recording), name);
}

// Snapshots that are kept at most: of large joints fewer.
static size_t most_shots(const lac_recording *recording)
{
    char name[64];
    size_t values = 0, n, shots;
    (void)values_of(recording, "snapshot_time", &shots);
    for (size_t f = 0; lac_run_field(f) != NULL; f++) {
        (void)snprintf(name, sizeof name, "cell_%s", lac_run_field(f));
        (void)values_of(recording, name, &n);
        values += n;
    }
    const size_t each = shots > 0 ? values / shots * sizeof(double) : 0;
    const size_t most = each > 0 ? SHOT_BYTES / each : MOST_SHOTS;
    return most < FEWEST_SHOTS ? FEWEST_SHOTS : most < MOST_SHOTS ? most : MOST_SHOTS;
}

// Keeps about so many of the snapshots, or of the records where that is 0.
static lac_status thin_along(lac_recording *recording, size_t shots, lac_error *err)
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
        lac_page_mark_records(recording, n, time, before, keep);
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
    const lac_status status = thin_along(recording, 0, err);
    return status == LAC_OK ? thin_along(recording, most_shots(recording), err) : status;
}
