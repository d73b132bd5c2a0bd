// SPDX-License-Identifier: GPL-3.0-or-later
// Fractal measures of a solved contact, for which coarser grids are solved under the same load.
#include <math.h>
#include <string.h>

#include "scene/internal.h"

lac_scene_measure_def lac_scene_measure_default(void)
{
    static const double sizes[] = {0.05, 0.1, 0.2, 0.4, 1, 10, 100, 1000};
    lac_scene_measure_def def = {.scaling = lac_scaling_default(),
                                 .boxes = lac_box_default(),
                                 .sizes = sizeof sizes / sizeof sizes[0]};
    memcpy(def.size, sizes, sizeof sizes);
    return def;
}

static lac_status measure_clusters(lac_scene_contact *contact, lac_error *err)
{
    lac_clusters *clusters = NULL;
    lac_status status = lac_clusters_create(contact->domain, &clusters, err);
    if (status == LAC_OK) {
        contact->fractal.clusters = lac_clusters_summarise(clusters, &contact->grid);
        contact->fractal.clustered = true;
    }
    lac_clusters_free(clusters);
    return status;
}

// Solves the coarser resolutions under the load of the finest, which is there.
static lac_status measure_scaling(const lac_scaling_def *how, lac_scene_contact *contact,
                                  lac_error *err)
{
    LAC_FAIL_IF(!contact->solved, err, LAC_EINPUT, "no surface is pressed");
    const lac_contact_def def = lac_scene_contact_def(contact);
    lac_scaling_def scaling = *how;
    scaling.finest = contact->pressure;
    lac_status status = lac_scaling_measure(&def, &scaling, &contact->fractal.scaling, err);
    double dimension = contact->fractal.scaling.dimension;
    LAC_FAIL_IF(status == LAC_OK && !(dimension > 0 && dimension <= 2), err, LAC_EINPUT,
                "the areas follow no law: it would be %.3g", dimension);
    return status;
}

// Strength of specimens beside that of this interface.
static lac_status measure_sizes(const lac_scene_measure_def *def, lac_scene_contact *contact,
                                lac_error *err)
{
    lac_scene_fractal *fractal = &contact->fractal;
    const lac_grid *grid = &contact->grid;
    const lac_size_def size = {.dimension = fractal->scaling.dimension,
                               .error = fractal->scaling.error,
                               .size = sqrt(lac_grid_area(grid)),
                               .pressure = contact->mean_pressure};
    fractal->sizes = def->sizes;
    return lac_size_effect(&size, def->sizes, def->size, fractal->size, err);
}

static bool same_boxes(const lac_box_def *a, const lac_box_def *b)
{
    return a->smallest == b->smallest && a->largest == b->largest && a->origins == b->origins &&
           a->seed == b->seed;
}

lac_status lac_scene_contact_measure(const lac_scene_measure_def *def, lac_scene_contact *contact,
                                     lac_error *err)
{
    lac_status status = LAC_OK;
    lac_scene_fractal *fractal = &contact->fractal;
    lac_box_def counted = lac_box_default();
    *fractal = (lac_scene_fractal){0};
    LAC_FAIL_IF(def->sizes > LAC_SCENE_SIZES, err, LAC_EINPUT,
                "size effect: %zu specimens; at most %d", def->sizes, LAC_SCENE_SIZES);
    if (!same_boxes(&def->boxes, &counted)) {
        contact->counted = false;
        LAC_TRY(lac_box_dimension(contact->domain, &def->boxes, &contact->boxes, err));
        contact->counted = true;
    }
    LAC_TRY(measure_clusters(contact, err));
    status = measure_scaling(&def->scaling, contact, &fractal->why);
    fractal->scaled = status == LAC_OK;
    LAC_FAIL_MEMORY_IF(status == LAC_ENOMEM, err);
    status = LAC_OK;
    if (fractal->scaled) {
        LAC_TRY(measure_sizes(def, contact, err));
    }
out:
    return status;
}
