/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/param.h"

/// A way in which a parameter varies from cell to cell: value = nominal * factor of the cell.
/// docs/theory/friction.md, "From cell to cell".
typedef struct lac_heterogeneity_kind {
    lac_model_info info;
    /// A random factor, the same for the same parameters, place and stream whatever the order.
    /// @param place   index of the cell on the grid
    /// @param stream  of random numbers under the kind's seed
    /// NULL: not random; `map` and `size` are the scene's to work out
    double (*draw)(const void *params, uint64_t place, uint64_t stream);
} lac_heterogeneity_kind;

/// Parameters of every random kind.
typedef struct lac_heterogeneity_random {
    double width; ///< sigma, half width, shape or exponent; unused where the kind has none
    int64_t seed;
    double lowest, highest; ///< range of the factor that is kept; NaN: no limit
} lac_heterogeneity_random;

/// Parameters of `map`.
typedef struct lac_heterogeneity_map {
    char *path;
    char *variable; ///< NULL: the only one that fits the grid
    int as;         ///< lac_map_use
} lac_heterogeneity_map;

typedef enum lac_map_use {
    LAC_MAP_VALUE = 0, ///< the map takes the place of the nominal value
    LAC_MAP_FACTOR,    ///< the map multiplies it
} lac_map_use;

/// Parameters of `size`: factor = (s/reference)^exponent.
typedef struct lac_heterogeneity_size {
    double exponent;
    double reference; ///< [m]
    int of;           ///< lac_size_of
} lac_heterogeneity_size;

/// Whose size a cell has.
typedef enum lac_size_of {
    LAC_SIZE_PATCH = 0, ///< square root of the area of the contact patch that the cell belongs to
    LAC_SIZE_BLOCK,     ///< side of the largest block around the cell that touches everywhere
} lac_size_of;

extern const lac_heterogeneity_kind lac_heterogeneity_map_kind, lac_heterogeneity_size_kind;

/// The index-th kind, NULL past the end.
const lac_heterogeneity_kind *lac_heterogeneity_kind_get(size_t index);

/// One spread of one parameter.
typedef struct lac_heterogeneity {
    char *key;       ///< the parameter that varies
    lac_model model; ///< a lac_heterogeneity_kind and its parameters
    size_t line;
} lac_heterogeneity;

/// Spreads of any parameters; those of one parameter multiply.
typedef struct lac_heterogeneity_list {
    size_t count;
    lac_heterogeneity *item;
} lac_heterogeneity_list;

/// Whether a spread gives values outright instead of factors: a map as `value`.
bool lac_heterogeneity_is_value(const lac_heterogeneity *spread);

/// Whether a list has a spread of a parameter.
bool lac_heterogeneity_has(const lac_heterogeneity_list *list, const char *key);
