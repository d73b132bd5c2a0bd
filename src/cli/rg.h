/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_RG_H
#define LACUNA_CLI_RG_H

#include "cli/json.h"
#include "lacuna/scene_rg.h"

/// The names of rule and field as a case has them.
const char *cli_rg_rule(const lac_case *c);
const char *cli_rg_field(const lac_case *c);

/// The results as tables on stdout.
void cli_rg_print(const lac_case *c, const lac_scene_rg *rg, bool verbose);

/// The same as keys of an open JSON object.
void cli_rg_json(cli_json *json, const lac_case *c, const lac_scene_rg *rg);

#endif
