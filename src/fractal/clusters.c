// SPDX-License-Identifier: GPL-3.0-or-later
// Groups of contact cells that hang together, also across the edges of a periodic grid.
#include "fractal/fractal.h"

// One cluster while they are put in order.
typedef struct rank {
    uint32_t size, first; // cells; its first cell in the domain
} rank;

static uint32_t root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

// The earlier cell of the domain becomes the root, so that a root is its cluster's first cell.
static void join(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = root(parent, a);
    b = root(parent, b);
    if (a < b) {
        parent[b] = a;
    } else {
        parent[a] = b;
    }
}

// Joins cell i with the four of its neighbours that lie ahead: each pair is seen once.
static void join_neighbours(const lac_domain *domain, const uint32_t *at, uint32_t i,
                            uint32_t *parent)
{
    static const int ahead[4][2] = {{1, 0}, {-1, 1}, {0, 1}, {1, 1}};
    for (size_t k = 0; k < 4; k++) {
        size_t there = lac_grid_beside(&domain->grid, domain->index[i], ahead[k][0], ahead[k][1]);
        if (there != SIZE_MAX && at[there] != UINT32_MAX) {
            join(parent, i, at[there]);
        }
    }
}

static int by_size(const void *left, const void *right)
{
    const rank *a = left, *b = right;
    if (a->size != b->size) {
        return a->size > b->size ? -1 : 1;
    }
    return a->first < b->first ? -1 : a->first > b->first;
}

// Each cell's root becomes its cluster's number; sizes are counted. Ranks has room for each cell.
static void number(lac_clusters *c, uint32_t *parent, rank *ranks)
{
    for (size_t i = 0; i < c->cells; i++) {
        uint32_t r = root(parent, (uint32_t)i);
        if (r == i) {
            c->label[i] = (uint32_t)c->n;
            ranks[c->n++] = (rank){.size = 0, .first = r};
        }
        ranks[c->label[r]].size++;
    }
    qsort(ranks, c->n, sizeof *ranks, by_size);
    for (size_t k = 0; k < c->n; k++) {
        c->label[ranks[k].first] = (uint32_t)k;
    }
    for (size_t i = 0; i < c->cells; i++) {
        c->label[i] = c->label[root(parent, (uint32_t)i)];
    }
}

// A connected set leaves no line out between the first and the last, so its extent is the number
// of lines that it occupies, also round a periodic edge. `order` lists the
// cells of the domain cluster by cluster; `line` says which line each is on.
static void count_lines(const lac_clusters *c, const uint32_t *line, uint32_t *observation,
                        size_t lines, const uint32_t *order, uint32_t *extent)
{
    memset(observation, 0xff, lines * sizeof *observation);
    for (size_t k = 0, j = 0; k < c->n; k++) {
        extent[k] = 0;
        for (size_t end = j + c->size[k]; j < end; j++) {
            extent[k] += observation[line[order[j]]] != k;
            observation[line[order[j]]] = (uint32_t)k;
        }
    }
}

// The cells of the domain cluster by cluster.
static void group(const lac_clusters *c, uint32_t *next, uint32_t *order)
{
    uint32_t start = 0;
    for (size_t k = 0; k < c->n; k++) {
        next[k] = start;
        start += c->size[k];
    }
    for (size_t i = 0; i < c->cells; i++) {
        order[next[c->label[i]]++] = (uint32_t)i;
    }
}

// Columns and rows of each cluster. Scratch: `seen` has one entry per column or row, line and order
// one per cell of the domain.
static void measure(const lac_domain *domain, lac_clusters *c, uint32_t *observation,
                    uint32_t *line, uint32_t *order)
{
    const lac_grid *grid = &domain->grid;
    const uint32_t nx = (uint32_t)grid->nx;
    group(c, line, order);
    for (int axis = 0; axis < 2; axis++) {
        for (size_t i = 0; i < c->cells; i++) {
            line[i] = axis == 0 ? domain->index[i] % nx : domain->index[i] / nx;
        }
        count_lines(c, line, observation, axis == 0 ? grid->nx : grid->ny, order,
                    axis == 0 ? c->width : c->depth);
    }
}

lac_status lac_clusters_create(const lac_domain *domain, lac_clusters **out, lac_error *err)
{
    *out = NULL;
    lac_status status = LAC_OK;
    size_t cells = lac_grid_cells(&domain->grid);
    LAC_FAIL_IF(domain->n == 0, err, LAC_EINPUT, "clusters: no cell is in contact");
    lac_clusters *c = *out = calloc(1, sizeof *c);
    uint32_t *at = malloc(cells * sizeof *at);
    uint32_t *parent = malloc(domain->n * sizeof *parent);
    rank *ranks = malloc(domain->n * sizeof *ranks);
    if (c != NULL) {
        c->label = malloc(domain->n * sizeof *c->label);
    }
    LAC_TRY(c != NULL && c->label != NULL && at != NULL && parent != NULL && ranks != NULL
                ? LAC_OK
                : lac_fail_memory(err));
    memset(at, 0xff, cells * sizeof *at);
    for (uint32_t i = 0; i < domain->n; i++) {
        at[domain->index[i]] = i;
        parent[i] = i;
    }
    for (uint32_t i = 0; i < domain->n; i++) {
        join_neighbours(domain, at, i, parent);
    }
    c->cells = domain->n;
    number(c, parent, ranks);
    c->size = malloc(3 * c->n * sizeof *c->size);
    LAC_TRY(c->size != NULL ? LAC_OK : lac_fail_memory(err));
    c->width = c->size + c->n;
    c->depth = c->width + c->n;
    for (size_t k = 0; k < c->n; k++) {
        c->size[k] = ranks[k].size;
    }
    // Nothing of the ranks is needed any more: their room holds the order of the cells.
    measure(domain, c, at, parent, (uint32_t *)ranks);
out:
    free(at);
    free(parent);
    free(ranks);
    LAC_MADE(status, out, lac_clusters_free);
}

void lac_clusters_free(lac_clusters *clusters)
{
    if (clusters != NULL) {
        free(clusters->label);
        free(clusters->size);
    }
    free(clusters);
}

double lac_cluster_extent(const lac_clusters *clusters, const lac_grid *grid, size_t cluster)
{
    return lac_grid_extent(grid, clusters->width[cluster], clusters->depth[cluster]);
}

lac_cluster_summary lac_clusters_summarise(const lac_clusters *clusters, const lac_grid *grid)
{
    lac_cluster_summary s = {.n = clusters->n, .cells = clusters->cells};
    double squares = 0;
    for (size_t k = 0; k < clusters->n; k++) {
        size_t i = lac_octave(clusters->size[k]);
        s.count[i]++;
        s.cells_of[i] += clusters->size[k];
        s.widest = fmax(s.widest, lac_cluster_extent(clusters, grid, k));
        squares += (double)clusters->size[k] * clusters->size[k];
    }
    if (clusters->n > 0) { // largest first
        s.largest = clusters->size[0];
        s.largest_extent = lac_cluster_extent(clusters, grid, 0);
        s.octaves = lac_octave(clusters->size[0]) + 1;
        s.mean = (double)clusters->cells / (double)clusters->n;
        s.weighted = squares / (double)clusters->cells;
    }
    return s;
}
