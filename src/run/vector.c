// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors for SUNDIALS: fast kernels that sum in a fixed order, no crash where memory is short.
#include "run/vector.h"

#include <stdint.h>
#include <sys/mman.h>

#include "base/clones.h"
#include "run/pending.h"

typedef struct family family;

typedef struct content {
    double *data;
    double *own;   // to be freed or unmapped; NULL where they are lent
    size_t mapped; // bytes; 0: own is of malloc
    family *family;
} content;

// A vector and its clones. SUNDIALS 6.4 and 7 do not survive a clone that is NULL: where memory is
// short it is `lacking`, and all vectors count as empty until the engine looks.
struct family {
    lac_pending *pending;
    size_t members;
    bool lacking;
    content none; // of the members for which there was no memory
};

static content *content_of(N_Vector x) { return x->content; }

static double *raw(N_Vector x) { return content_of(x)->data; }

static lac_pending *pending_of(N_Vector x) { return content_of(x)->family->pending; }

static size_t length(N_Vector x) { return lac_pending_length(pending_of(x)); }

bool lac_vector_lacks(N_Vector x) { return content_of(x)->family->lacking; }

double *lac_vector_data(N_Vector x)
{
    lac_pending_finish(pending_of(x), raw(x));
    return raw(x);
}

double *lac_vector_alone(N_Vector x)
{
    lac_pending_finish_one(pending_of(x), raw(x));
    return raw(x);
}

const double *lac_vector_look(N_Vector x) { return lac_pending_look(pending_of(x), raw(x)); }

void lac_vector_forget(N_Vector x) { lac_pending_forget(pending_of(x), raw(x)); }

void lac_vector_lend(N_Vector x, double *components)
{
    content *c = content_of(x);
    lac_pending_finish(pending_of(x), raw(x));
    if (c != &c->family->none) {
        c->data = components;
    }
}

static void v_lend(sunrealtype *components, N_Vector x) { lac_vector_lend(x, components); }

static N_Vector_ID v_id(N_Vector x)
{
    (void)x;
    return SUNDIALS_NVEC_CUSTOM;
}

static sunindextype v_length(N_Vector x) { return (sunindextype)lac_pending_all(pending_of(x)); }

// In doubles and integers, as CVODES asks.
static void v_space(N_Vector x, sunindextype *reals, sunindextype *integers)
{
    *reals = v_length(x);
    *integers = 1;
}

static void leave(family *f)
{
    f->members--;
    if (f->members == 0) {
        lac_pending_free(f->pending);
        free(f);
    }
}

// Room for components. A long vector begins and mostly lies in pages of 2 MB where the system has
// them: a pass over it looks fewer addresses up. Its last piece stays in small ones, and what is
// mapped before its beginning is never touched, so that it takes no more memory.
static bool make_room(content *c, size_t bytes)
{
    const size_t page = (size_t)1 << 21, whole = bytes / page * page;
    if (whole == 0) {
        c->data = c->own = bytes == 0 ? NULL : malloc(bytes);
        return bytes == 0 || c->own != NULL;
    }
    c->mapped = bytes + page;
    char *room = mmap(NULL, c->mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (room == MAP_FAILED) {
        return false;
    }
    char *begin = room + (page - (uintptr_t)room % page) % page;
#ifdef MADV_HUGEPAGE
    (void)madvise(begin, whole, MADV_HUGEPAGE);
#endif
    c->own = (double *)(void *)room;
    c->data = (double *)(void *)begin;
    return true;
}

static void give_back(content *c)
{
    if (c->mapped > 0) {
        (void)munmap(c->own, c->mapped);
    } else {
        free(c->own);
    }
}

static void v_destroy(N_Vector x)
{
    content *c = content_of(x);
    family *f = c->family;
    lac_pending_finish(f->pending, c->data);
    if (c != &f->none) {
        give_back(c);
        free(c);
    }
    leave(f);
    x->content = NULL;
    N_VFreeEmpty(x);
}

// Makes x a member with room for `bytes` of components.
static void join(N_Vector x, family *f, size_t bytes)
{
    content *c = calloc(1, sizeof *c);
    if (c == NULL || !make_room(c, bytes)) {
        free(c);
        f->lacking = true;
        lac_pending_close(f->pending);
        c = &f->none;
    } else {
        c->family = f;
    }
    f->members++;
    x->content = c;
}

static N_Vector clone(N_Vector like, size_t bytes)
{
    N_Vector x = N_VNewEmpty(like->sunctx);
    if (x == NULL || N_VCopyOps(like, x) != 0) {
        N_VFreeEmpty(x);
        return NULL;
    }
    join(x, content_of(like)->family, bytes);
    return x;
}

N_Vector lac_vector_clone_empty(N_Vector like) { return clone(like, 0); }

// Of components; of none there is a place all the same.
static size_t bytes_of(size_t n) { return (n > 0 ? n : 1) * sizeof(double); }

static N_Vector v_clone(N_Vector like) { return clone(like, bytes_of(length(like))); }

static void v_linear_sum(sunrealtype a, N_Vector x, sunrealtype b, N_Vector y, N_Vector z)
{
    lac_pending_add(pending_of(z), 2, (double[]){a, b}, (const double *[]){raw(x), raw(y)}, raw(z));
}

static void v_const(sunrealtype c, N_Vector z)
{
    lac_pending_add(pending_of(z), 0, &c, NULL, raw(z));
}

static void v_scale(sunrealtype c, N_Vector x, N_Vector z)
{
    lac_pending_add(pending_of(z), 1, &c, (const double *[]){raw(x)}, raw(z));
}

// z_i = result, of x_i and, for two vectors, y_i
#define ELEMENTWISE(name, second, result, ...)            \
    LAC_CLONES static void name(N_Vector xv, __VA_ARGS__) \
    {                                                     \
        const double *x = lac_vector_look(xv);            \
        const double *y = lac_vector_look(second);        \
        double *z = lac_vector_alone(zv);                 \
        size_t n = length(xv);                            \
        (void)y;                                          \
        for (size_t i = 0; i < n; i++) {                  \
            z[i] = (result);                              \
        }                                                 \
    }

ELEMENTWISE(lac_vector_prod, yv, x[i] * y[i], N_Vector yv, N_Vector zv)
ELEMENTWISE(lac_vector_div, yv, x[i] / y[i], N_Vector yv, N_Vector zv)
ELEMENTWISE(lac_vector_abs, xv, fabs(x[i]), N_Vector zv)
ELEMENTWISE(lac_vector_inv, xv, 1.0 / x[i], N_Vector zv)
ELEMENTWISE(lac_vector_add_const, xv, x[i] + b, sunrealtype b, N_Vector zv)

static sunrealtype v_dot(N_Vector x, N_Vector y)
{
    return lac_pending_dot(pending_of(x), lac_vector_data(x), lac_vector_data(y));
}

static sunrealtype v_wrms_norm(N_Vector x, N_Vector w)
{
    return sqrt(lac_pending_squares(pending_of(x), raw(x), raw(w)) / (double)v_length(x));
}

LAC_CLONES static sunrealtype lac_vector_max_norm(N_Vector xv)
{
    const double *x = lac_vector_data(xv);
    size_t n = length(xv);
    double most = 0.0;
    for (size_t i = 0; i < n; i++) {
        double size = fabs(x[i]);
        // A NaN must not hide behind a comparison that is false.
        most = size <= most ? most : size;
    }
    return lac_team_most(lac_pending_team(pending_of(xv)), most);
}

static sunrealtype v_min(N_Vector xv)
{
    const double *x = lac_vector_alone(xv);
    size_t n = length(xv);
    double least = INFINITY;
    for (size_t i = 0; i < n; i++) {
        least = x[i] < least ? x[i] : least;
    }
    return lac_team_least(lac_pending_team(pending_of(xv)), least);
}

static lac_sun_status v_linear_combination(int count, sunrealtype *c, N_Vector *xv, N_Vector z)
{
    const double *x[LAC_PASS_TERMS];
    double by[LAC_PASS_TERMS] = {0.0};
    int terms = 0;
    if (count > LAC_PASS_TERMS) {
        return -1;
    }
    for (int j = 0; j < count; j++) { // what counts 0, as at the end of a step, is not read
        by[terms] = c[j];
        x[terms] = raw(xv[j]);
        terms += c[j] != 0.0 || (j == count - 1 && terms == 0) ? 1 : 0;
    }
    lac_pending_add(pending_of(z), terms, by, x, raw(z));
    return 0;
}

// z_j = a_j x + y_j
static lac_sun_status v_scale_add_multi(int count, sunrealtype *a, N_Vector x, N_Vector *y,
                                        N_Vector *z)
{
    for (int j = 0; j < count; j++) {
        v_linear_sum(a[j], x, 1.0, y[j], z[j]);
    }
    return 0;
}

static void set_operations(N_Vector x)
{
    x->ops->nvgetvectorid = v_id;
    x->ops->nvclone = v_clone;
    x->ops->nvcloneempty = lac_vector_clone_empty;
    x->ops->nvdestroy = v_destroy;
    x->ops->nvspace = v_space;
    x->ops->nvgetlength = v_length;
    x->ops->nvgetarraypointer = lac_vector_data;
    x->ops->nvsetarraypointer = v_lend;
    x->ops->nvlinearsum = v_linear_sum;
    x->ops->nvconst = v_const;
    x->ops->nvprod = lac_vector_prod;
    x->ops->nvdiv = lac_vector_div;
    x->ops->nvscale = v_scale;
    x->ops->nvabs = lac_vector_abs;
    x->ops->nvinv = lac_vector_inv;
    x->ops->nvaddconst = lac_vector_add_const;
    x->ops->nvdotprod = v_dot;
    x->ops->nvmaxnorm = lac_vector_max_norm;
    x->ops->nvwrmsnorm = v_wrms_norm;
    x->ops->nvmin = v_min;
    x->ops->nvlinearcombination = v_linear_combination;
    x->ops->nvscaleaddmulti = v_scale_add_multi;
}

N_Vector lac_vector_create(const lac_range *range, size_t arrays, bool waits, SUNContext sun)
{
    family *f = calloc(1, sizeof *f);
    N_Vector x = f == NULL ? NULL : N_VNewEmpty(sun);
    lac_pending *pending = x == NULL ? NULL : lac_pending_create(range, arrays, waits);
    if (pending == NULL) {
        N_VFreeEmpty(x);
        free(f);
        return NULL;
    }
    f->none.family = f;
    f->pending = pending;
    set_operations(x);
    join(x, f, bytes_of(lac_pending_length(f->pending)));
    if (f->lacking) {
        v_destroy(x);
        return NULL;
    }
    return x;
}
