// SPDX-License-Identifier: GPL-3.0-or-later
// Standard input: bytes to whole lines, noted before they are looked at; lines that are sent again
// are skipped.
#include "watch/internal.h"

const char lac_watch_too_long[] = "the line is longer than 65535 bytes";
static const char source[] = "standard input";

static lac_status keep(lac_watch *w, const char *bytes, size_t n, lac_error *err)
{
    const size_t need = w->waiting + n;
    LAC_TRY_RETURN(lac_grow(&w->pending, &w->room, need, 1, err));
    if (n > 0) {
        memcpy(w->pending + w->waiting, bytes, n);
    }
    w->waiting = need;
    return LAC_OK;
}

// A line of the beginning that the state knows already.
static lac_status skip(lac_watch *w, const char *line, size_t n, lac_error *err)
{
    w->skipped = lac_sum_bytes(w->skipped, line, n);
    w->skip--;
    LAC_FAIL_IF(w->skip == 0 && w->skipped != w->sum, err, LAC_EINPUT,
                "%s: its first %llu lines are not those that %s was made from: a stream that "
                "begins with what is new is `stream: live` in %s",
                source, (unsigned long long)w->counts.lines, w->def.state, w->def.fleet->path);
    return LAC_OK;
}

// @param line  [n] ends in its '\n', which is taken off
static lac_status take(lac_watch *w, char *line, size_t n, lac_error *err)
{
    w->counts.lines++;
    w->sum = lac_sum_bytes(w->sum, line, n);
    line[n - 1] = '\0';
    if (n > 1 && line[n - 2] == '\r') {
        line[n - 2] = '\0';
    }
    if (n > LAC_WATCH_LINE || strlen(line) + 2 < n) {
        w->since++;
        lac_watch_blame(w, source, w->counts.lines, NULL,
                        n > LAC_WATCH_LINE ? lac_watch_too_long
                                           : "the line holds bytes that are not text",
                        line);
        return LAC_OK;
    }
    return lac_watch_line(w, w->reader, NULL, line, source, w->counts.lines, err);
}

// All whole lines in bytes that end in one.
static lac_status take_all(lac_watch *w, char *bytes, size_t n, lac_error *err)
{
    size_t first = 0;
    for (size_t i = 0; i < n; i++) {
        if (bytes[i] == '\n') {
            LAC_TRY_RETURN(take(w, bytes + first, i + 1 - first, err));
            first = i + 1;
        }
    }
    return LAC_OK;
}

// Bytes of the lines to be skipped.
static lac_status skip_all(lac_watch *w, size_t n, size_t *skipped, lac_error *err)
{
    size_t first = 0;
    for (size_t i = 0; i < n && w->skip > 0; i++) {
        if (w->pending[i] == '\n') {
            LAC_TRY_RETURN(skip(w, w->pending + first, i + 1 - first, err));
            first = i + 1;
        }
    }
    *skipped = first;
    return LAC_OK;
}

static lac_status take_waiting(lac_watch *w, size_t whole, lac_error *err)
{
    size_t skipped = 0;
    LAC_TRY_RETURN(skip_all(w, whole, &skipped, err));
    LAC_TRY_RETURN(lac_watch_note(w, w->pending + skipped, whole - skipped, err));
    const lac_status status = take_all(w, w->pending + skipped, whole - skipped, err);
    if (status == LAC_EINPUT && w->counts.readings == 0) {
        lac_watch_forget(w); // a wrong header: nothing was begun
    }
    w->waiting -= whole;
    memmove(w->pending, w->pending + whole, w->waiting);
    return status == LAC_OK ? lac_watch_flush(w, false, err) : status;
}

// Of a line that is too long no more than its begin waits, however it was cut.
lac_status lac_watch_stream(lac_watch *w, const char *bytes, size_t n, lac_error *err)
{
    size_t whole = 0;
    for (size_t at = 0; at < n;) {
        const char *end = memchr(bytes + at, '\n', n - at);
        const size_t length = end != NULL ? (size_t)(end - bytes) - at : n - at;
        const size_t room = LAC_WATCH_LINE - (w->waiting - whole);
        LAC_TRY_RETURN(keep(w, bytes + at, length < room ? length : room, err));
        LAC_TRY_RETURN(end != NULL ? keep(w, "\n", 1, err) : LAC_OK);
        whole = end != NULL ? w->waiting : whole;
        at += length + 1;
    }
    return whole > 0 ? take_waiting(w, whole, err) : LAC_OK;
}

size_t lac_watch_waiting(const lac_watch *w) { return w->waiting; }

uint64_t lac_watch_missing(const lac_watch *w) { return w->skip; }
