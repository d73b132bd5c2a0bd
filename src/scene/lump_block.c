// SPDX-License-Identifier: GPL-3.0-or-later
// The cells of a block as points in what they differ in: which sums over them a few of them keep.
#include "scene/lump_parts.h"

// Products of the variables of degree at most `left`, from variable v on, times `product`.
static double *products(const lac_lump_block *b, const double *z, size_t v, size_t left,
                        double product, double *out)
{
    if (v == b->active) {
        *out = product;
        return out + 1;
    }
    for (size_t k = 0; k <= left; k++, product *= z[v]) {
        out = products(b, z, v + 1, left - k, product, out);
    }
    return out;
}

// The first variables of a cell: each less what those before it have of it, its mean 0, its
// deviation 1, by pressure.
static void coordinates(const lac_lump_block *b, size_t variables, size_t point, double *z)
{
    for (size_t v = 0; v < variables; v++) {
        z[v] = b->at[v]->value[b->first + point] - b->mean[v];
        for (size_t u = 0; u < v; u++) {
            z[v] -= b->share[v][u] * z[u];
        }
        z[v] /= b->scale[v];
    }
}

void lac_lump_block_values(const void *context, size_t point, double *value)
{
    const lac_lump_block *b = context;
    double z[MOST_VARIABLES];
    const double p = b->pressure[point] / b->mean_pressure;
    coordinates(b, b->active, point, z);
    double *end = products(b, z, 0, b->degree, p, value);
    if (b->apart) {
        end[0] = 1.0;
        end[1] = p * p;
    }
}

static size_t count_products(size_t variables, size_t degree)
{
    double count = 1.0; // binomial(variables + degree, degree)
    for (size_t k = 1; k <= degree; k++) {
        count = count * (double)(variables + k) / (double)k;
    }
    return (size_t)(count + 0.5);
}

// Sums of one variable are kept up to the degree of Gauss's nodes; of more, less.
static size_t degree_of(size_t variables, size_t nodes)
{
    static const size_t less[] = {0, 0, 0, 1, 2, 3, 3};
    const size_t degree =
        variables == 1 ? 2 * nodes - 1 : nodes + 1 - less[variables < 7 ? variables : 6];
    return variables > 6 || degree > 2 * nodes ? 2 : degree > 2 ? degree : 2;
}

// Takes a variable up among those of a block, if it tells more than those before it.
static void take_variable(const lac_lump_variable *of, double sum, lac_lump_block *b)
{
    const double *x = of->value + b->first;
    const size_t v = b->active;
    double mean = 0.0, square = 0.0, z[MOST_VARIABLES];
    for (size_t i = 0; i < b->n; i++) {
        mean += b->pressure[i] * x[i] / sum;
    }
    b->at[v] = of;
    b->mean[v] = mean;
    b->scale[v] = 1.0;
    memset(b->share[v], 0, sizeof b->share[v]);
    for (size_t i = 0; i < b->n; i++) {
        coordinates(b, v, i, z);
        for (size_t u = 0; u < v; u++) {
            b->share[v][u] += b->pressure[i] / sum * z[u] * (x[i] - mean);
        }
    }
    for (size_t i = 0; i < b->n; i++) {
        coordinates(b, v + 1, i, z);
        square += b->pressure[i] / sum * z[v] * z[v];
    }
    b->scale[v] = sqrt(square);
    b->active += b->scale[v] > 1e-6 * of->scale ? 1 : 0;
}

size_t lac_lump_block_functions(const lac_lump_block *b)
{
    return count_products(b->active, b->degree) + (b->apart ? 2 : 0);
}

void lac_lump_block_look(const lac_lump_cells *of, const double *pressure, size_t first, size_t n,
                         size_t nodes, lac_lump_block *b)
{
    double sum = 0.0;
    memset(b, 0, sizeof *b);
    b->pressure = pressure + first;
    b->first = first;
    b->n = n;
    for (size_t i = 0; i < n; i++) {
        sum += b->pressure[i];
    }
    b->mean_pressure = sum / (double)n;
    for (size_t v = 0; v < of->variables; v++) {
        take_variable(&of->of[v], sum, b);
    }
    b->apart = of->apart;
    b->degree = b->active > 0 ? degree_of(b->active, nodes) : 0;
}

void lac_lump_block_assign(const lac_lump_block *b, const uint32_t *kept, size_t leaves,
                           uint32_t *leaf, double *room)
{
    double z[MOST_VARIABLES];
    for (size_t c = 0; c < leaves; c++) {
        coordinates(b, b->active, kept[c], room + c * b->active);
    }
    for (size_t i = 0; i < b->n; i++) {
        double nearest = INFINITY;
        coordinates(b, b->active, i, z);
        for (size_t c = 0; c < leaves; c++) {
            const double *at = room + c * b->active;
            double apart = 0.0;
            for (size_t v = 0; v < b->active; v++) {
                apart += (z[v] - at[v]) * (z[v] - at[v]);
            }
            if (apart < nearest) {
                nearest = apart;
                leaf[i] = (uint32_t)c;
            }
        }
    }
}
