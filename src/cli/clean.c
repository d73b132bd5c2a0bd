// SPDX-License-Identifier: GPL-3.0-or-later
// What is printed reaches a terminal without control characters, wherever a text comes from.
#define _GNU_SOURCE // fopencookie
#include "cli/clean.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { C1_LEAD = 0xc2, BLOCK = 4096 }; // in UTF-8 the controls 0x80 to 0x9f follow this byte

size_t cli_clean(char *text, size_t n)
{
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        const unsigned char c = (unsigned char)text[i];
        const bool second = kept > 0 && (unsigned char)text[kept - 1] == C1_LEAD;
        if (second && c >= 0x80 && c <= 0x9f) {
            text[kept - 1] = '?';
        } else {
            text[kept++] = (c < 0x20 && c != '\n' && c != '\t') || c == 0x7f ? '?' : text[i];
        }
    }
    return kept;
}

static bool write_all(const char *text, size_t n)
{
    while (n > 0) {
        const ssize_t done = write(STDOUT_FILENO, text, n);
        if (done < 0 && errno != EINTR) {
            return false;
        }
        text += done > 0 ? done : 0;
        n -= done > 0 ? (size_t)done : 0;
    }
    return true;
}

// A first byte of two that stands last waits for the other.
static ssize_t write_clean(void *context, const char *text, size_t n)
{
    bool *waits = context;
    char block[BLOCK + 1];
    for (size_t done = 0; done < n;) {
        const size_t more = n - done < BLOCK ? n - done : BLOCK;
        size_t filled = *waits ? 1 : 0;
        block[0] = (char)C1_LEAD;
        memcpy(block + filled, text + done, more);
        filled = cli_clean(block, filled + more);
        *waits = (unsigned char)block[filled - 1] == C1_LEAD;
        if (!write_all(block, filled - (*waits ? 1 : 0))) {
            return 0;
        }
        done += more;
    }
    return (ssize_t)n;
}

void cli_clean_stdout(void)
{
    static bool waits;
    const cookie_io_functions_t functions = {.write = write_clean};
    FILE *clean = fopencookie(&waits, "w", functions);
    if (clean != NULL) {
        (void)setvbuf(clean, NULL, isatty(STDOUT_FILENO) == 1 ? _IOLBF : _IOFBF, BUFSIZ);
        stdout = clean;
    }
}
