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
    double *weight; // [columns]; 0: the group is gone
    double *room;   // [rows]
    size_t *basis;  // [rows] column of each row's unit; SIZE_MAX: the row has vanished
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

static size_t largest(const tableau *t, size_t row)
{
    const double *a = t->a + row * t->columns;
    size_t best = 0;
    for (size_t j = 1; j < t->columns; j++) {
        best = fabs(a[j]) > fabs(a[best]) ? j : best;
    }
    return best;
}

// A row whose functions depend on those before it has nothing left but rounding.
static void find_basis(tableau *t)
{
    const double rounding = 1e-11;
    for (size_t i = 0; i < t->rows; i++) {
        t->room[i] = fmax(t->least, rounding * fabs(t->a[i * t->columns + largest(t, i)]));
        t->basis[i] = SIZE_MAX;
    }
    for (size_t i = 0; i < t->rows; i++) {
        const size_t best = largest(t, i);
        if (fabs(t->a[i * t->columns + best]) > t->room[i]) {
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
    t->weight[q] = leaves != SIZE_MAX ? t->weight[q] - most : 0.0;
    for (size_t i = 0; i < t->rows; i++) {
        if (t->basis[i] != SIZE_MAX) {
            double *w = &t->weight[t->basis[i]];
            *w = fmax(0.0, *w + most * t->a[i * t->columns + q]);
        }
    }
    if (leaves != SIZE_MAX) {
        t->weight[t->basis[leaves]] = 0.0;
        pivot(t, leaves, q);
    }
}

static void reduce(tableau *t)
{
    find_basis(t);
    for (size_t q = 0; q < t->columns; q++) {
        bool free = t->weight[q] > 0.0;
        for (size_t i = 0; i < t->rows; i++) {
            free = free && t->basis[i] != q;
        }
        if (free) {
            remove_one(t, q);
        }
    }
}

// The last of `groups` that begins, g count/groups, at point i or before it.
static size_t group_of(size_t i, size_t groups, size_t count)
{
    return ((i + 1) * groups - 1) / count;
}

lac_status lac_cubature_thin(const lac_cubature *of, uint32_t *kept, double *weight, size_t *count,
                             lac_error *err)
{
    const size_t rows = of->functions, most = 2 * rows;
    tableau t = {.rows = rows};
    size_t before = of->points + 1;
    t.a = malloc((rows * most + most + rows) * sizeof *t.a);
    t.basis = malloc(rows * sizeof *t.basis);
    lac_status status = t.a != NULL && t.basis != NULL ? LAC_OK : lac_fail_memory(err);
    t.weight = t.a + rows * most;
    t.room = t.weight + most;
    *count = of->points;
    for (size_t i = 0; i < of->points; i++) {
        kept[i] = (uint32_t)i;
        weight[i] = 1.0;
    }
    while (status == LAC_OK && *count > rows && *count < before) {
        before = *count;
        *count = 0;
        t.columns = before < most ? before : most;
        t.least = of->least * (double)of->points / (double)t.columns;
        memset(t.a, 0, rows * most * sizeof *t.a);
        for (size_t i = 0; i < before; i++) {
            const size_t g = group_of(i, t.columns, before);
            t.weight[g] = 1.0;
            of->at(of->context, kept[i], t.room);
            for (size_t j = 0; j < rows; j++) {
                t.a[j * t.columns + g] += weight[i] * t.room[j];
            }
        }
        reduce(&t);
        for (size_t i = 0; i < before; i++) { // of the groups that have weight left
            const double w = t.weight[group_of(i, t.columns, before)];
            kept[*count] = kept[i];
            weight[*count] = weight[i] * w;
            *count += w > 0.0 ? 1 : 0;
        }
    }
    free(t.a);
    free(t.basis);
    return status;
}
