// SPDX-License-Identifier: GPL-3.0-or-later
// CPU time a reading of `lacuna watch`: of 1 000 stations with 50 readings each, the quiet ones,
// those that accelerate, and both as they come; then of one quiet station whose window is full.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "watch/watch.h"

#include "support/cost.h"

enum { STATIONS = 1000, READINGS = 50, ONE_IN = 10, LINE = 80 };

static const char fleet_text[] = "columns: [station, time, moved]\n"
                                 "displacement: \"moved:mm\"\n"
                                 "window: {count: 2000}\n";

static void stop(const lac_error *err)
{
    fprintf(stderr, "bench_watch: %s\n", err->message);
    exit(1);
}

// A noise of 1 mm, near enough: the sum of three uniform numbers.
static double noise(void)
{
    double sum = -1.5;
    for (int i = 0; i < 3; i++) {
        sum += (double)rand() / (double)RAND_MAX;
    }
    return 2.0 * sum;
}

typedef struct load {
    size_t stations, readings;
    bool quiet, fast; // which are sent
} load;

static double measure(const lac_fleet *fleet, const lac_units *units, const load *l,
                      lac_watch_counts *counts)
{
    lac_error err = {""};
    lac_watch_def def = {
        .fleet = fleet, .units = units, .forecast = lac_forecast_default(), .out = NULL};
    lac_watch *watch = NULL;
    char line[LINE];
    def.forecast.window_count = (size_t)fleet->window_count;
    def.out = fopen("/dev/null", "w");
    if (def.out == NULL || lac_watch_create(&def, &watch, &err) != LAC_OK) {
        stop(&err);
    }
    srand(1);
    const double start = cpu_seconds();
    for (size_t k = 0; k < l->readings; k++) {
        for (size_t s = 0; s < l->stations; s++) {
            const bool fast = s % ONE_IN == 0 && l->stations > 1;
            const double life = 1.1 * (double)l->readings, day = (double)k;
            const double moved = fast ? -300.0 * log(1.0 - day / life) : 0.02 * day;
            const int n = snprintf(line, sizeof line, "P%04zu,%.0f,%.1f\n", s, 86400.0 * day,
                                   moved + (fast ? 0.3 : 1.0) * noise());
            if ((fast ? l->fast : l->quiet) &&
                lac_watch_stream(watch, line, (size_t)n, &err) != LAC_OK) {
                stop(&err);
            }
        }
    }
    const double spent = cpu_seconds() - start;
    *counts = lac_watch_count(watch);
    lac_watch_free(watch);
    (void)fclose(def.out);
    return spent;
}

int main(void)
{
    static const struct {
        const char *name;
        load load;
    } row[] = {{"quiet stations", {STATIONS, READINGS, true, false}},
               {"one quiet, 10 000 readings", {1, 10000, true, false}},
               {"accelerating ones", {STATIONS, READINGS, false, true}},
               {"both, a tenth accelerating", {STATIONS, READINGS, true, true}}};
    char path[] = "/tmp/bench-watch-XXXXXX";
    lac_error err = {""};
    lac_units *units = NULL;
    lac_fleet *fleet = NULL;
    const int fd = mkstemp(path);
    const bool written = fd >= 0 && write(fd, fleet_text, sizeof fleet_text - 1) > 0;
    if (!written || lac_units_create(&units, &err) != LAC_OK ||
        lac_fleet_read(path, units, &fleet, &err) != LAC_OK) {
        stop(&err);
    }
    (void)close(fd);
    (void)unlink(path);
    printf("%-28s %9s %9s %11s\n", "what", "readings", "CPU s", "ms/reading");
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        lac_watch_counts counts;
        const double spent = measure(fleet, units, &row[i].load, &counts);
        printf("%-28s %9llu %9.2f %11.3f\n", row[i].name, (unsigned long long)counts.readings,
               spent, 1e3 * spent / (double)counts.readings);
        (void)fflush(stdout);
    }
    lac_fleet_free(fleet);
    lac_units_free(units);
    return 0;
}
