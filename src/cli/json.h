/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_JSON_H
#define LACUNA_CLI_JSON_H

#include "data/json.h"

#define cli_json lac_json
#define cli_json_open lac_json_open
#define cli_json_close lac_json_close
#define cli_json_number lac_json_number
#define cli_json_integer lac_json_integer
#define cli_json_boolean lac_json_boolean
#define cli_json_null lac_json_null
#define cli_json_text lac_json_text
#define cli_utf8_length lac_utf8_length

#endif
