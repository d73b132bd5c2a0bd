/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_VIEW_INBOX_H
#define LACUNA_CLI_VIEW_INBOX_H

#include <pthread.h>

#include "lacuna/run.h"

/// What a run has put out and its viewer has not yet looked at. The run's thread only copies into
/// it: it never waits for the viewer. Where memory runs out the page misses something and says so.
typedef struct cli_inbox {
    pthread_mutex_t lock;
    lac_progress progress;
    bool moved;           ///< progress came since the last look
    unsigned char *bytes; ///< records, snapshots and events as they came
    size_t used, room;    ///< [bytes]
    size_t extras;        ///< values that an analysis adds to a record
    size_t cells;         ///< of a snapshot; 0: none is kept
    unsigned fields;      ///< LAC_FIELD_* of a snapshot
    lac_sink next;        ///< where everything goes first
    size_t most;          ///< that it holds [bytes]
    bool missing;         ///< no room or no memory: not all came through
} cli_inbox;

/// @return false where the system gives no lock
bool cli_inbox_create(cli_inbox *inbox);
void cli_inbox_clear(cli_inbox *inbox);

/// A sink that passes everything on to inbox->next and keeps a copy of what went well.
lac_sink cli_inbox_sink(cli_inbox *inbox);

void cli_inbox_progress(cli_inbox *inbox, const lac_progress *progress);

/// Empties it into a sink, in order; on the viewer's thread.
/// @param progress  the newest
/// @param moved     whether there was any since the last time
/// @return how many records, snapshots and events there were
size_t cli_inbox_empty(cli_inbox *inbox, const lac_sink *sink, lac_progress *progress, bool *moved);

/// @return whether anything has not come through since the inbox was made
bool cli_inbox_missing(cli_inbox *inbox);

#endif
