/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/keep.h"
#include "cli/common/options.h"
#include "cli/common/pool.h"
#include "scene/scene_rg.h"

/// The cascade over the interfaces of a case: all but the last one are parts, made in processes of
/// the pool and kept for --resume. The last one, whose cells the file shows, is made in the end, or
/// is the only one.
typedef struct cli_rg_parts {
    const cli_request *request;
    const lac_case *source; ///< its rg.seeds interfaces
    cli_pool pool;
    cli_keep keep;
    size_t n, next;
    unsigned char **part; ///< [n] of lac_scene_rg_part; NULL: not made yet
} cli_rg_parts;

/// Reads --jobs, and opens what is kept beside the output, with --resume for the parts in it.
/// @return LAC_OK; LAC_EINPUT (--resume of one interface, and as cli_keep_open); LAC_EIO;
/// LAC_ENOMEM
lac_status cli_rg_parts_open(cli_rg_parts *parts, const char *path, lac_error *err);

/// As lac_scene_rg_run, to the bit.
lac_status cli_rg_parts_run(cli_rg_parts *parts, lac_scene_rg *out, lac_error *err);

/// @param status  how it ended: what is kept is not needed any more once all is written, or where
/// the
///                case cannot be followed
void cli_rg_parts_close(cli_rg_parts *parts, lac_status status);
