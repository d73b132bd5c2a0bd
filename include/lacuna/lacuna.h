/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_LACUNA_H
#define LACUNA_LACUNA_H

/// Lacuna: creep, acceleration and failure of rough rock joints. All public headers.
#include "lacuna/analysis.h"
#include "lacuna/case.h"
#include "lacuna/contact.h"
#include "lacuna/error.h"
#include "lacuna/fit.h"
#include "lacuna/fractal.h"
#include "lacuna/friction.h"
#include "lacuna/grid.h"
#include "lacuna/hierarchy.h"
#include "lacuna/load.h"
#include "lacuna/param.h"
#include "lacuna/problem.h"
#include "lacuna/rg.h"
#include "lacuna/rg_map.h"
#include "lacuna/rg_study.h"
#include "lacuna/run.h"
#include "lacuna/sampler.h"
#include "lacuna/scene.h"
#include "lacuna/scene_analysis.h"
#include "lacuna/scene_rg.h"
#include "lacuna/sensitivity.h"
#include "lacuna/series.h"
#include "lacuna/spread.h"
#include "lacuna/store.h"
#include "lacuna/store_cells.h"
#include "lacuna/store_fit.h"
#include "lacuna/store_map.h"
#include "lacuna/store_rg.h"
#include "lacuna/surface.h"
#include "lacuna/tangential.h"
#include "lacuna/transfer.h"
#include "lacuna/version.h"

#endif
