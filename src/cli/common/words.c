// SPDX-License-Identifier: GPL-3.0-or-later
// How the program talks: notes on stderr, rows on stdout, the nearest word to an unknown one; and
// nothing that it prints holds control characters, wherever a text comes from.
#define _GNU_SOURCE // fopencookie
#include "cli/common/words.h"

#include <stdarg.h>
#include <unistd.h>

#include "base/date.h"
#include "base/hidden.h"
#include "base/nearest.h"
#include "base/temp_file.h"
#include "base/units.h"

enum { MOST_ROWS = 128, BLOCK = 4096, HELD = 4 }; // rows: of a table that words are looked up in

lac_status cli_unknown(const char *where, const char *word, const char *what,
                       const char *const *known, size_t count, lac_error *err)
{
    const char *near = lac_nearest(word, known, count);
    LAC_FAIL_IF(near != NULL, err, LAC_EINPUT, "%s\"%.60s\" is no %s; did you mean \"%s\"?", where,
                word, what, near);
    char list[512] = "";
    for (size_t i = 0; i < count; i++) {
        lac_append(list, sizeof list, "%s %s", i == 0 ? "" : ",", known[i]);
    }
    return lac_fail(err, LAC_EINPUT, "%s\"%.60s\" is no %s; known:%s", where, word, what, list);
}

const void *cli_find(const char *where, const char *word, const char *what, const void *rows,
                     size_t stride, lac_error *err)
{
    const char *names[MOST_ROWS], *row = rows;
    size_t n = 0;
    for (; n < MOST_ROWS && *(const char *const *)(const void *)row != NULL; row += stride) {
        names[n] = *(const char *const *)(const void *)row;
        if (strcmp(names[n++], word) == 0) {
            return row;
        }
    }
    (void)cli_unknown(where, word, what, names, n, err);
    return NULL;
}

lac_status cli_count(const char *option, const char *text, int most, int *out, lac_error *err)
{
    char *end;
    const long n = strtol(text, &end, 10);
    LAC_FAIL_IF(end == text || *end != '\0' || n < 1 || n > most, err, LAC_EINPUT,
                "%s: \"%s\" must be a number from 1 to %d", option, text, most);
    *out = (int)n;
    return LAC_OK;
}

// The first bytes of a character whose others have not come.
typedef struct held {
    char bytes[HELD];
    size_t count;
} held;

// Puts '?' in the place of control characters in UTF-8 (C0 but tab and newline, DEL) and of hidden
// ones (lac_hidden_length): those of a title, a column or a file's name are no commands to a
// terminal, and turn no line around. @return characters that are left
static size_t clean(char *text, size_t n)
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

static ssize_t write_clean(void *context, const char *text, size_t n)
{
    held *h = context;
    char block[BLOCK + HELD];
    for (size_t done = 0; done < n;) {
        const size_t more = n - done < BLOCK ? n - done : BLOCK;
        memcpy(block, h->bytes, h->count);
        memcpy(block + h->count, text + done, more);
        const size_t filled = clean(block, h->count + more);
        h->count = lac_hidden_begun(block, filled);
        memcpy(h->bytes, block + filled - h->count, h->count);
        if (!lac_temp_file_write(STDOUT_FILENO, block, filled - h->count)) {
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
    FILE *cleaned = fopencookie(&begun, "w", functions);
    if (cleaned != NULL) {
        (void)setvbuf(cleaned, NULL, isatty(STDOUT_FILENO) == 1 ? _IOLBF : _IOFBF, BUFSIZ);
        stdout = cleaned;
    }
}

void cli_note_list(const char *format, va_list args)
{
    char text[2048];
    (void)vsnprintf(text, sizeof text, format, args);
    for (char *c = text; *c != '\0'; c++) {
        *c = *c == '\n' || *c == '\t' ? '?' : *c; // a note is one line
    }
    text[clean(text, strlen(text))] = '\0';
    (void)fprintf(stderr, "lacuna: %s\n", text);
}

void cli_note(const char *format, ...)
{
    va_list args;
    va_start(args, format);
    cli_note_list(format, args);
    va_end(args);
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

cli_text cli_format(const char *format, ...)
{
    cli_text text;
    va_list args;
    va_start(args, format);
    (void)vsnprintf(text.s, sizeof text.s, format, args);
    va_end(args);
    return text;
}

cli_text cli_exact(double value, const char *unit)
{
    cli_text text;
    (void)lac_units_format(value, unit, text.s, sizeof text.s);
    return text;
}

cli_text cli_amount(double value, const char *unit)
{
    char *rest;
    const cli_text exact = cli_exact(value, unit);
    const double number = strtod(exact.s, &rest);
    return cli_format("%.4g%s", number, rest);
}

cli_text cli_date(double seconds)
{
    cli_text text;
    (void)lac_date_format(seconds, text.s, sizeof text.s);
    return text;
}

const cli_time_unit *cli_time_unit_of(double seconds, double least)
{
    static const cli_time_unit units[] = {
        {86400.0, "days", "day"}, {3600.0, "hour", "hour"}, {60.0, "min", "min"}, {1.0, "s", "s"}};
    const cli_time_unit *u = units;
    while (seconds < least * u->seconds && u + 1 < units + sizeof units / sizeof *units) {
        u++;
    }
    return u;
}

void cli_row_quantity(const char *label, double value, const char *unit)
{
    cli_row(label, "%s", cli_amount(value, unit).s);
}

void cli_wrap_after(const char *lead, const char *indent, const char *text)
{
    size_t width = 79 - strlen(indent), column = 0;
    while (*text != '\0') {
        size_t word = strcspn(text, " \n");
        if (column > 0 && column + 1 + word > width) {
            putchar('\n');
            column = 0;
            lead = indent;
        }
        if (word > 0) {
            printf("%s%.*s", column == 0 ? lead : " ", (int)word, text);
            column += word + (column > 0);
        }
        text += word;
        text += strspn(text, " \n");
    }
    if (column > 0) {
        putchar('\n');
    }
}

void cli_wrap(const char *indent, const char *text) { cli_wrap_after(indent, indent, text); }

void cli_row_wrap(const char *label, const char *text)
{
    char lead[64];
    (void)snprintf(lead, sizeof lead, "  %-20s ", label);
    cli_wrap_after(lead, "                       ", text);
}
