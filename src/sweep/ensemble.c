// SPDX-License-Identifier: GPL-3.0-or-later
// Members together: made from a sweep, read from its file, gathered from its parts.
#include "sweep/ensemble.h"

#include "lacuna/simulation.h"
#include "sweep/describe.h"

enum { MOST_TEXT = 1 << 22 }; // of a case

// Texts of a plan as attributes of a file.
static const struct {
    const char *name;
    size_t offset, room;
} texts[] = {
    {"sweep_design", offsetof(lac_ensemble, design), 64},
    {"sweep_series", offsetof(lac_ensemble, series), 64},
    {"title", offsetof(lac_ensemble, title), 4096},
    {"case", offsetof(lac_ensemble, case_text), MOST_TEXT},
    {"sweep_files", offsetof(lac_ensemble, files), MOST_TEXT},
};
enum { TEXTS = sizeof texts / sizeof *texts };

static char **text_at(lac_ensemble *e, size_t k)
{
    return (char **)(void *)((char *)e + texts[k].offset);
}

static void free_sample(lac_ensemble *e)
{
    free(e->drawn);
    free(e->rate);
    free((void *)e->key);
}

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
    for (size_t k = 0; k < TEXTS; k++) {
        free(*text_at(e, k));
    }
    free(e->param);
    free(e->member);
    free(e->place);
    free_sample(e);
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
        text[i] = own != NULL ? own : LAC_AS_THE_CASE;
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
    e->files = strdup(sweep->files);
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
    LAC_FAIL_MEMORY_IF(e->case_text == NULL || e->files == NULL || e->design == NULL ||
                           e->series == NULL || e->place == NULL || e->param == NULL,
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
    LAC_MADE(status, out, lac_ensemble_free);
}

static lac_status read_numbers(const lac_stored_file *file, const char *name, size_t n,
                               lac_stored_values *out, const char *path, lac_error *err)
{
    LAC_TRY_RETURN(lac_stored_file_values(file, name, out, err));
    LAC_FAIL_IF(out->value == NULL || out->n != n, err, LAC_EIO, "%s: %s: %s", path, name,
                out->value == NULL ? "is not there" : "has another number of members");
    return LAC_OK;
}

// One variable of the table of a member, into all of them.
static lac_status read_row(const lac_stored_file *file, const lac_variable *row, lac_ensemble *e,
                           const char *path, lac_error *err)
{
    lac_stored_values all = {0};
    lac_stored_shape shape;
    char **text = NULL;
    if (row->held == LAC_HELD_CHARS) {
        LAC_TRY_RETURN(lac_stored_file_shape(file, row->name, &shape, err));
        LAC_FAIL_IF(shape.count != e->n, err, LAC_EIO, "%s: %s: has another number of members",
                    path, row->name);
        LAC_TRY_RETURN(lac_stored_file_texts(file, row->name, &shape, &text, err));
    } else {
        LAC_TRY_RETURN(read_numbers(file, row->name, e->n, &all, path, err));
    }
    for (size_t i = 0; i < e->n; i++) {
        char *at = (char *)e->member[i] + row->offset;
        const double number = all.value != NULL ? all.value[i] : 0.0;
        switch (row->held) {
        case LAC_HELD_CHARS:
            (void)snprintf(at, LAC_MEMBER_MESSAGE, "%s", text[i]);
            break;
        case LAC_HELD_REAL:
            memcpy(at, &number, sizeof number);
            break;
        case LAC_HELD_INT64:
            *(int64_t *)(void *)at = (int64_t)number;
            break;
        default:
            *(int *)(void *)at = (int)number;
            break;
        }
    }
    lac_stored_values_clear(&all);
    free((void *)text);
    return LAC_OK;
}

static lac_status read_series(const lac_stored_file *file, lac_ensemble *e, const char *path,
                              lac_error *err)
{
    lac_stored_values all = {0};
    lac_status status = read_numbers(file, lac_ensemble_axes[e->axis].value, e->n, &all, path, err);
    for (size_t i = 0; status == LAC_OK && all.width == e->records && i < e->n; i++) {
        for (size_t k = 0; k < e->records; k++) {
            e->member[i]->series[k] = (float)all.value[i * e->records + k];
        }
    }
    lac_stored_values_clear(&all);
    return status;
}

// The variables that say what they vary, or that an indicator gave them.
static lac_status read_named(const lac_stored_file *file, const char *name, lac_ensemble *e,
                             const char *path, lac_error *err)
{
    char key[256], said[4096], unit[64] = "1";
    lac_stored_values all = {0};
    lac_stored_shape shape;
    char **text = NULL;
    lac_status status = LAC_OK;
    const bool result = lac_stored_file_text(file, name, "sweep_result", key, sizeof key);
    if (!result && !lac_stored_file_text(file, name, "sweep_key", key, sizeof key)) {
        return LAC_OK;
    }
    (void)lac_stored_file_text(file, name, "units", unit, sizeof unit);
    if (result) {
        LAC_FAIL_IF(e->extras == LAC_MEMBER_EXTRAS, err, LAC_EIO, "%s: has too many results", path);
        lac_ensemble_extra *x = &e->extra[e->extras];
        (void)snprintf(x->name, sizeof x->name, "%s", name);
        (void)snprintf(x->unit, sizeof x->unit, "%s", unit);
        (void)lac_stored_file_text(file, name, "long_name", x->long_name, sizeof x->long_name);
        LAC_TRY_RETURN(read_numbers(file, name, e->n, &all, path, err));
        for (size_t i = 0; i < e->n; i++) {
            e->member[i]->extra[e->extras] = all.value[i];
        }
        e->extras++;
        lac_stored_values_clear(&all);
        return LAC_OK;
    }
    (void)lac_stored_file_text(file, name, "sweep_values", said, sizeof said);
    lac_ensemble_param *grown = realloc(e->param, (e->params + 1) * sizeof *grown);
    LAC_FAIL_MEMORY_IF(grown == NULL, err);
    e->param = grown;
    lac_ensemble_param *param = &e->param[e->params++];
    *param = (lac_ensemble_param){.key = strdup(key), .said = strdup(said), .unit = strdup(unit)};
    LAC_FAIL_MEMORY_IF(param->key == NULL || param->said == NULL || param->unit == NULL, err);
    LAC_TRY(lac_stored_file_shape(file, name, &shape, err));
    LAC_LEAVE_IF(shape.count != e->n, err, LAC_EIO, "%s: %s: has another number of members", path,
                 name);
    if (shape.text) {
        param->value = malloc((e->n + 1) * sizeof *param->value);
        LAC_TRY(param->value == NULL ? lac_fail_memory(err) : LAC_OK);
        LAC_TRY(lac_stored_file_texts(file, name, &shape, &text, err));
        LAC_TRY(lac_ensemble_words(param, e->n, (const char *const *)text, err));
    } else {
        LAC_TRY(read_numbers(file, name, e->n, &all, path, err));
        param->value = all.value;
        all.value = NULL;
    }
out:
    lac_stored_values_clear(&all);
    free((void *)text);
    return status;
}

static lac_status read_plan(const lac_stored_file *file, const char *path, lac_ensemble *e,
                            lac_error *err)
{
    lac_stored_shape shape;
    lac_stored_values place = {0};
    (void)lac_stored_file_text(file, NULL, "sweep_mark", e->mark, sizeof e->mark);
    LAC_FAIL_IF(e->mark[0] == '\0', err, LAC_EINPUT, "%s: is no file of lacuna sweep", path);
    (void)lac_stored_file_text(file, NULL, "sweep_seed", e->seed, sizeof e->seed);
    e->members = (size_t)lac_stored_file_number(file, NULL, "sweep_members");
    e->end = lac_stored_file_number(file, NULL, "sweep_end_s");
    for (size_t k = 0; k < TEXTS; k++) {
        char *text = *text_at(e, k) = calloc(1, texts[k].room);
        LAC_FAIL_MEMORY_IF(text == NULL, err);
        (void)lac_stored_file_text(file, NULL, texts[k].name, text, texts[k].room);
    }
    while (e->axis < LAC_SERIES_LEFT &&
           lac_stored_file_shape(file, lac_ensemble_axes[e->axis].place, &shape, NULL) != LAC_OK) {
        e->axis++;
    }
    LAC_TRY_RETURN(lac_stored_file_values(file, lac_ensemble_axes[e->axis].place, &place, err));
    LAC_FAIL_IF(place.value == NULL, err, LAC_EIO, "%s: has no records", path);
    e->place = place.value;
    e->records = place.n;
    LAC_TRY_RETURN(lac_stored_file_shape(file, "realization", &shape, err));
    e->member = calloc(shape.count + 1, sizeof(lac_member *));
    LAC_FAIL_MEMORY_IF(e->member == NULL, err);
    for (; e->n < shape.count; e->n++) {
        e->member[e->n] = calloc(1, sizeof(lac_member) + e->records * sizeof(float));
        LAC_FAIL_MEMORY_IF(e->member[e->n] == NULL, err);
    }
    return LAC_OK;
}

static lac_status read_all(const lac_stored_file *file, const char *path, lac_ensemble *e,
                           lac_error *err)
{
    char name[LAC_STORED_NAME];
    LAC_TRY_RETURN(read_plan(file, path, e, err));
    for (size_t i = 0; i < lac_ensemble_rows; i++) {
        LAC_TRY_RETURN(read_row(file, &lac_ensemble_of_member[i], e, path, err));
    }
    for (size_t i = 0; i < e->n; i++) {
        const bool broken = e->member[i]->ended > LAC_END_REST;
        e->member[i]->state = broken ? LAC_MEMBER_BROKEN : LAC_MEMBER_DONE;
    }
    for (size_t i = 0; lac_stored_file_variable(file, i, name, sizeof name); i++) {
        LAC_TRY_RETURN(read_named(file, name, e, path, err));
    }
    return read_series(file, e, path, err);
}

lac_status lac_ensemble_read(const char *path, lac_ensemble **out, lac_error *err)
{
    lac_stored_file *file = NULL;
    lac_status status;
    lac_ensemble *e = *out = calloc(1, sizeof *e);
    LAC_FAIL_MEMORY_IF(e == NULL, err);
    LAC_TRY(lac_stored_file_open(path, &file, err));
    LAC_TRY(read_all(file, path, e, err));
out:
    lac_stored_file_close(file);
    LAC_MADE(status, out, lac_ensemble_free);
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

// A member's own number; of a failure that did not come INFINITY. @return whether it is missing
static bool take_result(const lac_member *m, const lac_ensemble_result *of, double *out)
{
    const bool done = m->state == LAC_MEMBER_DONE;
    double value;
    memcpy(&value, (const char *)m + of->offset, sizeof value);
    *out = !done ? NAN : of->time && isnan(value) ? INFINITY : value;
    return done && isnan(*out);
}

lac_status lac_ensemble_sample(lac_ensemble *e, const lac_ensemble_result *of, double by,
                               lac_sample *out, lac_error *err)
{
    size_t missing = 0;
    const lac_design *design = NULL;
    free_sample(e);
    e->rate = malloc((e->n * e->records + 1) * sizeof *e->rate);
    e->drawn = malloc(((e->params + 2) * e->n + 1) * sizeof *e->drawn);
    e->key = malloc((2 * e->params + 1) * sizeof *e->key);
    LAC_FAIL_MEMORY_IF(e->rate == NULL || e->drawn == NULL || e->key == NULL, err);
    e->result = e->drawn + e->params * e->n;
    e->followed = e->result + e->n;
    e->unit = e->key + e->params;
    for (size_t p = 0; p < e->params; p++) {
        memcpy(e->drawn + p * e->n, e->param[p].value, e->n * sizeof *e->drawn);
        e->key[p] = e->param[p].key;
        e->unit[p] = e->param[p].unit;
    }
    for (size_t i = 0; i < e->n; i++) {
        missing += take_result(e->member[i], of, &e->result[i]) ? 1 : 0;
        e->followed[i] = e->member[i]->end_time;
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
                        .followed = of->time ? e->followed : NULL,
                        .plain = !of->time,
                        .missing = missing,
                        .design = design != NULL && e->n == e->members ? design->sample
                                                                       : LAC_SAMPLE_DRAWN,
                        .by = by,
                        .seed = strtoull(e->seed, NULL, 10),
                        .name = of->name,
                        .unit = of->unit != NULL ? of->unit : "1",
                        .about = of->long_name,
                        .word = word_of,
                        .of = e,
                        .key = e->key,
                        .key_unit = e->unit};
    return LAC_OK;
}
