/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "contact/contact.h"

enum { LAC_NEIGHBOURS = 8 };

/// Where each neighbour lies [cells]. The first four are ahead: with them each pair comes up once.
extern const int32_t lac_neighbour_x[LAC_NEIGHBOURS], lac_neighbour_y[LAC_NEIGHBOURS];

/// The contact cells that touch each one by side or corner, through the edges where periodic.
/// @return [8 n] UINT32_MAX: none there; the caller frees it; NULL: no memory
uint32_t *lac_neighbours_find(const lac_domain *domain);
