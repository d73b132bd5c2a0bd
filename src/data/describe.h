/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

// How a module writes down the tables of its result.

#include "data/dataset.h"

#define LAC_VARIABLES(rows_, over_, stride_)                                      \
    {                                                                             \
        .row = (rows_), .rows = sizeof(rows_) / sizeof *(rows_), .over = (over_), \
        .stride = (stride_)                                                       \
    }

/// The same, laid on pointers to many.
#define LAC_VARIABLES_OF_MANY(rows_, over_)                                                        \
    {                                                                                              \
        .row = (rows_), .rows = sizeof(rows_) / sizeof *(rows_), .over = (over_), .pointers = true \
    }

/// Getters: `declared` names what the expression is about, from `of` and `at`.
#define LAC_GETTER(returned, name, declared, expression)   \
    static returned name(const void *of, const size_t *at) \
    {                                                      \
        declared;                                          \
        (void)at;                                          \
        return (expression);                               \
    }
#define LAC_TEXT_GETTER(name, declared, expression)                                     \
    static const char *name(const void *of, const size_t *at, char room[LAC_TEXT_ROOM]) \
    {                                                                                   \
        declared;                                                                       \
        (void)at, (void)room;                                                           \
        return (expression);                                                            \
    }

/// How a row has its values: a number by its getter, a text by its own.
#define G(getter) .value = (getter)
#define T(getter) .text = (getter)

/// A row of a file.
#define LAC_ROW(name_, dims_, unit_, long_name_, ...)                                             \
    {                                                                                             \
        .name = (name_), .dims = (dims_), .unit = (unit_), .long_name = (long_name_), __VA_ARGS__ \
    }

/// A value that is held. @param kind  REAL, COUNT ... of lac_held
#define LAC_HELD(kind, type, field) .held = LAC_HELD_##kind, .offset = offsetof(type, field)

/// A row of a file's attributes and of JSON.
#define LAC_BOTH(name_, path, ...)                   \
    {                                                \
        .name = (name_), .json = (path), __VA_ARGS__ \
    }

/// Rows of JSON alone: of a value that is held, and of one by its getter.
#define LAC_JSON(path, kind, type, field)           \
    {                                               \
        .json = (path), LAC_HELD(kind, type, field) \
    }
#define LAC_JSON_BY(path, dims_, getter)                   \
    {                                                      \
        .json = (path), .dims = (dims_), .value = (getter) \
    }
