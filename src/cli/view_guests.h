/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_VIEW_GUESTS_H
#define LACUNA_CLI_VIEW_GUESTS_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

/// Connections that stay beside one another, and room for those that are being shown out.
enum { CLI_GUESTS = 32, CLI_GUESTS_ROOM = 2 * CLI_GUESTS };

/// One connection.
typedef struct cli_guest {
    int socket;     ///< -1: free
    uint64_t order; ///< of coming; 0: it was shown out
    bool watches;   ///< has a stream of events; these are counted elsewhere
} cli_guest;

/// Who is connected to the page: slow ones must not keep others out, so one more than there is room
/// for shuts the oldest that is no stream. A page and its data take moments.
typedef struct cli_guests {
    pthread_mutex_t lock;
    uint64_t next;
    cli_guest at[CLI_GUESTS_ROOM];
} cli_guests;

void cli_guests_create(cli_guests *guests);
void cli_guests_clear(cli_guests *guests);

/// A connection that has been made. @return NULL where there is no room
cli_guest *cli_guests_enter(cli_guests *guests, int socket);

/// It has a stream of events from now on. @param guest  NULL is fine
void cli_guests_watch(cli_guests *guests, cli_guest *guest);

/// It ends; its socket is still open. @param guest  NULL is fine
void cli_guests_leave(cli_guests *guests, cli_guest *guest);

#endif
