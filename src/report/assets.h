/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_REPORT_ASSETS_H
#define LACUNA_REPORT_ASSETS_H

/// The page without its data, made from the files in `page/` when Lacuna is built; ends in '\0'.
/// @TITLE@ and @DATA@ stand in it once each, in this order.
extern const unsigned char lac_page_html[];

#endif
