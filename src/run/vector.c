// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/vector.h"

#include <math.h>

#include "base/clones.h"

double *lac_vector_data(N_Vector x) { return NV_DATA_S(x); }

static size_t length(N_Vector x) { return (size_t)NV_LENGTH_S(x); }

LAC_CLONES static void lac_vector_linear_sum(sunrealtype a, N_Vector xv, sunrealtype b, N_Vector yv,
                                             N_Vector zv)
{
    const double *x = NV_DATA_S(xv);
    const double *y = NV_DATA_S(yv);
    double *z = NV_DATA_S(zv);
    size_t n = length(xv);
    if (a == 1.0) {
        for (size_t i = 0; i < n; i++) {
            z[i] = x[i] + b * y[i];
        }
        return;
    }
    if (b == 1.0) {
        for (size_t i = 0; i < n; i++) {
            z[i] = a * x[i] + y[i];
        }
        return;
    }
    for (size_t i = 0; i < n; i++) {
        z[i] = a * x[i] + b * y[i];
    }
}

static void v_const(sunrealtype c, N_Vector zv)
{
    double *z = NV_DATA_S(zv);
    size_t n = length(zv);
    for (size_t i = 0; i < n; i++) {
        z[i] = c;
    }
}

LAC_CLONES static void lac_vector_prod(N_Vector xv, N_Vector yv, N_Vector zv)
{
    const double *x = NV_DATA_S(xv);
    const double *y = NV_DATA_S(yv);
    double *z = NV_DATA_S(zv);
    size_t n = length(xv);
    for (size_t i = 0; i < n; i++) {
        z[i] = x[i] * y[i];
    }
}

LAC_CLONES static void lac_vector_div(N_Vector xv, N_Vector yv, N_Vector zv)
{
    const double *x = NV_DATA_S(xv);
    const double *y = NV_DATA_S(yv);
    double *z = NV_DATA_S(zv);
    size_t n = length(xv);
    for (size_t i = 0; i < n; i++) {
        z[i] = x[i] / y[i];
    }
}

LAC_CLONES static void lac_vector_scale(sunrealtype c, N_Vector xv, N_Vector zv)
{
    const double *x = NV_DATA_S(xv);
    double *z = NV_DATA_S(zv);
    size_t n = length(xv);
    for (size_t i = 0; i < n; i++) {
        z[i] = c * x[i];
    }
}

LAC_CLONES static void lac_vector_abs(N_Vector xv, N_Vector zv)
{
    const double *x = NV_DATA_S(xv);
    double *z = NV_DATA_S(zv);
    size_t n = length(xv);
    for (size_t i = 0; i < n; i++) {
        z[i] = fabs(x[i]);
    }
}

LAC_CLONES static void lac_vector_inv(N_Vector xv, N_Vector zv)
{
    const double *x = NV_DATA_S(xv);
    double *z = NV_DATA_S(zv);
    size_t n = length(xv);
    for (size_t i = 0; i < n; i++) {
        z[i] = 1.0 / x[i];
    }
}

static void v_add_const(N_Vector xv, sunrealtype b, N_Vector zv)
{
    const double *x = NV_DATA_S(xv);
    double *z = NV_DATA_S(zv);
    size_t n = length(xv);
    for (size_t i = 0; i < n; i++) {
        z[i] = x[i] + b;
    }
}

// Eight running sums, added up in a fixed order: vectorises, and the bits never change.
enum { LANES = 8 };

static double lanes_sum(const double s[LANES])
{
    return ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]));
}

LAC_CLONES static sunrealtype lac_vector_dot(N_Vector xv, N_Vector yv)
{
    const double *x = NV_DATA_S(xv);
    const double *y = NV_DATA_S(yv);
    size_t n = length(xv);
    size_t whole = n - n % LANES;
    double s[LANES] = {0};
    for (size_t i = 0; i < whole; i += LANES) {
        for (size_t k = 0; k < LANES; k++) {
            s[k] += x[i + k] * y[i + k];
        }
    }
    for (size_t i = whole; i < n; i++) {
        s[i - whole] += x[i] * y[i];
    }
    return lanes_sum(s);
}

LAC_CLONES static sunrealtype lac_vector_weighted_squares(N_Vector xv, N_Vector wv)
{
    const double *x = NV_DATA_S(xv);
    const double *w = NV_DATA_S(wv);
    size_t n = length(xv);
    size_t whole = n - n % LANES;
    double s[LANES] = {0};
    for (size_t i = 0; i < whole; i += LANES) {
        for (size_t k = 0; k < LANES; k++) {
            double term = x[i + k] * w[i + k];
            s[k] += term * term;
        }
    }
    for (size_t i = whole; i < n; i++) {
        double term = x[i] * w[i];
        s[i - whole] += term * term;
    }
    return lanes_sum(s);
}

static sunrealtype v_wrms_norm(N_Vector xv, N_Vector wv)
{
    return sqrt(lac_vector_weighted_squares(xv, wv) / (double)length(xv));
}

LAC_CLONES static sunrealtype lac_vector_max_norm(N_Vector xv)
{
    const double *x = NV_DATA_S(xv);
    size_t n = length(xv);
    double most = 0.0;
    for (size_t i = 0; i < n; i++) {
        double size = fabs(x[i]);
        // A NaN must not hide behind a comparison that is false.
        most = size <= most ? most : size;
    }
    return most;
}

// z = sum_j c_j x_j of 2 to 8 vectors, each read once; z may be x_0. Added in the order of j.
enum { MOST_TERMS = 8 };

typedef struct terms {
    const double *x[MOST_TERMS];
    double c[MOST_TERMS];
} terms;

static inline __attribute__((always_inline)) void combine(int count, size_t n, const terms *from,
                                                          double *z)
{
    const terms t = *from;
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double sum = t.c[0] * t.x[0][i] + t.c[1] * t.x[1][i];
        for (int j = 2; j < count; j++) {
            sum += t.c[j] * t.x[j][i];
        }
        z[i] = sum;
    }
}

LAC_CLONES static void lac_vector_combine_terms(int count, size_t n, const terms *t, double *z)
{
    switch (count) { // so that each loop is unrolled
    case 2:
        combine(2, n, t, z);
        break;
    case 3:
        combine(3, n, t, z);
        break;
    case 4:
        combine(4, n, t, z);
        break;
    case 5:
        combine(5, n, t, z);
        break;
    case 6:
        combine(6, n, t, z);
        break;
    case 7:
        combine(7, n, t, z);
        break;
    default:
        combine(8, n, t, z);
    }
}

// z = c_0 x_0 + c_1 x_1 + ..., eight at first and then seven more at a time
static lac_sun_status v_linear_combination(int count, sunrealtype *c, N_Vector *xv, N_Vector zv)
{
    double *z = NV_DATA_S(zv);
    if (count == 1) {
        lac_vector_scale(c[0], xv[0], zv);
        return 0;
    }
    terms t;
    int used = 0;
    for (int j = 0; j < count; j++) {
        t.x[used] = NV_DATA_S(xv[j]);
        t.c[used] = c[j];
        used++;
        if (used == MOST_TERMS || j + 1 == count) {
            lac_vector_combine_terms(used, length(zv), &t, z);
            t.x[0] = z;
            t.c[0] = 1.0;
            used = 1;
        }
    }
    return 0;
}

// z_j = a_j x + y_j
static lac_sun_status v_scale_add_multi(int count, sunrealtype *a, N_Vector xv, N_Vector *yv,
                                        N_Vector *zv)
{
    for (int j = 0; j < count; j++) {
        lac_vector_linear_sum(a[j], xv, 1.0, yv[j], zv[j]);
    }
    return 0;
}

N_Vector lac_vector_create(size_t n, SUNContext sun)
{
    N_Vector x = N_VNew_Serial((sunindextype)n, sun);
    if (x == NULL) {
        return NULL;
    }
    x->ops->nvlinearsum = lac_vector_linear_sum;
    x->ops->nvconst = v_const;
    x->ops->nvprod = lac_vector_prod;
    x->ops->nvdiv = lac_vector_div;
    x->ops->nvscale = lac_vector_scale;
    x->ops->nvabs = lac_vector_abs;
    x->ops->nvinv = lac_vector_inv;
    x->ops->nvaddconst = v_add_const;
    x->ops->nvdotprod = lac_vector_dot;
    x->ops->nvmaxnorm = lac_vector_max_norm;
    x->ops->nvwrmsnorm = v_wrms_norm;
    x->ops->nvwsqrsumlocal = lac_vector_weighted_squares;
    x->ops->nvdotprodlocal = lac_vector_dot;
    x->ops->nvmaxnormlocal = lac_vector_max_norm;
    x->ops->nvlinearcombination = v_linear_combination;
    x->ops->nvscaleaddmulti = v_scale_add_multi;
    return x;
}
