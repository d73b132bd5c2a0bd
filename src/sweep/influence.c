// SPDX-License-Identifier: GPL-3.0-or-later
// What decides: indices of Sobol' of a saltelli design; of other members the part of the variance
// between those of equal or neighbouring values. Errors by bootstrap.
#include "sweep/answers.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>

#include "base/rng.h"
#include "base/statistics.h"

enum { REPLICATES = 500 };

// What influences are computed from: rows that are whole, drawn again and again.
typedef struct rows {
    size_t n, wide, params; // wide: numbers of a row
    double *y;              // [n][wide]
    size_t *member;         // [n] first of its members
    size_t *group, *groups; // [params][n], [params] where no design says more
    size_t *pick;           // [n] rows of a replicate
    double *first, *total;  // [params][REPLICATES]
    double *room;           // [params + 2n + 2] of sums
} rows;

static bool all_known(const lac_sample *s, size_t first, size_t wide)
{
    bool known = true;
    for (size_t k = 0; k < wide; k++) {
        known = known && !isnan(s->result[first + k]);
    }
    return known;
}

// Whether it fails by then, or when.
static double value_of(const lac_sample *s, const lac_answers *a, size_t member)
{
    const double t = s->result[member];
    return !a->of_chance ? t : t <= a->chance.by ? 1.0 : 0.0;
}

// First-order and total index of each parameter, of some rows. With f_0 the mean over A and B and V
// the variance, S_p = mean((f_B - f_0) (f_ABp - f_A))/V (Saltelli et al. 2010, table 2 b; f_0 is
// taken off, which lessens the error), ST_p = mean((f_A - f_ABp)^2)/(2 V) (Jansen 1999).
static void saltelli(const rows *r, const size_t *pick, double *first, double *total, size_t stride)
{
    double mean = 0.0, square = 0.0;
    const double n = (double)r->n;
    for (size_t p = 0; p < r->params; p++) {
        first[p * stride] = total[p * stride] = 0.0;
    }
    for (size_t i = 0; i < r->n; i++) {
        const double *y = r->y + pick[i] * r->wide;
        mean += (y[0] + y[1]) / (2.0 * n);
    }
    for (size_t i = 0; i < r->n; i++) {
        const double *y = r->y + pick[i] * r->wide, a = y[0] - mean, b = y[1] - mean;
        square += (a * a + b * b) / (2.0 * n);
        for (size_t p = 0; p < r->params; p++) {
            const double change = y[2 + p] - y[0];
            first[p * stride] += b * change / n;
            total[p * stride] += change * change / (2.0 * n);
        }
    }
    const bool tells = square > 0.0 && r->n > 1; // one row has no error
    for (size_t p = 0; p < r->params; p++) {
        first[p * stride] = tells ? first[p * stride] / square : (double)NAN;
        total[p * stride] = tells ? total[p * stride] / square : (double)NAN;
    }
}

// Epsilon squared: (between - (k - 1) within/(n - k))/all, sums of squares of k groups.
// @return NaN: it cannot be told
static double between(const rows *r, const size_t *pick, size_t p)
{
    const size_t k = r->groups[p], *group = r->group + p * r->n;
    double *sum = r->room, *many = r->room + k, mean = 0.0, all = 0.0, between = 0.0;
    for (size_t g = 0; g < k; g++) {
        sum[g] = many[g] = 0.0;
    }
    for (size_t i = 0; i < r->n; i++) {
        mean += r->y[pick[i]] / (double)r->n;
    }
    for (size_t i = 0; i < r->n; i++) {
        const double y = r->y[pick[i]] - mean;
        sum[group[pick[i]]] += y;
        many[group[pick[i]]] += 1.0;
        all += y * y;
    }
    double filled = 0.0;
    for (size_t g = 0; g < k; g++) {
        between += many[g] > 0.0 ? sum[g] * sum[g] / many[g] : 0.0;
        filled += many[g] > 0.0 ? 1.0 : 0.0;
    }
    const double rest = (double)r->n - filled; // one group has nothing to be told from
    return all > 0.0 && rest > 0.0 && filled > 1.0
               ? (between - (filled - 1.0) * (all - between) / rest) / all
               : (double)NAN;
}

static void evaluate(const rows *r, const size_t *pick, double *first, double *total, size_t stride)
{
    if (r->wide > 1) {
        saltelli(r, pick, first, total, stride);
        return;
    }
    for (size_t p = 0; p < r->params; p++) {
        first[p * stride] = between(r, pick, p);
        total[p * stride] = NAN;
    }
}

// Members of equal values are a group; of more values than half of the members, sqrt(n) groups of
// neighbours.
static lac_status make_groups(const lac_sample *s, rows *r, size_t p, lac_error *err)
{
    const double *value = s->drawn + p * s->members;
    size_t *order = malloc((r->n + 1) * sizeof *order), distinct = 0;
    LAC_FAIL_MEMORY_IF(order == NULL, err);
    for (size_t i = 0; i < r->n; i++) {
        r->room[i] = value[r->member[i]];
    }
    gsl_sort_index(order, r->room, 1, r->n);
    for (size_t i = 0; i < r->n; i++) {
        distinct += i == 0 || r->room[order[i]] != r->room[order[i - 1]] ? 1 : 0;
    }
    const size_t bins = (size_t)sqrt((double)r->n);
    const bool each = 2 * distinct <= r->n;
    size_t group = 0, begun = 0;
    for (size_t i = 0; i < r->n; i++) {
        const bool equal = i > 0 && r->room[order[i]] == r->room[order[i - 1]];
        const bool full = each || i * bins / r->n > begun * bins / r->n;
        if (i > 0 && !equal && full) {
            group++;
            begun = i;
        }
        r->group[p * r->n + order[i]] = group;
    }
    r->groups[p] = group + 1;
    free(order);
    return LAC_OK;
}

static int compare(double a, double b) { return a > b ? 1 : a < b ? -1 : 0; }

static int by_influence(const void *left, const void *right)
{
    const lac_influence *l = left, *r = right;
    const double a = isnan(l->total) ? l->first : l->total;
    const double b = isnan(r->total) ? r->first : r->total;
    const int order = compare(isnan(b) ? -INFINITY : b, isnan(a) ? -INFINITY : a);
    return order != 0 ? order : l->param < r->param ? -1 : 1;
}

// Standard deviation and 95 % interval of the replicates.
static void spread(double *replicate, double *error, double *low, double *high)
{
    size_t n = 0;
    *error = *low = *high = NAN;
    for (size_t k = 0; k < REPLICATES; k++) {
        if (!isnan(replicate[k])) {
            replicate[n++] = replicate[k];
        }
    }
    if (n > REPLICATES / 2) {
        gsl_sort(replicate, 1, n);
        *error = gsl_stats_sd(replicate, 1, n);
        *low = lac_quantile(n, replicate, 0.025);
        *high = lac_quantile(n, replicate, 0.975);
    }
}

static void bootstrap(const lac_sample *s, rows *r, lac_answers *a)
{
    for (size_t k = 0; k < REPLICATES; k++) {
        for (size_t i = 0; i < r->n; i++) {
            const double u = lac_random_uniform(s->seed, LAC_STREAM_BOOTSTRAP, k, i);
            r->pick[i] = (size_t)(u * (double)r->n);
        }
        evaluate(r, r->pick, r->first + k, r->total + k, REPLICATES);
    }
    for (size_t p = 0; p < r->params; p++) {
        lac_influence *one = &a->influence[p];
        spread(r->first + p * REPLICATES, &one->first_error, &one->first_low, &one->first_high);
        spread(r->total + p * REPLICATES, &one->total_error, &one->total_low, &one->total_high);
        if (r->wide == 1) { // members drawn twice look alike: their groups tell apart too well
            one->first_low = one->first - 1.96 * one->first_error;
            one->first_high = one->first + 1.96 * one->first_error;
        }
    }
}

// Rank correlation with the result, never being later than all; NaN: of words, which have no order.
static double rank(const lac_sample *s, rows *r, size_t p)
{
    double *x = r->room, *y = r->room + r->n, *work = malloc((2 * r->n + 1) * sizeof *work);
    double rho = NAN;
    const bool words = r->n > 0 && s->word != NULL && s->word(s->of, p, r->member[0]) != NULL;
    if (work != NULL && r->n > 2 && !words) {
        for (size_t i = 0; i < r->n; i++) {
            x[i] = s->drawn[p * s->members + r->member[i]];
            y[i] = s->result[r->member[i]];
        }
        rho = gsl_stats_spearman(x, 1, y, 1, r->n, work);
    }
    free(work);
    return rho;
}

static lac_status fill(const lac_sample *s, rows *r, lac_answers *a, lac_error *err)
{
    double *first = r->first, *total = r->total;
    for (size_t i = 0; i < r->n; i++) {
        r->pick[i] = i;
    }
    for (size_t p = 0; p < r->params; p++) {
        const char *key = s->key != NULL ? s->key[p] : NULL;
        a->influence[p] = (lac_influence){.param = p, .key = key, .rank = rank(s, r, p)};
        LAC_TRY_RETURN(r->wide == 1 ? make_groups(s, r, p, err) : LAC_OK);
    }
    evaluate(r, r->pick, first, total, REPLICATES);
    for (size_t p = 0; p < r->params; p++) {
        a->influence[p].first = first[p * REPLICATES];
        a->influence[p].total = total[p * REPLICATES];
    }
    bootstrap(s, r, a);
    qsort(a->influence, r->params, sizeof *a->influence, by_influence);
    return LAC_OK;
}

lac_status lac_influences_fill(const lac_sample *s, lac_answers *a, lac_error *err)
{
    const size_t d = s->params, n = s->members;
    const size_t wide = s->design == LAC_SAMPLE_SALTELLI ? d + 2 : 1;
    rows r = {.wide = wide, .params = d};
    double zero = 0.0; // what results count from
    lac_status status;
    r.y = malloc((n + 1) * sizeof *r.y);
    r.member = malloc((n + 1) * sizeof *r.member);
    r.pick = malloc((n + 1) * sizeof *r.pick);
    r.group = malloc((d * n + 1) * sizeof *r.group);
    r.groups = malloc((d + 1) * sizeof *r.groups);
    r.first = malloc((d + 1) * REPLICATES * sizeof *r.first);
    r.total = malloc((d + 1) * REPLICATES * sizeof *r.total);
    r.room = malloc((2 * n + 2) * sizeof *r.room);
    LAC_TRY(r.y != NULL && r.member != NULL && r.pick != NULL && r.group != NULL &&
                    r.groups != NULL && r.first != NULL && r.total != NULL && r.room != NULL
                ? LAC_OK
                : lac_fail_memory(err));
    a->of_chance = a->never > 0 || !isnan(s->by);
    for (size_t i = 0; i + wide <= n; i += wide) {
        if (all_known(s, i, wide)) {
            r.member[r.n] = i;
            for (size_t k = 0; k < wide; k++) {
                const double y = value_of(s, a, i + k);
                r.y[r.n * wide + k] = r.n + k > 0 ? y - zero : 0.0; // what is equal has exactly 0
                zero = r.n + k > 0 ? zero : y;
            }
            r.n++;
        }
    }
    a->rows = r.n;
    a->alike = true;
    for (size_t i = 0; i < r.n * wide; i++) {
        a->alike = a->alike && r.y[i] == 0.0;
    }
    LAC_TRY(fill(s, &r, a, err));
out:
    free(r.y);
    free(r.member);
    free(r.pick);
    free(r.group);
    free(r.groups);
    free(r.first);
    free(r.total);
    free(r.room);
    return status;
}
