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

// What a structure of options begins as; those of C++ and of C warn of each other's.
#ifdef __cplusplus
#define LAC_ZEROS \
    {             \
    }
#else
#define LAC_ZEROS \
    {             \
        0         \
    }
#endif

#endif
