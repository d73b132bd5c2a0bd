// SPDX-License-Identifier: GPL-3.0-or-later
// Gridded points `x y z`, one a line, in any order; nodes without a point are masked.
#include <gsl/gsl_sort.h>

#include "surface/read.h"

// Coordinates closer than this part of their extent are one: writers round.
static const double same = 1e-7;
// How far from its node a point may lie [spacings].
static const double off_node = 0.1;
// Nodes per point: a file with fewer points is scattered, not gridded.
enum { NODES_PER_POINT = 8 };

typedef struct point {
    double x[3];
    size_t line;
} point;

typedef struct points {
    point *at;
    size_t n, capacity;
} points;

// Regular positions along x or y.
typedef struct axis {
    char name;
    double first, spacing;
    uint64_t n;
} axis;

// Beginnings of a remark.
static const char remarks[] = "#;%!";

static bool is_remark(lac_word word)
{
    return word.length > 0 && word.text[0] != '\0' && strchr(remarks, word.text[0]) != NULL;
}

static bool is_numeric(char c) { return strchr("0123456789+-.", c) != NULL && c != '\0'; }

// A text whose first line that is no remark begins like a number, or names x, y and z.
static bool is_xyz(const lac_bytes *bytes)
{
    lac_scan scan = lac_scan_begin(bytes);
    do {
        lac_word word;
        if (lac_scan_word(&scan, &word) && !is_remark(word)) {
            return is_numeric(word.text[0]) || word.text[0] == 'x' || word.text[0] == 'X' ||
                   lac_word_is(word, "nan");
        }
    } while (lac_scan_line(&scan));
    return false;
}

static bool has_blank(lac_word word)
{
    return memchr(word.text, ' ', word.length) != NULL ||
           memchr(word.text, '\t', word.length) != NULL;
}

// Three fields between blanks, or between two commas or semicolons.
static size_t split(lac_word line, lac_word field[4])
{
    for (const char *mark = ";,"; *mark != '\0'; mark++) {
        size_t n = 0;
        const char *end = line.text + line.length;
        for (const char *at = line.text; n < 4; n++) {
            const char *stop = memchr(at, *mark, (size_t)(end - at));
            lac_scan part = {.at = at, .end = stop != NULL ? stop : end};
            field[n] = lac_scan_rest(&part);
            at = stop != NULL ? stop + 1 : end;
            if (stop == NULL) {
                n++;
                break;
            }
        }
        if (n == 3 && !has_blank(field[0]) && !has_blank(field[1]) && !has_blank(field[2])) {
            return n;
        }
    }
    size_t n = 0;
    lac_scan part = {.at = line.text, .end = line.text + line.length};
    while (n < 4 && lac_scan_word(&part, &field[n])) {
        n++;
    }
    return n;
}

static lac_status add_point(points *p, point new, lac_error *err)
{
    LAC_TRY_RETURN(lac_grow(&p->at, &p->capacity, p->n + 1, sizeof *p->at, err));
    p->at[p->n++] = new;
    return LAC_OK;
}

static lac_status read_line(const lac_scan *scan, lac_word line, points *p, lac_error *err)
{
    lac_word field[4];
    char shown[40];
    size_t n = split(line, field);
    point new = {.line = scan->line};
    LAC_FAIL_IF(n != 3, err, LAC_EINPUT, "%s:%zu: \"%s\" %s; must be the three numbers x y z",
                scan->path, scan->line, lac_word_show(line, shown, sizeof shown),
                n > 3 ? "has more than three columns" : "has fewer than three columns");
    for (size_t k = 0; k < 3; k++) {
        LAC_TRY_RETURN(lac_scan_number(scan, field[k], &new.x[k], err));
        LAC_FAIL_IF(k < 2 && isnan(new.x[k]), err, LAC_EINPUT,
                    "%s:%zu: %c is nan; only z may be missing", scan->path, scan->line,
                    k == 0 ? 'x' : 'y');
    }
    return add_point(p, new, err);
}

static lac_status read_points(const lac_bytes *bytes, points *p, lac_error *err)
{
    lac_scan scan = lac_scan_begin(bytes);
    lac_scan_decimal(&scan, remarks);
    do {
        lac_word line = lac_scan_rest(&scan);
        bool header = p->n == 0 && line.length > 0 && (line.text[0] | 0x20) == 'x';
        if (line.length == 0 || is_remark(line) || header) {
            continue;
        }
        LAC_TRY_RETURN(read_line(&scan, line, p, err));
    } while (lac_scan_line(&scan));
    return p->n > 0 ? LAC_OK
                    : lac_fail(err, LAC_EINPUT, "%s:%zu: the file ends without a point",
                               bytes->path, scan.line);
}

// The node of a coordinate; false where it is none.
static bool node_of(const axis *a, double x, size_t *node)
{
    double u = a->spacing > 0.0 ? (x - a->first) / a->spacing : 0.0;
    double k = round(u);
    *node = (size_t)fmax(k, 0.0);
    return fabs(u - k) <= off_node;
}

static bool fits(const axis *a, const double *x, size_t n)
{
    size_t node;
    for (size_t i = 0; i < n; i++) {
        if (!node_of(a, x[i], &node)) {
            return false;
        }
    }
    return true;
}

// Spacing from the number of different positions, or, where some are missing, the smallest step.
static void find_spacing(axis *a, const double *x, size_t n)
{
    double extent = x[n - 1] - x[0];
    double smallest = extent;
    uint64_t different = 1;
    for (size_t i = 1; i < n; i++) {
        double step = x[i] - x[i - 1];
        if (step > same * extent) {
            different++;
            smallest = fmin(smallest, step);
        }
    }
    a->first = x[0];
    a->n = different;
    a->spacing = different > 1 ? extent / (double)(different - 1) : 0.0;
    if (different > 1 && !fits(a, x, n)) {
        a->n = (uint64_t)llround(extent / smallest) + 1;
        a->spacing = extent / (double)(a->n - 1);
    }
}

static lac_status find_axis(const lac_bytes *bytes, const points *p, size_t k, axis *a,
                            lac_error *err)
{
    lac_status status = LAC_OK;
    size_t node;
    double *x = malloc((p->n + 1) * sizeof *x);
    LAC_FAIL_MEMORY_IF(x == NULL, err);
    for (size_t i = 0; i < p->n; i++) {
        x[i] = p->at[i].x[k];
    }
    gsl_sort(x, 1, p->n);
    a->name = k == 0 ? 'x' : 'y';
    LAC_LEAVE_IF(!isfinite(x[p->n - 1] - x[0]), err, LAC_EINPUT,
                 "%s: %c goes from %g to %g; no grid is that large", bytes->path, a->name, x[0],
                 x[p->n - 1]);
    find_spacing(a, x, p->n);
    for (size_t i = 0; i < p->n; i++) {
        LAC_LEAVE_IF(!node_of(a, p->at[i].x[k], &node), err, LAC_EINPUT,
                     "%s:%zu: %c = %g is off the grid from %g in steps of %g; points must be "
                     "gridded at a regular spacing along x and y (turn a grid that is rotated)",
                     bytes->path, p->at[i].line, a->name, p->at[i].x[k], a->first, a->spacing);
    }
out:
    free(x);
    return status;
}

// The points on their nodes. `taken` [n] is all zero.
static lac_status place(const lac_bytes *bytes, const points *p, const axis a[2], size_t *taken,
                        lac_height_map *map, lac_error *err)
{
    for (size_t i = 0; i < map->nx * map->ny; i++) {
        map->heights[i] = (double)NAN;
    }
    for (size_t i = 0; i < p->n; i++) {
        size_t ix = 0, iy = 0;
        (void)node_of(&a[0], p->at[i].x[0], &ix);
        (void)node_of(&a[1], p->at[i].x[1], &iy);
        size_t at = iy * map->nx + ix;
        double old = map->heights[at], new = p->at[i].x[2];
        if (taken[at] != 0 && (old == new || (isnan(old) && isnan(new)))) {
            continue; // measured twice, alike
        }
        LAC_FAIL_IF(taken[at] != 0, err, LAC_EINPUT,
                    "%s:%zu: the point x = %g, y = %g stands in line %zu already, with another "
                    "height, %g, not %g",
                    bytes->path, p->at[i].line, p->at[i].x[0], p->at[i].x[1], taken[at], old, new);
        taken[at] = p->at[i].line;
        map->heights[at] = new;
    }
    return LAC_OK;
}

static lac_status read_xyz(const lac_bytes *bytes, lac_height_map *map, lac_error *err)
{
    lac_status status;
    points p = {0};
    axis a[2] = {{0}, {0}};
    size_t *taken = NULL;
    LAC_TRY(read_points(bytes, &p, err));
    LAC_TRY(find_axis(bytes, &p, 0, &a[0], err));
    LAC_TRY(find_axis(bytes, &p, 1, &a[1], err));
    size_t most = NODES_PER_POINT * p.n;
    LAC_LEAVE_IF(
        a[0].n > most || a[1].n > most || a[0].n * a[1].n > most, err, LAC_EINPUT,
        "%s: %zu points on %llu x %llu nodes of a regular grid; must be gridded along x and y "
        "(turn a grid that is rotated), with a point on one node in %d at least",
        bytes->path, p.n, (unsigned long long)a[0].n, (unsigned long long)a[1].n, NODES_PER_POINT);
    LAC_TRY(lac_map_size(map, bytes->path, a[0].n, a[1].n, most, err));
    taken = calloc(map->nx * map->ny, sizeof *taken);
    LAC_TRY(taken != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(place(bytes, &p, a, taken, map, err));
    map->dx = a[0].n > 1 ? a[0].spacing : (double)NAN;
    map->dy = a[1].n > 1 ? a[1].spacing : (double)NAN;
    map->x = a[0].first;
    map->y = a[1].first;
out:
    free(taken);
    free(p.at);
    return status;
}

const lac_map_format lac_map_xyz = {"xyz", is_xyz, read_xyz};
