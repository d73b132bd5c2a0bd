// SPDX-License-Identifier: GPL-3.0-or-later
// Any bytes as a file of results: read as what it says that it holds, or refused with a message.
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <unistd.h>

#include "store/past.h"
#include "store/store_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool sound)
{
    if (!sound) {
        abort();
    }
}

static void check_status(lac_status status, const lac_error *err)
{
    require(status == LAC_OK ||
            ((status == LAC_EIO || status == LAC_EINPUT) && err->message[0] != '\0'));
}

// Every variable, as a whole and at a place.
static void read_variables(const lac_stored_file *file)
{
    char name[LAC_STORED_NAME], text[40];
    for (size_t i = 0; lac_stored_file_variable(file, i, name, sizeof name); i++) {
        lac_stored_values values = {0};
        lac_stored_shape shape;
        lac_error err = {""};
        check_status(lac_stored_file_shape(file, name, &shape, &err), &err);
        check_status(lac_stored_file_values(file, name, &values, &err), &err);
        require(values.value != NULL || values.n * values.width == 0);
        lac_stored_values_clear(&values);
        check_status(lac_stored_file_row(file, name, 1, &values, &err), &err);
        lac_stored_values_clear(&values);
        (void)lac_stored_file_text(file, name, "units", text, sizeof text);
        (void)lac_stored_file_number(file, name, "_FillValue");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char path[] = "/tmp/fuzz_dataset_XXXXXX";
    const int fd = mkstemp(path);
    require(fd >= 0 && write(fd, data, size) == (ssize_t)size && close(fd) == 0);
    lac_error err = {""};
    lac_stored_file *file = NULL;
    lac_stored_past past;
    lac_status status = lac_stored_file_open(path, &file, &err);
    check_status(status, &err);
    if (status == LAC_OK) {
        read_variables(file);
    }
    lac_stored_file_close(file);
    check_status(lac_stored_past_open(path, &past, &err), &err);
    lac_stored_past_clear(&past);
    (void)remove(path);
    return 0;
}
