/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "sweep/answers.h"

/// Fills influences, whether they are of a chance, and how many rows they are of.
/// @pre   the chance is known
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_influences_fill(const lac_sample *sample, lac_answers *answers, lac_error *err);
