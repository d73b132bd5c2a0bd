/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_LACUNA_H
#define LACUNA_LACUNA_H

/// Lacuna: creep, acceleration and failure of rough rock joints. All public headers.
#include "lacuna/case.h"
#include "lacuna/contact.h"
#include "lacuna/dataset.h"
#include "lacuna/error.h"
#include "lacuna/fit.h"
#include "lacuna/forecast.h"
#include "lacuna/linkage.h"
#include "lacuna/param.h"
#include "lacuna/rg.h"
#include "lacuna/series.h"
#include "lacuna/simulation.h"
#include "lacuna/version.h"

#endif
