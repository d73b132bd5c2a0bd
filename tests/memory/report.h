/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_MEMORY_REPORT_H
#define LACUNA_MEMORY_REPORT_H

#include "lacuna/error.h"

/// Makes the runs and the fit that are reported, while allocations succeed.
void report_prepare(void);
void report_remove(void);

/// Two runs to pages: one beside readings and a fit, one with events.
lac_status whole_report(const char *path, lac_error *err);

/// A run in memory, what a file holds before it, and its page while it goes on.
lac_status whole_live(const char *path, lac_error *err);

/// Each allocation of a record, a snapshot and an event in memory fails once.
void recording_stays_whole(void);

/// The same of what is moved from one recording to another.
void recording_is_handed_on_whole(void);

#endif
