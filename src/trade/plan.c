// SPDX-License-Identifier: GPL-3.0-or-later
// Which combinations of positions are run.
#include "trade/trade.h"

// NULL: there is none of that name, which `err` says.
static const lac_setting *find(const char *name, size_t length, lac_error *err)
{
    char known[256] = "";
    const lac_setting *setting;
    for (size_t i = 0; (setting = lac_setting_get(i)) != NULL; i++) {
        if (strlen(setting->name) == length && strncmp(setting->name, name, length) == 0) {
            return setting;
        }
        lac_append(known, sizeof known, "%s%s", i > 0 ? ", " : "", setting->name);
    }
    (void)lac_fail(err, LAC_EINPUT, "--dials: \"%.*s\" is no dial; there are %s",
                   (int)(length < 40 ? length : 40), name, known);
    return NULL;
}

// A ladder is climbed from coarse to fine: its last rung is what all are compared with.
static lac_status check_rungs(const lac_trade_setting *setting, lac_error *err)
{
    double before = 0.0;
    for (size_t i = 0; setting->setting->ratio > 0.0 && i < setting->count; i++) {
        char *end;
        const double rung = strtod(setting->value[i].yaml, &end);
        const bool finer = i == 0 || (setting->setting->falls ? rung < before : rung > before);
        LAC_FAIL_IF(*end != '\0' || !(rung > 0.0) || !finer, err, LAC_EINPUT,
                    "--dials: %s: \"%s\" must be a number > 0, and %s than the one before it: from "
                    "coarse to fine",
                    setting->setting->name, setting->value[i].label,
                    setting->setting->falls ? "smaller" : "larger");
        before = rung;
    }
    return LAC_OK;
}

// "1e-3:1e-5" into positions; the setting's own where a label of them is meant.
static lac_status read_values(const char *text, size_t length, const lac_case *c, lac_trade_of of,
                              lac_trade_setting *out, lac_error *err)
{
    lac_setting_value own[LAC_SETTING_VALUES];
    const size_t n = out->setting->values(c, of, own);
    out->count = 0;
    for (size_t at = 0; at <= length;) {
        const size_t end = at + strcspn(text + at, ":,");
        const size_t size = (end < length ? end : length) - at;
        LAC_FAIL_IF(
            size == 0 || size >= LAC_SETTING_LABEL || out->count + 2 >= LAC_SETTING_VALUES, err,
            LAC_EINPUT, "--dials: %s=%.*s must be some positions with : between them, at most %d",
            out->setting->name, (int)(length < 60 ? length : 60), text, LAC_SETTING_VALUES - 2);
        lac_setting_value *value = &out->value[out->count++];
        memset(value, 0, sizeof *value);
        memcpy(value->label, text + at, size);
        memcpy(value->yaml, text + at, size);
        for (size_t i = 0; i < n; i++) {
            if (strcmp(own[i].label, value->label) == 0) {
                *value = own[i];
            }
        }
        at = end + 1;
    }
    out->shown = out->count;
    return check_rungs(out, err);
}

static bool is_of(const lac_setting *setting, unsigned of) { return (setting->use & of) != 0; }

// One word of --dials.
static lac_status add_word(const char *word, size_t length, const lac_case *c, lac_trade *trade,
                           lac_error *err)
{
    const char *equals = memchr(word, '=', length);
    const size_t name = equals != NULL ? (size_t)(equals - word) : length;
    const lac_setting *setting = find(word, name, err);
    if (setting == NULL) {
        return LAC_EINPUT;
    }
    for (size_t d = 0; d < trade->settings; d++) {
        LAC_FAIL_IF(trade->setting[d].setting == setting, err, LAC_EINPUT,
                    "--dials: %s stands there twice", setting->name);
    }
    lac_trade_setting *added = &trade->setting[trade->settings];
    *added = (lac_trade_setting){.setting = setting, .named = equals != NULL};
    if (equals != NULL) {
        LAC_TRY_RETURN(read_values(equals + 1, length - name - 1, c, trade->of, added, err));
    } else {
        added->count = added->shown = setting->values(c, trade->of, added->value);
    }
    trade->settings++;
    return LAC_OK;
}

// A cascade has the settings of a run too where its fidelity is turned, which makes it one.
static lac_status check_turned(const lac_trade *trade, lac_error *err)
{
    unsigned of = trade->of;
    for (size_t d = 0; trade->of == LAC_OF_CASCADE && d < trade->settings; d++) {
        of |= trade->setting[d].setting->cascade != NULL ? LAC_OF_RUN : 0;
    }
    for (size_t d = 0; d < trade->settings; d++) {
        const lac_setting *setting = trade->setting[d].setting;
        const bool turns = is_of(setting, of);
        LAC_FAIL_IF(!turns && trade->of == LAC_OF_RUN, err, LAC_EINPUT,
                    "--dials: %s turns nothing but a cascade", setting->name);
        LAC_FAIL_IF(!turns, err, LAC_EINPUT, "--dials: %s turns nothing in a %s", setting->name,
                    trade->of == LAC_OF_CONTACT ? "contact"
                                                : "cascade, unless fidelity is turned too");
        LAC_FAIL_IF(trade->setting[d].count == 0, err, LAC_EINPUT,
                    "--dials: %s has nothing to turn in this case", setting->name);
    }
    return LAC_OK;
}

static lac_status read_words(const char *words, const lac_case *c, lac_trade *trade, lac_error *err)
{
    for (const char *word = words, *next; word != NULL; word = next != NULL ? next + 1 : NULL) {
        next = strchr(word, ',');
        const size_t length = next != NULL ? (size_t)(next - word) : strlen(word);
        LAC_TRY_RETURN(add_word(word, length, c, trade, err));
    }
    return check_turned(trade, err);
}

// All that need not be asked for.
static void add_usual(const lac_case *c, lac_trade *trade)
{
    const lac_setting *setting;
    for (size_t i = 0; (setting = lac_setting_get(i)) != NULL; i++) {
        lac_trade_setting *added = &trade->setting[trade->settings];
        if ((setting->asked & trade->of) != 0 || !is_of(setting, trade->of)) {
            continue;
        }
        *added = (lac_trade_setting){.setting = setting};
        added->count = added->shown = setting->values(c, trade->of, added->value);
        trade->settings += added->count > 1 ? 1 : 0;
    }
}

// Whether the last position, which the reference has, is a run in time.
static bool reference_runs(const lac_trade *trade)
{
    lac_trade_run last = {.why = 0};
    for (size_t d = 0; d < trade->settings; d++) {
        last.at[d] = (short)((int)trade->setting[d].shown - 1);
    }
    return trade->of == LAC_OF_RUN || lac_trade_of_run(trade, &last) == LAC_OF_RUN;
}

// A run has its tolerance to tell how good its reference is, asked for or not.
static void add_tolerance(const lac_case *c, lac_trade *trade)
{
    const lac_setting *rtol = lac_setting_get(0);
    for (size_t d = 0; d < trade->settings; d++) {
        if (trade->setting[d].setting == rtol) {
            return;
        }
    }
    trade->setting[trade->settings++] =
        (lac_trade_setting){.setting = rtol,
                            .count = 2,
                            .value = {lac_setting_number(fmin(c->run.rtol * 10.0, 0.1)),
                                      lac_setting_number(c->run.rtol)}};
}

// The positions that only the reference has.
static void add_tighter(lac_trade *trade)
{
    for (size_t d = 0; d < trade->settings; d++) {
        lac_trade_setting *added = &trade->setting[d];
        const lac_setting *setting = added->setting;
        if (setting->finer > 0.0) {
            const double next = strtod(added->value[added->count - 1].yaml, NULL) * setting->finer;
            added->value[added->count++] = lac_setting_number(
                setting->falls ? fmax(next, setting->finest) : fmin(next, setting->finest));
        }
    }
}

// Adds a combination, or the reason to one that is there.
static lac_status add_run(lac_trade *trade, const short *at, int why, size_t *index, lac_error *err)
{
    const size_t size = trade->settings * sizeof *at;
    size_t i = 0;
    while (i < trade->runs && memcmp(trade->run[i].at, at, size) != 0) {
        i++;
    }
    if (i == trade->runs) {
        lac_trade_run *grown = realloc(trade->run, (i + 1) * sizeof *grown);
        LAC_FAIL_MEMORY_IF(grown == NULL, err);
        trade->run = grown;
        trade->run[i] = (lac_trade_run){.why = 0};
        memcpy(trade->run[i].at, at, size);
        trade->runs++;
    }
    trade->run[i].why |= why;
    *index = i;
    return LAC_OK;
}

// The reference and what tells how good it is; they are run first.
static lac_status add_reference(lac_trade *trade, lac_error *err)
{
    short at[LAC_SETTINGS];
    const bool runs = reference_runs(trade);
    for (size_t d = 0; d < trade->settings; d++) {
        const lac_trade_setting *setting = &trade->setting[d];
        const bool applies = is_of(setting->setting, runs ? LAC_OF_RUN : trade->of);
        const bool finest = applies && (setting->setting->ratio > 0.0 || setting->setting->scene);
        at[d] = (short)(finest ? (int)setting->count - 1 : -1);
    }
    lac_status status = add_run(trade, at, LAC_TRADE_REFERENCE, &trade->finest, err);
    for (size_t d = 0; status == LAC_OK && d < trade->settings; d++) {
        const short finest = at[d];
        for (short k = 0; status == LAC_OK && k < 2; k++) {
            const bool has = trade->setting[d].setting->ratio > 0.0 && finest > k;
            trade->coarser[d][k] = SIZE_MAX;
            at[d] = (short)(finest - k - 1);
            status = has ? add_run(trade, at, LAC_TRADE_CHECK, &trade->coarser[d][k], err) : LAC_OK;
        }
        at[d] = finest;
    }
    return status;
}

// The case's own positions and each other one, on every rung of the first ladder.
static lac_status add_star(lac_trade *trade, lac_error *err)
{
    const size_t ladder = trade->ladder;
    const size_t rungs = ladder == SIZE_MAX ? 1 : trade->setting[ladder].shown;
    size_t index;
    for (size_t rung = 0; rung < rungs; rung++) {
        short at[LAC_SETTINGS];
        memset(at, -1, sizeof at);
        if (ladder != SIZE_MAX) {
            at[ladder] = (short)rung;
        }
        LAC_TRY_RETURN(add_run(trade, at, LAC_TRADE_TRIED, &index, err));
        for (size_t d = 0; d < trade->settings; d++) {
            for (size_t k = 0; d != ladder && k < trade->setting[d].shown; k++) {
                at[d] = (short)k;
                LAC_TRY_RETURN(add_run(trade, at, LAC_TRADE_TRIED, &index, err));
                at[d] = -1;
            }
        }
    }
    return LAC_OK;
}

// The next combination, the first setting turning fastest; false after the last.
static bool next(const lac_trade *trade, short *at)
{
    for (size_t d = 0; d < trade->settings; d++) {
        const size_t shown = trade->setting[d].shown;
        if (shown > 0 && (size_t)(at[d] + 1) < shown) {
            at[d]++;
            return true;
        }
        at[d] = shown > 0 ? 0 : -1;
    }
    return false;
}

static lac_status add_all(lac_trade *trade, lac_error *err)
{
    enum { MOST = 10000 };
    short at[LAC_SETTINGS];
    size_t index, count = 1;
    for (size_t d = 0; d < trade->settings; d++) {
        at[d] = trade->setting[d].shown > 0 ? 0 : -1;
        count *= trade->setting[d].shown > 0 ? trade->setting[d].shown : 1;
        LAC_FAIL_IF(count > MOST, err, LAC_EINPUT,
                    "--crossed: more than %d combinations; name fewer positions", MOST);
    }
    lac_status status = LAC_OK;
    do {
        status = add_run(trade, at, LAC_TRADE_TRIED, &index, err);
    } while (status == LAC_OK && next(trade, at));
    return status;
}

lac_status lac_trade_create(const lac_case *c, lac_trade_of of, const char *words, bool crossed,
                            lac_trade *out, lac_error *err)
{
    lac_status status = LAC_OK;
    *out = (lac_trade){.of = of};
    LAC_FAIL_IF(of == LAC_OF_RUN && !isnan(c->accuracy), err, LAC_EINPUT,
                "%s: solver.accuracy is for lacuna run, which picks settings by pilot runs; here "
                "solver.rtol counts: leave it out",
                c->path);
    if (words != NULL) {
        LAC_TRY(read_words(words, c, out, err));
    } else {
        add_usual(c, out);
    }
    if (reference_runs(out)) {
        add_tolerance(c, out);
    }
    LAC_LEAVE_IF(out->settings == 0, err, LAC_EINPUT,
                 "there is no dial to turn: its cells are given");
    add_tighter(out);
    out->ladder = SIZE_MAX;
    for (size_t d = out->settings; d-- > 0;) {
        const bool is_ladder = out->setting[d].setting->ratio > 0.0 && out->setting[d].shown > 0;
        out->ladder = is_ladder ? d : out->ladder;
    }
    LAC_TRY(add_reference(out, err));
    LAC_TRY(crossed ? add_all(out, err) : add_star(out, err));
    for (size_t d = 0; d < out->settings; d++) {
        lac_setting_current(out->setting[d].setting, c, out->own[d]);
    }
out:
    if (status != LAC_OK) {
        lac_trade_clear(out);
    }
    return status;
}

void lac_trade_clear(lac_trade *trade)
{
    free(trade->run);
    free(trade->row);
    *trade = (lac_trade){0};
}

lac_trade_of lac_trade_of_run(const lac_trade *trade, const lac_trade_run *run)
{
    lac_trade_of of = trade->of;
    for (size_t d = 0; d < trade->settings; d++) {
        const lac_trade_setting *setting = &trade->setting[d];
        const char *cascade = setting->setting->cascade;
        if (run->at[d] >= 0 && cascade != NULL) {
            const bool is_static = strcmp(setting->value[run->at[d]].label, cascade) == 0;
            of = is_static ? LAC_OF_CASCADE : LAC_OF_RUN;
        }
    }
    return of;
}

bool lac_trade_is_coarser(const lac_trade *trade, const lac_trade_run *a, const lac_trade_run *b)
{
    for (size_t d = 0; d < trade->settings; d++) {
        if (d != trade->ladder && a->at[d] != b->at[d]) {
            return false;
        }
    }
    return trade->ladder != SIZE_MAX && a->at[trade->ladder] < b->at[trade->ladder];
}
