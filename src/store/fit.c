// SPDX-License-Identifier: GPL-3.0-or-later
// The file of a fit: the posterior's draws, the predicted series, the readings.
#include "lacuna/store_fit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/date.h"
#include "store/nc.h"

enum { CHAIN, DRAW, QUANTILE, PREDICTION, READING, SAMPLE, DIMENSIONS };

typedef struct writer {
    const lac_nc *file;
    const lac_fit_view *view;
    int dim[DIMENSIONS];
    char time_unit[64];
    double time_shift; // what the unit's whole second leaves of the start [s]
    double *row;       // room for the largest variable
} writer;

// Writes w->row as a variable over one or two dimensions, or of none.
static lac_status put(writer *w, const lac_nc_var *var, int rank, const int *dims, int *id,
                      lac_error *err)
{
    return lac_nc_reals(w->file, var, rank, dims, rank > 1 ? 1 : 0, w->row, id, err);
}

static double kept(double value) { return isfinite(value) ? value : NC_FILL_DOUBLE; }

static void copy(writer *w, size_t n, const double *from, double shift)
{
    for (size_t i = 0; i < n; i++) {
        w->row[i] = kept(from[i] + shift);
    }
}

// "friction.aging.dc" as a name that every tool takes.
static void name_of(const char *key, char *name, size_t size)
{
    (void)snprintf(name, size, "%s", key);
    for (char *c = name; *c != '\0'; c++) {
        *c = *c == '.' || *c == '-' ? '_' : *c;
    }
}

// Draws of one unknown over (chain, draw), or its best value alone.
static lac_status put_unknown(writer *w, size_t k, lac_error *err)
{
    const lac_fit_view *view = w->view;
    const lac_fit_column *of = &view->unknown[k];
    char name[256];
    char title[300];
    name_of(of->key, name, sizeof name);
    (void)snprintf(title, sizeof title, "%s of %s",
                   view->draws > 0 ? "posterior draws" : "best fit", of->key);
    const lac_nc_var var = {.name = name, .unit = of->unit, .long_name = title, .type = NC_DOUBLE};
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"best_fit", of->best},
                   {of->log ? "standard_error_of_logarithm" : "standard_error", of->error},
                   {"best_fit_at_end_of_range", of->limit},
                   {"rhat", of->rhat},
                   {"effective_sample_size", of->ess}};
    for (size_t c = 0; c < view->chains; c++) {
        for (size_t i = 0; i < view->draws; i++) {
            double x = view->x[(i * view->chains + c) * view->unknowns + k];
            w->row[c * view->draws + i] = kept(of->log ? exp(x) : x);
        }
    }
    if (view->draws == 0) {
        w->row[0] = kept(of->best);
    }
    int id = 0;
    const int dims[] = {w->dim[CHAIN], w->dim[DRAW]};
    lac_status status = put(w, &var, view->draws > 0 ? 2 : 0, dims, &id, err);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        if (status == LAC_OK && isfinite(numbers[i].value)) {
            status = lac_nc_real(w->file, id, numbers[i].name, numbers[i].value, err);
        }
    }
    return status == LAC_OK ? lac_nc_text(w->file, id, "case_key", of->key, err) : status;
}

static lac_status put_chain(writer *w, lac_error *err)
{
    const lac_fit_view *view = w->view;
    const int dims[] = {w->dim[CHAIN], w->dim[DRAW]};
    const lac_nc_var density = {.name = "log_posterior",
                                .unit = "1",
                                .long_name =
                                    "logarithm of the posterior density of the coordinates, "
                                    "up to a constant",
                                .type = NC_DOUBLE};
    const lac_nc_var acceptance = {.name = "acceptance",
                                   .unit = "1",
                                   .long_name = "share of a walker's moves that were accepted",
                                   .type = NC_DOUBLE};
    int id = 0;
    for (size_t c = 0; c < view->chains; c++) {
        for (size_t i = 0; i < view->draws; i++) {
            w->row[c * view->draws + i] = kept(view->log_density[i * view->chains + c]);
        }
    }
    lac_status status = put(w, &density, 2, dims, &id, err);
    if (status != LAC_OK) {
        return status;
    }
    copy(w, view->chains, view->acceptance, 0.0);
    return put(w, &acceptance, 1, dims, &id, err);
}

// One variable of the series, in the order of `series_of`.
typedef struct series_row {
    const char *name, *unit; // NULL: a time
    const char *long_name;
    int rank, dims[2]; // indices of the writer's
    bool whole;        // nothing is ever missing
} series_row;

static const series_row series_rows[] = {
    {"quantile", "1", "share of the posterior below", 1, {QUANTILE}, true},
    {"prediction_time", NULL, "time of a prediction", 1, {PREDICTION}, true},
    {"best_displacement",
     "m",
     "displacement of the best fit, its zero that of the data",
     1,
     {PREDICTION},
     false},
    {"predicted_displacement",
     "m",
     "quantiles of the posterior's displacement; missing beyond failure",
     2,
     {QUANTILE, PREDICTION},
     false},
    {"predicted_slip_rate",
     "m s-1",
     "quantiles of the posterior's slip rate; missing beyond failure",
     2,
     {QUANTILE, PREDICTION},
     false},
    {"reading_time", NULL, "time of a reading", 1, {READING}, true},
    {"observed_displacement", "m", "displacement that was read", 1, {READING}, false},
    {"observed_slip_rate", "m s-1", "velocity that was read", 1, {READING}, false},
    {"failure_time",
     NULL,
     "time of failure of draws that were run on; missing where none by the end of the run",
     1,
     {SAMPLE},
     false},
};

enum { SERIES_ROWS = sizeof series_rows / sizeof series_rows[0] };

// What the rows hold; NULL: not there.
static void series_of(const lac_fit_view *v, const double *from[SERIES_ROWS], size_t n[SERIES_ROWS])
{
    const size_t all = v->quantiles * v->times;
    const double *const values[] = {v->quantile,     v->time,          v->fitted,
                                    v->displacement, v->rate,          v->reading_time,
                                    v->observed,     v->observed_rate, v->failure};
    const size_t lengths[] = {v->quantiles, v->times,    v->times,    all,        all,
                              v->readings,  v->readings, v->readings, v->failures};
    for (size_t i = 0; i < SERIES_ROWS; i++) {
        from[i] = values[i];
        n[i] = lengths[i];
    }
}

static lac_status put_series(writer *w, lac_error *err)
{
    const double *from[SERIES_ROWS];
    size_t n[SERIES_ROWS];
    lac_status status = LAC_OK;
    series_of(w->view, from, n);
    for (size_t i = 0; i < SERIES_ROWS; i++) {
        const series_row *row = &series_rows[i];
        const lac_nc_var var = {.name = row->name,
                                .unit = row->unit != NULL ? row->unit : w->time_unit,
                                .long_name = row->long_name,
                                .type = NC_DOUBLE,
                                .fill = !row->whole};
        int dims[2] = {w->dim[row->dims[0]], w->dim[row->dims[1]]};
        int id = 0;
        if (from[i] == NULL || n[i] == 0) {
            continue;
        }
        copy(w, n[i], from[i], row->unit == NULL ? w->time_shift : 0.0);
        LAC_TRY(put(w, &var, row->rank, dims, &id, err));
    }
out:
    return status;
}

static void set_time_unit(writer *w)
{
    const lac_fit_view *view = w->view;
    char date[32] = "";
    double whole = floor(view->start_date);
    (void)snprintf(w->time_unit, sizeof w->time_unit, "s");
    if (view->dated && lac_date_format(whole, date, sizeof date)[0] != '\0') {
        (void)snprintf(w->time_unit, sizeof w->time_unit, "seconds since %s", date);
        w->time_shift = view->start_date - whole;
    }
}

static lac_status put_all(const lac_nc *file, void *context, lac_error *err)
{
    writer *w = context;
    w->file = file;
    const lac_fit_view *view = w->view;
    static const char *const names[DIMENSIONS] = {"chain",      "draw",    "quantile",
                                                  "prediction", "reading", "sample"};
    const size_t length[DIMENSIONS] = {view->chains, view->draws,    view->quantiles,
                                       view->times,  view->readings, view->failures};
    lac_status status = LAC_OK;
    for (int i = 0; i < DIMENSIONS; i++) {
        if (length[i] > 0) { // 0 would be a dimension without end
            LAC_TRY(lac_nc_dim(w->file, names[i], length[i], &w->dim[i], err));
        }
    }
    for (size_t k = 0; k < view->unknowns; k++) {
        LAC_TRY(put_unknown(w, k, err));
    }
    if (view->draws > 0) {
        LAC_TRY(put_chain(w, err));
    }
    LAC_TRY(put_series(w, err));
    LAC_TRY(lac_nc_text(file, NC_GLOBAL, "status", view->status, err));
out:
    return status;
}

lac_status lac_store_fit(const char *path, bool force, const lac_provenance *provenance,
                         const lac_fit_view *view, lac_error *err)
{
    static const char *const summary =
        "Parameters of a creep model fitted to a monitoring series: draws of the posterior, "
        "predicted series and times of failure.";
    writer w = {.view = view};
    size_t most = view->chains * view->draws + view->chains + view->quantiles * view->times +
                  view->times + view->readings + view->failures + 1;
    set_time_unit(&w);
    w.row = calloc(most, sizeof *w.row);
    lac_status status = w.row != NULL
                            ? lac_nc_write(path, force, provenance, summary, put_all, &w, err)
                            : lac_fail_memory(err);
    free(w.row);
    return status;
}
