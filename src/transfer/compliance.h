/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TRANSFER_COMPLIANCE_H
#define LACUNA_TRANSFER_COMPLIANCE_H

#include "contact/contact.h"
#include "transfer/kernels.h"

/// The elastic half-spaces on both sides of a contact domain: traction of the contact cells ->
/// slip, along x, gaps free of traction; docs/theory/transfer.md, equations 9 to 12.
typedef struct lac_compliance lac_compliance;

/// Prepares the compliance of a domain. One that does not repeat is alone on the half-spaces, a row
/// of cells too: a strip unless the rock says that it is a line; a periodic row is one anyway.
/// Holds the buffers of its transforms: for one thread at a time.
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_compliance_create(const lac_domain *domain, const lac_rock *rock,
                                 lac_compliance **out, lac_error *err);

/// Frees a compliance; NULL is fine.
void lac_compliance_free(lac_compliance *c);

/// slip = C traction, equation 9. @param traction, slip  [n]; may be the same array
void lac_compliance_slip(lac_compliance *c, const double *traction, double *slip);

/// traction = R F^-1 S F R^T slip: the slip held to 0 in the gaps; on full contact K itself.
void lac_compliance_traction(lac_compliance *c, const double *slip, double *traction);

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
