// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of a sweep put together.
#include "sweep/describe.h"

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
        int length;
        const char *changed = lac_sweep_changed_file(part[0]->files, part[k]->files, &length);
        LAC_LEAVE_IF(strcmp(part[k]->mark, part[0]->mark) != 0 || part[k]->members != n ||
                         part[k]->records != part[0]->records || part[k]->params != part[0]->params,
                     err, LAC_EINPUT, "%s: is of another sweep than %s%s%.*s%s", path[k], path[0],
                     changed != NULL ? ": " : "", length, changed != NULL ? changed : "",
                     changed != NULL ? " was changed between them" : "");
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

bool lac_ensemble_is(const char *path)
{
    lac_stored_file *file = NULL;
    char mark[32];
    const bool is = lac_stored_file_open(path, &file, NULL) == LAC_OK &&
                    lac_stored_file_text(file, NULL, "sweep_mark", mark, sizeof mark);
    lac_stored_file_close(file);
    return is;
}
