/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_COST_H
#define LACUNA_TESTS_COST_H

/// CPU time of the process so far, and time on a clock that never goes back [s].
double cpu_seconds(void);
double wall_seconds(void);

/// Most bytes in memory since the last reset, as Linux counts them; 0 elsewhere.
double peak_bytes(void);
void reset_peak(void);

#endif
