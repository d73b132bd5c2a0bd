// SPDX-License-Identifier: GPL-3.0-or-later
// The fractal options of `lacuna contact`, such as --boxes 2:32, read and checked.
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "cli/contact/fractal.h"

static const char *const names[] = {[LAC_SAMPLE] = "sample", [LAC_BLOCK_MEAN] = "block-mean"};

static lac_status read_coarsening(const char *text, lac_coarsening *coarsening, lac_error *err)
{
    for (int i = LAC_SAMPLE; i <= LAC_BLOCK_MEAN; i++) {
        if (strcmp(text, names[i]) == 0) {
            *coarsening = (lac_coarsening)i;
            return LAC_OK;
        }
    }
    return lac_fail(err, LAC_EINPUT, "--coarsening: \"%.60s\" must be sample or block-mean", text);
}

static bool is_power_of_two(unsigned long n) { return n != 0 && (n & (n - 1)) == 0; }

// "2:32"
static lac_status read_boxes(const char *text, lac_box_def *boxes, lac_error *err)
{
    char *colon;
    char *end = "";
    unsigned long smallest = strtoul(text, &colon, 10);
    unsigned long largest = *colon == ':' ? strtoul(colon + 1, &end, 10) : 0;
    if (strspn(text, "0123456789:") != strlen(text) || *end != '\0' || !is_power_of_two(smallest) ||
        !is_power_of_two(largest) || largest <= smallest) {
        return lac_fail(err, LAC_EINPUT,
                        "--boxes: \"%.60s\" must be two sides in cells, powers of two: 2:32", text);
    }
    boxes->smallest = smallest;
    boxes->largest = largest;
    return LAC_OK;
}

static lac_status read_coarsest(const char *text, size_t *coarsest, lac_error *err)
{
    unsigned long n = strtoul(text, NULL, 10);
    if (strspn(text, "0123456789") != strlen(text) || n < 2 || n > 1ul << 20) {
        return lac_fail(err, LAC_EINPUT, "--coarsest: \"%.60s\" must be a number of cells from 2",
                        text);
    }
    *coarsest = n;
    return LAC_OK;
}

// "50 mm, 1 m"
static lac_status read_sizes(const char *text, lac_scene_measure_def *def, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_units *units = NULL;
    char *copy = strdup(text);
    char *rest = copy;
    if (copy == NULL) {
        return lac_fail_memory(err);
    }
    LAC_TRY(lac_units_create(&units, err));
    def->sizes = 0;
    while (rest != NULL) {
        const char *word = strsep(&rest, ",");
        double size = 0;
        status = lac_units_parse(units, word + strspn(word, " "), "m", &size, err);
        if (status == LAC_OK && !(size > 0)) {
            status = lac_fail(err, LAC_EINPUT, "must be > 0");
        }
        if (status == LAC_OK && def->sizes == LAC_SCENE_SIZES) {
            status = lac_fail(err, LAC_EINPUT, "is one more than %d", LAC_SCENE_SIZES);
        }
        if (status != LAC_OK) {
            status = lac_fail_within(err, status, "--sizes: \"%.60s\"", word);
            goto out;
        }
        def->size[def->sizes++] = size;
    }
out:
    lac_units_free(units);
    free(copy);
    return status;
}

lac_status cli_fractal_read(const cli_request *request, lac_scene_measure_def *def, lac_error *err)
{
    lac_status status = LAC_OK;
    *def = lac_scene_measure_default();
    if (request->boxes != NULL) {
        LAC_TRY(read_boxes(request->boxes, &def->boxes, err));
    }
    if (request->coarsest != NULL) {
        LAC_TRY(read_coarsest(request->coarsest, &def->scaling.coarsest, err));
    }
    if (request->coarsening != NULL) {
        LAC_TRY(read_coarsening(request->coarsening, &def->scaling.coarsening, err));
    }
    if (request->sizes != NULL) {
        LAC_TRY(read_sizes(request->sizes, def, err));
    }
out:
    return status;
}
