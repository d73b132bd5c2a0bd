/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_SUPPORT_SLOT_H
#define TEST_SUPPORT_SLOT_H

#include "load/load.h"

/// Sets a real or choice parameter of a model by its key; fails the program where there is none.
void test_slot_set(lac_model *model, const char *key, double value);

/// Decimal exponents between which a test varies a parameter, by its key or its unit.
void test_slot_exponents(const lac_param *param, double *low, double *high);

/// Gives every number that must be given, and is not, one in the middle of those, within its range.
void test_slot_fill(lac_model *model);

/// A model of the shear load of that name with its defaults; fails the program where there is none.
lac_model test_slot_shear(const char *name);

/// Loads made ready, undated, for a run of any length; fails the program where they cannot be.
lac_load_set test_load_set(const lac_load_models *models);

#endif
