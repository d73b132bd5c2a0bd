// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/view_feed.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "cli/progress.h"

bool cli_feed_create(cli_feed *feed)
{
    pthread_condattr_t monotonic;
    memset(feed, 0, sizeof *feed);
    (void)snprintf(feed->mark, sizeof feed->mark, "%lx.%lx", (unsigned long)getpid() & 0xffffffUL,
                   (unsigned long)time(NULL) & 0xffffffffUL);
    if (pthread_condattr_init(&monotonic) != 0) {
        return false;
    }
    bool good = pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC) == 0 &&
                pthread_cond_init(&feed->changed, &monotonic) == 0;
    (void)pthread_condattr_destroy(&monotonic);
    if (good && pthread_mutex_init(&feed->lock, NULL) != 0) {
        (void)pthread_cond_destroy(&feed->changed);
        good = false;
    }
    return good;
}

void cli_feed_clear(cli_feed *feed)
{
    (void)pthread_mutex_destroy(&feed->lock);
    (void)pthread_cond_destroy(&feed->changed);
    free(feed->data);
}

void cli_feed_event(cli_feed *feed, const char *json, bool last)
{
    (void)pthread_mutex_lock(&feed->lock);
    feed->id++;
    (void)snprintf(feed->event, sizeof feed->event, "%s", json);
    feed->ended = feed->ended || last;
    feed->expected = last ? feed->watchers : feed->expected;
    (void)pthread_cond_broadcast(&feed->changed);
    (void)pthread_mutex_unlock(&feed->lock);
}

void cli_feed_data(cli_feed *feed, char *json)
{
    (void)pthread_mutex_lock(&feed->lock);
    char *old = feed->data;
    feed->data = json;
    feed->taken = 0;
    feed->wanted = false;
    feed->version++;
    (void)pthread_cond_broadcast(&feed->changed);
    (void)pthread_mutex_unlock(&feed->lock);
    free(old);
}

bool cli_feed_watched(cli_feed *feed)
{
    (void)pthread_mutex_lock(&feed->lock);
    const bool watched = feed->watchers > 0 || feed->wanted;
    (void)pthread_mutex_unlock(&feed->lock);
    return watched;
}

bool cli_feed_streams(cli_feed *feed)
{
    (void)pthread_mutex_lock(&feed->lock);
    const bool streams = feed->watchers > 0;
    (void)pthread_mutex_unlock(&feed->lock);
    return streams;
}

void cli_feed_close(cli_feed *feed)
{
    (void)pthread_mutex_lock(&feed->lock);
    feed->ended = true;
    (void)pthread_cond_broadcast(&feed->changed);
    (void)pthread_mutex_unlock(&feed->lock);
}

bool cli_feed_wait(cli_feed *feed, double seconds)
{
    struct timespec until;
    (void)clock_gettime(CLOCK_MONOTONIC, &until);
    const double whole = floor(seconds);
    until.tv_sec += (time_t)whole;
    until.tv_nsec += (long)((seconds - whole) * 1e9);
    if (until.tv_nsec >= 1000000000L) {
        until.tv_nsec -= 1000000000L;
        until.tv_sec++;
    }
    return pthread_cond_timedwait(&feed->changed, &feed->lock, &until) != ETIMEDOUT;
}

void cli_feed_drain(cli_feed *feed, double seconds)
{
    const double end = cli_clock() + seconds;
    (void)pthread_mutex_lock(&feed->lock);
    while (feed->taken < feed->expected && cli_clock() < end) {
        (void)cli_feed_wait(feed, fmax(end - cli_clock(), 0.0));
    }
    (void)pthread_mutex_unlock(&feed->lock);
}

char *cli_feed_take(cli_feed *feed, double seconds, uint64_t *version)
{
    const double end = cli_clock() + seconds;
    char *copy = NULL;
    (void)pthread_mutex_lock(&feed->lock);
    feed->wanted = true; // newer ones next time, for who asks again and again
    (void)pthread_cond_broadcast(&feed->changed);
    while (feed->data == NULL && !feed->ended && cli_clock() < end) {
        (void)cli_feed_wait(feed, fmax(end - cli_clock(), 0.0));
    }
    if (feed->data != NULL) {
        copy = strdup(feed->data);
        *version = feed->version;
    }
    (void)pthread_mutex_unlock(&feed->lock);
    return copy;
}

void cli_feed_taken(cli_feed *feed, uint64_t version)
{
    (void)pthread_mutex_lock(&feed->lock);
    feed->taken += version == feed->version;
    (void)pthread_cond_broadcast(&feed->changed);
    (void)pthread_mutex_unlock(&feed->lock);
}
