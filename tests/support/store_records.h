/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_STORE_RECORDS_H
#define LACUNA_TESTS_STORE_RECORDS_H

#include "store/store.h"

/// The i-th record of a series in which no two values are alike; the first has no step.
lac_record record_of(size_t i);

/// A def with a little provenance and no cells, dated from 1963-07-01.
lac_store_def store_def(const char *path);

/// How a run that failed after 100 days ended.
lac_run_result run_result(void);

/// Reads a variable over time of a run's file. @param values  [n] the caller frees
/// @return what the file's readers return
lac_status read_over_time(const char *path, const char *variable, double **values, size_t *n,
                          lac_error *err);

/// Reads a file back and compares every value with record_of.
/// @param n  number of records found
/// @return what read_over_time returns; LAC_ENUMERIC where a value differs
lac_status check_records(const char *path, size_t *n, lac_error *err);

#endif
