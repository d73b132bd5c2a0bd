// SPDX-License-Identifier: GPL-3.0-or-later
// Sums of vectors that wait, so that many are made in one pass over memory, to the same bits.
#include "run/pending.h"

#include "base/clones.h"
#include "base/parallel_for.h"
#include "run/pass.h"

enum {
    MOST_WAITING = 64,
    LEAST_APART = 1 << 14, // elements: shorter vectors stay in a cache, and all is made at once
};

struct lac_pending {
    lac_range range;
    size_t arrays, n, waiting;
    bool waits;
    lac_pass pass;            // of those that wait, the first so many, to be made now
    lac_combination last;     // sum of two arrays that still holds, made or waiting; z NULL: none
    const double *one, *twin; // or NULL: what one is, made or waiting, twin is
    lac_combination list[MOST_WAITING];
};

lac_pending *lac_pending_create(const lac_range *range, size_t arrays, bool waits)
{
    lac_pending *p = malloc(sizeof *p);
    if (p != NULL) {
        *p = (lac_pending){
            .range = *range, .arrays = arrays, .n = arrays * range->n, .waits = waits};
        p->pass.list = p->list;
    }
    return p;
}

void lac_pending_free(lac_pending *p) { free(p); }

void lac_pending_close(lac_pending *p)
{
    p->n = p->arrays = p->waiting = p->pass.count = 0;
    p->range = lac_range_whole(0);
}

size_t lac_pending_length(const lac_pending *p) { return p->n; }

const lac_team *lac_pending_team(const lac_pending *p) { return p->range.team; }

size_t lac_pending_all(const lac_pending *p) { return p->arrays * p->range.all; }

// Eight running sums, added up in a fixed order: vectorises, and the bits never change.
static double together(const double *s)
{
    return ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]));
}

static void make_part(void *context, size_t part, size_t first, size_t end)
{
    double none[LAC_PASS_LANES] = {0};
    (void)part;
    const lac_pending *p = context;
    lac_pass_make(&p->pass, first, end, none);
}

// A block of cells: its stretches of all arrays, or where all cells are one block the whole.
typedef void stretch(const void *context, size_t first, size_t end, double *s);

static double over_block(const lac_pending *p, stretch *look, const void *context, size_t first,
                         size_t end)
{
    double s[LAC_PASS_LANES] = {0};
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
    const lac_pending *p = context;
    sums[0] += over_block(p, lac_pass_make, &p->pass, first, end);
}

static bool reads(const lac_combination *t, const double *x)
{
    bool found = false;
    for (int j = 0; j < t->count; j++) {
        found = found || t->x[j] == x;
    }
    return found;
}

// Whether the order of two sums counts.
static bool tied(const lac_combination *a, const lac_combination *b)
{
    return a->z == b->z || reads(a, b->z) || reads(b, a->z);
}

// Picks what x and w wait for, and what has to be made before it; it comes to the front in its
// order. @param written  x may be overwritten: what reads it counts as well
// @param all  so does all else, but for other arrays that are one number and nobody asks for yet
static void pick(lac_pending *p, const double *x, const double *w, bool written, bool all)
{
    lac_combination late[MOST_WAITING];
    bool picked[MOST_WAITING];
    size_t rest = 0;
    p->pass.count = p->waiting;
    if (p->n < LEAST_APART) {
        return;
    }
    for (size_t i = p->waiting; i-- > 0;) {
        const lac_combination *t = &p->list[i];
        picked[i] = t->z == x || t->z == w || (written && reads(t, x)) || (all && t->count > 0);
        for (size_t k = i + 1; k < p->waiting && !picked[i]; k++) {
            picked[i] = picked[k] && tied(t, &p->list[k]);
        }
    }
    p->pass.count = 0;
    for (size_t i = 0; i < p->waiting; i++) {
        *(picked[i] ? &p->list[p->pass.count++] : &late[rest++]) = p->list[i];
    }
    memcpy(p->list + p->pass.count, late, rest * sizeof *late);
}

// What was picked is made.
static void drop_made(lac_pending *p)
{
    p->waiting -= p->pass.count;
    memmove(p->list, p->list + p->pass.count, p->waiting * sizeof *p->list);
}

static void make_picked(lac_pending *p)
{
    if (p->pass.count > 0) {
        lac_pass_plan(&p->pass);
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
    if (p->one == x || p->twin == x) {
        p->one = p->twin = NULL;
    }
}

void lac_pending_finish(lac_pending *p, const double *x)
{
    pick(p, x, NULL, false, true);
    make_picked(p);
    touch(p, x);
}

void lac_pending_finish_one(lac_pending *p, const double *x)
{
    pick(p, x, x, true, false);
    make_picked(p);
    touch(p, x);
}

static bool waits_for(const lac_pending *p, const double *x)
{
    bool found = false;
    for (size_t i = 0; i < p->waiting; i++) {
        found = found || p->list[i].z == x;
    }
    return found;
}

// Where what x will be can be read, or made, without x.
static const double *made_of(const lac_pending *p, const double *x)
{
    return x == p->one && waits_for(p, x) ? p->twin : x;
}

const double *lac_pending_look(lac_pending *p, const double *x)
{
    const double *made = made_of(p, x);
    pick(p, made, made, true, false);
    make_picked(p);
    return made;
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
    x = made_of(p, x);
    const double *same = level_of(p, x), *level = level_of(p, w); // these can go on waiting
    const bool zero = same != NULL && *same == 0.0;
    p->pass.x = zero ? NULL : x;
    p->pass.w = level != NULL ? NULL : w;
    p->pass.level = level != NULL ? *level : 0.0;
    p->pass.count = 0;
    if (!zero) {
        pick(p, x, level != NULL ? x : w, false, false);
    }
    double sum;
    lac_pass_plan(&p->pass);
    lac_range_sums(&p->range, 1, add_block, p, &sum);
    drop_made(p);
    p->pass.x = p->pass.w = NULL;
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
    double s[LAC_PASS_LANES];
    memcpy(s, sums, sizeof s);
    const double *x = ((const product *)context)->x, *y = ((const product *)context)->y;
    size_t whole = end - (end - first) % LAC_PASS_LANES;
    for (size_t i = first; i < whole; i += LAC_PASS_LANES) {
        for (size_t k = 0; k < LAC_PASS_LANES; k++) {
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

static bool copies(const lac_combination *t) { return t->count == 1 && t->c[0] == 1.0; }

// Whether t is what was added up last, of arrays that have not changed since, or gives one's twin
// what it has.
static bool holds(const lac_pending *p, const lac_combination *t)
{
    const lac_combination *last = &p->last;
    const bool again = t->count == 2 && last->z == t->z && last->x[0] == t->x[0] &&
                       last->x[1] == t->x[1] && last->c[0] == t->c[0] && last->c[1] == t->c[1];
    return again || (copies(t) && t->x[0] == p->one && t->z == p->twin);
}

// Whether t is z = x + z where y = z + x was added up last: a state that is corrected becomes the
// one that was tried, to the bit.
static bool makes_twin(const lac_pending *p, const lac_combination *t)
{
    const lac_combination *last = &p->last;
    return last->z != NULL && t->count == 2 && t->x[1] == t->z && last->x[0] == t->z &&
           last->x[1] == t->x[0] && t->c[0] == 1.0 && t->c[1] == 1.0 && last->c[0] == 1.0 &&
           last->c[1] == 1.0;
}

void lac_pending_add(lac_pending *p, int count, const double *c, const double *const *x, double *z)
{
    lac_combination *t = &p->list[p->waiting]; // there is always room for one more
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
    if (copies(t) && t->x[0] == p->one) {
        t->x[0] = p->twin; // one can go on waiting
    }
    const double *twin = p->waits && makes_twin(p, t) ? p->last.z : NULL;
    touch(p, t->z);
    if (twin != NULL) {
        p->one = t->z;
        p->twin = twin;
    }
    if (t->count == 2 && !reads(t, t->z)) {
        p->last = *t;
    }
    p->waiting++;
    if (!p->waits || p->waiting == MOST_WAITING) {
        p->pass.count = p->waiting;
        make_picked(p);
    }
}
