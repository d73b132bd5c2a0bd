// SPDX-License-Identifier: GPL-3.0-or-later
// One pass over memory: each block through all that waits while it is in the cache.
#include "run/pass.h"

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

static inline __attribute__((always_inline)) void make_form(const lac_combination *t, size_t first,
                                                            size_t end)
{
    const double *x = t->x[0], c = t->c[0];
    double *z = t->z;
    if (t->form == LAC_PENDING_ABS) {
        LAC_INDEPENDENT
        for (size_t i = first; i < end; i++) {
            z[i] = fabs(x[i]);
        }
    } else if (t->form == LAC_PENDING_SHIFT) {
        LAC_INDEPENDENT
        for (size_t i = first; i < end; i++) {
            z[i] = x[i] + c;
        }
    } else {
        LAC_INDEPENDENT
        for (size_t i = first; i < end; i++) {
            z[i] = 1.0 / x[i];
        }
    }
}

static inline __attribute__((always_inline)) void make(const lac_combination *t, size_t first,
                                                       size_t end)
{
    if (t->form != LAC_PENDING_SUM) {
        make_form(t, first, end);
        return;
    }
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
        combine(LAC_PENDING_TERMS, first, end, t);
    }
}

// The whole history of an element in registers: as sums, a step of order 5 reads and writes the
// first cache 63 times and not 13. What is beyond `order` is left out where this is inlined.
static inline __attribute__((always_inline)) void predict(int order, bool corrected, size_t first,
                                                          size_t end, const lac_prediction *from)
{
#define LAC_OF(j) ((j) > order ? 0.0 : corrected ? t.c[j] * t.a[i] + t.z[j][i] : t.z[j][i])
#define LAC_ADD(j, next) (z##j = (next) > order ? z##j : z##j + z##next)
#define LAC_PUT(j) ((j) < order + (corrected ? 1 : 0) ? (void)(t.to[j][i] = z##j) : (void)0)
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
        LAC_PUT(0), LAC_PUT(1), LAC_PUT(2), LAC_PUT(3), LAC_PUT(4), LAC_PUT(5);
    }
}

static inline __attribute__((always_inline)) void make_predicted(const lac_prediction *t,
                                                                 size_t first, size_t end)
{
#define LAC_PREDICTED(q)                    \
    case 2 * (q):                           \
        predict((q), false, first, end, t); \
        break;                              \
    case 2 * (q) + 1:                       \
        predict((q), true, first, end, t);  \
        break;
    switch (2 * t->order + (t->corrected ? 1 : 0)) {
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

// Whether t is z = c x + z.
bool lac_combination_gains(const lac_combination *t, const double *z, const double *x)
{
    return t->count == 2 && t->z == z && t->x[0] == x && t->x[1] == z && t->c[1] == 1.0;
}

// Whether t is z = z + x.
static bool adds(const lac_combination *t, const double *z, const double *x)
{
    return t->count == 2 && t->z == z && t->x[0] == z && t->x[1] == x && t->c[0] == 1.0 &&
           t->c[1] == 1.0;
}

// Whether the sums from t on are a prediction of this order, and the arrays all others.
static bool find_order(const lac_combination *t, int order, lac_prediction *found)
{
    *found = (lac_prediction){.order = order};
    found->z[order] = t->x[1];
    for (int j = 0; j < order; j++) {
        found->z[j] = found->to[j] = t[order - 1 - j].z;
    }
    bool good = true;
    for (int m = 1; m <= order; m++) {
        for (int j = order; j >= m; j--) {
            good = good && adds(t++, found->z[j - 1], found->z[j]);
        }
        for (int j = 0; j < m; j++) {
            good = good && found->z[j] != found->z[m];
        }
    }
    return good;
}

// Whether the sums from t on, as many as the prediction has arrays, correct these.
static bool find_correction(const lac_combination *t, lac_prediction *found)
{
    found->a = t->x[0];
    found->corrected = true;
    for (int j = 0; j <= found->order; j++) {
        found->corrected = found->corrected &&
                           lac_combination_gains(&t[j], found->z[j], found->a) &&
                           found->z[j] != found->a;
    }
    for (int j = 0; found->corrected && j <= found->order; j++) {
        found->to[j] = t[j].z;
        found->c[j] = t[j].c[0];
    }
    return found->corrected;
}

// The last sums may be a prediction.
void lac_pass_plan(lac_pass *pass)
{
    pass->apart = pass->count;
    pass->predicted = (lac_prediction){.order = 0};
    for (size_t order = LAC_PASS_ORDER; order > 1 && pass->predicted.order == 0; order--) {
        const size_t sums = order * (order + 1) / 2, first = pass->count - sums, arrays = order + 1;
        lac_prediction found;
        if (pass->count >= sums && find_order(&pass->list[first], (int)order, &found)) {
            pass->apart = first >= arrays && find_correction(&pass->list[first - arrays], &found)
                              ? first - arrays
                              : first;
            pass->predicted = found;
        }
    }
}
