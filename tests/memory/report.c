// SPDX-License-Identifier: GPL-3.0-or-later
#include "memory/report.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
// cmocka needs the headers above first
#include <cmocka.h>

#include "lacuna/report.h"
#include "lacuna/store_fit.h"
#include "memory/whole_run.h"

enum { READINGS = 8, TIMES = 3, DRAWS = 4, QUANTILES = 5 };

static const double start = 1577836800.0; // of whole_run: 2020-01-01
static char run[] = "/tmp/lacuna-report-run-XXXXXX";
static char events[] = "/tmp/lacuna-report-events-XXXXXX";
static char fit[] = "/tmp/lacuna-report-fit-XXXXXX";

static void make_name(char *name)
{
    const int fd = mkstemp(name);
    assert_true(fd >= 0);
    (void)close(fd);
}

static lac_status store_fit(lac_error *err)
{
    static const double quantile[QUANTILES] = {0.05, 0.25, 0.5, 0.75, 0.95};
    static const double x[DRAWS] = {1.0, 2.0, 3.0, 4.0}, failure[DRAWS] = {90.0, 70.0, NAN, 80.0};
    static const double time[TIMES] = {0.0, 30.0, 60.0}, fitted[TIMES] = {0.0, 1e-6, 2e-6};
    static double band[QUANTILES * TIMES];
    const lac_fit_column column = {.key = "friction.aging.dc", .unit = "m", .best = 2.0};
    const lac_fit_view view = {.status = "complete",
                               .unknowns = 1,
                               .unknown = &column,
                               .chains = 2,
                               .draws = 2,
                               .x = x,
                               .log_density = x,
                               .acceptance = x,
                               .quantiles = QUANTILES,
                               .quantile = quantile,
                               .times = TIMES,
                               .time = time,
                               .displacement = band,
                               .rate = band,
                               .fitted = fitted,
                               .readings = TIMES,
                               .reading_time = time,
                               .observed = fitted,
                               .failures = DRAWS,
                               .failure = failure,
                               .dated = true,
                               .start_date = start};
    const lac_provenance provenance = {.title = "fitted", .seed = 1};
    return lac_store_fit(fit, true, &provenance, &view, err);
}

void report_prepare(void)
{
    lac_error err = {""};
    make_name(run);
    make_name(events);
    make_name(fit);
    assert_int_equal(whole_run(run, &err), LAC_OK);
    assert_int_equal(whole_resumed(events, &err), LAC_OK);
    assert_int_equal(store_fit(&err), LAC_OK);
}

void report_remove(void)
{
    (void)unlink(run);
    (void)unlink(events);
    (void)unlink(fit);
}

lac_status whole_report(const char *path, lac_error *err)
{
    double time[READINGS], displacement[READINGS];
    for (size_t i = 0; i < READINGS; i++) {
        time[i] = start + 2.0 * (double)i;
        displacement[i] = -1e-3 * log(10.0 - (double)i);
    }
    const lac_series series = {
        .n = READINGS, .dated = true, .time = time, .displacement = displacement};
    lac_report_def def = {
        .run = run, .series = &series, .series_name = "readings", .fit = fit, .made_by = "test"};
    lac_status status;
    LAC_TRY(lac_report_write(&def, path, true, err));
    def = (lac_report_def){.run = events, .made_by = "test"};
    LAC_TRY(lac_report_write(&def, path, true, err));
out:
    return status;
}
