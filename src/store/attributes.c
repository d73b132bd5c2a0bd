// SPDX-License-Identifier: GPL-3.0-or-later
// What a file would say of a dataset, told to who reads it in memory: types and attributes.
#include "base/ask.h"
#include "store/writer.h"

static char *copy(char **end, const char *text)
{
    const size_t size = text != NULL ? strlen(text) + 1 : 0;
    char *own = text != NULL ? memcpy(*end, text, size) : NULL;
    *end += size;
    return own;
}

static size_t size_of(const char *text) { return text != NULL ? strlen(text) + 1 : 0; }

// In the order of a file, which counts where a later one says more.
static lac_status keep(const lac_teller *t, const char *name, const char *text, size_t n,
                       const double *number, bool whole, lac_error *err)
{
    lac_told *told =
        malloc(sizeof *told + n * sizeof *number + size_of(t->of) + size_of(name) + size_of(text));
    LAC_FAIL_MEMORY_IF(told == NULL, err);
    char *end = (char *)(told->number + n);
    *told = (lac_told){.n = n, .whole = whole};
    if (n > 0) {
        memcpy(told->number, number, n * sizeof *number);
    }
    told->of = copy(&end, t->of);
    told->name = copy(&end, name);
    told->text = copy(&end, text);
    lac_told **last = &t->keep->told;
    while (*last != NULL) {
        last = &(*last)->next;
    }
    *last = told;
    return LAC_OK;
}

static lac_status tell(const lac_teller *t, const char *name, const char *text, size_t n,
                       const double *number, bool whole, lac_error *err)
{
    if (n == 0 && (text == NULL || text[0] == '\0')) {
        return LAC_OK;
    }
    if (t->keep != NULL) {
        return keep(t, name, text, n, number, whole, err);
    }
    t->tell(t->context, name, text, n, number, whole);
    return LAC_OK;
}

lac_status lac_tell_numbers(void *to, const char *name, const char *text, size_t n,
                            const double *number, nc_type type, lac_error *err)
{
    return tell(to, name, text, n, number, type != NC_DOUBLE && type != NC_FLOAT, err);
}

static lac_status tell_one(void *to, const char *name, const char *text, double number, bool whole,
                           lac_error *err)
{
    const size_t n = isfinite(number) ? 1 : 0;
    return tell(to, name, n > 0 ? NULL : text, n, &number, whole, err);
}

lac_status lac_tell_whole(lac_teller *teller, const lac_dataset *dataset,
                          const lac_provenance *made, const lac_dataset *ending, lac_error *err)
{
    const lac_provenance unknown = {.seed = INT64_MIN, .now = NAN};
    lac_provenance own = made != NULL ? *made : unknown;
    own.now = NAN; // no clock is read here
    LAC_TRY_RETURN(lac_provenance_put(&own, dataset->summary, tell_one, teller, err));
    LAC_TRY_RETURN(lac_dataset_put_attributes(dataset, false, tell_one, teller, err));
    LAC_TRY_RETURN(lac_dataset_put_attributes(dataset, true, tell_one, teller, err));
    return ending != NULL ? lac_dataset_put_attributes(ending, false, tell_one, teller, err)
                          : LAC_OK;
}

static const char *type_name(const lac_writer *w, const lac_item *item)
{
    switch (lac_writer_type(w, item)) {
    case NC_STRING:
    case NC_CHAR:
        return "str";
    case NC_BYTE:
        return "int8";
    case NC_INT:
        return "int32";
    case NC_INT64:
        return "int64";
    case NC_FLOAT:
        return "float32";
    default:
        return "float64";
    }
}

lac_status lac_tell_variable(lac_teller *teller, const lac_dataset *dataset, const lac_item *item,
                             bool single, lac_error *err)
{
    lac_writer w = {.dataset = dataset, .single = single};
    LAC_TRY_RETURN(lac_writer_clock(&w, err));
    LAC_TRY_RETURN(tell(teller, NULL, type_name(&w, item), 0, NULL, false, err));
    return lac_writer_attributes(&w, item, lac_tell_numbers, teller, err);
}

static bool same(const char *a, const char *b)
{
    return a == b || (a != NULL && b != NULL && strcmp(a, b) == 0);
}

lac_status lac_dataset_tell(const lac_dataset *dataset, const char *name, lac_attribute_told told,
                            void *context, lac_error *err)
{
    lac_item item;
    LAC_TRY_RETURN(LAC_NEED(err, dataset, told));
    for (const lac_told *at = dataset->told; at != NULL; at = at->next) {
        if (same(at->of, name)) {
            told(context, at->name, at->text, at->n, at->number, at->whole);
        }
    }
    lac_teller teller = {.tell = told, .context = context, .of = name};
    if (dataset->told != NULL) {
        return LAC_OK;
    }
    if (name == NULL) {
        return lac_tell_whole(&teller, dataset, dataset->made, NULL, err);
    }
    LAC_FAIL_IF(!lac_dataset_find(dataset, name, &item), err, LAC_EINPUT,
                "dataset: has no variable \"%s\"", name);
    return lac_item_is_global(&item) ? tell(&teller, NULL, "attribute", 0, NULL, false, err)
                                     : lac_tell_variable(&teller, dataset, &item, false, err);
}
