// SPDX-License-Identifier: GPL-3.0-or-later
// One pass over memory: each block through all that waits while it is in the cache.
#include "run/pass.h"

#include <string.h>

#include "base/clones.h"

enum { BLOCK = 256 }; // elements: some ten arrays of them fit the first cache

// Each vector is read once. `count` is known where this is inlined.
static inline __attribute__((always_inline)) void combine(int count, size_t first, size_t end,
                                                          const lac_combination *from)
{
    const lac_combination t = *from;
    double *z = t.z;
    LAC_INDEPENDENT
    for (size_t i = first; i < end; i++) {
        double sum = t.c[0];
        if (count > 0) {
            sum *= t.x[0][i];
        }
        for (int j = 1; j < count; j++) {
            sum += t.c[j] * t.x[j][i];
        }
        z[i] = sum;
    }
}

static inline __attribute__((always_inline)) void make(const lac_combination *t, size_t first,
                                                       size_t end)
{
#define LAC_UNROLLED(n)              \
    case n:                          \
        combine((n), first, end, t); \
        break;
#define LAC_UNROLLED_4(n) \
    LAC_UNROLLED(n) LAC_UNROLLED((n) + 1) LAC_UNROLLED((n) + 2) LAC_UNROLLED((n) + 3)
    switch (t->count) { // so that each loop is unrolled
        LAC_UNROLLED_4(0)
        LAC_UNROLLED_4(4)
        LAC_UNROLLED_4(8)
        LAC_UNROLLED_4(12)
    default:
        combine(LAC_PASS_TERMS, first, end, t);
    }
}

// The whole history of an element in registers: as sums, a prediction of order 5 reads and writes
// the first cache 45 times and not 11. What is beyond `order` is left out where this is inlined.
static inline __attribute__((always_inline)) void predict(int order, size_t first, size_t end,
                                                          const lac_prediction *from)
{
#define LAC_OF(j) ((j) > order ? 0.0 : (j) == order ? t.top[i] : t.z[j][i])
#define LAC_ADD(j, next) (z##j = (next) > order ? z##j : z##j + z##next)
#define LAC_PUT(j) ((j) < order ? (void)(t.z[j][i] = z##j) : (void)0)
    const lac_prediction t = *from;
    LAC_INDEPENDENT
    for (size_t i = first; i < end; i++) {
        double z0 = LAC_OF(0), z1 = LAC_OF(1), z2 = LAC_OF(2);
        double z3 = LAC_OF(3), z4 = LAC_OF(4), z5 = LAC_OF(5);
        LAC_ADD(4, 5), LAC_ADD(3, 4), LAC_ADD(2, 3), LAC_ADD(1, 2), LAC_ADD(0, 1);
        LAC_ADD(4, 5), LAC_ADD(3, 4), LAC_ADD(2, 3), LAC_ADD(1, 2);
        LAC_ADD(4, 5), LAC_ADD(3, 4), LAC_ADD(2, 3);
        LAC_ADD(4, 5), LAC_ADD(3, 4);
        LAC_ADD(4, 5);
        LAC_PUT(0), LAC_PUT(1), LAC_PUT(2), LAC_PUT(3), LAC_PUT(4);
    }
}

static inline __attribute__((always_inline)) void make_predicted(const lac_prediction *t,
                                                                 size_t first, size_t end)
{
#define LAC_PREDICTED(q)             \
    case q:                          \
        predict((q), first, end, t); \
        break;
    switch (t->order) {
        LAC_PREDICTED(2)
        LAC_PREDICTED(3)
        LAC_PREDICTED(4)
        LAC_PREDICTED(5)
    default:
        break;
    }
}

// @param w  NULL: `level`, known where this is inlined
static inline __attribute__((always_inline)) void
add_squares(const double *x, const double *w, double level, size_t first, size_t end, double *s)
{
    size_t whole = end - (end - first) % LAC_PASS_LANES;
    for (size_t i = first; i < whole; i += LAC_PASS_LANES) {
        for (size_t k = 0; k < LAC_PASS_LANES; k++) {
            double term = x[i + k] * (w != NULL ? w[i + k] : level);
            s[k] += term * term;
        }
    }
    for (size_t i = whole; i < end; i++) {
        double term = x[i] * (w != NULL ? w[i] : level);
        s[i - whole] += term * term;
    }
}

LAC_CLONES void lac_pass_make(const void *context, size_t first, size_t end, double *sums)
{
    const lac_pass *p = context;
    double s[LAC_PASS_LANES]; // in registers
    memcpy(s, sums, sizeof s);
    // what is alone has nothing to share a cache with
    size_t block = p->count + (p->x != NULL ? 1 : 0) > 1 ? BLOCK : end - first;
    for (size_t begin = first; begin < end; begin += block) {
        size_t stop = end - begin < block ? end : begin + block;
        for (size_t i = 0; i < p->apart; i++) {
            make(&p->list[i], begin, stop);
        }
        make_predicted(&p->predicted, begin, stop);
        if (p->x != NULL && p->w != NULL) {
            add_squares(p->x, p->w, 0.0, begin, stop, s);
        } else if (p->x != NULL) {
            add_squares(p->x, NULL, p->level, begin, stop, s);
        }
    }
    memcpy(sums, s, sizeof s);
}

// Whether t is z = z + x.
static bool adds(const lac_combination *t, const double *z, const double *x)
{
    return t->count == 2 && t->z == z && t->x[0] == z && t->x[1] == x && t->c[0] == 1.0 &&
           t->c[1] == 1.0;
}

// Whether the sums from t on are a prediction of this order, and the arrays all others.
static bool find_prediction(const lac_combination *t, int order, lac_prediction *found)
{
    *found = (lac_prediction){.order = order, .top = t->x[1]};
    for (int j = 0; j < order; j++) {
        found->z[j] = t[order - 1 - j].z;
    }
    bool good = true;
    for (int m = order; m > 0; m--) { // sums of this sweep: of z_order-1 ... z_order-m
        for (int j = order - 1; j >= order - m; j--) {
            good = good && adds(t++, found->z[j], j + 1 < order ? found->z[j + 1] : found->top);
        }
        for (int j = 0; j < m; j++) {
            good = good && found->z[j] != (m < order ? found->z[m] : found->top);
        }
    }
    return good;
}

void lac_pass_plan(lac_pass *pass)
{
    pass->apart = pass->count;
    pass->predicted = (lac_prediction){.order = 0};
    for (int order = LAC_PASS_ORDER; order > 1 && pass->predicted.order == 0; order--) {
        const size_t sums = (size_t)(order * (order + 1) / 2), first = pass->count - sums;
        lac_prediction found;
        if (pass->count >= sums && find_prediction(&pass->list[first], order, &found)) {
            pass->apart = first;
            pass->predicted = found;
        }
    }
}
