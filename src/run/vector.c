// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/vector.h"

#include <math.h>

#include "base/clones.h"
#include "base/parts.h"

double *lac_vector_data(N_Vector x) { return NV_DATA_S(x); }

void lac_vector_lend(N_Vector x, double *components) { N_VSetArrayPointer(components, x); }

static size_t length(N_Vector x) { return (size_t)NV_LENGTH_S(x); }

// The arrays and numbers of one operation, for its parts.
typedef struct operation {
    double a, b;
    const double *x, *y;
    double *z;
    double sum[LAC_PARTS];
} operation;

LAC_CLONES static void lac_vector_sum_part(void *context, size_t part, size_t first, size_t end)
{
    const operation *o = context;
    double a = o->a;
    double b = o->b;
    const double *x = o->x;
    const double *y = o->y;
    double *z = o->z;
    (void)part;
    // a factor of 1 changes no bit of the product
    LAC_INDEPENDENT
    for (size_t i = first; i < end; i++) {
        z[i] = a * x[i] + b * y[i];
    }
}

static void v_linear_sum(sunrealtype a, N_Vector xv, sunrealtype b, N_Vector yv, N_Vector zv)
{
    operation o = {.a = a, .b = b, .x = NV_DATA_S(xv), .y = NV_DATA_S(yv), .z = NV_DATA_S(zv)};
    (void)lac_parts_run(length(xv), lac_vector_sum_part, &o);
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

LAC_CLONES static void lac_vector_scale_part(void *context, size_t part, size_t first, size_t end)
{
    const operation *o = context;
    double a = o->a;
    const double *x = o->x;
    double *z = o->z;
    (void)part;
    LAC_INDEPENDENT
    for (size_t i = first; i < end; i++) {
        z[i] = a * x[i];
    }
}

static void v_scale(sunrealtype c, N_Vector xv, N_Vector zv)
{
    operation o = {.a = c, .x = NV_DATA_S(xv), .z = NV_DATA_S(zv)};
    (void)lac_parts_run(length(xv), lac_vector_scale_part, &o);
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

LAC_CLONES static void lac_vector_squares_part(void *context, size_t part, size_t first, size_t end)
{
    operation *o = context;
    const double *x = o->x;
    const double *w = o->y;
    size_t whole = end - (end - first) % LANES;
    double s[LANES] = {0};
    for (size_t i = first; i < whole; i += LANES) {
        for (size_t k = 0; k < LANES; k++) {
            double term = x[i + k] * w[i + k];
            s[k] += term * term;
        }
    }
    for (size_t i = whole; i < end; i++) {
        double term = x[i] * w[i];
        s[i - whole] += term * term;
    }
    o->sum[part] = lanes_sum(s);
}

static sunrealtype v_weighted_squares(N_Vector xv, N_Vector wv)
{
    operation o = {.x = NV_DATA_S(xv), .y = NV_DATA_S(wv)};
    size_t parts = lac_parts_run(length(xv), lac_vector_squares_part, &o);
    return lac_parts_sum(parts, o.sum);
}

static sunrealtype v_wrms_norm(N_Vector xv, N_Vector wv)
{
    return sqrt(v_weighted_squares(xv, wv) / (double)length(xv));
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
    int count;
    double *z;
} terms;

static inline __attribute__((always_inline)) void combine(int count, size_t first, size_t end,
                                                          const terms *from)
{
    const terms t = *from;
    double *z = t.z;
    LAC_INDEPENDENT
    for (size_t i = first; i < end; i++) {
        double sum = t.c[0] * t.x[0][i] + t.c[1] * t.x[1][i];
        for (int j = 2; j < count; j++) {
            sum += t.c[j] * t.x[j][i];
        }
        z[i] = sum;
    }
}

LAC_CLONES static void lac_vector_combine_part(void *context, size_t part, size_t first, size_t end)
{
    const terms *t = context;
    (void)part;
    switch (t->count) { // so that each loop is unrolled
    case 2:
        combine(2, first, end, t);
        break;
    case 3:
        combine(3, first, end, t);
        break;
    case 4:
        combine(4, first, end, t);
        break;
    case 5:
        combine(5, first, end, t);
        break;
    case 6:
        combine(6, first, end, t);
        break;
    case 7:
        combine(7, first, end, t);
        break;
    default:
        combine(8, first, end, t);
    }
}

// z = c_0 x_0 + c_1 x_1 + ..., eight at first and then seven more at a time
static lac_sun_status v_linear_combination(int count, sunrealtype *c, N_Vector *xv, N_Vector zv)
{
    double *z = NV_DATA_S(zv);
    if (count == 1) {
        v_scale(c[0], xv[0], zv);
        return 0;
    }
    terms t = {.z = z};
    int used = 0;
    for (int j = 0; j < count; j++) {
        t.x[used] = NV_DATA_S(xv[j]);
        t.c[used] = c[j];
        used++;
        if (used == MOST_TERMS || j + 1 == count) {
            t.count = used;
            (void)lac_parts_run(length(zv), lac_vector_combine_part, &t);
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
        v_linear_sum(a[j], xv, 1.0, yv[j], zv[j]);
    }
    return 0;
}

N_Vector lac_vector_create(size_t n, SUNContext sun)
{
    N_Vector x = N_VNew_Serial((sunindextype)n, sun);
    if (x == NULL) {
        return NULL;
    }
    x->ops->nvlinearsum = v_linear_sum;
    x->ops->nvconst = v_const;
    x->ops->nvprod = lac_vector_prod;
    x->ops->nvdiv = lac_vector_div;
    x->ops->nvscale = v_scale;
    x->ops->nvabs = lac_vector_abs;
    x->ops->nvinv = lac_vector_inv;
    x->ops->nvaddconst = v_add_const;
    x->ops->nvdotprod = lac_vector_dot;
    x->ops->nvmaxnorm = lac_vector_max_norm;
    x->ops->nvwrmsnorm = v_wrms_norm;
    x->ops->nvwsqrsumlocal = v_weighted_squares;
    x->ops->nvdotprodlocal = lac_vector_dot;
    x->ops->nvmaxnormlocal = lac_vector_max_norm;
    x->ops->nvlinearcombination = v_linear_combination;
    x->ops->nvscaleaddmulti = v_scale_add_multi;
    return x;
}
