/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CONTACT_TANGENTIAL_STATE_H
#define LACUNA_CONTACT_TANGENTIAL_STATE_H

#include "contact/tangential.h"
#include "contact/tangential_solve.h"

struct lac_tangential {
    lac_tangential_def def;
    lac_shear_space *space;
    double softness; ///< displacements in the unit of space to metres [m/Pa]
    double *tau;     ///< [2 * cells] tractions [Pa]
    double *u;       ///< [2 * cells] displacements, in the unit of space
    double *slip;    ///< [2 * cells] [m]
    uint8_t *state;  ///< [cells]
    double shift[2]; ///< [m]
    bool used[2];    ///< axes that have ever been loaded, or are coupled to one that has
};

/// One step on the contact cells, in tractions of order one.
typedef struct lac_shear_step {
    lac_shear_problem p;
    double unit; ///< of tractions, a power of two [Pa]
    uint32_t *cell;
    double *work; ///< limit, before, tau, u
    uint8_t *limited;
} lac_shear_step;

/// Room for n cells, to be cleared whatever the status.
lac_status lac_shear_step_create(lac_shear_step *s, size_t n, lac_error *err);
void lac_shear_step_clear(lac_shear_step *s);

/// The pressures of a contact: how many press, their mean and the highest.
typedef struct lac_pressed {
    size_t n;
    double mean, most;
} lac_pressed;

/// What all that shears demands of a def.
/// @return LAC_OK; LAC_EINPUT
lac_status lac_tangential_check(const lac_tangential_def *def, lac_error *err);

/// @return LAC_OK; LAC_EINPUT (a pressure that is none, no contact, friction beyond numbers)
lac_status lac_tangential_check_pressure(const lac_tangential_def *def, const double *pressure,
                                         lac_pressed *pressed, lac_error *err);

/// Displacements in the unit of lac_shear_space to metres [m/Pa].
double lac_tangential_softness(const lac_tangential_def *def);

#endif
