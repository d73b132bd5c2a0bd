/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_VERSION_H
#define LACUNA_VERSION_H

#define LACUNA_VERSION "0.1.0"

#endif
