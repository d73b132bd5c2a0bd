/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_LINKAGE_H
#define LACUNA_LINKAGE_H

// Between these two a public header declares what it declares, so that C++ finds it by its C name.
#ifdef __cplusplus
#define LAC_BEGIN_C extern "C" {
#define LAC_END_C }
#else
#define LAC_BEGIN_C
#define LAC_END_C
#endif

#endif
