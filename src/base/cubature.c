// SPDX-License-Identifier: GPL-3.0-or-later
// Few points in the place of many. Points are taken together in groups, of which one moves weight
// along directions that change no sum until groups have none left; what stays is grouped anew.
#include "base/cubature.h"

#include <math.h>

// Sums of the functions over the groups, row by row, reduced so that some columns are unit vectors.
typedef struct tableau {
    size_t rows, columns;
    double least;   // below which a row has nothing that those before it have not
    double *a;      // [rows][columns]
    size_t *basis;  // [rows] column of each row's unit; SIZE_MAX: the row has vanished
    double *weight; // [columns]
    double *scale;  // [rows] the largest of each
    bool *gone;     // [columns] its weight is 0
} tableau;

// Makes column q the unit vector of row p.
static void pivot(tableau *t, size_t p, size_t q)
{
    double *row = t->a + p * t->columns;
    const double by = 1.0 / row[q];
    for (size_t j = 0; j < t->columns; j++) {
        row[j] *= by;
    }
    row[q] = 1.0;
    for (size_t i = 0; i < t->rows; i++) {
        double *other = t->a + i * t->columns;
        const double of = other[q];
        for (size_t j = 0; i != p && of != 0.0 && j < t->columns; j++) {
            other[j] -= of * row[j];
        }
        other[q] = i == p ? 1.0 : 0.0;
    }
    t->basis[p] = q;
}

// A row whose functions depend on those before it has nothing left but rounding.
static void find_basis(tableau *t)
{
    const double rounding = 1e-11;
    for (size_t i = 0; i < t->rows; i++) {
        double *row = t->a + i * t->columns;
        t->scale[i] = 0.0;
        for (size_t j = 0; j < t->columns; j++) {
            t->scale[i] = fmax(t->scale[i], fabs(row[j]));
        }
    }
    for (size_t i = 0; i < t->rows; i++) {
        size_t best = 0;
        double *row = t->a + i * t->columns;
        for (size_t j = 1; j < t->columns; j++) {
            best = fabs(row[j]) > fabs(row[best]) ? j : best;
        }
        t->basis[i] = SIZE_MAX;
        if (fabs(row[best]) > fmax(rounding * t->scale[i], t->least)) {
            pivot(t, i, best);
        }
    }
}

// Takes weight off column q, which those of the basis make up for, until one has none: q, or one
// whose place q takes.
static void remove_one(tableau *t, size_t q)
{
    size_t leaves = SIZE_MAX;
    double most = t->weight[q];
    for (size_t i = 0; i < t->rows; i++) {
        const double z = -t->a[i * t->columns + q];
        if (t->basis[i] != SIZE_MAX && z > 0.0 && t->weight[t->basis[i]] < most * z) {
            leaves = i;
            most = t->weight[t->basis[i]] / z;
        }
    }
    t->weight[q] -= most;
    for (size_t i = 0; i < t->rows; i++) {
        if (t->basis[i] != SIZE_MAX) {
            double *w = &t->weight[t->basis[i]];
            *w = fmax(0.0, *w + most * t->a[i * t->columns + q]);
        }
    }
    if (leaves == SIZE_MAX) {
        t->gone[q] = true;
        return;
    }
    t->gone[t->basis[leaves]] = true;
    pivot(t, leaves, q);
}

static void reduce(tableau *t)
{
    find_basis(t);
    for (size_t q = 0; q < t->columns; q++) {
        bool free = !t->gone[q];
        for (size_t i = 0; i < t->rows; i++) {
            free = free && t->basis[i] != q;
        }
        if (free) {
            remove_one(t, q);
        }
    }
}

// Where group g of `groups` begins among `count` points.
static size_t begins(size_t g, size_t groups, size_t count) { return g * count / groups; }

static void sum_groups(const lac_cubature *of, const uint32_t *kept, const double *weight,
                       size_t count, tableau *t, double *value)
{
    memset(t->a, 0, t->rows * t->columns * sizeof *t->a);
    for (size_t g = 0; g < t->columns; g++) {
        t->weight[g] = 1.0;
        t->gone[g] = false;
        for (size_t i = begins(g, t->columns, count); i < begins(g + 1, t->columns, count); i++) {
            of->at(of->context, kept[i], value);
            for (size_t j = 0; j < t->rows; j++) {
                t->a[j * t->columns + g] += weight[i] * value[j];
            }
        }
    }
}

// Keeps the points of the groups that have weight left.
static size_t keep(const tableau *t, uint32_t *kept, double *weight, size_t count)
{
    size_t stay = 0;
    for (size_t g = 0; g < t->columns; g++) {
        for (size_t i = begins(g, t->columns, count); i < begins(g + 1, t->columns, count); i++) {
            if (!t->gone[g] && t->weight[g] > 0.0) {
                kept[stay] = kept[i];
                weight[stay++] = weight[i] * t->weight[g];
            }
        }
    }
    return stay;
}

lac_status lac_cubature_thin(const lac_cubature *of, uint32_t *kept, double *weight, size_t *count,
                             lac_error *err)
{
    const size_t most = 2 * of->functions, rows = of->functions;
    tableau t = {.rows = rows};
    lac_status status = LAC_OK;
    t.a = malloc((rows * most + most + 2 * rows) * sizeof *t.a);
    t.basis = malloc(rows * sizeof *t.basis);
    t.gone = malloc(most * sizeof *t.gone);
    LAC_TRY(t.a != NULL && t.basis != NULL && t.gone != NULL ? LAC_OK : lac_fail_memory(err));
    t.weight = t.a + rows * most;
    t.scale = t.weight + most;
    for (size_t i = 0; i < of->points; i++) {
        kept[i] = (uint32_t)i;
        weight[i] = 1.0;
    }
    *count = of->points;
    while (*count > rows) {
        const size_t before = *count;
        t.columns = before < most ? before : most;
        t.least = of->least * (double)of->points / (double)t.columns;
        sum_groups(of, kept, weight, before, &t, t.scale + rows);
        reduce(&t);
        *count = keep(&t, kept, weight, before);
        if (*count == before) {
            break;
        }
    }
out:
    free(t.a);
    free(t.basis);
    free(t.gone);
    return status;
}
