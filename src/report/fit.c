// SPDX-License-Identifier: GPL-3.0-or-later
// What a fitted model forecasts: the predictive band of displacement and rate, when it fails, and
// what it found, as lacuna fit has stored it.
#include <gsl/gsl_sort.h>

#include "base/date.h"
#include "base/statistics.h"
#include "base/temp_file.h"
#include "report/run.h"

enum { NAME = 128, STEPS = 200, QUANTILES = 5 };

enum { QUANTILE, TIME, BEST, SLIP, RATE, READING, FAILURE, VARIABLES };

static const char *const names[VARIABLES] = {"quantile",
                                             "prediction_time",
                                             "best_displacement",
                                             "predicted_displacement",
                                             "predicted_slip_rate",
                                             "reading_time",
                                             "failure_time"};

// A fit's file, opened.
typedef struct fitted {
    const char *path;
    lac_stored_file *file;
    lac_stored_values value[VARIABLES];
    double shift; // from its clock to the run's [s]
} fitted;

// Where the fit's clock stands on the run's. Its unit is "s", or "seconds since DATE".
static lac_status find_shift(const lac_page *page, fitted *f)
{
    static const char since[] = "seconds since ";
    char unit[NAME];
    double start = 0.0;
    (void)lac_stored_file_text(f->file, names[READING], "units", unit, sizeof unit);
    const bool dated = strncmp(unit, since, sizeof since - 1) == 0 &&
                       lac_date_parse(unit + sizeof since - 1, &start);
    LAC_FAIL_IF(dated != page->dated, page->err, LAC_EINPUT, "%s: has %s, and the run %s has %s",
                f->path, dated ? "dates" : "no dates", page->def->run, dated ? "none" : "some");
    f->shift = dated ? start - page->start : 0.0;
    return LAC_OK;
}

static bool fits_together(const fitted *f)
{
    const lac_stored_values *v = f->value, *shares = &v[QUANTILE];
    const size_t n = v[TIME].value != NULL ? v[TIME].n : 0;
    bool sound = v[BEST].value == NULL || (v[BEST].n == n && v[BEST].width == 1);
    for (size_t k = SLIP; k <= RATE; k++) {
        sound = sound && (v[k].value == NULL || (v[k].n == QUANTILES && v[k].width == n));
    }
    sound = sound && (shares->value == NULL || shares->n == QUANTILES);
    for (size_t q = 0; sound && q < shares->n; q++) {
        sound = shares->value[q] >= 0.0 && shares->value[q] <= 1.0;
    }
    return sound && v[READING].value != NULL && v[READING].n > 0;
}

static lac_status open_fit(lac_page *page, fitted *f)
{
    LAC_TRY_RETURN(lac_stored_file_open(f->path, &f->file, page->err));
    for (size_t v = 0; v < VARIABLES; v++) {
        f->value[v] = lac_page_values(page, f->file, names[v]);
    }
    LAC_FAIL_IF(!fits_together(f), page->err, LAC_EIO,
                "%s: is not a file of lacuna fit to displacements or velocities", f->path);
    return find_shift(page, f);
}

static void write_band(lac_page *page, const char *key, const lac_stored_values *band)
{
    lac_json_open(&page->json, key, '[');
    for (size_t q = 0; band->value != NULL && q < band->n; q++) {
        lac_page_column(page, NULL, band->width, band->value + q * band->width, NULL, 7);
    }
    lac_json_close(&page->json, ']');
}

// Times of failure of the draws that were run on, in order; those that do not fail stand last.
static void write_failures(lac_page *page, const fitted *f)
{
    const lac_stored_values *all = &f->value[FAILURE], *share = &f->value[QUANTILE];
    double at[STEPS], part[STEPS];
    size_t failing = 0;
    for (size_t i = 0; i < all->n; i++) {
        failing += isfinite(all->value[i]) ? 1 : 0;
        all->value[i] = isfinite(all->value[i]) ? all->value[i] + f->shift : INFINITY;
    }
    gsl_sort(all->value, 1, all->n);
    lac_json_open(&page->json, "failure", '{');
    lac_json_integer(&page->json, "draws", (int64_t)all->n);
    lac_json_integer(&page->json, "failing", (int64_t)failing);
    for (size_t q = 0; q < share->n; q++) {
        at[q] = lac_quantile(all->n, all->value, share->value[q]);
    }
    lac_page_column(page, "quantile", share->n, at, NULL, 12);
    const size_t steps = failing < STEPS ? failing : STEPS;
    for (size_t i = 0; i < steps; i++) {
        at[i] = all->value[(i + 1) * failing / steps - 1];
        part[i] = (double)((i + 1) * failing / steps) / (double)all->n;
    }
    lac_page_column(page, "time", steps, at, NULL, 12);
    lac_page_column(page, "share", steps, part, NULL, 6);
    lac_json_close(&page->json, '}');
}

// An estimate, if the variable is one.
static void write_estimate(lac_page *page, const fitted *f, const char *name)
{
    static const struct {
        const char *key, *attribute;
        int digits;
    } numbers[] = {{"best", "best_fit", 5},
                   {"limit", "best_fit_at_end_of_range", 5},
                   {"error", "standard_error", 3},
                   {"log_error", "standard_error_of_logarithm", 3},
                   {"rhat", "rhat", 4}};
    static const struct {
        const char *key;
        double share;
    } quantiles[] = {{"low90", 0.05}, {"median", 0.5}, {"high90", 0.95}};
    char key[NAME], unit[NAME];
    lac_json *json = &page->json;
    lac_stored_values draws = {0};
    (void)lac_stored_file_text(f->file, name, "case_key", key, sizeof key);
    if (key[0] == '\0' ||
        !lac_page_good(page, lac_stored_file_values(f->file, name, &draws, page->err)) ||
        draws.value == NULL) {
        return;
    }
    const size_t n = draws.n * draws.width;
    gsl_sort(draws.value, 1, n);
    (void)lac_stored_file_text(f->file, name, "units", unit, sizeof unit);
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "key", key);
    lac_json_text(json, "unit", unit);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        lac_json_digits(json, numbers[i].key,
                        lac_stored_file_number(f->file, name, numbers[i].attribute),
                        numbers[i].digits);
    }
    for (size_t i = 0; n > 1 && i < sizeof quantiles / sizeof *quantiles; i++) { // 1: the best fit
        lac_json_digits(json, quantiles[i].key, lac_quantile(n, draws.value, quantiles[i].share),
                        5);
    }
    lac_json_close(json, '}');
    lac_stored_values_clear(&draws);
}

static void write_fit(lac_page *page, const fitted *f)
{
    lac_json *json = &page->json;
    const lac_stored_values *v = f->value;
    char text[NAME];
    lac_json_text(json, "name", lac_path_last(f->path));
    if (lac_stored_file_text(f->file, NULL, "title", text, sizeof text)) {
        lac_json_text(json, "title", text);
    }
    if (lac_stored_file_text(f->file, NULL, "point", text, sizeof text)) {
        lac_json_text(json, "point", text);
    }
    lac_json_integer(json, "readings", (int64_t)v[READING].n);
    lac_json_digits(json, "from", v[READING].value[0] + f->shift, 12);
    lac_json_digits(json, "until", v[READING].value[v[READING].n - 1] + f->shift, 12);
    for (size_t i = 0; v[TIME].value != NULL && i < v[TIME].n; i++) {
        v[TIME].value[i] += f->shift;
    }
    lac_page_column(page, "time", v[TIME].n, v[TIME].value, NULL, 12);
    lac_page_column(page, "best", v[BEST].n, v[BEST].value, NULL, 7);
    write_band(page, "slip", &v[SLIP]);
    write_band(page, "rate", &v[RATE]);
    if (v[FAILURE].value != NULL && v[FAILURE].n > 0) {
        write_failures(page, f);
    }
    lac_json_open(json, "estimates", '[');
    for (size_t i = 0; lac_stored_file_variable(f->file, i, text, sizeof text); i++) {
        write_estimate(page, f, text);
    }
    lac_json_close(json, ']');
}

void lac_page_fit(lac_page *page, const char *key)
{
    fitted f = {.path = page->def->fit};
    if (f.path != NULL && lac_page_good(page, open_fit(page, &f))) {
        lac_json_open(&page->json, key, '{');
        write_fit(page, &f);
        lac_json_close(&page->json, '}');
    }
    lac_stored_file_close(f.file);
}
