/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_COMMON_TEMPLATES_H
#define LACUNA_CLI_COMMON_TEMPLATES_H

/// A commented case to start from.
typedef struct cli_template {
    const char *kind;
    const char *text;
} cli_template;

/// In the order of `kind`; the row after the last has a NULL kind.
extern const cli_template cli_templates[];

#endif
