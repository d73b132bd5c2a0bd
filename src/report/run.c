// SPDX-License-Identifier: GPL-3.0-or-later
// What a page reads of a run, from its file or from memory: the columns of its sections over time,
// and the time to the end; and what slips at each scale, against the fixed points of the cascade
// and of the run's own map.
#include "report/run.h"

#include "base/date.h"

enum {
    BUCKETS = 500,
    LEVEL_BUCKETS = 300,
    LIVE_BUCKETS = 1000, // leaves 36 000 records at most
    COMMENT = 600
};

// Of a column: it may be missing, and does not say which records are kept; or it says which a
// recording keeps.
enum { ASIDE = 1, WATCHED = 2 };

// Columns over time: where the page shows them, and under which key.
static const struct {
    const char *section, *key, *name;
    unsigned flags;
} shown[] = {
    {"motion", "slip", "slip", 0},
    {"motion", "rate", "slip_rate", WATCHED},
    {"motion", "max_rate", "max_slip_rate", WATCHED},
    {"direction", "x", "slip_x", 0},
    {"direction", "y", "slip_y", 0},
    {"direction", "rate_x", "slip_rate_x", 0},
    {"direction", "rate_y", "slip_rate_y", 0},
    {"safety", "factor", "factor_of_safety", WATCHED},
    {"safety", "ratio", "effective_ratio", 0},
    {"safety", "pore", "pore_pressure", WATCHED},
    {"safety", "lake", "lake_level", WATCHED},
    {"safety", "lake2", "lake_level_2", 0},
    {"safety", "table", "water_level", 0},
    {"safety", "rain", "rain", WATCHED},
    {"safety", "rain2", "rain_2", 0},
    {"safety", "angle", "angle", 0},
    {"safety", "thickness", "thickness", 0},
    {"safety", "excess", "excess_pore_pressure", WATCHED},
    {"safety", "heat", "temperature_rise", WATCHED},
    {"safety", "broken", "broken_cohesion", 0},
    {"forces", "friction", "apparent_friction", WATCHED},
    {"forces", "shear", "shear_force", WATCHED},
    {"forces", "normal", "normal_force", 0},
    {"forces", "effective", "effective_normal_force", WATCHED},
    {"solver", "step", "step_size", WATCHED},
    {"solver", "order", "order", 0},
    {"solver", "evaluations", "rhs_evaluations", 0},
    {"solver", "residual", "balance_residual", WATCHED},
    {"levels", "fraction", "slip_fraction", WATCHED},
    {"levels", "length", "correlation_length", 0},
    {"levels", "criticality", "criticality", ASIDE},
};
enum { SHOWN = sizeof shown / sizeof *shown };

static bool is_in(size_t c, const char *section) { return strcmp(shown[c].section, section) == 0; }

// What the page owns: values that were read, or room.
typedef struct lac_page_owned {
    struct lac_page_owned *next;
    const lac_stored_file *file; // NULL: room
    const char *name;
    lac_stored_values values;
} owned;

bool lac_page_good(lac_page *page, lac_status status)
{
    if (status != LAC_OK && page->status == LAC_OK) {
        page->status = status;
        page->err = NULL;
    }
    return status == LAC_OK;
}

static owned *own(lac_page *page)
{
    owned *one = calloc(1, sizeof *one);
    if (lac_page_good(page, one != NULL ? LAC_OK : lac_fail_memory(page->err))) {
        one->next = page->owned;
        page->owned = one;
    }
    return one;
}

void *lac_page_room(lac_page *page, size_t bytes)
{
    owned *one = own(page);
    void *room = one != NULL ? malloc(bytes + 1) : NULL;
    if (one != NULL) {
        one->values.value = room;
        (void)lac_page_good(page, room != NULL ? LAC_OK : lac_fail_memory(page->err));
    }
    return room;
}

lac_stored_values lac_page_values(lac_page *page, const lac_stored_file *file, const char *name)
{
    for (const owned *o = page->owned; o != NULL; o = o->next) {
        if (o->file == file && strcmp(o->name, name) == 0) {
            return o->values;
        }
    }
    owned *one = own(page);
    if (one == NULL) {
        return (lac_stored_values){0};
    }
    (void)lac_page_good(page, lac_stored_file_values(file, name, &one->values, page->err));
    one->file = file;
    one->name = name;
    return one->values;
}

const double *lac_page_over_time(lac_page *page, const char *name)
{
    const lac_stored_values column = lac_page_values(page, page->file, name);
    const bool over = column.n >= page->n && column.width == 1;
    if (column.value != NULL && !over) {
        (void)lac_page_good(page, lac_fail(page->err, LAC_EIO, "%s: %s does not run over time",
                                           page->def->run, name));
    }
    return over ? column.value : NULL;
}

// Time before the last record, from the pair that tells the last milliseconds apart.
static void find_before(lac_page *page)
{
    const lac_stored_values origin = lac_page_values(page, page->file, "time_origin");
    const lac_stored_values local = lac_page_values(page, page->file, "time_local");
    const size_t last = page->n - 1;
    const bool pair =
        origin.value != NULL && local.value != NULL && origin.n >= page->n && local.n >= page->n;
    page->before = lac_page_room(page, page->n * sizeof *page->before);
    for (size_t i = 0; page->before != NULL && i < page->n; i++) {
        page->before[i] =
            pair ? (origin.value[last] - origin.value[i]) + (local.value[last] - local.value[i])
                 : page->time[last] - page->time[i];
    }
}

static void check_columns(lac_page *page)
{
    for (size_t c = 0; c < SHOWN; c++) {
        (void)lac_page_over_time(page, shown[c].name);
    }
    for (size_t c = 0; c < SHOWN && page->status == LAC_OK; c++) {
        if (is_in(c, "motion") && lac_page_over_time(page, shown[c].name) == NULL) {
            (void)lac_page_good(page, lac_fail(page->err, LAC_EIO,
                                               "%s: is not the file of a run: has no %s",
                                               page->def->run, shown[c].name));
        }
    }
}

// Times of the file's records, or of those that are in memory.
static lac_status open_run(lac_page *page)
{
    const lac_page_def *def = page->def;
    owned *one = own(page);
    LAC_FAIL_MEMORY_IF(one == NULL, page->err);
    LAC_TRY_RETURN(def->recording == NULL
                       ? lac_stored_file_open(def->run, &page->file, page->err)
                       : lac_stored_file_of(def->recording, &page->file, page->err));
    if (def->ensemble != NULL) {
        return LAC_OK;
    }
    page->readings = def->recording == NULL && lac_page_holds_readings(page->file);
    if (page->readings) {
        return lac_page_open_readings(page);
    }
    LAC_TRY_RETURN(lac_stored_file_series(page->file, "time", &one->values, page->err));
    page->time = one->values.value;
    page->n = one->values.n;
    LAC_FAIL_IF(page->n == 0, page->err, LAC_EINPUT, "%s: holds no record", def->run);
    return LAC_OK;
}

void lac_page_begin(lac_page *page)
{
    char text[64];
    if (lac_page_good(page, open_run(page)) && !page->readings) {
        if (page->def->ensemble == NULL) {
            find_before(page);
            check_columns(page);
        }
        page->dated =
            lac_stored_file_text(page->file, NULL, "time_coverage_start", text, sizeof text) &&
            lac_date_parse(text, &page->start);
    }
}

void lac_page_clear(lac_page *page)
{
    while (page->owned != NULL) {
        owned *first = page->owned;
        page->owned = first->next;
        lac_stored_values_clear(&first->values);
        free(first);
    }
    lac_stored_file_close(page->file);
}

void lac_page_column(lac_page *page, const char *key, size_t n, const double *value,
                     const uint8_t *keep, int digits)
{
    lac_json_open(&page->json, key, '[');
    for (size_t i = 0; value != NULL && i < n; i++) {
        if (keep == NULL || keep[i]) {
            lac_json_digits(&page->json, NULL, value[i], digits);
        }
    }
    lac_json_close(&page->json, ']');
}

// The records that the charts of a section's columns need. @return [n] NULL: no memory
static uint8_t *keep_of(lac_page *page, const char *section, size_t buckets)
{
    const double *column[SHOWN];
    size_t columns = 0;
    for (size_t c = 0; c < SHOWN; c++) {
        if (is_in(c, section) && (shown[c].flags & ASIDE) == 0) {
            column[columns++] = lac_page_over_time(page, shown[c].name);
        }
    }
    uint8_t *keep = lac_page_room(page, page->n);
    if (keep != NULL) {
        (void)lac_page_thin(page->n, page->time, page->before, buckets, columns, column, keep);
    }
    return keep;
}

void lac_page_mark_records(const lac_recording *recording, size_t n, const double *time,
                           const double *before, uint8_t *keep)
{
    const double *column[SHOWN];
    size_t columns = 0;
    for (size_t c = 0; c < SHOWN; c++) {
        if ((shown[c].flags & WATCHED) != 0) {
            column[columns++] = lac_dataset_array(lac_recording_dataset(recording), shown[c].name);
        }
    }
    (void)lac_page_thin(n, time, before, LIVE_BUCKETS, columns, column, keep);
}

// Times and the columns of a section, at the records that are kept.
static void write_records(lac_page *page, const char *section, const uint8_t *keep)
{
    lac_page_column(page, "time", page->n, page->time, keep, 12);
    lac_page_column(page, "before", page->n, page->before, keep, 6);
    for (size_t c = 0; c < SHOWN; c++) {
        const double *value = is_in(c, section) ? lac_page_over_time(page, shown[c].name) : NULL;
        if (value != NULL) {
            lac_page_column(page, shown[c].key, page->n, value, keep, 6);
        }
    }
}

// Whether a column changes by more than what its digits are worth.
static bool varies(lac_page *page, const char *name)
{
    const double *v = lac_page_over_time(page, name);
    double least = INFINITY, most = -INFINITY;
    for (size_t i = 0; v != NULL && i < page->n; i++) {
        least = fmin(least, v[i]);
        most = fmax(most, v[i]);
    }
    return most - least > 1e-6 * fmax(fabs(most), fabs(least));
}

// Not of a file that some tool took a column from, nor of constant loads, which the case tells. Of
// safety and water a case may name any part.
static bool is_there(lac_page *page, const char *section)
{
    bool any = false, all = true;
    for (size_t c = 0; c < SHOWN; c++) {
        const bool has = is_in(c, section) && lac_page_over_time(page, shown[c].name) != NULL;
        any = any || (has && varies(page, shown[c].name));
        all = all && (has || !is_in(c, section));
    }
    if (strcmp(section, "safety") == 0) {
        return any;
    }
    return all && (strcmp(section, "forces") != 0 || varies(page, "apparent_friction") ||
                   varies(page, "shear_force") || varies(page, "effective_normal_force"));
}

void lac_page_course(lac_page *page, const char *key)
{
    const uint8_t *keep = is_there(page, key) ? keep_of(page, key, BUCKETS) : NULL;
    if (keep != NULL) {
        lac_json_open(&page->json, key, '{');
        lac_json_integer(&page->json, "records", (int64_t)page->n);
        write_records(page, key, keep);
        lac_json_close(&page->json, '}');
    }
}

// Variables of one number; null on the page where the file has none.
static void write_fixed_points(lac_page *page)
{
    static const char *const scalars[] = {
        "critical_fraction",
        "critical_fraction_low",
        "critical_fraction_high",
        "run_critical_fraction",
        "run_critical_fraction_low",
        "run_critical_fraction_high",
        "run_lambda",
        "run_lambda_low",
        "run_lambda_high",
    };
    static const char *const comments[][2] = {{"source", "critical_fraction"},
                                              {"definition", "n_slip"}};
    char comment[COMMENT];
    for (size_t i = 0; i < sizeof scalars / sizeof *scalars; i++) {
        const lac_stored_values value = lac_page_values(page, page->file, scalars[i]);
        lac_json_digits(&page->json, scalars[i], value.n == 1 ? value.value[0] : NAN, 6);
    }
    for (size_t i = 0; i < 2; i++) {
        (void)lac_stored_file_text(page->file, comments[i][1], "comment", comment, sizeof comment);
        lac_json_text(&page->json, comments[i][0], comment);
    }
}

static void write_counts(lac_page *page, const lac_stored_values *n_slip, const uint8_t *keep)
{
    lac_json_open(&page->json, "slipping", '[');
    for (size_t level = 0; level < n_slip->width; level++) {
        double *column = lac_page_room(page, page->n * sizeof *column);
        for (size_t i = 0; column != NULL && i < page->n; i++) {
            column[i] = n_slip->value[i * n_slip->width + level];
        }
        lac_page_column(page, NULL, page->n, column, keep, 17);
    }
    lac_json_close(&page->json, ']');
}

void lac_page_levels(lac_page *page, const char *key)
{
    const lac_stored_values n_slip = lac_page_values(page, page->file, "n_slip");
    const lac_stored_values size = lac_page_values(page, page->file, "block_size");
    const lac_stored_values total = lac_page_values(page, page->file, "n_tot");
    if (n_slip.value == NULL || n_slip.n < page->n || n_slip.width < 2 ||
        lac_page_over_time(page, "slip_fraction") == NULL ||
        lac_page_over_time(page, "correlation_length") == NULL || size.n != n_slip.width ||
        total.n != n_slip.width) {
        return; // the case did not ask for it, or it is a block
    }
    const uint8_t *keep = keep_of(page, key, LEVEL_BUCKETS);
    if (keep != NULL) {
        lac_json_open(&page->json, key, '{');
        lac_page_column(page, "size", size.n, size.value, NULL, 8);
        lac_page_column(page, "total", total.n, total.value, NULL, 17);
        write_records(page, key, keep);
        write_counts(page, &n_slip, keep);
        write_fixed_points(page);
        lac_json_close(&page->json, '}');
    }
}
