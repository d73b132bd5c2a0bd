/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_SURFACE_MEASURE_H
#define LACUNA_SURFACE_MEASURE_H

#include "surface/surface.h"

/// As lac_surface_measure, with the default range narrowed to where the spectrum is known to be a
/// power law.
/// @param known  NaN where it is not known
lac_status lac_surface_measure_within(const lac_grid *grid, const double *heights,
                                      const lac_wave_range *known, lac_surface_measures *out,
                                      lac_error *err);

#endif
