// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/words.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"

enum { LONGEST_WORD = 64 };

static size_t least(size_t a, size_t b, size_t c)
{
    size_t ab = a < b ? a : b;
    return ab < c ? ab : c;
}

// Optimal string alignment distance, three rows at a time.
static size_t distance(const char *a, const char *b)
{
    size_t rows[3][LONGEST_WORD + 1], na = strlen(a), nb = strlen(b);
    if (na > LONGEST_WORD || nb > LONGEST_WORD) {
        return na > nb ? na : nb;
    }
    for (size_t j = 0; j <= nb; j++) {
        rows[0][j] = j;
    }
    for (size_t i = 1; i <= na; i++) {
        size_t *now = rows[i % 3], *above = rows[(i + 2) % 3], *twice = rows[(i + 1) % 3];
        now[0] = i;
        for (size_t j = 1; j <= nb; j++) {
            size_t change = above[j - 1] + (a[i - 1] != b[j - 1]);
            now[j] = least(above[j] + 1, now[j - 1] + 1, change);
            bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swapped && twice[j - 2] + 1 < now[j]) {
                now[j] = twice[j - 2] + 1;
            }
        }
    }
    return rows[na % 3][nb];
}

const char *cli_nearest(const char *word, const char *const *candidates, size_t count)
{
    size_t best = 0;
    for (size_t i = 1; i < count; i++) {
        if (distance(word, candidates[i]) < distance(word, candidates[best])) {
            best = i;
        }
    }
    return candidates[best];
}

void cli_row(const char *label, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    printf("  %-20s ", label);
    (void)vprintf(format, args);
    putchar('\n');
    va_end(args);
}

void cli_row_quantity(const char *label, double value, const char *unit)
{
    char text[64];
    cli_row(label, "%s", lac_units_format(value, unit, text, sizeof text));
}

void cli_wrap(const char *indent, const char *text)
{
    size_t width = 79 - strlen(indent), column = 0;
    while (*text != '\0') {
        size_t word = strcspn(text, " \n");
        if (column > 0 && column + 1 + word > width) {
            putchar('\n');
            column = 0;
        }
        if (word > 0) {
            printf("%s%.*s", column == 0 ? indent : " ", (int)word, text);
            column += word + (column > 0);
        }
        text += word;
        text += strspn(text, " \n");
    }
    if (column > 0) {
        putchar('\n');
    }
}
