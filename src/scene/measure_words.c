// SPDX-License-Identifier: GPL-3.0-or-later
// How a contact is measured, as words say it.
#include "base/units.h"
#include "scene/scene.h"

static lac_status read_coarsening(const char *text, lac_coarsening *coarsening, lac_error *err)
{
    const bool sample = strcmp(text, "sample") == 0;
    *coarsening = sample ? LAC_SAMPLE : LAC_BLOCK_MEAN;
    return sample || strcmp(text, "block-mean") == 0
               ? LAC_OK
               : lac_fail(err, LAC_EINPUT, "coarsening: \"%.60s\" must be sample or block-mean",
                          text);
}

static bool is_power_of_two(unsigned long n) { return n != 0 && (n & (n - 1)) == 0; }

// "2:32"
static lac_status read_boxes(const char *text, lac_box_def *boxes, lac_error *err)
{
    char *colon;
    char *end = "";
    unsigned long smallest = strtoul(text, &colon, 10);
    unsigned long largest = *colon == ':' ? strtoul(colon + 1, &end, 10) : 0;
    LAC_FAIL_IF(strspn(text, "0123456789:") != strlen(text) || *end != '\0' ||
                    !is_power_of_two(smallest) || !is_power_of_two(largest) || largest <= smallest,
                err, LAC_EINPUT, "boxes: \"%.60s\" must be two sides in cells, powers of two: 2:32",
                text);
    boxes->smallest = smallest;
    boxes->largest = largest;
    return LAC_OK;
}

static lac_status read_coarsest(const char *text, size_t *coarsest, lac_error *err)
{
    unsigned long n = strtoul(text, NULL, 10);
    LAC_FAIL_IF(strspn(text, "0123456789") != strlen(text) || n < 2 || n > 1ul << 20, err,
                LAC_EINPUT, "coarsest: \"%.60s\" must be a number of cells from 2", text);
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
    LAC_FAIL_MEMORY_IF(copy == NULL, err);
    LAC_TRY(lac_units_create(&units, err));
    def->sizes = 0;
    while (rest != NULL && status == LAC_OK) {
        const char *word = strsep(&rest, ",");
        double size = 0;
        status = lac_units_parse(units, word + strspn(word, " "), "m", &size, err);
        if (status == LAC_OK && !(size > 0)) {
            status = lac_fail(err, LAC_EINPUT, "must be > 0");
        } else if (status == LAC_OK && def->sizes == LAC_SCENE_SIZES) {
            status = lac_fail(err, LAC_EINPUT, "is one more than %d", LAC_SCENE_SIZES);
        } else if (status == LAC_OK) {
            def->size[def->sizes++] = size;
        }
        if (status != LAC_OK) {
            (void)lac_fail_within(err, status, "sizes: \"%.60s\"", word);
        }
    }
out:
    lac_units_free(units);
    free(copy);
    return status;
}

lac_status lac_scene_measure_read(const lac_measure_words *words, lac_scene_measure_def *def,
                                  lac_error *err)
{
    *def = lac_scene_measure_default();
    if (words->boxes != NULL) {
        LAC_TRY_RETURN(read_boxes(words->boxes, &def->boxes, err));
    }
    if (words->coarsest != NULL) {
        LAC_TRY_RETURN(read_coarsest(words->coarsest, &def->scaling.coarsest, err));
    }
    if (words->coarsening != NULL) {
        LAC_TRY_RETURN(read_coarsening(words->coarsening, &def->scaling.coarsening, err));
    }
    return words->sizes != NULL ? read_sizes(words->sizes, def, err) : LAC_OK;
}
