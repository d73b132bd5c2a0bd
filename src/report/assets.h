/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

/// The page without its data, made from the files in `page/` when Lacuna is built; ends in '\0'.
/// The marks @TITLE@ and @DATA@ stand in it once each, @NONCE@ in the tag of each style and script.
extern const unsigned char lac_page_html[];
