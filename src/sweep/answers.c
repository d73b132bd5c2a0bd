// SPDX-License-Identifier: GPL-3.0-or-later
// What an ensemble says of one number of its members: how likely, how much, and what decides.
// Members that never fail count as later than all, broken ones are left out, and both are told.
#include "sweep/answers.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sort.h>

#include "base/statistics.h"

const double lac_answers_share[LAC_ANSWERS_QUANTILES] = {0.05, 0.25, 0.5, 0.75, 0.95};

bool lac_answers_counts(const lac_sample *sample, size_t member)
{
    const bool combined =
        sample->design == LAC_SAMPLE_SALTELLI && member % (sample->params + 2) > 1;
    return !isnan(sample->result[member]) && !combined;
}

// Ends of the 95 % interval of k of n, Wilson (1927) J. Am. Stat. Assoc. 22, 209: where k/n lies
// 1.96 standard deviations of a share p from p.
static double wilson(double k, double n, double side)
{
    static const double z = 1.959963984540054;
    const double p = k / n, middle = p + z * z / (2.0 * n);
    const double half = z * sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
    const double end = (middle + side * half) / (1.0 + z * z / n);
    return side < 0 && k == 0.0 ? 0.0 : side > 0 && k == n ? 1.0 : end;
}

lac_chance lac_answers_chance(const lac_sample *sample, double by)
{
    lac_chance c = {.by = by, .share = NAN, .low = NAN, .high = NAN};
    for (size_t i = 0; i < sample->members; i++) {
        if (lac_answers_counts(sample, i)) {
            const double t = sample->result[i];
            const bool lost = t > by && isinf(t) && sample->followed != NULL &&
                              sample->followed[i] < by * (1.0 - 1e-9);
            c.failed += t <= by ? 1 : 0;
            c.unknown += lost ? 1 : 0;
            c.known += lost ? 0 : 1;
        }
    }
    const double all = (double)(c.known + c.unknown);
    if (all > 0.0) {
        c.share = c.known > 0 ? (double)c.failed / (double)c.known : (double)NAN;
        c.low = wilson((double)c.failed, all, -1.0);
        c.high = wilson((double)(c.failed + c.unknown), all, 1.0);
    }
    return c;
}

// From 0 to the longest that a member was followed, to its end or not; of a plain result from the
// least to the largest.
static void range_of(const lac_sample *sample, double range[2])
{
    range[0] = sample->plain ? (double)NAN : 0.0;
    range[1] = range[0];
    for (size_t i = 0; i < sample->members; i++) {
        const double t = sample->result[i];
        const double until = sample->followed != NULL ? sample->followed[i] : t;
        range[0] = isfinite(t) ? fmin(range[0], t) : range[0];
        range[1] = isfinite(t) ? fmax(range[1], t) : range[1];
        range[1] = !isnan(t) && isfinite(until) ? fmax(range[1], until) : range[1];
    }
}

// Ranks, from 1, of the sorted values between which a quantile lies with at least 95 %: less than
// `low` values are below it, and less than `high`, with 2.5 % and 97.5 %; 0 and n + 1: none is.
static void ranks_of(size_t n, double share, size_t *low, size_t *high)
{
    const double every = (double)n;
    *low = *high = (size_t)(share * every);
    while (*low > 0 && gsl_cdf_binomial_P((unsigned)(*low - 1), share, (unsigned)n) > 0.025) {
        (*low)--;
    }
    *high += 1;
    while (*high <= n && gsl_cdf_binomial_P((unsigned)(*high - 1), share, (unsigned)n) < 0.975) {
        (*high)++;
    }
}

static void fill_quantiles(lac_answers *a, const double *sorted)
{
    const size_t n = a->counted;
    for (size_t q = 0; q < LAC_ANSWERS_QUANTILES; q++) {
        lac_quantile_answer *one = &a->quantile[q];
        *one = (lac_quantile_answer){lac_answers_share[q], NAN, NAN, NAN};
        size_t low = 0, high = 0;
        if (n > 0) {
            ranks_of(n, one->share, &low, &high);
            one->value = lac_quantile(n, sorted, one->share);
            one->low = low > 0 ? sorted[low - 1] : (double)NAN;
            one->high = high <= n ? sorted[high - 1] : (double)NAN;
        }
    }
}

static void fill_chances(const lac_sample *sample, lac_answers *a)
{
    double range[2];
    range_of(sample, range);
    a->chance = lac_answers_chance(sample, isnan(sample->by) ? range[1] : sample->by);
    for (size_t k = 0; k < LAC_ANSWERS_TIMES; k++) {
        const double wide = range[1] - range[0];
        const double at = range[0] + wide * (double)k / (double)(LAC_ANSWERS_TIMES - 1);
        const bool last = sample->plain && k + 1 == LAC_ANSWERS_TIMES;
        a->course[k] = lac_answers_chance(sample, last ? range[1] : at);
    }
}

static int by_swing(const void *left, const void *right)
{
    const lac_swing *l = left, *r = right;
    const double a = isnan(l->swing) ? -1.0 : l->swing, b = isnan(r->swing) ? -1.0 : r->swing;
    return a > b ? -1 : a < b ? 1 : l->param < r->param ? -1 : 1;
}

static const char *word_of(const lac_sample *sample, size_t param, size_t member)
{
    return sample->word != NULL ? sample->word(sample->of, param, member) : NULL;
}

static void fill_swings(const lac_sample *sample, lac_answers *a)
{
    const double *result = sample->result;
    a->base = result[0];
    for (size_t p = 0; p < sample->params; p++) {
        const double *value = sample->drawn + p * sample->members;
        const size_t low = 1 + 2 * p, high = low + 1;
        const double l = result[low], h = result[high], b = result[0];
        const double most = fmax(fmax(l, h), b), least = fmin(fmin(l, h), b);
        const bool known = !isnan(l) && !isnan(h) && !isnan(b);
        const double swing = most == least ? 0.0 : most - least; // never from never is no change
        a->swing[p] = (lac_swing){.param = p,
                                  .key = sample->key != NULL ? sample->key[p] : NULL,
                                  .unit = sample->key_unit != NULL ? sample->key_unit[p] : NULL,
                                  .low = value[low],
                                  .high = value[high],
                                  .low_word = word_of(sample, p, low),
                                  .high_word = word_of(sample, p, high),
                                  .result_low = l,
                                  .result_high = h,
                                  .swing = known ? swing : (double)NAN};
    }
    qsort(a->swing, sample->params, sizeof *a->swing, by_swing);
}

static void count(const lac_sample *sample, lac_answers *a, double *values)
{
    for (size_t i = 0; i < sample->members; i++) {
        a->broken += isnan(sample->result[i]) ? 1 : 0;
        a->never += isinf(sample->result[i]) ? 1 : 0;
        if (lac_answers_counts(sample, i) && !a->tornado) {
            values[a->counted++] = sample->result[i];
        }
    }
    a->missing = sample->missing;
    a->broken -= sample->missing;
    gsl_sort(values, 1, a->counted);
}

static lac_status check(const lac_sample *sample, lac_error *err)
{
    const size_t n = sample->members, d = sample->params;
    LAC_FAIL_IF(sample->design == LAC_SAMPLE_SALTELLI && n % (d + 2) != 0, err, LAC_EINPUT,
                "%zu members are no whole design saltelli of %zu parameters, which has rows of %zu",
                n, d, d + 2);
    LAC_FAIL_IF(sample->design == LAC_SAMPLE_TORNADO && n != 2 * d + 1, err, LAC_EINPUT,
                "%zu members are no whole design tornado of %zu parameters, which has %zu", n, d,
                2 * d + 1);
    return LAC_OK;
}

lac_status lac_answers_create(const lac_sample *sample, lac_answers **out, lac_error *err)
{
    lac_status status;
    *out = NULL;
    LAC_TRY_RETURN(check(sample, err));
    double *values = malloc((sample->members + 1) * sizeof *values);
    lac_answers *a = *out = calloc(1, sizeof *a);
    LAC_TRY(values != NULL && a != NULL ? LAC_OK : lac_fail_memory(err));
    a->name = sample->name;
    a->unit = sample->unit;
    a->about = sample->about;
    a->plain = sample->plain;
    a->params = sample->params;
    a->members = sample->members;
    a->tornado = sample->design == LAC_SAMPLE_TORNADO;
    a->influence = calloc(sample->params + 1, sizeof *a->influence);
    a->swing = calloc(sample->params + 1, sizeof *a->swing);
    LAC_TRY(a->influence != NULL && a->swing != NULL ? LAC_OK : lac_fail_memory(err));
    count(sample, a, values);
    fill_quantiles(a, values);
    if (a->tornado) {
        fill_swings(sample, a);
    } else {
        fill_chances(sample, a);
        LAC_TRY(lac_influences_fill(sample, a, err));
    }
out:
    free(values);
    LAC_MADE(status, out, lac_answers_free);
}

void lac_answers_free(lac_answers *answers)
{
    if (answers != NULL) {
        free(answers->influence);
        free(answers->swing);
        free(answers);
    }
}

lac_status lac_answers_fan(size_t members, size_t records, const float *series, const bool *use,
                           double *fan, lac_error *err)
{
    double *at = malloc((members + 1) * sizeof *at);
    LAC_FAIL_MEMORY_IF(at == NULL, err);
    for (size_t r = 0; r < records; r++) {
        size_t n = 0;
        for (size_t i = 0; i < members; i++) {
            const double value = (double)series[i * records + r];
            if ((use == NULL || use[i]) && !isnan(value)) {
                at[n++] = value;
            }
        }
        gsl_sort(at, 1, n);
        for (size_t q = 0; q < LAC_ANSWERS_QUANTILES; q++) {
            fan[q * records + r] = n > 0 ? lac_quantile(n, at, lac_answers_share[q]) : (double)NAN;
        }
    }
    free(at);
    return LAC_OK;
}
