// SPDX-License-Identifier: GPL-3.0-or-later
// What is printed reaches a terminal without control characters, wherever a text comes from.
#define _GNU_SOURCE // fopencookie
#include "cli/common/clean.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/hidden.h"

enum { BLOCK = 4096, HELD = 4 };

// The first bytes of a character whose others have not come.
typedef struct held {
    char bytes[HELD];
    size_t count;
} held;

size_t cli_clean(char *text, size_t n)
{
    size_t kept = 0;
    for (size_t i = 0; i < n;) {
        const unsigned char c = (unsigned char)text[i];
        const size_t hidden = c < 0x80 ? 0 : lac_hidden_length(text + i, n - i);
        const bool control = (c < 0x20 && c != '\n' && c != '\t') || c == 0x7f;
        text[kept++] = control || hidden > 0 ? '?' : text[i];
        i += hidden > 0 ? hidden : 1;
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

static ssize_t write_clean(void *context, const char *text, size_t n)
{
    held *h = context;
    char block[BLOCK + HELD];
    for (size_t done = 0; done < n;) {
        const size_t more = n - done < BLOCK ? n - done : BLOCK;
        memcpy(block, h->bytes, h->count);
        memcpy(block + h->count, text + done, more);
        const size_t filled = cli_clean(block, h->count + more);
        h->count = lac_hidden_begun(block, filled);
        memcpy(h->bytes, block + filled - h->count, h->count);
        if (!write_all(block, filled - h->count)) {
            return 0;
        }
        done += more;
    }
    return (ssize_t)n;
}

void cli_clean_stdout(void)
{
    static held begun;
    const cookie_io_functions_t functions = {.write = write_clean};
    FILE *clean = fopencookie(&begun, "w", functions);
    if (clean != NULL) {
        (void)setvbuf(clean, NULL, isatty(STDOUT_FILENO) == 1 ? _IOLBF : _IOFBF, BUFSIZ);
        stdout = clean;
    }
}
