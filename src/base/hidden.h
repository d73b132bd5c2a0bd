/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

/// Length of the UTF-8 sequence at `s`, 0 where it is none (overlong forms, surrogates included),
/// and the number of its character.
size_t lac_utf8_length(const unsigned char *s, uint32_t *code);

/// Bytes of the character that a text in UTF-8 begins with, where that is not seen but changes what
/// is: controls, what turns or breaks a line, what has no width. 0 where it is none, or not whole.
size_t lac_hidden_length(const char *text, size_t n);

/// How many bytes at the end of a text may be the beginning of such a character: 0 to 3.
size_t lac_hidden_begun(const char *text, size_t n);
