// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of each station: its last readings in the order of time, whatever order they came
// in.
#include "watch/internal.h"

enum { COLUMNS = 4, FIRST_ROOM = 16 };

// The place of a name, or where it belongs.
static size_t find(const lac_stations *s, const char *name, bool *there)
{
    size_t low = 0, high = s->n;
    *there = false;
    while (low < high && !*there) {
        const size_t middle = low + (high - low) / 2;
        const int order = strcmp(s->at[middle]->name, name);
        *there = order == 0;
        low = order < 0 ? middle + 1 : *there ? middle : low;
        high = order > 0 ? middle : high;
    }
    return low;
}

static void free_station(lac_station *s)
{
    if (s != NULL) {
        free(s->time);
        free(s->name);
        free(s);
    }
}

lac_status lac_stations_find(lac_stations *s, const char *name, size_t most, lac_station **out,
                             lac_error *err)
{
    bool there;
    const size_t at = find(s, name, &there);
    *out = there ? s->at[at] : NULL;
    if (there || s->n >= most) {
        return LAC_OK;
    }
    LAC_TRY_RETURN(lac_grow((void *)&s->at, &s->room, s->n + 1, sizeof(lac_station *), err));
    lac_station *made = calloc(1, sizeof *made);
    if (made == NULL || (made->name = strdup(name)) == NULL) {
        free(made);
        return lac_fail_memory(err);
    }
    made->rate = made->chance = NAN;
    memmove(s->at + at + 1, s->at + at, (s->n - at) * sizeof(lac_station *));
    s->at[at] = *out = made;
    s->n++;
    return LAC_OK;
}

void lac_stations_clear(lac_stations *s)
{
    for (size_t i = 0; i < s->n; i++) {
        free_station(s->at[i]);
    }
    free(s->at);
    *s = (lac_stations){0};
}

lac_status lac_station_reserve(lac_station *s, size_t n, size_t count, lac_error *err)
{
    size_t room = s->room > 0 ? s->room : FIRST_ROOM;
    if (n <= s->room) {
        return LAC_OK;
    }
    while (room < n) {
        room *= 2;
    }
    room = room < count ? room : count + 1; // one more, before the oldest goes
    double *grown = malloc(COLUMNS * room * sizeof *grown);
    LAC_FAIL_MEMORY_IF(grown == NULL, err);
    double **const column[COLUMNS] = {&s->time, &s->displacement, &s->sigma, &s->digit};
    double *const old = s->time;
    for (size_t c = 0; c < COLUMNS; c++) {
        if (s->n > 0) {
            memcpy(grown + c * room, *column[c], s->n * sizeof *grown);
        }
        *column[c] = grown + c * room;
    }
    free(old);
    s->room = room;
    return LAC_OK;
}

static void drop_first(lac_station *s, size_t n)
{
    double *const column[COLUMNS] = {s->time, s->displacement, s->sigma, s->digit};
    s->n -= n;
    for (size_t c = 0; c < COLUMNS && n > 0; c++) {
        memmove(column[c], column[c] + n, s->n * sizeof *column[c]);
    }
}

static void insert(lac_station *s, size_t at, const lac_line *l)
{
    double *const column[COLUMNS] = {s->time, s->displacement, s->sigma, s->digit};
    const double value[COLUMNS] = {l->time, l->displacement, l->sigma, l->digit};
    for (size_t c = 0; c < COLUMNS; c++) {
        memmove(column[c] + at + 1, column[c] + at, (s->n - at) * sizeof *column[c]);
        column[c][at] = value[c];
    }
    s->n++;
}

// The first of two readings of a time stays; what it lacks comes from the other, as in a file.
static lac_taken merge(lac_station *s, size_t at, const lac_line *l)
{
    bool news = false;
    if (isnan(s->displacement[at]) && !isnan(l->displacement)) {
        s->displacement[at] = l->displacement;
        s->digit[at] = l->digit;
        news = true;
    }
    if (isnan(s->sigma[at]) && !isnan(l->sigma)) {
        s->sigma[at] = l->sigma;
        news = true;
    }
    return news ? LAC_TAKEN_LATE : LAC_TAKEN_DOUBLED;
}

static lac_taken count(lac_station *s, lac_taken taken)
{
    s->taken[taken]++;
    s->taken[LAC_TAKEN] += taken == LAC_TAKEN_LATE ? 1 : 0;
    return taken;
}

lac_status lac_station_take(lac_station *s, const lac_line *l, const lac_fleet *fleet,
                            double latest, lac_taken *out, lac_error *err)
{
    const size_t most = (size_t)fleet->window_count;
    const double time = fleet->window_time;
    size_t at = s->n, over = 0;
    if (l->dated && l->time > latest) { // one would make all that follow old
        *out = count(s, LAC_TAKEN_AHEAD);
        return LAC_OK;
    }
    while (at > 0 && s->time[at - 1] > l->time) {
        at--;
    }
    if (at > 0 && s->time[at - 1] == l->time) {
        *out = count(s, merge(s, at - 1, l));
        return LAC_OK;
    }
    if (s->n > 0 && ((at == 0 && s->n >= most) || l->time < s->time[s->n - 1] - time)) {
        *out = count(s, LAC_TAKEN_OLD);
        return LAC_OK;
    }
    LAC_TRY_RETURN(lac_station_reserve(s, s->n + 1, most, err));
    *out = count(s, at < s->n ? LAC_TAKEN_LATE : LAC_TAKEN);
    insert(s, at, l);
    over = s->n > most ? s->n - most : 0;
    while (s->time[over] < s->time[s->n - 1] - time) {
        over++;
    }
    drop_first(s, over);
    return LAC_OK;
}
