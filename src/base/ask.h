/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

// What a public function asks of its arguments before it looks at them.

#include "base/base.h"

/// Refuses NULL among its pointers: at most 8, by the names that they have where it stands.
#define LAC_NEED(err, ...)                                               \
    lac_need(__func__, #__VA_ARGS__, (const void *const[]){__VA_ARGS__}, \
             sizeof((const void *const[]){__VA_ARGS__}) / sizeof(void *), err)

/// @return LAC_OK; LAC_EINPUT
lac_status lac_need(const char *function, const char *names, const void *const *pointer, size_t n,
                    lac_error *err);

/// Takes options, whose first member is their size: programs made with an older library know fewer
/// of them, and the others stay as they are in `own`.
/// @param what   the type, whose name with _default is where to start from
/// @param given  NULL: none
/// @param own    [size] the default
/// @return LAC_OK; LAC_EINPUT: of no size that there has been
lac_status lac_take_options(const char *what, const void *given, void *own, size_t size,
                            lac_error *err);
