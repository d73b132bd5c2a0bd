/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "analysis/analysis.h"

extern const lac_indicator_kind lac_indicator_rg, lac_indicator_events;
