// SPDX-License-Identifier: GPL-3.0-or-later
// Which cells slip: told by the strength that is left of that at the start, or by the slip rate.
#include "analysis/slipping.h"

#include "lacuna/simulation.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

lac_status lac_slipping_create(const lac_friction *friction, double strength, double rate,
                               double ratio, lac_slipping *out, lac_error *err)
{
    const size_t n = friction->n;
    *out = (lac_slipping){.friction = friction,
                          .n = n,
                          .by_rate = isnan(strength),
                          .strength = strength,
                          .rate = rate,
                          .ratio = ratio};
    out->slips = calloc(n, sizeof *out->slips);
    out->changed = malloc(n * sizeof *out->changed);
    out->most_state = out->by_rate ? NULL : malloc(n * sizeof *out->most_state);
    if (out->slips == NULL || out->changed == NULL || (!out->by_rate && out->most_state == NULL)) {
        lac_slipping_clear(out);
        return lac_fail_memory(err);
    }
    return LAC_OK;
}

void lac_slipping_clear(lac_slipping *s)
{
    free(s->slips);
    free(s->changed);
    free(s->most_state);
    *s = (lac_slipping){0};
}

// A strength grows with the state, so that the part of it is reached at one ln theta.
static void begin(lac_slipping *s, const lac_record *record)
{
    s->begun = true;
    if (s->by_rate) {
        s->rate = isnan(s->ratio) ? s->rate : s->ratio * record->observation.mean_rate;
        return;
    }
    const lac_cellwise *v0 = &s->friction->column[LAC_V0];
    for (size_t i = 0; i < s->n; i++) {
        double u = log(lac_cellwise_of(v0, i));
        double at_start = lac_friction_coefficient(s->friction, i, u, record->cells.log_state[i]);
        s->most_state[i] = lac_friction_state_for(s->friction, i, u, s->strength * at_start);
    }
}

// changed[] takes every cell; only one that did change moves on.
static size_t look_at_states(lac_slipping *s, const double *w)
{
    size_t changes = 0;
    for (size_t i = 0; i < s->n; i++) {
        uint8_t now = w[i] <= s->most_state[i];
        s->changed[changes] = (uint32_t)i;
        changes += now ^ s->slips[i];
        s->slips[i] = now;
    }
    return changes;
}

static size_t look_at_rates(lac_slipping *s, const double *v)
{
    size_t changes = 0;
    for (size_t i = 0; i < s->n; i++) {
        uint8_t now = fabs(v[i]) >= s->rate;
        s->changed[changes] = (uint32_t)i;
        changes += now ^ s->slips[i];
        s->slips[i] = now;
    }
    return changes;
}

void lac_slipping_evaluate(lac_slipping *s, const lac_record *record)
{
    if (!s->begun) {
        begin(s, record);
    }
    s->changes = s->by_rate ? look_at_rates(s, record->cells.slip_rate)
                            : look_at_states(s, record->cells.log_state);
}

void lac_slipping_serialize(lac_slipping *s, lac_archive *archive)
{
    lac_archive_pass(archive, &s->begun, sizeof s->begun);
    lac_archive_pass(archive, &s->rate, sizeof s->rate);
    lac_archive_pass(archive, s->slips, s->n * sizeof *s->slips);
    if (!s->by_rate) {
        lac_archive_pass(archive, s->most_state, s->n * sizeof *s->most_state);
    }
}

const char *lac_slipping_describe(const lac_slipping *s, char *text, size_t size)
{
    if (!s->by_rate) {
        (void)snprintf(text, size,
                       "a cell slips while its strength f(v0, theta) is at most %.4g of what it "
                       "was at the start",
                       s->strength);
    } else if (isnan(s->ratio)) {
        (void)snprintf(text, size, "a cell slips while its slip rate is at least %.6g m/s",
                       s->rate);
    } else {
        (void)snprintf(
            text, size,
            "a cell slips while its slip rate is at least %.6g times the mean rate at the start",
            s->ratio);
    }
    return text;
}
