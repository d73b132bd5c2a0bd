/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_VIEW_FEED_H
#define LACUNA_CLI_VIEW_FEED_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

enum { CLI_FEED_EVENT = 1024, CLI_FEED_MARK = 17 };

/// What the pages of a run are given: the newest event, which says where the run stands, and the
/// newest data. Between the thread that makes them and those that serve them.
typedef struct cli_feed {
    pthread_mutex_t lock;
    pthread_cond_t changed;     ///< on the monotonic clock
    char mark[CLI_FEED_MARK];   ///< of this process: ids of another's events mean nothing here
    uint64_t id;                ///< of the newest event; 0: none yet
    char event[CLI_FEED_EVENT]; ///< JSON, one line
    char *data;                 ///< JSON; owned; NULL: none yet
    uint64_t version;           ///< of the data; 0: none yet
    unsigned watchers;          ///< streams of events that are open
    unsigned taken;             ///< times that the newest data were sent
    unsigned expected;          ///< streams that were open at the last event
    bool wanted;                ///< data were asked for since there were new ones
    bool ended;                 ///< the newest event is the last
} cli_feed;

/// @return false where the system gives no lock
bool cli_feed_create(cli_feed *feed);
void cli_feed_clear(cli_feed *feed);

/// Puts an event in the place of the last one. @param last  no other follows
void cli_feed_event(cli_feed *feed, const char *json, bool last);

/// Puts data in the place of the last ones. @param json  taken over
void cli_feed_data(cli_feed *feed, char *json);

/// Whether anybody looks: a stream is open, or data were asked for.
bool cli_feed_watched(cli_feed *feed);

/// Whether a stream is open, to which the end can be told.
bool cli_feed_streams(cli_feed *feed);

/// Lets all that wait go.
void cli_feed_close(cli_feed *feed);

/// After the last event: waits until `seconds` are over or all that watched have the newest data.
void cli_feed_drain(cli_feed *feed, double seconds);

/// Waits for a change under the lock. @return false when `seconds` are over
bool cli_feed_wait(cli_feed *feed, double seconds);

/// A copy of the newest data, waiting for the first ones a while; NULL: none. The caller frees it.
char *cli_feed_take(cli_feed *feed, double seconds, uint64_t *version);

/// Says that data have been sent.
void cli_feed_taken(cli_feed *feed, uint64_t version);

#endif
