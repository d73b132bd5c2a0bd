// SPDX-License-Identifier: GPL-3.0-or-later
// The cells in contact, listed in Morton order, in which the cells of any block stand side by side;
// and contact cells without a surface: all of them, those of a random cascade, or those of a file.
#include "base/rng.h"
#include "base/roots.h"
#include "base/rows.h"
#include "contact/contact.h"

// Moves bit i of a 32-bit number to bit 2i.
static uint64_t spread_bits(uint32_t bits)
{
    uint64_t x = bits;
    x = (x | x << 16) & UINT64_C(0x0000ffff0000ffff);
    x = (x | x << 8) & UINT64_C(0x00ff00ff00ff00ff);
    x = (x | x << 4) & UINT64_C(0x0f0f0f0f0f0f0f0f);
    x = (x | x << 2) & UINT64_C(0x3333333333333333);
    x = (x | x << 1) & UINT64_C(0x5555555555555555);
    return x;
}

uint64_t lac_morton(uint32_t ix, uint32_t iy) { return spread_bits(ix) | spread_bits(iy) << 1; }

static lac_status check_grid(const lac_grid *grid, lac_error *err)
{
    // Cells are counted in 32 bits throughout, with one number to spare for "one past the end".
    LAC_FAIL_IF(
        grid->nx == 0 || grid->ny == 0 || grid->nx > (UINT32_MAX - 1) / grid->ny, err, LAC_EINPUT,
        "an interface of %zu x %zu cells is not possible: at least one cell and at most 2^32 - 2",
        grid->nx, grid->ny);
    LAC_FAIL_IF(!(isfinite(grid->dx) && grid->dx > 0 && isfinite(grid->dy) && grid->dy > 0), err,
                LAC_EINPUT, "a cell of %g m x %g m is not possible: both must be > 0", grid->dx,
                grid->dy);
    return LAC_OK;
}

// The cells of a block in turn.
typedef struct collection {
    lac_domain *into;
    const double *pressure; // [ny * nx], or of what is listed
    lac_domain *listed;     // all that is in contact, row by row, where ranks have their rows; NULL
    size_t *next;           // [ny] where the rest of each row begins in that list
} collection;

static lac_status count_contact(const lac_strip *rows, size_t nx, const double *pressure, size_t *n,
                                lac_error *err)
{
    for (size_t i = 0; i < rows->n * nx; i++) {
        LAC_FAIL_IF(!(isfinite(pressure[i]) && pressure[i] >= 0), err, LAC_EINPUT,
                    "the pressure of cell (%zu, %zu) is %g Pa: must be finite and >= 0", i % nx,
                    rows->first + i / nx, pressure[i]);
        *n += pressure[i] > 0;
    }
    return LAC_OK;
}

static void add(lac_domain *domain, size_t i, double pressure)
{
    domain->index[domain->n] = (uint32_t)i;
    domain->pressure[domain->n++] = pressure;
}

// The pressure of cell i, in row y. What is next in the list of its row is the cell, or it touches
// nothing.
static double take(const collection *c, size_t y, size_t i)
{
    if (c->listed == NULL) {
        return c->pressure[i];
    }
    const size_t at = c->next[y];
    const bool touches = at < c->listed->n && c->listed->index[at] == i;
    c->next[y] += touches;
    return touches ? c->listed->pressure[at] : 0.0;
}

// Collects the contact cells of the block of `side` cells at (x, y), its four quarters in turn.
static void collect(const collection *c, size_t x, size_t y, size_t side)
{
    const size_t nx = c->into->grid.nx;
    if (x >= nx || y >= c->into->grid.ny) {
        return;
    }
    if (side == 1) {
        const double pressure = take(c, y, y * nx + x);
        if (pressure > 0) {
            add(c->into, y * nx + x, pressure);
        }
        return;
    }
    size_t half = side / 2;
    collect(c, x, y, half);
    collect(c, x + half, y, half);
    collect(c, x, y + half, half);
    collect(c, x + half, y + half, half);
}

static lac_status allocate(const lac_grid *grid, size_t n, lac_domain **out, lac_error *err)
{
    lac_domain *domain = *out = calloc(1, sizeof *domain);
    LAC_FAIL_MEMORY_IF(domain == NULL, err);
    domain->grid = *grid;
    domain->index = calloc(n + 2, sizeof *domain->index); // an even number of them is joined
    domain->pressure = calloc(n + 1, sizeof *domain->pressure);
    return domain->index != NULL && domain->pressure != NULL ? LAC_OK : lac_fail_memory(err);
}

// Lists the n contact cells of all ranks, those of the rows here behind so many of ranks before.
static lac_status list_rows(collection *c, const lac_grid *grid, const lac_strip *rows,
                            size_t before, size_t n, lac_error *err)
{
    LAC_TRY_RETURN(allocate(grid, n, &c->listed, err));
    c->next = calloc(grid->ny, sizeof *c->next);
    LAC_FAIL_MEMORY_IF(c->next == NULL, err);
    c->listed->n = before;
    for (size_t i = 0; i < rows->n * grid->nx; i++) {
        if (c->pressure[i] > 0) {
            add(c->listed, rows->first * grid->nx + i, c->pressure[i]);
        }
    }
    c->listed->n = n;
    rows->team->join(rows->team, (uint64_t *)(void *)c->listed->index, (n + 1) / 2);
    lac_team_join(rows->team, c->listed->pressure, n);
    for (size_t at = n; at-- > 0;) {
        c->next[c->listed->index[at] / grid->nx] = at;
    }
    return LAC_OK;
}

lac_status lac_domain_gather(const lac_grid *grid, lac_team *team, const double *pressure,
                             lac_domain **out, lac_error *err)
{
    size_t n = 0, before = 0, counts[LAC_TEAM_MOST] = {0};
    const size_t rank = team != NULL ? (size_t)team->rank : 0;
    const lac_strip rows = lac_strip_rows(team, grid->ny);
    collection c = {.pressure = pressure};
    lac_status status = LAC_OK;
    *out = NULL;
    LAC_TRY_RETURN(check_grid(grid, err));
    status = count_contact(&rows, grid->nx, pressure, &counts[rank], err);
    LAC_TRY_RETURN(lac_team_agree(team, status, err));
    if (team != NULL) {
        team->join(team, counts, (size_t)team->ranks);
    }
    for (size_t i = 0; i < LAC_TEAM_MOST; i++) {
        before += i < rank ? counts[i] : 0;
        n += counts[i];
    }
    LAC_FAIL_IF(n == 0, err, LAC_EINPUT, "no cell is in contact: every pressure is 0");
    LAC_TRY(team != NULL ? list_rows(&c, grid, &rows, before, n, err) : LAC_OK);
    LAC_TRY(allocate(grid, n, out, err));
    c.into = *out;
    collect(&c, 0, 0, (size_t)1 << lac_grid_levels(grid));
out:
    lac_domain_free(c.listed);
    free(c.next);
    LAC_MADE(status, out, lac_domain_free);
}

lac_status lac_domain_create(const lac_grid *grid, const double *pressure, lac_domain **out,
                             lac_error *err)
{
    return lac_domain_gather(grid, NULL, pressure, out, err);
}

void lac_domain_free(lac_domain *domain)
{
    if (domain != NULL) {
        free(domain->index);
        free(domain->pressure);
        free(domain->weight);
        free(domain);
    }
}

static lac_status fill_full(const void *params, const lac_grid *grid, uint8_t *occupied,
                            lac_error *err)
{
    (void)params;
    (void)err;
    memset(occupied, 1, lac_grid_cells(grid));
    return LAC_OK;
}

static const lac_domain_source full = {
    .info =
        LAC_ABOUT("full", "every cell is in contact", "docs/theory/contact.md, \"Full contact\""),
    .fill = fill_full,
    .full = true,
};

typedef struct cascade {
    const lac_grid *grid;
    uint64_t seed;
    double keep; // probability that a child is kept by its own number
    uint8_t *occupied;
} cascade;

// The probability q with which each of `children` is kept, so that with "at least one" the mean
// number kept is 2^D: children q + (1 - q)^children = 2^D.
static double keep_probability(double dimension, int children)
{
    double wanted = exp2(dimension);
    double low = 0, high = 1;
    for (int i = 0; i < 60; i++) {
        double q = 0.5 * (low + high);
        lac_halve(&low, &high, children * q + pow(1 - q, children) < wanted);
    }
    return high;
}

// Four numbers in [0, 1), one per child of a block; blocks are numbered from the root, so that
// finer grids only add to the coarse blocks. Children outside the grid get 2: never kept.
static void draw(const cascade *c, unsigned depth, size_t x, size_t y, size_t side, double u[4])
{
    uint64_t bits[4];
    lac_random(c->seed, LAC_STREAM_DOMAIN, depth, (uint64_t)(y / side) << 32 | x / side, bits);
    for (size_t j = 0; j < 4; j++) {
        bool inside =
            x + (j & 1) * (side / 2) < c->grid->nx && y + (j >> 1) * (side / 2) < c->grid->ny;
        u[j] = inside ? (double)(bits[j] >> 11) * 0x1p-53 : 2;
    }
}

// Marks what the block of `side` cells at (x, y) keeps. The child with the smallest number is
// always kept: given that all numbers are >= q, it is any of them with equal probability.
static void descend(const cascade *c, unsigned depth, size_t x, size_t y, size_t side)
{
    if (side == 1) {
        c->occupied[y * c->grid->nx + x] = 1;
        return;
    }
    double u[4];
    draw(c, depth, x, y, side, u);
    size_t smallest = 0;
    for (size_t j = 1; j < 4; j++) {
        smallest = u[j] < u[smallest] ? j : smallest;
    }
    for (size_t j = 0; j < 4; j++) {
        if (u[j] < c->keep || j == smallest) {
            descend(c, depth + 1, x + (j & 1) * (side / 2), y + (j >> 1) * (side / 2), side / 2);
        }
    }
}

static lac_status fill_cascade(const void *params, const lac_grid *grid, uint8_t *occupied,
                               lac_error *err)
{
    const lac_cascade *p = params;
    bool line = grid->nx == 1 || grid->ny == 1;
    double highest = line ? 1 : 2;
    LAC_FAIL_IF(!(p->dimension > 0 && p->dimension <= highest), err, LAC_EINPUT,
                "dimension %g: must be > 0 and <= %g on a %s", p->dimension, highest,
                line ? "line" : "plane");
    cascade c = {.grid = grid,
                 .seed = (uint64_t)p->seed,
                 .keep = keep_probability(p->dimension, line ? 2 : 4),
                 .occupied = occupied};
    memset(occupied, 0, lac_grid_cells(grid));
    descend(&c, 0, 0, 0, (size_t)1 << lac_grid_levels(grid));
    return LAC_OK;
}

static const lac_param cascade_params[] = {
    LAC_REAL("dimension", "1", offsetof(lac_cascade, dimension), NAN, 0, 2, LAC_ABOVE_MIN,
             "fractal dimension: a block keeps 2^D of its children on average (a line: at most 1)"),
    LAC_SEED(offsetof(lac_cascade, seed), 1, 0,
             "of the random numbers; the same seed gives the same coarse blocks at every level"),
};

static const lac_domain_source random_cascade = {
    .info = LAC_ABOUT(
        "cascade",
        "random dyadic cascade: every block keeps some of its four quarters, at least one",
        "Mandelbrot (1974) J. Fluid Mech. 62, 331, doi "
        "10.1017/S0022112074000711; docs/theory/transfer.md, \"Random cascades\"",
        LAC_ROWS(cascade_params, lac_cascade)),
    .fill = fill_cascade,
};

static const char *const pressure_words[] = {"kept", "scaled", "equal", NULL};

static const lac_param file_params[] = {
    LAC_PATH("path", offsetof(lac_domain_file, path), 0,
             "the file of a contact or a run (.nc), its last step; or a grid of pressures in Pa, 0 "
             "where nothing touches, or of 0 and 1: .npy, .asc, .xyz"),
    LAC_CHOICE("pressures", offsetof(lac_domain_file, pressures), LAC_PRESSURES_KEPT,
               pressure_words, 0,
               "as the file has them, which must carry load.normal to 1e-6 (kept); in proportion, "
               "to carry it (scaled); or the load in equal parts on the cells that touch (equal)"),
};

const lac_domain_source lac_domain_from_file = {
    .info = LAC_ABOUT("file", "contact cells with their pressures, as a file has them",
                      "docs/format.md", LAC_ROWS(file_params, lac_domain_file)),
};

static const lac_domain_source *const registry[] = {
    &full,
    &random_cascade,
    &lac_domain_from_file,
};

LAC_KINDS_AT(lac_domain_source, lac_domain_source_get, registry)

// The load is held: every contact cell carries N/n times the mean pressure.
static void spread_load(size_t cells, const uint8_t *occupied, double mean_pressure,
                        double *pressure)
{
    size_t n = 0;
    for (size_t i = 0; i < cells; i++) {
        n += occupied[i] != 0;
    }
    double share = n > 0 ? mean_pressure * (double)cells / (double)n : 0;
    for (size_t i = 0; i < cells; i++) {
        pressure[i] = occupied[i] != 0 ? share : 0;
    }
}

lac_status lac_domain_from_source(const lac_model *model, const lac_grid *grid,
                                  double mean_pressure, lac_domain **domain, lac_error *err)
{
    *domain = NULL;
    lac_status status = LAC_OK;
    uint8_t *occupied = NULL;
    double *pressure = NULL;
    LAC_FAIL_IF(model->info == NULL, err, LAC_EINPUT, "no contact domain is chosen");
    LAC_FAIL_IF(!(isfinite(mean_pressure) && mean_pressure > 0), err, LAC_EINPUT,
                "the mean pressure is %g Pa: must be finite and > 0", mean_pressure);
    LAC_TRY_RETURN(check_grid(grid, err));
    // The descriptor is the first member of the source's row.
    const lac_domain_source *source = (const void *)model->info;
    LAC_FAIL_IF(source->fill == NULL, err, LAC_EINPUT,
                "domain %s: its cells are the scene's to read", source->info.name);
    size_t cells = lac_grid_cells(grid);
    occupied = calloc(cells, sizeof *occupied);
    pressure = calloc(cells, sizeof *pressure);
    LAC_TRY(occupied != NULL && pressure != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(source->fill(model->params, grid, occupied, err));
    spread_load(cells, occupied, mean_pressure, pressure);
    LAC_TRY(lac_domain_create(grid, pressure, domain, err));
out:
    free(occupied);
    free(pressure);
    return lac_fail_within(err, status, "domain %s", model->info->name);
}
