// SPDX-License-Identifier: GPL-3.0-or-later
// The lines of a text file as UTF-8, whatever system wrote them; what is no text is told apart.
#include "base/hidden.h"
#include "series/text.h"

enum { LINE_MAX_BYTES = 1 << 24, LONGEST_CHARACTER = 3 };

static lac_status append(lac_lines *lines, int byte, lac_error *err)
{
    LAC_TRY_RETURN(lac_grow(&lines->text, &lines->capacity, lines->length + 2, 1, err));
    lines->text[lines->length++] = (char)byte;
    return LAC_OK;
}

// What other files begin with, and what to do with them.
static lac_status check_begin(const lac_lines *lines, lac_error *err)
{
    static const char save[] = "save it as CSV, such as by libreoffice --headless --convert-to csv";
    static const struct {
        const char *begin, *is, *way;
    } others[] = {
        {"PK\x03", "a workbook (xlsx, ods) or another zip archive", save},
        {"\xd0\xcf\x11", "a workbook of old Excel (xls)", save},
        {"\xff\xfe", "UTF-16", "convert it, iconv -f UTF-16 -t UTF-8"},
        {"\xfe\xff", "UTF-16", "convert it, iconv -f UTF-16 -t UTF-8"},
        {"\x1f", "compressed", "unpack it, gunzip"},
    };
    for (size_t i = 0; lines->number == 1 && i < sizeof others / sizeof *others; i++) {
        const size_t length = strlen(others[i].begin);
        LAC_FAIL_IF(lines->length == length && memcmp(lines->text, others[i].begin, length) == 0,
                    err, LAC_EINPUT, "%s:1: is %s: %s %s", lines->path, others[i].is, others[i].way,
                    lines->path);
    }
    return LAC_OK;
}

static lac_status take_byte(lac_lines *lines, int byte, lac_error *err)
{
    LAC_FAIL_IF(lines->length >= LINE_MAX_BYTES, err, LAC_EINPUT,
                "%s:%zu: the line is longer than %d bytes", lines->path, lines->number,
                LINE_MAX_BYTES);
    LAC_TRY_RETURN(append(lines, byte, err));
    LAC_TRY_RETURN(check_begin(lines, err));
    LAC_FAIL_IF((byte < ' ' && byte != '\t' && byte != '\f') || byte == 0x7f, err, LAC_EINPUT,
                "%s:%zu: byte 0x%02x is not text; must be CSV in UTF-8", lines->path, lines->number,
                (unsigned)byte);
    return LAC_OK;
}

// What a line says after the marks that editors put before it.
static void strip_mark(lac_lines *lines)
{
    if (lines->number == 1 && lines->length >= 3 && memcmp(lines->text, "\xef\xbb\xbf", 3) == 0) {
        lines->length -= 3;
        memmove(lines->text, lines->text + 3, lines->length);
    }
}

bool lac_text_is_utf8(const char *text)
{
    const unsigned char *at = (const unsigned char *)text;
    uint32_t code;
    while (*at != '\0') {
        const size_t length = lac_utf8_length(at, &code);
        if (length == 0) {
            return false;
        }
        at += length;
    }
    return true;
}

// Windows-1252 where it is not Latin-1: from 0x80 on; what it leaves open is U+FFFD.
static const uint16_t western[32] = {
    0x20ac, 0xfffd, 0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021, 0x02c6, 0x2030, 0x0160,
    0x2039, 0x0152, 0xfffd, 0x017d, 0xfffd, 0xfffd, 0x2018, 0x2019, 0x201c, 0x201d, 0x2022,
    0x2013, 0x2014, 0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0xfffd, 0x017e, 0x0178};

static size_t encode(unsigned byte, char *to)
{
    const unsigned code = byte >= 0x80 && byte < 0xa0 ? western[byte - 0x80] : byte;
    if (code < 0x80) {
        to[0] = (char)code;
        return 1;
    }
    if (code < 0x800) {
        to[0] = (char)(0xc0 | (code >> 6));
        to[1] = (char)(0x80 | (code & 0x3f));
        return 2;
    }
    to[0] = (char)(0xe0 | (code >> 12));
    to[1] = (char)(0x80 | ((code >> 6) & 0x3f));
    to[2] = (char)(0x80 | (code & 0x3f));
    return 3;
}

char *lac_text_decode(const char *from)
{
    char *text = malloc(LONGEST_CHARACTER * strlen(from) + 1);
    size_t length = 0;
    for (; text != NULL && *from != '\0'; from++) {
        length += encode((unsigned char)*from, text + length);
    }
    if (text != NULL) {
        text[length] = '\0';
    }
    return text;
}

static lac_status decode(lac_lines *lines, lac_error *err)
{
    char *text = lac_text_decode(lines->text);
    LAC_FAIL_MEMORY_IF(text == NULL, err);
    free(lines->text);
    lines->text = text;
    lines->length = strlen(text);
    lines->capacity = lines->length + 1;
    lines->latin = true;
    return LAC_OK;
}

lac_status lac_lines_next(lac_lines *lines, bool *more, lac_error *err)
{
    int byte = 0;
    lines->number++;
    lines->length = 0;
    lines->latin = false;
    for (;;) {
        byte = getc_unlocked(lines->stream);
        if (byte == EOF || byte == '\n' || byte == '\r') {
            break;
        }
        LAC_TRY_RETURN(take_byte(lines, byte, err));
    }
    LAC_FAIL_IF(byte == EOF && ferror(lines->stream), err, LAC_EIO, "%s: %s", lines->path,
                strerror(errno));
    *more = byte != EOF || lines->length > 0;
    if (byte == '\r') {
        int next = getc_unlocked(lines->stream);
        if (next != '\n' && next != EOF) {
            (void)ungetc(next, lines->stream);
        }
    }
    strip_mark(lines);
    LAC_TRY_RETURN(append(lines, '\0', err));
    lines->length--;
    return lac_text_is_utf8(lines->text) ? LAC_OK : decode(lines, err);
}
