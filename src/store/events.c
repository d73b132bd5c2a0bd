// SPDX-License-Identifier: GPL-3.0-or-later
// The catalogue of events in a run's file: one line an event, as they end.
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "store/internal.h"

enum { EVENT_CHUNK = 512, TIME = 0 };

#define AT(member) offsetof(lac_event, member)
#define PLACES "event_time event_x event_y"

const lac_column lac_event_columns[LAC_EVENT_COLUMNS] = {
    {{.name = "event_time",
      .long_name = "start of the event since the start of the run",
      .comment = "its first cell comes to the slip rate of analysis.events; lines are in the order "
                 "in which events end",
      .type = NC_DOUBLE},
     0},
    {{.name = "event_duration",
      .unit = "s",
      .long_name = "time from the start of the event to the fall of its last cell",
      .coordinates = PLACES,
      .type = NC_DOUBLE},
     AT(duration)},
    {{.name = "event_cells",
      .unit = "1",
      .long_name = "different cells that moved in the event",
      .coordinates = PLACES,
      .type = NC_INT64},
     AT(cells)},
    {{.name = "event_potency",
      .unit = "m3",
      .long_name = "sum over the event's cells of area times slip while moving",
      .coordinates = PLACES,
      .type = NC_DOUBLE},
     AT(potency)},
    {{.name = "event_moment",
      .unit = "N m",
      .long_name = "shear modulus times potency of the event",
      .comment = "missing where the case gives no material.shear_modulus",
      .coordinates = PLACES,
      .type = NC_DOUBLE,
      .fill = true},
     AT(moment)},
    {{.name = "event_size",
      .unit = "m",
      .long_name = "longest side of the cells that moved in the event",
      .comment = "along x or y, round periodic edges; of a line along it",
      .coordinates = PLACES,
      .type = NC_DOUBLE},
     AT(size)},
    {{.name = "event_x",
      .unit = "m",
      .long_name = "position along x of the first cell that moved",
      .type = NC_DOUBLE},
     AT(x)},
    {{.name = "event_y",
      .unit = "m",
      .long_name = "position along y of the first cell that moved",
      .type = NC_DOUBLE},
     AT(y)},
    {{.name = "event_max_slip_rate",
      .unit = "m s-1",
      .long_name = "largest slip rate of a cell of the event at the end of a step",
      .coordinates = PLACES,
      .type = NC_DOUBLE},
     AT(max_rate)},
    {{.name = "event_cut",
      .unit = "1",
      .long_name = "ends of the event that lie outside the run",
      .comment = "where any do, duration, cells, moment and size are at least what is given",
      .coordinates = PLACES,
      .type = NC_INT64},
     AT(cut)},
};

lac_status lac_store_create_events(lac_store *s, lac_error *err)
{
    s->events = malloc(s->capacity * sizeof *s->events);
    return s->events != NULL ? LAC_OK : lac_fail_memory(err);
}

lac_status lac_store_define_events(lac_store *s, lac_error *err)
{
    const long long values[] = {0, LAC_EVENT_BEGUN_BEFORE, LAC_EVENT_UNENDED,
                                LAC_EVENT_BEGUN_BEFORE | LAC_EVENT_UNENDED};
    const size_t chunk = EVENT_CHUNK;
    lac_status status = LAC_OK;
    int dim = 0;
    LAC_TRY(lac_nc_dim(&s->file, "event", NC_UNLIMITED, &dim, err));
    for (size_t c = 0; c < LAC_EVENT_COLUMNS; c++) {
        lac_nc_var var = lac_event_columns[c].var;
        var.appended = true;
        if (c == TIME) {
            var.unit = s->time_unit;
            var.standard_name = s->dated ? "time" : NULL;
        }
        LAC_TRY(lac_nc_define(&s->file, &var, 1, &dim, &chunk, 0, &s->event_ids[c], err));
    }
    if (s->dated) {
        LAC_TRY(lac_nc_text(&s->file, s->event_ids[TIME], "calendar", "proleptic_gregorian", err));
    }
    int cut = s->event_ids[LAC_EVENT_COLUMNS - 1];
    LAC_TRY(lac_nc_text(&s->file, cut, "flag_meanings", "whole begun_before unended both", err));
    LAC_TRY(lac_nc_check(s->file.path,
                         nc_put_att_longlong(s->file.id, cut, "flag_values", NC_INT64, 4, values),
                         err, "define", "event_cut"));
out:
    return status;
}

static int put_column(const lac_store *s, size_t c, double *reals, long long *integers)
{
    const size_t *start = &s->events_written;
    const size_t *count = &s->events_buffered;
    for (size_t i = 0; i < *count; i++) {
        const lac_event *event = &s->events[i];
        const char *at = (const char *)event + lac_event_columns[c].offset;
        if (lac_event_columns[c].var.type == NC_INT64) {
            int64_t value;
            memcpy(&value, at, sizeof value);
            integers[i] = value;
            continue;
        }
        memcpy(&reals[i], at, sizeof reals[i]);
        if (c == TIME) {
            reals[i] = event->time_origin + event->time_local;
        }
        if (isnan(reals[i])) {
            reals[i] = NC_FILL_DOUBLE;
        }
    }
    return lac_event_columns[c].var.type == NC_INT64
               ? lac_nc_append(&s->file, NC_INT64, s->event_ids[c], start, count, integers)
               : lac_nc_append(&s->file, NC_DOUBLE, s->event_ids[c], start, count, reals);
}

lac_status lac_store_write_events(lac_store *s, lac_error *err)
{
    lac_status status = LAC_OK;
    if (s->events_buffered == 0) {
        return LAC_OK;
    }
    double *reals = malloc(s->events_buffered * sizeof *reals);
    long long *integers = malloc(s->events_buffered * sizeof *integers);
    if (reals == NULL || integers == NULL) {
        LAC_TRY(lac_fail_memory(err));
    }
    LAC_TRY(lac_store_reserve(s, s->events_buffered * sizeof *s->events, err));
    for (size_t c = 0; c < LAC_EVENT_COLUMNS; c++) {
        errno = 0;
        LAC_TRY(lac_nc_check(s->file.path, put_column(s, c, reals, integers), err, "write",
                             lac_event_columns[c].var.name));
    }
    s->events_written += s->events_buffered;
    s->events_buffered = 0;
out:
    free(reals);
    free(integers);
    return status;
}

lac_status lac_store_put_event(void *context, const lac_event *event, lac_error *err)
{
    lac_store *s = context;
    lac_status status = s->events_buffered == s->capacity ? lac_store_write_events(s, err) : LAC_OK;
    if (status == LAC_OK) {
        s->events[s->events_buffered++] = *event;
        status = lac_store_count(s, err);
    }
    return status;
}
