// SPDX-License-Identifier: GPL-3.0-or-later
// Characters of UTF-8; and those that nobody sees but that change what is seen, to be kept out of
// all output.
#include "base/hidden.h"

size_t lac_utf8_length(const unsigned char *s, uint32_t *code)
{
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const unsigned c = *s;
    const size_t length = c < 0x80         ? 1
                          : c >> 5 == 0x6  ? 2
                          : c >> 4 == 0xe  ? 3
                          : c >> 3 == 0x1e ? 4
                                           : 0;
    *code = length > 1 ? c & (0xffu >> (length + 1)) : c;
    for (size_t i = 1; i < length; i++) {
        if ((s[i] & 0xc0) != 0x80) {
            return 0;
        }
        *code = *code << 6 | (s[i] & 0x3fu);
    }
    const bool surrogate = *code >= 0xd800 && *code <= 0xdfff;
    return *code >= least[length] && *code <= 0x10ffff && !surrogate ? length : 0;
}

// Characters of the same bytes but the last one.
static const struct {
    char first[5];
    unsigned char last;
} forms[] = {
    {"\xc2\x80", 0x9f},         {"\xd8\x9c", 0x9c},     {"\xe1\xa0\x8e", 0x8e},
    {"\xe2\x80\x8b", 0x8f},     {"\xe2\x80\xa8", 0xae}, {"\xe2\x81\xa0", 0xaf},
    {"\xef\xbb\xbf", 0xbf},     {"\xef\xbf\xb9", 0xbb}, {"\xf3\xa0\x80\x80", 0xbf},
    {"\xf3\xa0\x81\x80", 0xbf},
};

enum { FORMS = sizeof forms / sizeof *forms, LONGEST = 4 };

size_t lac_hidden_length(const char *text, size_t n)
{
    for (size_t k = 0; n > 1 && (unsigned char)*text > 0x7f && k < FORMS; k++) {
        const size_t length = strlen(forms[k].first);
        if (n < length || memcmp(text, forms[k].first, length - 1) != 0) {
            continue;
        }
        const unsigned char last = (unsigned char)text[length - 1];
        if (last >= (unsigned char)forms[k].first[length - 1] && last <= forms[k].last) {
            return length;
        }
    }
    return 0;
}

static bool is_begun(const char *text, size_t n)
{
    bool begun = false;
    for (size_t k = 0; k < FORMS; k++) {
        begun = begun || (n < strlen(forms[k].first) && memcmp(text, forms[k].first, n) == 0);
    }
    return begun;
}

size_t lac_hidden_begun(const char *text, size_t n)
{
    size_t begun = n < LONGEST ? n : LONGEST - 1;
    while (begun > 0 && !is_begun(text + n - begun, begun)) {
        begun--;
    }
    return begun;
}
