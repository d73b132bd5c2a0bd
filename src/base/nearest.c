// SPDX-License-Identifier: GPL-3.0-or-later
// The known word that a misspelt one was probably meant to be, for messages: "did you mean ...?"
#include "base/nearest.h"

#include <ctype.h>

enum { LONGEST_WORD = 40 };

static size_t least(size_t a, size_t b) { return a < b ? a : b; }

// Small and capital letters, hyphen and underscore are alike to a hasty writer.
static char plain(char c) { return c == '-' ? '_' : (char)tolower((unsigned char)c); }

// Letters to add, drop, change or swap with the next to turn one word into the other
// (optimal string alignment).
static size_t distance(const char *a, const char *b)
{
    size_t n = strlen(a), m = strlen(b);
    size_t row[LONGEST_WORD + 1][LONGEST_WORD + 1];
    for (size_t i = 0; i <= n; i++) {
        for (size_t j = 0; j <= m; j++) {
            if (i == 0 || j == 0) {
                row[i][j] = i + j;
                continue;
            }
            bool same = plain(a[i - 1]) == plain(b[j - 1]);
            size_t d = row[i - 1][j - 1] + (same ? 0 : 1);
            d = least(d, least(row[i - 1][j], row[i][j - 1]) + 1);
            if (i > 1 && j > 1 && plain(a[i - 1]) == plain(b[j - 2]) &&
                plain(a[i - 2]) == plain(b[j - 1])) {
                d = least(d, row[i - 2][j - 2] + 1);
            }
            row[i][j] = d;
        }
    }
    return row[n][m];
}

const char *lac_nearest(const char *word, const char *const *known, size_t count)
{
    const char *near = NULL;
    size_t length = strlen(word);
    size_t most = (length + 1) / 3; // of a word of two letters one may be wrong
    if (length > LONGEST_WORD) {
        return NULL;
    }
    for (size_t i = 0; i < count; i++) {
        size_t d = strlen(known[i]) <= LONGEST_WORD ? distance(word, known[i]) : most + 1;
        if (d <= most && (near == NULL || d < most)) {
            near = known[i];
            most = d;
        }
    }
    return near;
}
