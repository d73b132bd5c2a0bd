// SPDX-License-Identifier: GPL-3.0-or-later
// Members together: made from a sweep, read from its file, gathered from its parts.
#include "sweep/ensemble.h"

#include "sweep/describe.h"

static void free_param(lac_ensemble_param *param)
{
    free(param->key);
    free(param->said);
    free(param->unit);
    free(param->value);
    free(param->word);
    free(param->words);
}

void lac_ensemble_free(lac_ensemble *e)
{
    if (e == NULL) {
        return;
    }
    for (size_t p = 0; e->param != NULL && p < e->params; p++) {
        free_param(&e->param[p]);
    }
    for (size_t i = 0; e->member != NULL && i < e->n; i++) {
        free(e->member[i]);
    }
    free(e->param);
    free(e->member);
    free(e->place);
    free(e->case_text);
    free(e->title);
    free(e->design);
    free(e->series);
    free(e->drawn);
    free(e->result);
    free(e->followed);
    free(e->rate);
    free((void *)e->key);
    free((void *)e->unit);
    free(e);
}

static int by_index(const void *a, const void *b)
{
    const lac_member *x = *(lac_member *const *)a, *y = *(lac_member *const *)b;
    return x->index < y->index ? -1 : x->index > y->index ? 1 : 0;
}

lac_status lac_ensemble_words(lac_ensemble_param *param, size_t n, const char *const *text,
                              lac_error *err)
{
    size_t length = 0, known = 0;
    for (size_t i = 0; i < n; i++) {
        length += strlen(text[i]) + 1;
    }
    param->word = calloc(n + 1, sizeof *param->word);
    param->words = malloc(length + 1);
    const char **first = calloc(n + 1, sizeof *first);
    const bool room = param->word != NULL && param->words != NULL && first != NULL;
    char *at = param->words;
    for (size_t i = 0; room && i < n; i++) {
        const size_t size = strlen(text[i]) + 1;
        size_t k = 0;
        param->word[i] = memcpy(at, text[i], size);
        at += size;
        while (k < known && strcmp(first[k], text[i]) != 0) {
            k++;
        }
        first[k] = param->word[i];
        known = k == known ? known + 1 : known;
        param->value[i] = (double)k;
    }
    free(first);
    return room ? LAC_OK : lac_fail_memory(err);
}

static lac_status make_param(const lac_sweep *sweep, size_t p, lac_ensemble *e, lac_error *err)
{
    const lac_swept *from = &sweep->param[p];
    lac_ensemble_param *param = &e->param[p];
    *param = (lac_ensemble_param){.key = strdup(from->key),
                                  .said = strdup(from->said),
                                  .unit = strdup(from->number ? from->unit : "1"),
                                  .value = malloc((e->n + 1) * sizeof *param->value)};
    LAC_FAIL_MEMORY_IF(param->key == NULL || param->said == NULL || param->unit == NULL ||
                           param->value == NULL,
                       err);
    for (size_t i = 0; i < e->n; i++) {
        param->value[i] = lac_sweep_value(sweep, p, (size_t)e->member[i]->index);
    }
    if (from->number) {
        return LAC_OK;
    }
    const char **text = malloc((e->n + 1) * sizeof *text);
    LAC_FAIL_MEMORY_IF(text == NULL, err);
    for (size_t i = 0; i < e->n; i++) {
        const char *own = lac_sweep_text(sweep, p, (size_t)e->member[i]->index, NULL, 0);
        text[i] = own != NULL ? own : "(as the case)";
    }
    const lac_status status = lac_ensemble_words(param, e->n, text, err);
    free(text);
    return status;
}

static lac_status make(const lac_sweep *sweep, lac_ensemble *e, lac_error *err)
{
    qsort(e->member, e->n, sizeof(lac_member *), by_index);
    e->case_text = strdup(sweep->text);
    e->title = sweep->base->title != NULL ? strdup(sweep->base->title) : NULL;
    e->design = strdup(sweep->design->name);
    e->series = strdup(sweep->said);
    (void)snprintf(e->mark, sizeof e->mark, "%016" PRIx64, sweep->mark);
    (void)snprintf(e->seed, sizeof e->seed, "%" PRIu64, sweep->seed);
    e->end = sweep->base->run.end;
    e->members = sweep->members;
    e->params = sweep->params;
    e->records = sweep->records;
    e->axis = sweep->series;
    e->extras = sweep->extras;
    if (e->extras > 0) {
        memcpy(e->extra, sweep->extra, e->extras * sizeof *e->extra);
    }
    e->place = malloc(e->records * sizeof *e->place);
    e->param = calloc(e->params, sizeof *e->param);
    LAC_FAIL_MEMORY_IF(e->case_text == NULL || e->design == NULL || e->series == NULL ||
                           e->place == NULL || e->param == NULL,
                       err);
    memcpy(e->place, sweep->place, e->records * sizeof *e->place);
    for (size_t p = 0; p < e->params; p++) {
        LAC_TRY_RETURN(make_param(sweep, p, e, err));
    }
    return LAC_OK;
}

lac_status lac_ensemble_create(const lac_sweep *sweep, size_t n, lac_member **member,
                               lac_ensemble **out, lac_error *err)
{
    lac_ensemble *e = *out = calloc(1, sizeof *e);
    if (e == NULL) {
        for (size_t i = 0; i < n; i++) {
            free(member[i]);
        }
        free(member);
        return lac_fail_memory(err);
    }
    e->n = n;
    e->member = member;
    const lac_status status = make(sweep, e, err);
    if (status != LAC_OK) {
        lac_ensemble_free(e);
        *out = NULL;
    }
    return status;
}

// Moves the members of all parts into the first, whose plan is that of all.
static lac_status join(size_t parts, lac_ensemble **part, size_t n, lac_error *err)
{
    lac_ensemble *all = part[0];
    lac_member **member = calloc(n + 1, sizeof *member);
    LAC_FAIL_MEMORY_IF(member == NULL, err);
    for (size_t k = 0; k < parts; k++) {
        for (size_t i = 0; i < part[k]->n; i++) {
            member[part[k]->member[i]->index] = part[k]->member[i];
        }
    }
    lac_status status = LAC_OK;
    for (size_t p = 0; p < all->params && status == LAC_OK; p++) {
        double *value = malloc((n + 1) * sizeof *value);
        const char **word = calloc(n + 1, sizeof *word);
        status = value == NULL || word == NULL ? lac_fail_memory(err) : LAC_OK;
        for (size_t k = 0; k < parts && status == LAC_OK; k++) {
            for (size_t i = 0; i < part[k]->n; i++) {
                const size_t at = (size_t)part[k]->member[i]->index;
                value[at] = part[k]->param[p].value[i];
                word[at] = part[k]->param[p].word != NULL ? part[k]->param[p].word[i] : NULL;
            }
        }
        lac_ensemble_param joined = {.value = value};
        if (status == LAC_OK && all->param[p].word != NULL) {
            status = lac_ensemble_words(&joined, n, word, err);
        }
        free((void *)word);
        if (status == LAC_OK) { // the first part's are needed no more
            free(all->param[p].value);
            free(all->param[p].word);
            free(all->param[p].words);
            all->param[p].value = joined.value;
            all->param[p].word = joined.word;
            all->param[p].words = joined.words;
        } else {
            free(value);
            free(joined.word);
            free(joined.words);
        }
    }
    if (status != LAC_OK) {
        free(member);
        return status;
    }
    for (size_t k = 0; k < parts; k++) {
        part[k]->n = 0; // they are in `member` now
    }
    free(all->member);
    all->member = member;
    all->n = n;
    return LAC_OK;
}

lac_status lac_ensemble_gather(size_t parts, lac_ensemble **part, const char *const *path,
                               lac_ensemble **out, lac_error *err)
{
    const size_t n = part[0]->members;
    size_t missing = 0, first = 0;
    lac_status status = LAC_OK;
    size_t *from = calloc(n + 1, sizeof *from); // 1 more than the part
    LAC_FAIL_MEMORY_IF(from == NULL, err);
    for (size_t k = 0; k < parts; k++) {
        LAC_LEAVE_IF(strcmp(part[k]->mark, part[0]->mark) != 0 || part[k]->members != n ||
                         part[k]->records != part[0]->records || part[k]->params != part[0]->params,
                     err, LAC_EINPUT, "%s: is of another sweep than %s", path[k], path[0]);
        for (size_t i = 0; i < part[k]->n; i++) {
            const int64_t index = part[k]->member[i]->index;
            LAC_LEAVE_IF(index < 0 || (size_t)index >= n, err, LAC_EIO,
                         "%s: has a member %lld, the sweep %zu", path[k], (long long)index, n);
            LAC_LEAVE_IF(from[index] != 0, err, LAC_EINPUT, "%s: member %lld is in %s too", path[k],
                         (long long)index, path[from[index] - 1]);
            from[index] = k + 1;
        }
    }
    for (size_t i = n; i-- > 0;) {
        first = from[i] == 0 ? i : first;
        missing += from[i] == 0 ? 1 : 0;
    }
    LAC_LEAVE_IF(missing > 0, err, LAC_EINPUT,
                 "%zu of %zu members are in none of these files, the first is member %zu", missing,
                 n, first);
    LAC_TRY(join(parts, part, n, err));
    *out = part[0];
    part[0] = NULL;
out:
    free(from);
    return status;
}

// Rates of all members, infinite once a member has failed.
static void fill_rates(lac_ensemble *e)
{
    for (size_t i = 0; i < e->n; i++) {
        const lac_member *m = e->member[i];
        for (size_t k = 0; k < e->records; k++) {
            const bool over = e->axis == LAC_SERIES_TIME && e->place[k] > m->failure_time;
            e->rate[i * e->records + k] = over ? INFINITY : m->series[k];
        }
    }
}

static const char *word_of(const void *of, size_t param, size_t member)
{
    const lac_ensemble_param *p = &((const lac_ensemble *)of)->param[param];
    return p->word != NULL ? p->word[member] : NULL;
}

lac_status lac_ensemble_sample(lac_ensemble *e, double by, lac_sample *out, lac_error *err)
{
    const lac_design *design = NULL;
    free(e->drawn);
    free(e->result);
    free(e->followed);
    free((void *)e->key);
    free((void *)e->unit);
    free(e->rate);
    e->rate = malloc((e->n * e->records + 1) * sizeof *e->rate);
    e->drawn = malloc((e->params * e->n + 1) * sizeof *e->drawn);
    e->result = malloc((e->n + 1) * sizeof *e->result);
    e->followed = malloc((e->n + 1) * sizeof *e->followed);
    e->key = malloc((e->params + 1) * sizeof *e->key);
    e->unit = malloc((e->params + 1) * sizeof *e->unit);
    LAC_FAIL_MEMORY_IF(e->rate == NULL || e->drawn == NULL || e->result == NULL ||
                           e->followed == NULL || e->key == NULL || e->unit == NULL,
                       err);
    for (size_t p = 0; p < e->params; p++) {
        memcpy(e->drawn + p * e->n, e->param[p].value, e->n * sizeof *e->drawn);
        e->key[p] = e->param[p].key;
        e->unit[p] = e->param[p].unit;
    }
    for (size_t i = 0; i < e->n; i++) {
        const lac_member *m = e->member[i];
        e->result[i] = m->state != LAC_MEMBER_DONE ? NAN
                       : isnan(m->failure_time)    ? INFINITY
                                                   : m->failure_time;
        e->followed[i] = m->end_time;
    }
    fill_rates(e);
    for (size_t i = 0; (design = lac_design_get(i)) != NULL; i++) {
        if (strcmp(design->name, e->design) == 0) {
            break;
        }
    }
    *out = (lac_sample){.params = e->params,
                        .members = e->n,
                        .drawn = e->drawn,
                        .result = e->result,
                        .followed = e->followed,
                        .design = design != NULL && e->n == e->members ? design->sample
                                                                       : LAC_SAMPLE_DRAWN,
                        .by = by,
                        .seed = strtoull(e->seed, NULL, 10),
                        .name = "failure_time",
                        .unit = "s",
                        .word = word_of,
                        .of = e,
                        .key = e->key,
                        .key_unit = e->unit};
    return LAC_OK;
}
