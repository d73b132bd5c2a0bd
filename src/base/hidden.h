/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_BASE_HIDDEN_H
#define LACUNA_BASE_HIDDEN_H

#include <stddef.h>

/// Bytes of the character that a text in UTF-8 begins with where that is not seen but changes what
/// is: controls (U+0080 to U+009F), what turns the direction of a line (U+061C, U+200E, U+200F,
/// U+202A to U+202E, U+2066 to U+2069), what breaks it (U+2028, U+2029), what has no width (U+180E,
/// U+200B to U+200D, U+2060 to U+206F, U+FEFF, U+FFF9 to U+FFFB, U+E0000 to U+E007F).
/// @param n  bytes of the text
/// @return 0 where it is none of these, or not whole
size_t lac_hidden_length(const char *text, size_t n);

/// How many bytes at the end of a text may be the beginning of such a character: 0 to 3.
size_t lac_hidden_begun(const char *text, size_t n);

#endif
