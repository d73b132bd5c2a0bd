// SPDX-License-Identifier: GPL-3.0-or-later
// What a public function asks of its arguments before it looks at them.
#include "base/ask.h"

lac_status lac_need(const char *function, const char *names, const void *const *pointer, size_t n,
                    lac_error *err)
{
    for (size_t i = 0; i < n; i++) {
        const size_t length = strcspn(names, ",");
        LAC_FAIL_IF(pointer[i] == NULL, err, LAC_EINPUT, "%s: \"%.*s\" must not be NULL", function,
                    (int)length, names);
        names += length;
        names += strspn(names, ", ");
    }
    return LAC_OK;
}

lac_status lac_take_options(const char *what, const void *given, void *own, size_t size,
                            lac_error *err)
{
    size_t told;
    if (given == NULL) {
        return LAC_OK;
    }
    memcpy(&told, given, sizeof told);
    LAC_FAIL_IF(told < sizeof told || told > size || told % sizeof told != 0, err, LAC_EINPUT,
                "%s of %zu bytes: up to %zu are known; start from %s_default", what, told, size,
                what);
    memcpy(own, given, told);
    return LAC_OK;
}
