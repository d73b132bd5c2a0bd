/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_VERSION_H
#define LACUNA_VERSION_H

#define LACUNA_VERSION "0.1.0"

/// LACUNA_VERSION of the library itself: of the headers that it was compiled with.
const char *lac_version(void);

#endif
