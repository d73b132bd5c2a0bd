/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_HEIGHT_FILES_H
#define LACUNA_TESTS_HEIGHT_FILES_H

#include <stddef.h>

#include "surface/surface.h"

// The map of the tests of height files: 3 columns, 2 rows; y upwards.
//    4 5 6   y = 1
//    1 2 3   y = 0
extern const double known_heights[6];

// Headers of such a map; what follows is the row of the largest y first, and of the smallest.
#define HEIGHTS_ASC "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 0.5\nNODATA_value -9999\n"
#define HEIGHTS_SDF_HEAD                                                                         \
    "aBCR-1.0\nManufacID = test\nNumPoints = 3\nNumProfiles = 2\nXscale = 1e-3\nYscale = 2e-3\n" \
    "Zscale = 0.5\nZresolution = -1\nCompression = 0\nDataType = 7\nCheckType = 0\n"
#define HEIGHTS_SDF HEIGHTS_SDF_HEAD "*\n"
#define HEIGHTS_GSF "Gwyddion Simple Field 1.0\nXRes = 3\nYRes = 2\n"

/// A .npy of version 1 with the header padded as NumPy pads it.
/// @param file  room for 128 bytes and the data
/// @return bytes
size_t heights_npy(unsigned char *file, const char *header, const void *data, size_t size);

/// A .gsf with the first of the heights 4, 5, 6, 1, 2, 3.
size_t heights_gsf(unsigned char *file, const char *header, size_t heights);

/// A binary .sdf of 3 points and 2 profiles, Zscale 0.5, as the version in its first eight bytes.
size_t heights_sdf(unsigned char *file, const char *version, unsigned type, const void *data,
                   size_t size);

/// The row of the registry of this name; stops the program where there is none.
const lac_surface_source *surface_source(const char *name);

#endif
