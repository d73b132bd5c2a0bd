/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_MEMORY_TRADE_H
#define LACUNA_TESTS_MEMORY_TRADE_H

#include "lacuna/error.h"

/// What `lacuna trade -o PATH` does around its runs: plans them, judges them, writes them down.
lac_status whole_trade(const char *path, lac_error *err);

/// What `lacuna run --accuracy` does before its run.
lac_status whole_accuracy(const char *path, lac_error *err);

#endif
