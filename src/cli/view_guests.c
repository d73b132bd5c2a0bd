// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/view_guests.h"

#include <stddef.h>
#include <sys/socket.h>

void cli_guests_create(cli_guests *guests)
{
    (void)pthread_mutex_init(&guests->lock, NULL);
    guests->next = 0;
    for (size_t i = 0; i < CLI_GUESTS_ROOM; i++) {
        guests->at[i].socket = -1;
    }
}

void cli_guests_clear(cli_guests *guests) { (void)pthread_mutex_destroy(&guests->lock); }

// Shuts one where there are too many. Its thread notices and closes it; it counts no more.
static void make_room(cli_guests *guests)
{
    size_t count = 0;
    cli_guest *out = NULL;
    for (size_t i = 0; i < CLI_GUESTS_ROOM; i++) {
        cli_guest *guest = &guests->at[i];
        const bool stays = guest->socket >= 0 && guest->order > 0;
        count += stays ? 1 : 0;
        if (stays && !guest->watches && (out == NULL || guest->order < out->order)) {
            out = guest;
        }
    }
    if (count > CLI_GUESTS && out != NULL) {
        (void)shutdown(out->socket, SHUT_RDWR);
        out->order = 0;
    }
}

cli_guest *cli_guests_enter(cli_guests *guests, int socket)
{
    cli_guest *entered = NULL;
    (void)pthread_mutex_lock(&guests->lock);
    for (size_t i = 0; i < CLI_GUESTS_ROOM && entered == NULL; i++) {
        entered = guests->at[i].socket < 0 ? &guests->at[i] : NULL;
    }
    if (entered != NULL) {
        *entered = (cli_guest){.socket = socket, .order = ++guests->next};
        make_room(guests);
    }
    (void)pthread_mutex_unlock(&guests->lock);
    return entered;
}

void cli_guests_watch(cli_guests *guests, cli_guest *guest)
{
    if (guest != NULL) {
        (void)pthread_mutex_lock(&guests->lock);
        guest->watches = true;
        (void)pthread_mutex_unlock(&guests->lock);
    }
}

void cli_guests_leave(cli_guests *guests, cli_guest *guest)
{
    if (guest != NULL) {
        (void)pthread_mutex_lock(&guests->lock);
        guest->socket = -1;
        (void)pthread_mutex_unlock(&guests->lock);
    }
}
