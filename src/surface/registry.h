/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "surface/surface.h"

/// Random self-affine heights by spectral synthesis.
extern const lac_surface_source lac_surface_self_affine;

/// Two faces, mated in their long waves.
extern const lac_surface_source lac_surface_joint;

/// Surfaces defined to the last wave, for comparing solvers.
extern const lac_surface_source lac_surface_benchmark;

/// Measured heights from a file.
extern const lac_surface_source lac_surface_from_file;
