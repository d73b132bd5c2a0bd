// SPDX-License-Identifier: GPL-3.0-or-later
// A member from the file of its sweep: the case that it was the run of.
#include "sweep/describe.h"

const lac_member *lac_ensemble_member(const lac_ensemble *e, int64_t index, size_t *row)
{
    *row = 0;
    while (*row < e->n && e->member[*row]->index != index) {
        (*row)++;
    }
    return *row < e->n ? e->member[*row] : NULL;
}

// What overrides a case, in order, with room for all texts.
typedef struct overrides {
    lac_override *at;
    size_t n;
    char *set;                  // the ensemble's lines, cut
    char (*key)[LAC_SWEEP_KEY]; // [n] of those of the member
    char (*value)[LAC_SWEEP_KEY];
} overrides;

static size_t count(const char *text, char what)
{
    size_t n = 0;
    for (; *text != '\0'; text++) {
        n += *text == what ? 1 : 0;
    }
    return n;
}

static lac_status make_room(const lac_ensemble *e, size_t more, overrides *o, lac_error *err)
{
    size_t keys = 1;
    for (size_t p = 0; p < e->params; p++) {
        keys += 1 + count(e->param[p].key, '+');
    }
    o->at = calloc(count(e->set, '\n') + keys + more, sizeof *o->at);
    o->set = strdup(e->set);
    o->key = calloc(keys, sizeof *o->key);
    o->value = calloc(keys, sizeof *o->value);
    const bool room = o->at != NULL && o->set != NULL && o->key != NULL && o->value != NULL;
    return room ? LAC_OK : lac_fail_memory(err);
}

// What --set gave to all members.
static void take_set(overrides *o)
{
    for (char *line = o->set, *end; (end = strchr(line, '\n')) != NULL; line = end + 1) {
        char *equals = strchr(line, '=');
        *end = '\0';
        if (equals != NULL) {
            *equals = '\0';
            o->at[o->n++] = (lac_override){line, equals + 1};
        }
    }
}

// What the member was given, to the bit: %.17g is.
static void take_member(const lac_ensemble *e, size_t row, overrides *o)
{
    size_t used = 0;
    for (size_t p = 0; p < e->params; p++) {
        const lac_ensemble_param *param = &e->param[p];
        const lac_swept keys = {.key = param->key};
        const bool as_case = param->word != NULL ? strcmp(param->word[row], LAC_AS_THE_CASE) == 0
                                                 : isnan(param->value[row]);
        for (size_t i = 0; !as_case && lac_swept_key(&keys, i, o->key[used]); i++, used++) {
            const char *value = lac_swept_quantity(param->value[row], param->unit, o->value[used],
                                                   sizeof *o->value);
            o->at[o->n++] =
                (lac_override){o->key[used], param->word != NULL ? param->word[row] : value};
        }
    }
}

lac_status lac_ensemble_case(const lac_ensemble *e, const char *path, int64_t index,
                             const lac_case_request *ask, lac_case **out, lac_case_issues *report,
                             lac_error *err)
{
    overrides o = {0};
    size_t row = 0;
    lac_status status;
    *out = NULL;
    *report = (lac_case_issues){0};
    LAC_FAIL_IF(lac_ensemble_member(e, index, &row) == NULL, err, LAC_EINPUT,
                "--member: %s has no member %lld: it holds %zu of %zu, counted from 0", path,
                (long long)index, e->n, e->members);
    LAC_FAIL_IF(e->written[0] == '\0', err, LAC_EINPUT,
                "%s: an earlier version of Lacuna made it, which kept no text to make members from",
                path);
    LAC_TRY(make_room(e, ask->count, &o, err));
    take_set(&o);
    take_member(e, row, &o);
    for (size_t i = 0; i < ask->count; i++) {
        o.at[o.n++] = ask->overrides[i];
    }
    const lac_case_request how = {ask->purpose, o.at, o.n};
    LAC_TRY(lac_case_read_text(path, e->written, strlen(e->written), &how, out, report, err));
    (*out)->run.end = fmin((*out)->run.end, e->until);
out:
    free(o.at);
    free(o.set);
    free(o.key);
    free(o.value);
    return status;
}
