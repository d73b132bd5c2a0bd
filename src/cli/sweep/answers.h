/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "sweep/answers.h"

/// Prints what an ensemble says, in words.
void cli_answers_print(const lac_answers *answers);
