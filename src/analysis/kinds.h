/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_ANALYSIS_KINDS_H
#define LACUNA_ANALYSIS_KINDS_H

#include "analysis/analysis.h"

extern const lac_indicator_kind lac_indicator_rg, lac_indicator_events;

#endif
