// SPDX-License-Identifier: GPL-3.0-or-later
// Sums of vectors that wait, so that many are made in one pass over memory, to the same bits.
#include "run/pending.h"

#include "base/clones.h"
#include "base/parallel_for.h"

enum {
    MOST_WAITING = 64,
    BLOCK = 256, // elements: some ten arrays of them fit the first cache
    LANES = 8,
    LEAST_APART = 1 << 14, // elements: shorter vectors stay in a cache, and all is made at once
};

// z = sum_j c_j x_j; count 0: z = c_0
typedef struct combination {
    const double *x[LAC_PENDING_TERMS];
    double c[LAC_PENDING_TERMS];
    double *z;
    int count;
} combination;

struct lac_pending {
    lac_range range;
    size_t arrays, n, waiting;
    size_t now; // of those that wait, the first so many are made in this pass
    bool waits;
    const double *x, *w; // (x w)^2 is wanted; or NULL
    double level;        // w where that is NULL
    combination last;    // sum of two arrays that still holds, made or waiting; z NULL: none
    combination list[MOST_WAITING];
};

lac_pending *lac_pending_create(const lac_range *range, size_t arrays, bool waits)
{
    lac_pending *p = malloc(sizeof *p);
    if (p != NULL) {
        *p = (lac_pending){
            .range = *range, .arrays = arrays, .n = arrays * range->n, .waits = waits};
    }
    return p;
}

void lac_pending_free(lac_pending *p) { free(p); }

void lac_pending_close(lac_pending *p)
{
    p->n = p->arrays = p->waiting = p->now = 0;
    p->range = lac_range_whole(0);
}

size_t lac_pending_length(const lac_pending *p) { return p->n; }

const lac_team *lac_pending_team(const lac_pending *p) { return p->range.team; }

size_t lac_pending_all(const lac_pending *p) { return p->arrays * p->range.all; }

// Each vector is read once. `count` is known where this is inlined.
static inline __attribute__((always_inline)) void combine(int count, size_t first, size_t end,
                                                          const combination *from)
{
    const combination t = *from;
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

static inline __attribute__((always_inline)) void make(const combination *t, size_t first,
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
        combine(LAC_PENDING_TERMS, first, end, t);
    }
}

// Eight running sums, added up in a fixed order: vectorises, and the bits never change.
static double together(const double *s)
{
    return ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]));
}

// @param w  NULL: `level`, known where this is inlined
static inline __attribute__((always_inline)) void
add_squares(const double *x, const double *w, double level, size_t first, size_t end, double *s)
{
    size_t whole = end - (end - first) % LANES;
    for (size_t i = first; i < whole; i += LANES) {
        for (size_t k = 0; k < LANES; k++) {
            double term = x[i + k] * (w != NULL ? w[i + k] : level);
            s[k] += term * term;
        }
    }
    for (size_t i = whole; i < end; i++) {
        double term = x[i] * (w != NULL ? w[i] : level);
        s[i - whole] += term * term;
    }
}

// All that waits for a stretch of the vectors. @param sums  [LANES] gain the squares
LAC_CLONES static void lac_pending_make(const void *context, size_t first, size_t end, double *sums)
{
    const lac_pending *p = context;
    double s[LANES]; // in registers
    memcpy(s, sums, sizeof s);
    // what is alone has nothing to share a cache with
    size_t block = p->now + (p->x != NULL ? 1 : 0) > 1 ? BLOCK : end - first;
    for (size_t begin = first; begin < end; begin += block) {
        size_t stop = end - begin < block ? end : begin + block;
        for (size_t i = 0; i < p->now; i++) {
            make(&p->list[i], begin, stop);
        }
        if (p->x != NULL && p->w != NULL) {
            add_squares(p->x, p->w, 0.0, begin, stop, s);
        } else if (p->x != NULL) {
            add_squares(p->x, NULL, p->level, begin, stop, s);
        }
    }
    memcpy(sums, s, sizeof s);
}

static void make_part(void *context, size_t part, size_t first, size_t end)
{
    double none[LANES] = {0};
    (void)part;
    lac_pending_make(context, first, end, none);
}

// A block of cells: its stretches of all arrays, or where all cells are one block the whole.
typedef void stretch(const void *context, size_t first, size_t end, double *s);

static double over_block(const lac_pending *p, stretch *look, const void *context, size_t first,
                         size_t end)
{
    double s[LANES] = {0};
    if (p->range.all <= p->range.block) {
        look(context, 0, p->n, s);
        return together(s);
    }
    for (size_t a = 0; a < p->arrays; a++) {
        look(context, a * p->range.n + first, a * p->range.n + end, s);
    }
    return together(s);
}

static void add_block(const void *context, size_t first, size_t end, double *sums)
{
    sums[0] += over_block(context, lac_pending_make, context, first, end);
}

static bool reads(const combination *t, const double *x)
{
    bool found = false;
    for (int j = 0; j < t->count; j++) {
        found = found || t->x[j] == x;
    }
    return found;
}

// Whether the order of two sums counts.
static bool tied(const combination *a, const combination *b)
{
    return a->z == b->z || reads(a, b->z) || reads(b, a->z);
}

// Picks what x and w wait for, and what has to be made before it; it comes to the front in its
// order. @param written  x may be overwritten: what reads it counts as well
// @param all  so does all else, but for other arrays that are one number and nobody asks for yet
static void pick(lac_pending *p, const double *x, const double *w, bool written, bool all)
{
    combination late[MOST_WAITING];
    bool picked[MOST_WAITING];
    size_t rest = 0;
    p->now = p->waiting;
    if (p->n < LEAST_APART) {
        return;
    }
    for (size_t i = p->waiting; i-- > 0;) {
        const combination *t = &p->list[i];
        picked[i] = t->z == x || t->z == w || (written && reads(t, x)) || (all && t->count > 0);
        for (size_t k = i + 1; k < p->waiting && !picked[i]; k++) {
            picked[i] = picked[k] && tied(t, &p->list[k]);
        }
    }
    p->now = 0;
    for (size_t i = 0; i < p->waiting; i++) {
        *(picked[i] ? &p->list[p->now++] : &late[rest++]) = p->list[i];
    }
    memcpy(p->list + p->now, late, rest * sizeof *late);
}

// What was picked is made.
static void drop_made(lac_pending *p)
{
    p->waiting -= p->now;
    memmove(p->list, p->list + p->now, p->waiting * sizeof *p->list);
}

static void make_picked(lac_pending *p)
{
    if (p->now > 0) {
        (void)lac_parallel_for(p->n, make_part, p);
        drop_made(p);
    }
}

// x changes: so does what was made of it.
static void touch(lac_pending *p, const double *x)
{
    if (p->last.z == x || reads(&p->last, x)) {
        p->last.z = NULL;
    }
}

void lac_pending_finish(lac_pending *p, const double *x)
{
    pick(p, x, NULL, false, true);
    make_picked(p);
    touch(p, x);
}

void lac_pending_finish_one(lac_pending *p, const double *x, bool written)
{
    pick(p, x, x, written, false);
    make_picked(p);
    if (written) {
        touch(p, x);
    }
}

void lac_pending_forget(lac_pending *p, const double *x)
{
    for (size_t i = p->waiting; i-- > 0;) {
        if (p->list[i].z == x) {
            p->waiting--;
            memmove(p->list + i, p->list + i + 1, (p->waiting - i) * sizeof *p->list);
        } else if (reads(&p->list[i], x)) {
            break;
        }
    }
    touch(p, x);
}

// The number that all of x waits to be; NULL: none.
static const double *level_of(const lac_pending *p, const double *x)
{
    size_t i = p->waiting;
    while (i > 0 && p->list[i - 1].z != x) {
        i--;
    }
    return i > 0 && p->list[i - 1].count == 0 ? p->list[i - 1].c : NULL;
}

double lac_pending_squares(lac_pending *p, const double *x, const double *w)
{
    const double *same = level_of(p, x), *level = level_of(p, w); // these can go on waiting
    const bool zero = same != NULL && *same == 0.0;
    p->x = zero ? NULL : x;
    p->w = level != NULL ? NULL : w;
    p->level = level != NULL ? *level : 0.0;
    p->now = 0;
    if (!zero) {
        pick(p, x, level != NULL ? x : w, false, false);
    }
    double sum;
    lac_range_sums(&p->range, 1, add_block, p, &sum);
    drop_made(p);
    p->x = p->w = NULL;
    return sum;
}

// Two vectors.
typedef struct product {
    const lac_pending *p;
    const double *x, *y;
} product;

LAC_CLONES static void lac_pending_multiply(const void *context, size_t first, size_t end,
                                            double *sums)
{
    double s[LANES];
    memcpy(s, sums, sizeof s);
    const double *x = ((const product *)context)->x, *y = ((const product *)context)->y;
    size_t whole = end - (end - first) % LANES;
    for (size_t i = first; i < whole; i += LANES) {
        for (size_t k = 0; k < LANES; k++) {
            s[k] += x[i + k] * y[i + k];
        }
    }
    for (size_t i = whole; i < end; i++) {
        s[i - whole] += x[i] * y[i];
    }
    memcpy(sums, s, sizeof s);
}

static void add_products(const void *context, size_t first, size_t end, double *sums)
{
    sums[0] += over_block(((const product *)context)->p, lac_pending_multiply, context, first, end);
}

double lac_pending_dot(const lac_pending *p, const double *x, const double *y)
{
    double sum;
    lac_range_sums(&p->range, 1, add_products, &(product){p, x, y}, &sum);
    return sum;
}

// Whether t is what was added up last, of arrays that have not changed since.
static bool holds(const lac_pending *p, const combination *t)
{
    const combination *last = &p->last;
    return t->count == 2 && last->z == t->z && last->x[0] == t->x[0] && last->x[1] == t->x[1] &&
           last->c[0] == t->c[0] && last->c[1] == t->c[1];
}

void lac_pending_add(lac_pending *p, int count, const double *c, const double *const *x, double *z)
{
    combination *t = &p->list[p->waiting]; // there is always room for one more
    t->count = count;
    t->c[0] = c[0];
    t->z = z;
    for (int j = 0; j < count; j++) {
        t->c[j] = c[j];
        t->x[j] = x[j];
    }
    if (holds(p, t)) {
        return;
    }
    touch(p, z);
    if (count == 2 && !reads(t, z)) {
        p->last = *t;
    }
    p->waiting++;
    if (!p->waits || p->waiting == MOST_WAITING) {
        p->now = p->waiting;
        make_picked(p);
    }
}
