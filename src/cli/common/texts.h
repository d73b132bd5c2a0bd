/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

/// A text that the program writes as it is, made from the files in `texts/` when Lacuna is built.
typedef struct cli_named_text {
    const char *name;
    const char *text;
} cli_named_text;

/// Cases to start from by their kind, and what shells read by the shell; the last name is NULL.
extern const cli_named_text cli_templates[], cli_shells[];
