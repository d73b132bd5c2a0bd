/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "transfer/transfer.h"

extern const lac_transfer_kind lac_hierarchy_kind;
extern const lac_transfer_kind lac_elastic_kind;
extern const lac_transfer_kind lac_none_kind;
