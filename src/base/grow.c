// SPDX-License-Identifier: GPL-3.0-or-later
// Arrays that grow as they are filled.
#include "base/base.h"

lac_status lac_grow(void *array, size_t *room, size_t need, size_t size, lac_error *err)
{
    const size_t larger = need > 2 * *room ? need + 7 : 2 * *room;
    void *at;
    if (need <= *room) {
        return LAC_OK;
    }
    memcpy(&at, array, sizeof at);
    at = realloc(at, larger * size);
    LAC_FAIL_MEMORY_IF(at == NULL, err);
    memcpy(array, &at, sizeof at);
    *room = larger;
    return LAC_OK;
}
