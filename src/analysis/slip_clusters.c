// SPDX-License-Identifier: GPL-3.0-or-later
// Union-find on a torus: each cell keeps its place relative to the root of its cluster, as if the
// interface were unrolled. A connected set leaves no line out between its first and its last there,
// so that it occupies as many lines of the interface as lie between them, or all.
#include "analysis/slipping.h"

enum { AHEAD = 4 };
enum { SHARE = 8, MOST_CREDIT = 2 }; // of all cells: joined anew a record, saved up at most

// Where each neighbour lies [cells]. The first four are ahead: with them each pair comes up once.
static const int32_t neighbour_x[LAC_NEIGHBOURS] = {1, -1, 0, 1, -1, 1, 0, -1};
static const int32_t neighbour_y[LAC_NEIGHBOURS] = {0, 1, 1, 1, 0, -1, -1, -1};

uint32_t *lac_neighbours_find(const lac_domain *domain)
{
    const size_t cells = lac_grid_cells(&domain->grid);
    uint32_t *at = malloc(cells * sizeof *at);
    uint32_t *neighbour = malloc(LAC_NEIGHBOURS * domain->n * sizeof *neighbour);
    if (at == NULL || neighbour == NULL) {
        free(at);
        free(neighbour);
        return NULL;
    }
    memset(at, 0xff, cells * sizeof *at);
    for (size_t i = 0; i < domain->n; i++) {
        at[domain->index[i]] = (uint32_t)i;
    }
    for (size_t i = 0; i < LAC_NEIGHBOURS * domain->n; i++) {
        size_t k = i % LAC_NEIGHBOURS;
        size_t there = lac_grid_beside(&domain->grid, domain->index[i / LAC_NEIGHBOURS],
                                       neighbour_x[k], neighbour_y[k]);
        neighbour[i] = there != SIZE_MAX ? at[there] : UINT32_MAX;
    }
    free(at);
    return neighbour;
}

lac_status lac_slip_clusters_create(const lac_domain *domain, lac_slip_clusters *out,
                                    lac_error *err)
{
    const size_t n = domain->n;
    *out = (lac_slip_clusters){.grid = domain->grid, .n = n, .credit = MOST_CREDIT * n};
    out->neighbour = lac_neighbours_find(domain);
    out->node = calloc(n, sizeof *out->node);
    out->box = calloc(n, sizeof *out->box);
    out->in = calloc(n, sizeof *out->in);
    const bool room = out->neighbour != NULL && out->node != NULL && out->box != NULL;
    LAC_FAIL_MEMORY_IF(!room || out->in == NULL, err);
    return LAC_OK;
}

void lac_slip_clusters_clear(lac_slip_clusters *c)
{
    free(c->neighbour);
    free(c->node);
    free(c->box);
    free(c->in);
    *c = (lac_slip_clusters){0};
}

// The root of a cell's cluster; the cell's place relative to it. Halves the way as it goes.
static uint32_t find(lac_cluster_node *node, uint32_t i, int32_t *x, int32_t *y)
{
    *x = *y = 0;
    while (node[i].parent != i) {
        lac_cluster_node *here = &node[i];
        const lac_cluster_node *above = &node[here->parent];
        if (above->parent != here->parent) {
            here->x += above->x;
            here->y += above->y;
            here->parent = above->parent;
        }
        *x += here->x;
        *y += here->y;
        i = here->parent;
    }
    return i;
}

static double lines(int32_t first, int32_t last, size_t n)
{
    return fmin((double)last - (double)first + 1.0, (double)n);
}

static void measure(lac_slip_clusters *c, const lac_cluster_box *box)
{
    const lac_grid *grid = &c->grid;
    c->extent = fmax(c->extent, lac_grid_extent(grid, lines(box->x0, box->x1, grid->nx),
                                                lines(box->y0, box->y1, grid->ny)));
}

static int32_t smaller(int32_t a, int32_t b) { return a < b ? a : b; }
static int32_t larger(int32_t a, int32_t b) { return a > b ? a : b; }

// Puts a cluster, its root at (x, y) relative to the other's, into the other.
static void merge(lac_slip_clusters *c, uint32_t from, uint32_t into, int32_t x, int32_t y)
{
    const lac_cluster_box *a = &c->box[from];
    lac_cluster_box *b = &c->box[into];
    c->node[from] = (lac_cluster_node){.parent = into, .x = x, .y = y};
    b->size += a->size;
    b->x0 = smaller(b->x0, a->x0 + x);
    b->x1 = larger(b->x1, a->x1 + x);
    b->y0 = smaller(b->y0, a->y0 + y);
    b->y1 = larger(b->y1, a->y1 + y);
    measure(c, b);
}

// Joins two neighbours, the second a step (dx, dy) from the first.
static void join(lac_slip_clusters *c, uint32_t i, uint32_t j, size_t k)
{
    int32_t xi, yi, xj, yj;
    uint32_t a = find(c->node, i, &xi, &yi);
    uint32_t b = find(c->node, j, &xj, &yj);
    if (a == b) {
        return;
    }
    // Where the second root lies from the first.
    int32_t x = xi + neighbour_x[k] - xj, y = yi + neighbour_y[k] - yj;
    bool swap = c->box[a].size < c->box[b].size;
    merge(c, swap ? a : b, swap ? b : a, swap ? -x : x, swap ? -y : y);
}

static void enter(lac_slip_clusters *c, uint32_t i)
{
    c->in[i] = 1;
    c->node[i] = (lac_cluster_node){.parent = i};
    c->box[i] = (lac_cluster_box){.size = 1};
}

static void join_all(lac_slip_clusters *c, uint32_t i, size_t neighbours)
{
    for (size_t k = 0; k < neighbours; k++) {
        uint32_t j = c->neighbour[LAC_NEIGHBOURS * i + k];
        if (j != UINT32_MAX && c->in[j]) {
            join(c, i, j, k);
        }
    }
}

static void rebuild(lac_slip_clusters *c, const uint8_t *slips)
{
    c->extent = 0.0;
    memset(c->in, 0, c->n);
    for (uint32_t i = 0; i < c->n; i++) {
        if (slips[i]) {
            enter(c, i);
            measure(c, &c->box[i]);
        }
    }
    for (uint32_t i = 0; i < c->n; i++) {
        if (slips[i]) {
            join_all(c, i, AHEAD);
        }
    }
}

void lac_slip_clusters_update(lac_slip_clusters *c, const uint8_t *slips, size_t slipping,
                              const uint32_t *changed, size_t changes)
{
    const size_t cost = slipping + c->n / (2 * SHARE); // to go through all cells is not free either
    size_t credit = c->credit + c->n / SHARE + 1;
    c->credit = credit < MOST_CREDIT * c->n ? credit : MOST_CREDIT * c->n;
    for (size_t k = 0; k < changes; k++) {
        c->stale |= !slips[changed[k]];
    }
    if (!c->stale) {
        for (size_t k = 0; k < changes; k++) {
            enter(c, changed[k]);
            measure(c, &c->box[changed[k]]);
            join_all(c, changed[k], LAC_NEIGHBOURS);
        }
    } else if (c->credit >= cost) {
        c->credit -= cost;
        c->stale = false;
        rebuild(c, slips);
    } else {
        c->extent = NAN;
    }
}

void lac_slip_clusters_serialize(lac_slip_clusters *c, lac_archive *archive)
{
    lac_archive_pass(archive, c->node, c->n * sizeof *c->node);
    lac_archive_pass(archive, c->box, c->n * sizeof *c->box);
    lac_archive_pass(archive, c->in, c->n * sizeof *c->in);
    LAC_PASS(archive, c->credit);
    LAC_PASS(archive, c->stale);
    LAC_PASS(archive, c->extent);
}
