// SPDX-License-Identifier: GPL-3.0-or-later
// The places that a run was watched at: where they are, and their motion.
#include "report/run.h"

enum { MOST_DRAWN = 24, BUCKETS = 300, NAME = 64 };

const double *lac_page_point_column(lac_page *page, const lac_page_points *points, const char *name,
                                    size_t point)
{
    const lac_stored_values all = lac_page_values(page, page->file, name);
    if (all.value == NULL || all.n < page->n || all.width != points->all) {
        return NULL;
    }
    double *values = lac_page_room(page, page->n * sizeof *values);
    for (size_t i = 0; values != NULL && i < page->n; i++) {
        values[i] = all.value[i * all.width + point];
    }
    return values;
}

// The names of a run in memory, or of its file.
bool lac_page_read_points(lac_page *page, lac_page_points *points)
{
    static const char variable[] = "point_name";
    const lac_recording *recording = page->def->recording;
    const lac_stored_values x = lac_page_values(page, page->file, "point_x");
    *points = (lac_page_points){.all = x.n};
    if (x.value == NULL || x.n == 0) {
        return false;
    }
    points->name = lac_page_room(page, points->all * sizeof *points->name);
    if (points->name != NULL && recording != NULL) {
        for (size_t k = 0; k < points->all; k++) {
            if (lac_dataset_text(lac_recording_dataset(recording), variable, k, points->name[k],
                                 NAME, NULL) != LAC_OK) {
                return false;
            }
        }
    } else if (points->name != NULL) {
        lac_stored_shape shape;
        char **text = NULL;
        if (lac_stored_file_shape(page->file, variable, &shape, NULL) != LAC_OK ||
            shape.count != points->all || !shape.text ||
            lac_stored_file_texts(page->file, variable, &shape, &text, NULL) != LAC_OK) {
            return false;
        }
        for (size_t k = 0; k < points->all; k++) {
            (void)snprintf(points->name[k], NAME, "%s", text[k]);
        }
        free((void *)text);
    }
    return points->name != NULL;
}

static void write_columns(lac_page *page, const char *key, size_t n, const double *const *column,
                          const uint8_t *keep)
{
    lac_json_open(&page->json, key, '[');
    for (size_t k = 0; k < n; k++) {
        lac_page_column(page, NULL, page->n, column[k], keep, 6);
    }
    lac_json_close(&page->json, ']');
}

static void write_places(lac_page *page, size_t n)
{
    static const char *const names[][2] = {
        {"x", "point_x"},           {"y", "point_y"},         {"cell_x", "point_cell_x"},
        {"cell_y", "point_cell_y"}, {"cells", "point_cells"}, {"distance", "point_distance"},
    };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const lac_stored_values v = lac_page_values(page, page->file, names[i][1]);
        lac_page_column(page, names[i][0], v.n < n ? v.n : n, v.value, NULL, 8);
    }
}

void lac_page_points_section(lac_page *page, const char *key)
{
    lac_page_points points;
    const double *slip[MOST_DRAWN], *rate[MOST_DRAWN];
    if (!lac_page_read_points(page, &points)) {
        return;
    }
    const size_t n = points.all < MOST_DRAWN ? points.all : MOST_DRAWN;
    for (size_t k = 0; k < n; k++) {
        slip[k] = lac_page_point_column(page, &points, "point_slip", k);
        rate[k] = lac_page_point_column(page, &points, "point_slip_rate", k);
        if (slip[k] == NULL || rate[k] == NULL) {
            return;
        }
    }
    uint8_t *keep = lac_page_room(page, page->n);
    if (keep == NULL) {
        return;
    }
    (void)lac_page_thin(page->n, page->time, page->before, BUCKETS, n, rate, keep);
    lac_json_open(&page->json, key, '{');
    lac_json_integer(&page->json, "all", (int64_t)points.all);
    lac_json_open(&page->json, "name", '[');
    for (size_t k = 0; k < n; k++) {
        lac_json_text(&page->json, NULL, points.name[k]);
    }
    lac_json_close(&page->json, ']');
    write_places(page, n);
    lac_page_column(page, "time", page->n, page->time, keep, 12);
    lac_page_column(page, "before", page->n, page->before, keep, 6);
    write_columns(page, "slip", n, slip, keep);
    write_columns(page, "rate", n, rate, keep);
    lac_json_close(&page->json, '}');
}
