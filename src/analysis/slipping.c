// SPDX-License-Identifier: GPL-3.0-or-later
// Which cells slip: told by the strength that is left of that at the start, or by the slip rate;
// and the blocks that slip as a whole, counted at every level while cells begin and cease to slip.
#include "analysis/slipping.h"

#include "lacuna/simulation.h"

lac_status lac_slipping_create(const lac_friction *friction, double strength, double rate,
                               lac_slipping *out, lac_error *err)
{
    const size_t n = friction->n;
    *out = (lac_slipping){.friction = friction,
                          .n = n,
                          .by_rate = isnan(strength),
                          .strength = strength,
                          .rate = rate};
    out->slips = calloc(n, sizeof *out->slips);
    out->changed = malloc(n * sizeof *out->changed);
    out->most_state = out->by_rate ? NULL : malloc(n * sizeof *out->most_state);
    const bool room = out->by_rate || out->most_state != NULL;
    LAC_FAIL_MEMORY_IF(out->slips == NULL || out->changed == NULL || !room, err);
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
        return;
    }
    const lac_cellwise *v0 = &s->friction->column[LAC_V0];
    for (size_t i = 0; i < s->n; i++) {
        double u = log(lac_cellwise_of(v0, i));
        double at_start = lac_friction_coefficient(s->friction, i, u, record->cells.log_state[i]);
        s->most_state[i] = lac_friction_state_for(s->friction, i, u, s->strength * at_start);
    }
}

void lac_slipping_evaluate(lac_slipping *s, const lac_record *record)
{
    if (!s->begun) {
        begin(s, record);
    }
    const bool by_rate = s->by_rate;
    const double *v = record->cells.slip_rate, *w = record->cells.log_state;
    size_t changes = 0;
    for (size_t i = 0; i < s->n; i++) {
        uint8_t now = by_rate ? fabs(v[i]) >= s->rate : w[i] <= s->most_state[i];
        s->changed[changes] = (uint32_t)i; // every cell; only one that did change moves on
        changes += now ^ s->slips[i];
        s->slips[i] = now;
    }
    s->changes = changes;
}

void lac_slipping_serialize(lac_slipping *s, lac_archive *archive)
{
    LAC_PASS(archive, s->begun);
    LAC_PASS(archive, s->rate);
    lac_archive_pass(archive, s->slips, s->n * sizeof *s->slips);
    if (!s->by_rate) {
        lac_archive_pass(archive, s->most_state, s->n * sizeof *s->most_state);
    }
}

void lac_slipping_describe(const lac_slipping *s, char *text, size_t size)
{
    if (!s->by_rate) {
        (void)snprintf(text, size,
                       "a cell slips while its strength f(v0, theta) is at most %.4g of what it "
                       "was at the start",
                       s->strength);
    } else {
        (void)snprintf(text, size, "a cell slips while its slip rate is at least %.6g m/s",
                       s->rate);
    }
}

lac_status lac_slip_blocks_create(const lac_hierarchy *h, lac_slip_blocks *out, lac_error *err)
{
    const size_t levels = lac_hierarchy_levels(h);
    size_t entries = 1;
    for (size_t level = 1; level <= levels; level++) {
        entries += lac_hierarchy_blocks(h, level);
    }
    *out = (lac_slip_blocks){.h = h, .levels = levels};
    out->slipping = calloc(levels + 1, sizeof *out->slipping);
    out->sticking = calloc(levels + 1, sizeof *out->sticking);
    out->memory = calloc(entries, sizeof *out->memory);
    LAC_FAIL_MEMORY_IF(out->slipping == NULL || out->sticking == NULL || out->memory == NULL, err);
    uint32_t *next = out->memory;
    for (size_t level = 0; level < levels; level++) {
        if (lac_hierarchy_rank(h, level) > 0) {
            out->sticking[level] = next;
            next += lac_hierarchy_blocks(h, level + 1);
            for (size_t b = 0; b < lac_hierarchy_blocks(h, level); b++) {
                out->sticking[level][lac_hierarchy_parents(h, level)[b]]++;
            }
        }
    }
    return LAC_OK;
}

void lac_slip_blocks_clear(lac_slip_blocks *b)
{
    free(b->slipping);
    free(b->sticking);
    free(b->memory);
    *b = (lac_slip_blocks){0};
}

void lac_slip_blocks_change(lac_slip_blocks *b, uint32_t cell, bool slips)
{
    uint32_t block = cell;
    for (size_t level = 0; level <= b->levels; level++) {
        b->slipping[level] += slips ? 1 : (size_t)-1;
        if (level < b->levels && b->sticking[level] != NULL) {
            block = lac_hierarchy_parents(b->h, level)[block];
            uint32_t *sticking = &b->sticking[level][block];
            // Only the last child that joins, or the first that leaves, changes the block itself.
            if (slips ? --*sticking > 0 : (*sticking)++ > 0) {
                return;
            }
        }
    }
}
