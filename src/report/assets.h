/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

/// The page without its data, made from the files in `page/` when Lacuna is built; ends in '\0'.
/// @TITLE@ and @DATA@ stand in it once each, in this order.
extern const unsigned char lac_page_html[];
