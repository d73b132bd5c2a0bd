// SPDX-License-Identifier: GPL-3.0-or-later
// The version of the library as it was built, which a program's headers may differ from.
#include "lacuna/version.h"

const char *lac_version(void) { return LACUNA_VERSION; }
