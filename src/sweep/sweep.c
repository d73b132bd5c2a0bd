// SPDX-License-Identifier: GPL-3.0-or-later
// The plan of a sweep: what varies, how members are chosen, and the case of each.
#include "sweep/ensemble.h"

#include "base/temp_file.h"
#include "lacuna/simulation.h"

enum { MOST_RECORDS = 1000 };

void lac_sweep_free(lac_sweep *sweep)
{
    if (sweep == NULL) {
        return;
    }
    for (size_t p = 0; p < sweep->params; p++) {
        lac_swept *param = &sweep->param[p];
        for (size_t i = 0; i < param->values; i++) {
            free(param->text[i]);
        }
        free(param->text);
        free(param->value);
        free(param->key);
        free(param->said);
    }
    for (size_t i = 0; i < sweep->count; i++) {
        free((char *)sweep->overrides[i].key);
        free((char *)sweep->overrides[i].value);
    }
    free(sweep->overrides);
    free(sweep->keys);
    free(sweep->param);
    free(sweep->positions);
    free(sweep->points);
    free(sweep->place);
    free(sweep->said);
    free(sweep->extra);
    free(sweep->path);
    free(sweep->text);
    free(sweep->written);
    free(sweep->files);
    free(sweep->current_words);
    lac_case_free(sweep->current);
    lac_case_free(sweep->base);
    free(sweep);
}

// Reads the case with the first `count` of the overrides.
static lac_status read_case(const lac_sweep *sweep, size_t count, lac_case **out, lac_error *err)
{
    static const char set[] = "--set: ";
    char text[512];
    lac_case_issues report = {0};
    const lac_case_request how = {LAC_FOR_RUN, sweep->overrides, count};
    const lac_status status = lac_case_read_text(sweep->path, sweep->written,
                                                 strlen(sweep->written), &how, out, &report, err);
    for (size_t i = report.count; status != LAC_OK && i-- > 0;) {
        if (!report.issue[i].warning) { // the first one stays
            const char *said = lac_case_issue_format(&report.issue[i], text, sizeof text);
            const bool own = count > sweep->count && strncmp(said, set, sizeof set - 1) == 0;
            (void)lac_fail(err, status, "%s%s", own ? "--over: " : "",
                           said + (own ? sizeof set - 1 : 0));
        }
    }
    lac_case_issues_clear(&report);
    return status;
}

// Keeps what is asked for, and the text of the case.
static lac_status copy_request(lac_sweep *sweep, const lac_sweep_request *r, lac_error *err)
{
    size_t size = 0;
    sweep->path = strdup(r->path);
    sweep->overrides = calloc(r->count + 1, sizeof *sweep->overrides);
    LAC_FAIL_MEMORY_IF(sweep->path == NULL || sweep->overrides == NULL, err);
    LAC_TRY_RETURN(lac_case_read_file(r->path, &sweep->written, &size, err));
    for (; sweep->count < r->count; sweep->count++) {
        lac_override *o = &sweep->overrides[sweep->count];
        o->key = strdup(r->overrides[sweep->count].key);
        o->value = strdup(r->overrides[sweep->count].value);
        LAC_FAIL_MEMORY_IF(o->key == NULL || o->value == NULL, err);
    }
    return LAC_OK;
}

// No key twice, and room for all of them.
static lac_status check_keys(lac_sweep *sweep, lac_error *err)
{
    char one[LAC_SWEEP_KEY], other[LAC_SWEEP_KEY];
    size_t keys = 0;
    for (size_t p = 0; p < sweep->params; p++) {
        for (size_t i = 0; lac_swept_key(&sweep->param[p], i, one); i++, keys++) {
            for (size_t q = 0; q <= p; q++) {
                for (size_t k = 0; lac_swept_key(&sweep->param[q], k, other); k++) {
                    LAC_FAIL_IF((q < p || k < i) && strcmp(one, other) == 0, err, LAC_EINPUT,
                                "--over: %s is named twice", one);
                }
            }
        }
    }
    lac_override *grown = realloc(sweep->overrides, (sweep->count + keys + 1) * sizeof *grown);
    sweep->overrides = grown != NULL ? grown : sweep->overrides;
    sweep->keys = calloc(keys + 1, sizeof *sweep->keys);
    LAC_FAIL_MEMORY_IF(grown == NULL || sweep->keys == NULL, err);
    return LAC_OK;
}

// A table's columns have one axis, each other key one of its own.
static lac_status find_axes(lac_sweep *sweep, size_t of_table, lac_error *err)
{
    sweep->axes = sweep->params - of_table + (of_table > 0 ? 1 : 0);
    LAC_FAIL_IF(
        sweep->axes == 0, err, LAC_EINPUT,
        "--over: name what varies, such as --over \"friction.aging.dc=uniform(1 cm, 5 cm)\"");
    LAC_FAIL_IF(sweep->axes > LAC_SWEEP_AXES, err, LAC_EINPUT,
                "--over: varies %zu keys by themselves: at most %d", sweep->axes, LAC_SWEEP_AXES);
    sweep->positions = calloc(sweep->axes, sizeof *sweep->positions);
    LAC_FAIL_MEMORY_IF(sweep->positions == NULL, err);
    for (size_t p = 0; p < sweep->params; p++) {
        lac_swept *param = &sweep->param[p];
        param->axis = p < of_table ? 0 : p - of_table + (of_table > 0 ? 1 : 0);
        sweep->positions[param->axis] = param->values;
    }
    return check_keys(sweep, err);
}

static lac_status read_params(lac_sweep *sweep, const lac_sweep_request *r, lac_error *err)
{
    if (r->table != NULL) {
        LAC_TRY_RETURN(lac_swept_table(sweep, r->table, err));
    }
    const size_t of_table = sweep->params;
    lac_swept *grown = realloc(sweep->param, (of_table + r->varied + 1) * sizeof *grown);
    LAC_FAIL_MEMORY_IF(grown == NULL, err);
    sweep->param = grown;
    for (size_t i = 0; i < r->varied; i++) {
        sweep->param[sweep->params] = (lac_swept){0};
        LAC_TRY_RETURN(
            lac_swept_read(&sweep->param[sweep->params++], r->over[i], sweep->base, err));
    }
    return find_axes(sweep, of_table, err);
}

// "time:50", "rate:2", "left": what is kept of each run, and where.
static lac_status read_series(lac_sweep *sweep, const char *said, lac_error *err)
{
    static const struct {
        const char *name;
        int usual, most;
    } kinds[] = {{"time", 50, MOST_RECORDS}, {"rate", 2, 50}, {"left", 2, 50}};
    const char *text = said != NULL ? said : "time", *colon = strchr(text, ':');
    const size_t length = colon != NULL ? (size_t)(colon - text) : strlen(text);
    char *end = NULL;
    long n = 0;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (strlen(kinds[i].name) == length && strncmp(text, kinds[i].name, length) == 0) {
            sweep->series = (int)i;
            n = colon != NULL ? strtol(colon + 1, &end, 10) : kinds[i].usual;
            n = (colon == NULL || (*end == '\0' && end != colon + 1)) && n <= kinds[i].most ? n : 0;
        }
    }
    LAC_FAIL_IF(n < 1, err, LAC_EINPUT,
                "--series: \"%s\" must be time:N (slip rates at N equal steps of time), rate:N "
                "(when N slip rates a decade are passed) or left:N (slip rates at N times a decade "
                "before failure)",
                said);
    const double end_time = sweep->base->run.end;
    const double first = sweep->series == LAC_SERIES_RATE ? 1e-12 : 1.0;
    const double last = sweep->series == LAC_SERIES_RATE ? 1.0 : fmax(end_time, 10.0);
    const double per = (double)n;
    sweep->records = sweep->series == LAC_SERIES_TIME
                         ? (size_t)n + 1
                         : (size_t)floor(log10(last / first) * per + 1e-9) + 1;
    sweep->place = malloc(sweep->records * sizeof *sweep->place);
    sweep->said = malloc(32);
    LAC_FAIL_MEMORY_IF(sweep->place == NULL || sweep->said == NULL, err);
    (void)snprintf(sweep->said, 32, "%s:%ld", kinds[sweep->series].name, n);
    for (size_t i = 0; i < sweep->records; i++) {
        sweep->place[i] = sweep->series == LAC_SERIES_TIME ? end_time * (double)i / per
                                                           : first * pow(10.0, (double)i / per);
    }
    return LAC_OK;
}

static void add(uint64_t *sum, const char *text)
{
    *sum = lac_sum_bytes(*sum, text, strlen(text) + 1);
}

// What members follow from: another plan has another mark.
static void find_mark(lac_sweep *sweep)
{
    char text[64];
    sweep->mark = LAC_SUM_OF_NOTHING;
    add(&sweep->mark, sweep->text);
    add(&sweep->mark, sweep->design->name);
    add(&sweep->mark, sweep->said);
    (void)snprintf(text, sizeof text, "%" PRIu64 " %zu", sweep->seed, sweep->members);
    add(&sweep->mark, text);
    for (size_t p = 0; p < sweep->params; p++) {
        const lac_swept *param = &sweep->param[p];
        add(&sweep->mark, param->key);
        add(&sweep->mark, param->said);
        for (size_t i = 0; i < param->values; i++) { // a file's too
            add(&sweep->mark, param->text[i]);
        }
    }
    sweep->mark = lac_sum_bytes(sweep->mark, sweep->files, strlen(sweep->files));
}

// Adds the keys of a parameter as they are set to a text. @return how many overrides there are
static size_t override(lac_sweep *sweep, size_t n, const lac_swept *param, const char *text)
{
    for (size_t i = 0; lac_swept_key(param, i, sweep->keys[n - sweep->count]); i++, n++) {
        sweep->overrides[n] = (lac_override){sweep->keys[n - sweep->count], text};
    }
    return n;
}

static size_t index_of(const lac_swept *param, double u)
{
    // At .1 and .9 of a tornado the ends of a list, whatever its length.
    const size_t i = (size_t)floor(u * (double)param->values);
    return i < param->values ? i : param->values - 1;
}

// All keys together must be such as the case can have: in the middle of what they take, else near
// one of its ends. Where that is refused too it is the keys, not a member's values.
static lac_status try_keys(lac_sweep *sweep, lac_error *err)
{
    static const double places[] = {0.5, 0.01, 0.99};
    char room[LAC_SWEEP_AXES][64];
    lac_status status = LAC_EINPUT;
    for (size_t k = 0; k < sizeof places / sizeof *places && status == LAC_EINPUT; k++) {
        size_t n = sweep->count;
        lac_case *c = NULL;
        lac_error later;
        for (size_t p = 0; p < sweep->params; p++) {
            const lac_swept *param = &sweep->param[p];
            const char *text =
                param->drawn == NULL ? param->text[index_of(param, places[k])] : room[param->axis];
            if (param->drawn != NULL) {
                (void)snprintf(room[param->axis], sizeof *room, "%.17g %s",
                               param->drawn->value(param->argument, places[k]),
                               strcmp(param->unit, "1") == 0 ? "" : param->unit);
            }
            n = override(sweep, n, param, text);
        }
        status = read_case(sweep, n, &c, k == 0 ? err : &later);
        lac_case_free(c);
    }
    return status;
}

// The case with one key set as a text, or as a number, all of it resolved; NULL: it is refused.
static char *with_value(lac_sweep *sweep, const lac_swept *param, const char *text, double value)
{
    lac_case *c = NULL;
    lac_error ignored;
    char key[LAC_SWEEP_KEY], *resolved = NULL;
    const size_t n = text != NULL ? override(sweep, sweep->count, param, text) : sweep->count;
    bool good = read_case(sweep, n, &c, &ignored) == LAC_OK;
    for (size_t i = 0; good && text == NULL && lac_swept_key(param, i, key); i++) {
        good = lac_case_set(c, key, value, NULL) == LAC_OK;
    }
    if (good) {
        resolved = lac_case_text(c);
    }
    lac_case_free(c);
    return resolved;
}

static double value_at(const lac_swept *param, double u);

const char *lac_swept_quantity(double value, const char *unit, char *text, size_t room)
{
    const bool plain = strcmp(unit, "1") == 0;
    (void)snprintf(text, room, "%.17g%s%s", value, plain ? "" : " ", plain ? "" : unit);
    return text;
}

// A number is set in the case that was read, which is fast, unless reading makes other values from
// it, as rg.friction from f0: then the case is another one than that which is read with it.
static void find_followers(lac_sweep *sweep)
{
    for (size_t p = 0; p < sweep->params; p++) {
        lac_swept *param = &sweep->param[p];
        char text[64], *read, *set;
        const double value = value_at(param, 0.01);
        if (param->word) {
            continue;
        }
        (void)lac_swept_quantity(value, param->unit, text, sizeof text);
        read = with_value(sweep, param, text, value);
        set = with_value(sweep, param, NULL, value);
        param->anew = read == NULL || set == NULL || strcmp(read, set) != 0;
        free(read);
        free(set);
    }
}

// Names of what the indicators say once: those of the case as it stands.
static lac_status find_extras(lac_sweep *sweep, lac_error *err)
{
    lac_simulation *simulation = NULL;
    const lac_extra *extra;
    lac_status status = LAC_OK;
    if (sweep->base->analysis.count == 0) {
        return LAC_OK;
    }
    sweep->extra = calloc(LAC_MEMBER_EXTRAS, sizeof *sweep->extra);
    LAC_FAIL_MEMORY_IF(sweep->extra == NULL, err);
    LAC_TRY(lac_simulation_create(sweep->base, NULL, &simulation, err));
    for (size_t i = 0; (extra = lac_simulation_extra(simulation, i)) != NULL; i++) {
        if (extra->over == LAC_OVER_NOTHING) {
            LAC_LEAVE_IF(sweep->extras == LAC_MEMBER_EXTRAS, err, LAC_EINPUT,
                         "analysis: says more than %d values once, which a sweep cannot keep",
                         (int)LAC_MEMBER_EXTRAS);
            lac_ensemble_extra *e = &sweep->extra[sweep->extras++];
            (void)snprintf(e->name, sizeof e->name, "%s", extra->name);
            (void)snprintf(e->unit, sizeof e->unit, "%s", extra->unit);
            (void)snprintf(e->long_name, sizeof e->long_name, "%s", extra->long_name);
        }
    }
out:
    lac_simulation_free(simulation);
    return status;
}

lac_status lac_sweep_create(const lac_sweep_request *request, lac_sweep **out, lac_error *err)
{
    lac_status status;
    lac_sweep *sweep = *out = calloc(1, sizeof *sweep);
    LAC_FAIL_MEMORY_IF(sweep == NULL, err);
    sweep->seed = request->seed;
    LAC_TRY(copy_request(sweep, request, err));
    LAC_TRY(read_case(sweep, sweep->count, &sweep->base, err));
    sweep->until = request->until;
    sweep->base->run.end = fmin(sweep->base->run.end, sweep->until);
    sweep->text = lac_case_text(sweep->base);
    LAC_TRY(sweep->text == NULL ? lac_fail_memory(err) : LAC_OK);
    LAC_TRY(read_params(sweep, request, err));
    LAC_TRY(try_keys(sweep, err));
    find_followers(sweep);
    LAC_TRY(lac_sweep_arrange(sweep, request, err));
    LAC_TRY(lac_sweep_sum_files(sweep, request->files, err));
    LAC_TRY(read_series(sweep, request->series, err));
    LAC_TRY(find_extras(sweep, err));
    find_mark(sweep);
out:
    LAC_MADE(status, out, lac_sweep_free);
}

// Where a member lies along the axis of a parameter.
static double place_of(const lac_sweep *sweep, size_t param, size_t member)
{
    double u[LAC_SWEEP_AXES];
    sweep->design->place(sweep, member, u);
    return u[sweep->param[param].axis];
}

static double value_at(const lac_swept *param, double u)
{
    if (param->drawn != NULL) {
        return param->drawn->value(param->argument, u);
    }
    const size_t i = index_of(param, u);
    return param->number ? param->value[i] : (double)i;
}

// A tornado's ends of a list.
static double ends(const lac_sweep *sweep, const lac_swept *param, double u)
{
    const bool list = sweep->design->sample == LAC_SAMPLE_TORNADO && param->drawn == NULL;
    return !list || isnan(u) ? u : u < 0.5 ? 0.0 : 1.0;
}

double lac_sweep_value(const lac_sweep *sweep, size_t param, size_t member)
{
    const lac_swept *p = &sweep->param[param];
    const double u = ends(sweep, p, place_of(sweep, param, member));
    double value = NAN;
    if (isnan(u)) {
        char key[LAC_SWEEP_KEY];
        (void)lac_swept_key(p, 0, key);
        return !p->word && lac_case_get(sweep->base, key, &value, NULL) == LAC_OK ? value : NAN;
    }
    return value_at(p, u);
}

const char *lac_sweep_text(const lac_sweep *sweep, size_t param, size_t member, char *text,
                           size_t room)
{
    const lac_swept *p = &sweep->param[param];
    const double u = ends(sweep, p, place_of(sweep, param, member));
    if (isnan(u)) {
        return NULL;
    }
    return p->drawn == NULL ? p->text[index_of(p, u)]
                            : lac_swept_quantity(value_at(p, u), p->unit, text, room);
}

// The case with what is set as text, read anew where it is another than the last one's.
// @param all  numbers too
static lac_status set_words(lac_sweep *sweep, size_t member, bool all, lac_error *err)
{
    char room[LAC_SWEEP_AXES][64], *words = NULL;
    size_t size = 0, n = sweep->count;
    FILE *out = open_memstream(&words, &size);
    LAC_FAIL_MEMORY_IF(out == NULL, err);
    for (size_t p = 0; p < sweep->params; p++) {
        const lac_swept *param = &sweep->param[p];
        const char *text = all || param->word || param->anew
                               ? lac_sweep_text(sweep, p, member, room[param->axis], sizeof *room)
                               : NULL;
        if (text != NULL) {
            n = override(sweep, n, param, text);
            (void)fprintf(out, "%s=%s\n", param->key, text);
        }
    }
    LAC_FAIL_MEMORY_IF(fclose(out) != 0, err);
    if (sweep->current != NULL && strcmp(words, sweep->current_words) == 0) {
        free(words);
        return LAC_OK;
    }
    lac_case_free(sweep->current);
    free(sweep->current_words);
    sweep->current = NULL;
    sweep->current_words = words;
    LAC_TRY_RETURN(read_case(sweep, n, &sweep->current, err));
    sweep->current->run.end = fmin(sweep->current->run.end, sweep->until);
    return LAC_OK;
}

static lac_status set_numbers(lac_sweep *sweep, size_t member)
{
    lac_status status = LAC_OK;
    for (size_t p = 0; p < sweep->params; p++) {
        const lac_swept *param = &sweep->param[p];
        char key[LAC_SWEEP_KEY];
        const bool number = !param->word && !param->anew;
        for (size_t i = 0; status == LAC_OK && number && lac_swept_key(param, i, key); i++) {
            status = lac_case_set(sweep->current, key, lac_sweep_value(sweep, p, member), NULL);
        }
    }
    return status;
}

lac_status lac_sweep_case(lac_sweep *sweep, size_t member, const lac_case **c, lac_error *err)
{
    LAC_TRY_RETURN(set_words(sweep, member, false, err));
    if (set_numbers(sweep, member) != LAC_OK) {
        // Refused beside values of the member before it, maybe: a member follows from its own.
        lac_case_free(sweep->current);
        sweep->current = NULL;
        LAC_TRY_RETURN(set_words(sweep, member, true, err));
    }
    if (sweep->current->run.fidelity == LAC_FIDELITY_AUTO) { // series are made of its steps
        sweep->current->run.fidelity = LAC_FIDELITY_ODE;
    }
    *c = sweep->current;
    return LAC_OK;
}
