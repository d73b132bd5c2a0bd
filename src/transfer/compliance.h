/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TRANSFER_COMPLIANCE_H
#define LACUNA_TRANSFER_COMPLIANCE_H

#include "lacuna/contact.h"

/// The elastic half-spaces on both sides of a contact domain: traction of the contact cells ->
/// slip, along x, gaps free of traction; docs/theory/transfer.md, equations 9 to 12.
typedef struct lac_compliance lac_compliance;

/// Prepares the compliance of a domain. One that does not repeat is alone on the half-spaces, a row
/// of cells too: a strip, where a periodic row is in plane strain.
/// @param shear_modulus  G [Pa], > 0
/// @param poisson        nu [1], < 1; 0 is antiplane
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_compliance_create(const lac_domain *domain, double shear_modulus, double poisson,
                                 lac_compliance **out, lac_error *err);

/// Frees a compliance; NULL is fine.
void lac_compliance_free(lac_compliance *c);

/// Traction K slip that a slip of the contact cells needs, its mean left free (zero net force),
/// and the energy slip . K slip, by preconditioned conjugate gradients.
/// @param slip       [n] [m]
/// @param tolerance  ends where the last two iterations added less to the energy, relative; the
///                   energy is then good to about a tenth of it
/// @param traction   [n] [Pa]; overwritten
/// @param energy     [Pa m]; approached from below
/// @return LAC_OK; LAC_ENUMERIC where it does not converge
/// @cost   two pairs of transforms an iteration, five to eight iterations at tolerance 1e-2
lac_status lac_compliance_invert(lac_compliance *c, const double *slip, double tolerance,
                                 double *traction, double *energy, lac_error *err);

#endif
