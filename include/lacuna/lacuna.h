/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_LACUNA_H
#define LACUNA_LACUNA_H

/// Lacuna: creep, acceleration and failure of rough rock joints. All public headers.
#include "lacuna/dataset.h"
#include "lacuna/error.h"
#include "lacuna/linkage.h"
#include "lacuna/param.h"
#include "lacuna/version.h"

#endif
