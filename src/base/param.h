/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"
#include "lacuna/param.h"

/// A model chosen in a case, with its parameters.
typedef struct lac_model {
    const lac_model_info *info; ///< first member of the model's row; NULL: nothing chosen
    void *params;               ///< owned; about->params_size bytes
} lac_model;

/// Fills `params` with the defaults of the table; absent and required ones with the absent mark.
void lac_params_default(const lac_model_info *info, void *params);

/// Sets one parameter to its default, or to the absent mark. A text it held is not freed.
void lac_param_reset(const lac_param *param, void *params);

/// Checks a parameter's value against its row.
/// @param value  SI
/// @param why    [size] set to what is allowed ("must be > 0 m") where the value is refused
/// @return true where the value is allowed; NaN and infinities never are
bool lac_param_allows(const lac_param *param, double value, char *why, size_t size);

/// Whether a parameter must be given.
bool lac_param_required(const lac_param *param);

/// Whether an optional parameter was given.
bool lac_param_given(const lac_param *param, const void *params);

/// A model with the defaults of its parameters.
/// @return LAC_OK, LAC_ENOMEM
lac_status lac_model_create(const lac_model_info *info, lac_model *model, lac_error *err);

/// Frees what a model owns; an empty model is fine. The model is empty afterwards.
void lac_model_clear(lac_model *model);

/// The row of a key among `count`, NULL where there is none.
const lac_param *lac_param_find(const lac_param *params, size_t count, const char *key);
