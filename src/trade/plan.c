// SPDX-License-Identifier: GPL-3.0-or-later
// Which combinations of positions are run.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "trade/trade.h"

static const lac_dial *find(const char *name, size_t length)
{
    const lac_dial *dial;
    for (size_t i = 0; (dial = lac_dial_at(i)) != NULL; i++) {
        if (strlen(dial->name) == length && strncmp(dial->name, name, length) == 0) {
            return dial;
        }
    }
    return NULL;
}

static lac_status no_dial(const char *name, size_t length, lac_error *err)
{
    char known[256] = "";
    const lac_dial *dial;
    for (size_t i = 0; (dial = lac_dial_at(i)) != NULL; i++) {
        size_t used = strlen(known);
        (void)snprintf(known + used, sizeof known - used, "%s%s", i > 0 ? ", " : "", dial->name);
    }
    return lac_fail(err, LAC_EINPUT, "--dials: \"%.*s\" is no dial; there are %s",
                    (int)(length < 40 ? length : 40), name, known);
}

// A ladder is climbed from coarse to fine: its last rung is what all are compared with.
static lac_status check_rungs(const lac_trade_dial *dial, lac_error *err)
{
    double before = 0.0;
    for (size_t i = 0; dial->dial->ratio > 0.0 && i < dial->count; i++) {
        char *end;
        const double rung = strtod(dial->value[i].yaml, &end);
        const bool finer = i == 0 || (dial->dial->falls ? rung < before : rung > before);
        if (*end != '\0' || !(rung > 0.0) || !finer) {
            return lac_fail(err, LAC_EINPUT,
                            "--dials: %s: \"%s\" must be a number > 0, and %s than the one before "
                            "it: from coarse to fine",
                            dial->dial->name, dial->value[i].label,
                            dial->dial->falls ? "smaller" : "larger");
        }
        before = rung;
    }
    return LAC_OK;
}

// "1e-3:1e-5" into positions; the dial's own where a label of them is meant.
static lac_status read_values(const char *text, size_t length, const lac_case *c, lac_trade_of of,
                              lac_trade_dial *out, lac_error *err)
{
    lac_dial_value own[LAC_DIAL_VALUES];
    const size_t n = out->dial->values(c, of, own);
    out->count = 0;
    for (size_t at = 0; at <= length;) {
        const size_t end = at + strcspn(text + at, ":,");
        const size_t size = (end < length ? end : length) - at;
        if (size == 0 || size >= LAC_DIAL_LABEL || out->count + 2 >= LAC_DIAL_VALUES) {
            return lac_fail(err, LAC_EINPUT,
                            "--dials: %s=%.*s must be some positions with : between them, at most "
                            "%d",
                            out->dial->name, (int)(length < 60 ? length : 60), text,
                            LAC_DIAL_VALUES - 2);
        }
        lac_dial_value *value = &out->value[out->count++];
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

static bool is_of(const lac_dial *dial, unsigned of) { return (dial->use & of) != 0; }

// One word of --dials.
static lac_status add_word(const char *word, size_t length, const lac_case *c, lac_trade_plan *plan,
                           lac_error *err)
{
    const char *equals = memchr(word, '=', length);
    const size_t name = equals != NULL ? (size_t)(equals - word) : length;
    const lac_dial *dial = find(word, name);
    if (dial == NULL) {
        return no_dial(word, name, err);
    }
    for (size_t d = 0; d < plan->dials; d++) {
        if (plan->dial[d].dial == dial) {
            return lac_fail(err, LAC_EINPUT, "--dials: %s stands there twice", dial->name);
        }
    }
    lac_trade_dial *added = &plan->dial[plan->dials];
    *added = (lac_trade_dial){.dial = dial, .named = equals != NULL};
    if (equals != NULL) {
        lac_status status = read_values(equals + 1, length - name - 1, c, plan->of, added, err);
        if (status != LAC_OK) {
            return status;
        }
    } else {
        added->count = added->shown = dial->values(c, plan->of, added->value);
    }
    plan->dials++;
    return LAC_OK;
}

// What the dials of a trade may belong to: a cascade has those of a run where its fidelity is
// turned, which makes it one.
static unsigned turned_of(const lac_trade_plan *plan)
{
    unsigned of = plan->of;
    for (size_t d = 0; plan->of == LAC_OF_CASCADE && d < plan->dials; d++) {
        of |= plan->dial[d].dial->cascade != NULL ? LAC_OF_RUN : 0;
    }
    return of;
}

static lac_status no_turn(const lac_dial *dial, lac_trade_of of, lac_error *err)
{
    if (of == LAC_OF_RUN) {
        return lac_fail(err, LAC_EINPUT, "--dials: %s turns nothing but a cascade", dial->name);
    }
    return lac_fail(err, LAC_EINPUT, "--dials: %s turns nothing in a %s", dial->name,
                    of == LAC_OF_CONTACT ? "contact" : "cascade, unless fidelity is turned too");
}

static lac_status check_turned(const lac_trade_plan *plan, lac_error *err)
{
    const unsigned of = turned_of(plan);
    for (size_t d = 0; d < plan->dials; d++) {
        const lac_dial *dial = plan->dial[d].dial;
        if (!is_of(dial, of)) {
            return no_turn(dial, plan->of, err);
        }
        if (plan->dial[d].count == 0) {
            return lac_fail(err, LAC_EINPUT, "--dials: %s has nothing to turn in this case",
                            dial->name);
        }
    }
    return LAC_OK;
}

static lac_status read_words(const char *words, const lac_case *c, lac_trade_plan *plan,
                             lac_error *err)
{
    for (const char *word = words;; word++) {
        const size_t length = strcspn(word, ",");
        lac_status status = add_word(word, length, c, plan, err);
        if (status != LAC_OK) {
            return status;
        }
        if (word[length] == '\0') {
            break;
        }
        word += length;
    }
    return check_turned(plan, err);
}

// All that need not be asked for.
static void add_usual(const lac_case *c, lac_trade_plan *plan)
{
    const lac_dial *dial;
    for (size_t i = 0; (dial = lac_dial_at(i)) != NULL; i++) {
        lac_trade_dial *added = &plan->dial[plan->dials];
        if ((dial->asked & plan->of) != 0 || !is_of(dial, plan->of)) {
            continue;
        }
        *added = (lac_trade_dial){.dial = dial};
        added->count = added->shown = dial->values(c, plan->of, added->value);
        plan->dials += added->count > 1 ? 1 : 0;
    }
}

// Whether the last position, which the reference has, is a run in time.
static bool reference_runs(const lac_trade_plan *plan)
{
    bool runs = plan->of == LAC_OF_RUN;
    for (size_t d = 0; d < plan->dials; d++) {
        const lac_trade_dial *dial = &plan->dial[d];
        if (plan->of == LAC_OF_CASCADE && dial->dial->cascade != NULL) {
            runs = strcmp(dial->value[dial->shown - 1].label, dial->dial->cascade) != 0;
        }
    }
    return runs;
}

// A run has its tolerance to tell how good its reference is, asked for or not.
static void add_tolerance(const lac_case *c, lac_trade_plan *plan)
{
    const lac_dial *rtol = lac_dial_at(0);
    for (size_t d = 0; d < plan->dials; d++) {
        if (plan->dial[d].dial == rtol) {
            return;
        }
    }
    lac_trade_dial *added = &plan->dial[plan->dials++];
    lac_dial_value own = {.label = ""};
    *added = (lac_trade_dial){.dial = rtol, .count = 2};
    lac_dial_current(rtol, c, own.label);
    memcpy(own.yaml, own.label, sizeof own.label);
    double value = c->run.rtol * 10.0 < 0.1 ? c->run.rtol * 10.0 : 0.1;
    (void)snprintf(added->value[0].label, LAC_DIAL_LABEL, "%.10g", value);
    memcpy(added->value[0].yaml, added->value[0].label, LAC_DIAL_LABEL);
    added->value[1] = own;
}

// The positions that only the reference has.
static void add_tighter(lac_trade_plan *plan)
{
    for (size_t d = 0; d < plan->dials; d++) {
        lac_trade_dial *dial = &plan->dial[d];
        if (dial->dial->finer > 0.0) {
            lac_dial_tighten(dial->dial, &dial->value[dial->count - 1], &dial->value[dial->count]);
            dial->count++;
        }
    }
}

static bool same(const lac_trade_run *a, const short *at, size_t dials)
{
    return memcmp(a->at, at, dials * sizeof *at) == 0;
}

// Adds a combination, or the reason to one that is there.
static lac_status add_run(lac_trade_plan *plan, const short *at, int why, size_t *index,
                          lac_error *err)
{
    size_t i = 0;
    while (i < plan->runs && !same(&plan->run[i], at, plan->dials)) {
        i++;
    }
    if (i == plan->runs) {
        lac_trade_run *grown = realloc(plan->run, (i + 1) * sizeof *grown);
        if (grown == NULL) {
            return lac_fail_memory(err);
        }
        plan->run = grown;
        plan->run[i] = (lac_trade_run){.why = 0};
        memcpy(plan->run[i].at, at, plan->dials * sizeof *at);
        plan->runs++;
    }
    plan->run[i].why |= why;
    *index = i;
    return LAC_OK;
}

// The reference and what tells how good it is; they are run first.
static lac_status add_reference(lac_trade_plan *plan, lac_error *err)
{
    short at[LAC_DIALS];
    const bool runs = reference_runs(plan);
    for (size_t d = 0; d < plan->dials; d++) {
        const lac_trade_dial *dial = &plan->dial[d];
        const bool applies = is_of(dial->dial, runs ? LAC_OF_RUN : plan->of);
        const bool finest = applies && (dial->dial->ratio > 0.0 || dial->dial->scene);
        at[d] = (short)(finest ? (int)dial->count - 1 : -1);
    }
    lac_status status = add_run(plan, at, LAC_TRADE_REFERENCE, &plan->reference, err);
    for (size_t d = 0; status == LAC_OK && d < plan->dials; d++) {
        const short finest = at[d];
        plan->coarser[d] = plan->coarsest[d] = SIZE_MAX;
        if (plan->dial[d].dial->ratio > 0.0 && finest >= 1) {
            at[d] = (short)(finest - 1);
            status = add_run(plan, at, LAC_TRADE_CHECK, &plan->coarser[d], err);
        }
        if (status == LAC_OK && plan->dial[d].dial->ratio > 0.0 && finest >= 2) {
            at[d] = (short)(finest - 2);
            status = add_run(plan, at, LAC_TRADE_CHECK, &plan->coarsest[d], err);
        }
        at[d] = finest;
    }
    return status;
}

// The case's own positions and each other one, on every rung of the first ladder.
static lac_status add_star(lac_trade_plan *plan, lac_error *err)
{
    const size_t ladder = plan->ladder;
    const size_t rungs = ladder == SIZE_MAX ? 1 : plan->dial[ladder].shown;
    lac_status status = LAC_OK;
    size_t index;
    for (size_t rung = 0; rung < rungs; rung++) {
        short at[LAC_DIALS];
        memset(at, -1, sizeof at);
        if (ladder != SIZE_MAX) {
            at[ladder] = (short)rung;
        }
        LAC_TRY(add_run(plan, at, LAC_TRADE_TRIED, &index, err));
        for (size_t d = 0; d < plan->dials; d++) {
            for (size_t k = 0; d != ladder && k < plan->dial[d].shown; k++) {
                at[d] = (short)k;
                LAC_TRY(add_run(plan, at, LAC_TRADE_TRIED, &index, err));
                at[d] = -1;
            }
        }
    }
out:
    return status;
}

// The next combination, the first dial turning fastest; false after the last.
static bool next(const lac_trade_plan *plan, short *at)
{
    for (size_t d = 0; d < plan->dials; d++) {
        const size_t shown = plan->dial[d].shown;
        if (shown > 0 && (size_t)(at[d] + 1) < shown) {
            at[d]++;
            return true;
        }
        at[d] = shown > 0 ? 0 : -1;
    }
    return false;
}

static lac_status add_all(lac_trade_plan *plan, lac_error *err)
{
    enum { MOST = 10000 };
    short at[LAC_DIALS];
    size_t index, count = 1;
    for (size_t d = 0; d < plan->dials; d++) {
        at[d] = plan->dial[d].shown > 0 ? 0 : -1;
        count *= plan->dial[d].shown > 0 ? plan->dial[d].shown : 1;
        if (count > MOST) {
            return lac_fail(err, LAC_EINPUT,
                            "--crossed: more than %d combinations; name fewer positions", MOST);
        }
    }
    lac_status status = LAC_OK;
    do {
        status = add_run(plan, at, LAC_TRADE_TRIED, &index, err);
    } while (status == LAC_OK && next(plan, at));
    return status;
}

static size_t find_ladder(const lac_trade_plan *plan)
{
    for (size_t d = 0; d < plan->dials; d++) {
        if (plan->dial[d].dial->ratio > 0.0 && plan->dial[d].shown > 0) {
            return d;
        }
    }
    return SIZE_MAX;
}

lac_status lac_trade_plan_create(const lac_case *c, lac_trade_of of, const char *words,
                                 bool crossed, lac_trade_plan *out, lac_error *err)
{
    lac_status status = LAC_OK;
    *out = (lac_trade_plan){.of = of};
    if (of == LAC_OF_RUN && !isnan(c->accuracy)) {
        return lac_fail(err, LAC_EINPUT,
                        "%s: solver.accuracy is picked for by lacuna run; here "
                        "solver.rtol counts: leave it out",
                        c->path);
    }
    if (words != NULL) {
        LAC_TRY(read_words(words, c, out, err));
    } else {
        add_usual(c, out);
    }
    if (reference_runs(out)) {
        add_tolerance(c, out);
    }
    if (out->dials == 0) {
        LAC_TRY(lac_fail(err, LAC_EINPUT, "there is no dial to turn: its cells are given"));
    }
    add_tighter(out);
    out->ladder = find_ladder(out);
    LAC_TRY(add_reference(out, err));
    LAC_TRY(crossed ? add_all(out, err) : add_star(out, err));
out:
    if (status != LAC_OK) {
        lac_trade_plan_clear(out);
    }
    return status;
}

void lac_trade_plan_clear(lac_trade_plan *plan)
{
    free(plan->run);
    *plan = (lac_trade_plan){0};
}

lac_trade_of lac_trade_of_run(const lac_trade_plan *plan, size_t run)
{
    lac_trade_of of = plan->of;
    for (size_t d = 0; d < plan->dials; d++) {
        const int at = plan->run[run].at[d];
        const char *cascade = plan->dial[d].dial->cascade;
        if (at >= 0 && cascade != NULL) {
            of = strcmp(plan->dial[d].value[at].label, cascade) == 0 ? LAC_OF_CASCADE : LAC_OF_RUN;
        }
    }
    return of;
}

bool lac_trade_is_coarser(const lac_trade_plan *plan, size_t a, size_t b)
{
    for (size_t d = 0; d < plan->dials; d++) {
        if (d != plan->ladder && plan->run[a].at[d] != plan->run[b].at[d]) {
            return false;
        }
    }
    return plan->ladder != SIZE_MAX &&
           plan->run[a].at[plan->ladder] < plan->run[b].at[plan->ladder];
}
