// SPDX-License-Identifier: GPL-3.0-or-later
// What a fitted model forecasts: the predictive band of displacement and rate, when it fails, and
// what it found, as lacuna fit has stored it.
#include <gsl/gsl_sort.h>
#include <math.h>
#include <string.h>

#include "base/date.h"
#include "base/statistics.h"
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

static void clear(fitted *f)
{
    for (size_t v = 0; v < VARIABLES; v++) {
        lac_stored_values_clear(&f->value[v]);
    }
    lac_stored_file_close(f->file);
}

// Where the fit's clock stands on the run's. Its unit is "s", or "seconds since DATE".
static lac_status find_shift(const lac_page *page, fitted *f, lac_error *err)
{
    static const char since[] = "seconds since ";
    const lac_page_run *run = page->run;
    char unit[NAME];
    double start = 0.0;
    lac_stored_file_text(f->file, names[READING], "units", unit, sizeof unit);
    const bool dated = strncmp(unit, since, sizeof since - 1) == 0 &&
                       lac_date_parse(unit + sizeof since - 1, &start);
    if (dated != run->dated) {
        return lac_fail(err, LAC_EINPUT, "%s: has %s, and the run %s has %s", f->path,
                        dated ? "dates" : "no dates", run->path, dated ? "none" : "some");
    }
    f->shift = dated ? start - run->start : 0.0;
    return LAC_OK;
}

static bool has_shares(const lac_stored_values *quantiles)
{
    bool sound = quantiles->value == NULL || quantiles->n == QUANTILES;
    for (size_t q = 0; sound && q < quantiles->n; q++) {
        sound = quantiles->value[q] >= 0.0 && quantiles->value[q] <= 1.0;
    }
    return sound;
}

static bool fits_together(const fitted *f)
{
    const lac_stored_values *v = f->value;
    const size_t n = v[TIME].value != NULL ? v[TIME].n : 0;
    bool sound = v[BEST].value == NULL || (v[BEST].n == n && v[BEST].width == 1);
    for (size_t k = SLIP; k <= RATE; k++) {
        sound = sound && (v[k].value == NULL || (v[k].n == QUANTILES && v[k].width == n));
    }
    return sound && v[READING].value != NULL && v[READING].n > 0 && has_shares(&v[QUANTILE]);
}

static lac_status open_fit(const lac_page *page, fitted *f, lac_error *err)
{
    lac_status status;
    f->path = page->def->fit;
    LAC_TRY(lac_stored_file_open(f->path, &f->file, err));
    for (size_t v = 0; v < VARIABLES; v++) {
        LAC_TRY(lac_stored_file_values(f->file, names[v], &f->value[v], err));
    }
    if (!fits_together(f)) {
        LAC_TRY(lac_fail(err, LAC_EIO, "%s: is not a file of lacuna fit", f->path));
    }
    LAC_TRY(find_shift(page, f, err));
out:
    return status;
}

static void write_times(lac_page_text *text, const fitted *f)
{
    const lac_stored_values *time = &f->value[TIME];
    lac_page_open(text, "time", '[');
    for (size_t i = 0; time->value != NULL && i < time->n; i++) {
        lac_page_number(text, NULL, time->value[i] + f->shift, 12);
    }
    lac_page_close(text, ']');
}

static void write_band(lac_page_text *text, const char *key, const lac_stored_values *band)
{
    lac_page_open(text, key, '[');
    for (size_t q = 0; band->value != NULL && q < band->n; q++) {
        lac_page_column(text, NULL, band->width, band->value + q * band->width, NULL, 7);
    }
    lac_page_close(text, ']');
}

// Times of failure of the draws that were run on, in order; those that do not fail stand last.
static void write_failures(lac_page_text *text, const fitted *f)
{
    const lac_stored_values *all = &f->value[FAILURE];
    size_t failing = 0;
    for (size_t i = 0; i < all->n; i++) {
        failing += isfinite(all->value[i]) ? 1 : 0;
        all->value[i] = isfinite(all->value[i]) ? all->value[i] + f->shift : INFINITY;
    }
    gsl_sort(all->value, 1, all->n);
    lac_page_open(text, "failure", '{');
    lac_page_number(text, "draws", (double)all->n, 17);
    lac_page_number(text, "failing", (double)failing, 17);
    lac_page_open(text, "quantile", '[');
    for (size_t q = 0; q < QUANTILES && f->value[QUANTILE].value != NULL; q++) {
        lac_page_number(text, NULL, lac_quantile(all->n, all->value, f->value[QUANTILE].value[q]),
                        12);
    }
    lac_page_close(text, ']');
    const size_t steps = failing < STEPS ? failing : STEPS;
    lac_page_open(text, "time", '[');
    for (size_t i = 0; i < steps; i++) {
        lac_page_number(text, NULL, all->value[(i + 1) * failing / steps - 1], 12);
    }
    lac_page_close(text, ']');
    lac_page_open(text, "share", '[');
    for (size_t i = 0; i < steps; i++) {
        lac_page_number(text, NULL, (double)((i + 1) * failing / steps) / (double)all->n, 6);
    }
    lac_page_close(text, ']');
    lac_page_close(text, '}');
}

static void write_draws(lac_page_text *text, const lac_stored_values *draws)
{
    static const char *const keys[] = {"low90", "median", "high90"};
    static const double share[] = {0.05, 0.5, 0.95};
    const size_t n = draws->n * draws->width;
    if (n > 1) { // one is the best fit alone
        gsl_sort(draws->value, 1, n);
    }
    for (size_t i = 0; n > 1 && i < sizeof share / sizeof *share; i++) {
        lac_page_number(text, keys[i], lac_quantile(n, draws->value, share[i]), 5);
    }
}

// An estimate, if the variable is one.
static lac_status write_estimate(lac_page_text *text, const fitted *f, const char *name,
                                 lac_error *err)
{
    char key[NAME], unit[NAME];
    lac_stored_values draws = {0};
    lac_stored_file_text(f->file, name, "case_key", key, sizeof key);
    if (key[0] == '\0') {
        return LAC_OK;
    }
    lac_stored_file_text(f->file, name, "units", unit, sizeof unit);
    const lac_status status = lac_stored_file_values(f->file, name, &draws, err);
    if (status == LAC_OK && draws.value != NULL) {
        lac_page_open(text, NULL, '{');
        lac_page_string(text, "key", key);
        lac_page_string(text, "unit", unit);
        lac_page_number(text, "best", lac_stored_file_number(f->file, name, "best_fit"), 5);
        lac_page_number(text, "limit",
                        lac_stored_file_number(f->file, name, "best_fit_at_end_of_range"), 5);
        lac_page_number(text, "error", lac_stored_file_number(f->file, name, "standard_error"), 3);
        lac_page_number(text, "log_error",
                        lac_stored_file_number(f->file, name, "standard_error_of_logarithm"), 3);
        lac_page_number(text, "rhat", lac_stored_file_number(f->file, name, "rhat"), 4);
        write_draws(text, &draws);
        lac_page_close(text, '}');
    }
    lac_stored_values_clear(&draws);
    return status;
}

static lac_status write_estimates(lac_page_text *text, const fitted *f, lac_error *err)
{
    char name[NAME];
    lac_status status = LAC_OK;
    lac_page_open(text, "estimates", '[');
    for (size_t i = 0; status == LAC_OK && lac_stored_file_variable(f->file, i, name, sizeof name);
         i++) {
        status = write_estimate(text, f, name, err);
    }
    lac_page_close(text, ']');
    return status;
}

static lac_status write_fit(const lac_page *page, const fitted *f, lac_error *err)
{
    lac_page_text *text = page->text;
    const char *slash = strrchr(f->path, '/');
    const lac_stored_values *reading = &f->value[READING];
    char title[NAME];
    lac_page_open(text, "fit", '{');
    lac_page_string(text, "name", slash != NULL ? slash + 1 : f->path);
    if (lac_page_attribute_text(f->file, "title", title, sizeof title)) {
        lac_page_string(text, "title", title);
    }
    lac_page_number(text, "readings", (double)reading->n, 17);
    lac_page_number(text, "from", reading->value[0] + f->shift, 12);
    lac_page_number(text, "until", reading->value[reading->n - 1] + f->shift, 12);
    write_times(text, f);
    lac_page_column(text, "best", f->value[BEST].n, f->value[BEST].value, NULL, 7);
    write_band(text, "slip", &f->value[SLIP]);
    write_band(text, "rate", &f->value[RATE]);
    if (f->value[FAILURE].value != NULL && f->value[FAILURE].n > 0) {
        write_failures(text, f);
    }
    const lac_status status = write_estimates(text, f, err);
    lac_page_close(text, '}');
    return status;
}

lac_status lac_page_fit(const lac_page *page, lac_error *err)
{
    fitted f = {0};
    lac_status status = LAC_OK;
    if (page->def->fit == NULL) {
        return LAC_OK;
    }
    LAC_TRY(open_fit(page, &f, err));
    LAC_TRY(write_fit(page, &f, err));
out:
    clear(&f);
    return status;
}
