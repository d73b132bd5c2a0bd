// SPDX-License-Identifier: GPL-3.0-or-later
#include "lacuna/version.h"

const char *lac_version(void) { return LACUNA_VERSION; }
