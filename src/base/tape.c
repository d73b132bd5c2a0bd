// SPDX-License-Identifier: GPL-3.0-or-later
// A state that is saved and loaded by the same calls: each piece goes to the tape or comes from it.
#include "base/tape.h"

#include <stdlib.h>
#include <string.h>

static bool make_room(lac_tape *tape, size_t size)
{
    if (size <= tape->room - tape->size) {
        return true;
    }
    size_t room = 2 * tape->room + size + 1024;
    unsigned char *grown = realloc(tape->bytes, room);
    if (grown == NULL) {
        tape->no_memory = true;
        return false;
    }
    tape->bytes = grown;
    tape->room = room;
    return true;
}

void lac_tape_pass(lac_tape *tape, void *piece, size_t size)
{
    if (!lac_tape_good(tape) || size == 0) {
        return;
    }
    if (!tape->loading) {
        if (make_room(tape, size)) {
            memcpy(tape->bytes + tape->size, piece, size);
            tape->size += size;
        }
    } else if (size > tape->size - tape->at) {
        tape->short_of = true;
    } else {
        memcpy(piece, tape->bytes + tape->at, size);
        tape->at += size;
    }
}
