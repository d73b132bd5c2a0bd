// SPDX-License-Identifier: GPL-3.0-or-later
// The rows of a file in the order of time, each time once.
#include <math.h>
#include <stdlib.h>

#include "series/text.h"

static int compare(const void *left, const void *right)
{
    const lac_row *a = left;
    const lac_row *b = right;
    if (a->time != b->time) {
        return a->time < b->time ? -1 : 1;
    }
    return a->line < b->line ? -1 : a->line > b->line;
}

size_t lac_rows_sort(size_t n, lac_row *rows)
{
    size_t disordered = 0;
    for (size_t i = 1; i < n; i++) {
        disordered += rows[i].time < rows[i - 1].time ? 1 : 0;
    }
    if (disordered > 0) {
        qsort(rows, n, sizeof *rows, compare);
    }
    return disordered;
}

// Whether a value of the later row is another one.
static bool merge(lac_row *first, const lac_row *later)
{
    bool differs = false;
    for (size_t c = 0; c < LAC_SERIES_VALUES; c++) {
        if (isnan(first->value[c])) {
            first->value[c] = later->value[c];
        }
        differs = differs || (!isnan(later->value[c]) && later->value[c] != first->value[c]);
    }
    return differs;
}

size_t lac_rows_merge(size_t *n, lac_row *rows, size_t *conflicts)
{
    size_t kept = 0;
    size_t line = 0;
    *conflicts = 0;
    for (size_t i = 1; i < *n; i++) {
        if (rows[i].time != rows[kept].time) {
            rows[++kept] = rows[i];
        } else if (merge(&rows[kept], &rows[i])) {
            line = line == 0 || rows[i].line < line ? rows[i].line : line;
            (*conflicts)++;
        }
    }
    *n = kept + 1;
    return line;
}
