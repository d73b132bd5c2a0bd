/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_STORE_CONTACT_FRACTAL_H
#define LACUNA_STORE_CONTACT_FRACTAL_H

#include "store/nc.h"

/// Writes the fractal measures of a contact: boxes, clusters, resolutions, specimens; each only
/// where it was measured.
lac_status lac_nc_fractal(const lac_nc *file, const lac_contact_view *contact, lac_error *err);

#endif
