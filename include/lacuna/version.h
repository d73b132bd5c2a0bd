/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_VERSION_H
#define LACUNA_VERSION_H

#include "lacuna/linkage.h"

LAC_BEGIN_C

#define LACUNA_VERSION "0.2.0"

/// LACUNA_VERSION of the library itself: of the headers that it was compiled with.
const char *lac_version(void);

LAC_END_C

#endif
