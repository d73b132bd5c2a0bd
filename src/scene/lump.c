// SPDX-License-Identifier: GPL-3.0-or-later
// A scene on fewer cells: of each block some cells stay that stand for all, with weights by which
// sums over the block keep their values; what holds them against each other is what held the
// block's cells, by how they would slip apart. docs/theory/lumped.md.
#include "base/cubature.h"
#include "base/vsum.h"
#include "scene/lump_parts.h"

// One lump as it is made.
typedef struct making {
    const lac_lump_source *source;
    lac_lump_cells field;
    size_t level;
    size_t most;      // leaves of a block, at most
    double least;     // of what a sum is worth keeping
    size_t first;     // cell of a block
    size_t leaves;    // so far
    uint32_t *kept;   // [n] cells that stay
    double *weight;   // [n] cells that each stands for
    uint32_t *begin;  // [blocks + 1] the first leaf of each block
    double *bond;     // [blocks] what holds its leaves against each other
    double stretch;   // times this
    double breaks;    // stretch below which one of them holds so weakly that a leaf slips by itself
    uint32_t *leaf;   // [n] which leaf stands for a cell
    lac_lump_way way; // of all cells
} making;

// Sums of the cells themselves and of what moves them apart, before those of what friction holds.
enum {
    COUNTED = 4,
    BEFORE = COUNTED + LAC_LUMP_PATTERNS - 1,
    FUNCTIONS = BEFORE + LAC_LUMP_ROWS + 1 // the last where loads have a shape
};

// What the leaves of a block keep the sums of: cells, pressure and its square, slip rate at the
// start, the shape of a load; and friction along some histories. Where a case says how many leaves,
// the first of those with the cells and their pressure.
static void values_of(const void *context, size_t point, double *value)
{
    const making *m = context;
    const lac_lump_cells *f = &m->field;
    const lac_problem_def *whole = &m->source->whole;
    const size_t i = m->first + point;
    const double p = whole->domain->pressure[i] / f->pressure;
    double all[FUNCTIONS] = {1.0, p, p * p, exp(whole->log_rate[i]) / f->mean_rate};
    for (size_t a = 1; a < LAC_LUMP_PATTERNS; a++) {
        all[COUNTED + a - 1] = p * (p * f->pattern[i] - f->answer) * f->pattern[a * f->n + i];
    }
    for (size_t k = 0; k < LAC_LUMP_ROWS; k++) {
        all[BEFORE + k] = p * f->friction[k * f->n + i];
    }
    all[FUNCTIONS - 1] = whole->loads.shape != NULL ? whole->loads.shape[i] : 0.0;
    const size_t first = m->most < FUNCTIONS - 1 ? 2 : m->most;
    memcpy(value, all, first * sizeof *value);
    for (size_t k = first; k < m->most; k++) {
        value[k] = all[BEFORE + k - first];
    }
}

// How far the leaves of a block would slip apart if 1 held them: squares.
static double leaves_apart(const making *m, size_t leaves)
{
    const uint32_t *kept = m->kept + m->leaves;
    const double *weight = m->weight + m->leaves, *p = m->source->whole.domain->pressure;
    double few = 0.0;
    for (size_t a = LAC_LUMP_ANSWER + 1; a < LAC_LUMP_PATTERNS; a++) {
        const double *pattern = m->field.pattern + a * m->field.n;
        double mean = 0.0, sum = 0.0;
        for (size_t i = 0; i < leaves; i++) {
            sum += weight[i] * p[kept[i]];
            mean += weight[i] * p[kept[i]] * pattern[kept[i]];
        }
        for (size_t i = 0; i < leaves; i++) {
            const double force = p[kept[i]] * (pattern[kept[i]] - mean / sum);
            few += weight[i] * force * force;
        }
    }
    return few;
}

// By how far the cells of a block would slip apart under the patterns, and what that does to all of
// each, the stiffness that does the same to its leaves.
static double bond_of(const making *m, size_t first, size_t end, size_t leaves)
{
    const double nothing = pow(1e-9 * m->field.pressure, 2.0); // rounding of what is alike
    const double soft = lac_vsum(end - first, m->field.apart + first);
    const double few = leaves_apart(m, leaves);
    return few > nothing * (double)(end - first) && soft > 0.0 ? few / soft
                                                               : lac_lump_stiffness(m->source, 0);
}

// What a bond must be for friction of none of the leaves of a block to give way faster than what
// holds it: it then slips by itself, early or never by what little its bond is off. (Ruina 1983:
// k_crit)
static double least_bond(const making *m, size_t leaves)
{
    const lac_problem_def *whole = &m->source->whole;
    const lac_cellwise *of = whole->friction->column;
    double least = 0.0;
    for (const uint32_t *i = m->kept + m->leaves; i < m->kept + m->leaves + leaves; i++) {
        const double falls = lac_cellwise_of(&of[LAC_B], *i) - lac_cellwise_of(&of[LAC_A], *i);
        const double p = whole->domain->pressure[*i];
        least = fmax(least, p * falls / lac_cellwise_of(&of[LAC_DC], *i));
    }
    return least;
}

// Which of the leaves of a block each of its cells is most like.
static void assign(making *m, size_t first, size_t end, size_t leaves)
{
    for (size_t i = first; i < end; i++) {
        double nearest = INFINITY;
        for (size_t c = m->leaves; c < m->leaves + leaves; c++) {
            const double *row = m->field.friction;
            double apart = 0.0;
            for (size_t k = 0; k < LAC_LUMP_ROWS && apart < nearest; k++, row += m->field.n) {
                apart += (row[i] - row[m->kept[c]]) * (row[i] - row[m->kept[c]]);
            }
            m->leaf[i] = apart < nearest ? (uint32_t)c : m->leaf[i];
            nearest = fmin(nearest, apart);
        }
    }
}

// The leaves that another lump has between two cells.
static size_t take_like(making *m, size_t first, size_t end)
{
    const lac_lump *like = m->source->like;
    size_t leaves = 0;
    for (size_t i = 0; i < like->domain->n; i++) {
        if (like->kept[i] >= first && like->kept[i] < end) {
            m->kept[m->leaves + leaves] = like->kept[i];
            m->weight[m->leaves + leaves++] = like->domain->weight[i] * like->domain->each;
        }
    }
    return leaves;
}

static lac_status take_block(making *m, size_t number, lac_error *err)
{
    const lac_lump_source *s = m->source;
    const uint32_t *begin = lac_hierarchy_offsets(s->blocks, m->level);
    const size_t first = begin[number], end = begin[number + 1];
    uint32_t *kept = m->kept + m->leaves;
    size_t leaves;
    const lac_cubature of = {.points = end - first,
                             .functions = m->most,
                             .least = m->least,
                             .at = values_of,
                             .context = m};
    m->first = first;
    if (s->like != NULL) {
        leaves = take_like(m, first, end);
    } else {
        LAC_TRY_RETURN(lac_cubature_thin(&of, kept, m->weight + m->leaves, &leaves, err));
        for (size_t i = 0; i < leaves; i++) {
            kept[i] += (uint32_t)first;
        }
    }
    assign(m, first, end, leaves);
    m->begin[number] = (uint32_t)m->leaves;
    m->bond[number] = leaves > 1 ? bond_of(m, first, end, leaves) : 0.0;
    m->breaks = fmax(m->breaks, leaves > 1 ? least_bond(m, leaves) / m->bond[number] : 0.0);
    m->leaves += leaves;
    m->begin[number + 1] = (uint32_t)m->leaves;
    return LAC_OK;
}

// Ties nodes to a new one, if there are several. @return the node that stands for them
static uint32_t tie(lac_classes *classes, const uint32_t *node, size_t count, double k)
{
    if (count == 1) {
        return node[0];
    }
    const uint32_t block = (uint32_t)classes->nodes++;
    for (size_t i = 0; i < count; i++) {
        classes->parent[node[i]] = block;
        classes->weight[block] += classes->weight[node[i]];
    }
    classes->k[block] = k;
    return block;
}

// The leaves in their blocks, and these over the levels above.
static lac_status make_classes(const making *m, lac_lump *lump, lac_error *err)
{
    const lac_hierarchy *h = m->source->blocks;
    const size_t blocks = lac_hierarchy_blocks(h, m->level), most = m->leaves + 3 * blocks;
    uint32_t *node = calloc(m->leaves + blocks, sizeof *node);
    LAC_FAIL_MEMORY_IF(node == NULL, err);
    uint32_t *block = node + m->leaves;
    lac_status status = lac_classes_create(m->leaves, most, &lump->classes, err);
    LAC_TRY(status);
    lac_classes *classes = lump->classes;
    classes->nodes = m->leaves;
    memcpy(classes->weight, m->weight, m->leaves * sizeof *m->weight);
    for (uint32_t i = 0; i < m->leaves; i++) {
        node[i] = i;
    }
    for (size_t b = 0; b < blocks; b++) {
        block[b] = tie(classes, node + m->begin[b], m->begin[b + 1] - m->begin[b],
                       m->stretch * m->bond[b]);
    }
    for (size_t l = m->level; l < lac_hierarchy_levels(h); l++) {
        if (lac_hierarchy_rank(h, l) == 0) {
            continue; // each block is alone in the one around it
        }
        const uint32_t *parent = lac_hierarchy_parents(h, l);
        const double k = lac_lump_stiffness(m->source, l);
        for (size_t c = 0, end, count = lac_hierarchy_blocks(h, l); c < count; c = end) {
            for (end = c + 1; end < count && parent[end] == parent[c]; end++) {
            }
            block[parent[c]] = tie(classes, block + c, end - c, k);
        }
    }
    classes->parent[classes->nodes - 1] = (uint32_t)classes->nodes - 1;
out:
    free(node);
    return status;
}

// What the leaves have of a column of the cells.
static void gather(const making *m, const double *of, double *out)
{
    for (size_t i = 0; i < m->leaves; i++) {
        out[i] = of[m->kept[i]];
    }
}

static lac_status make_domain(const making *m, lac_domain **out, lac_error *err)
{
    const lac_domain *whole = m->source->whole.domain;
    lac_domain *domain = calloc(1, sizeof *domain);
    *out = domain;
    LAC_FAIL_MEMORY_IF(domain == NULL, err);
    *domain = (lac_domain){.grid = whole->grid,
                           .n = m->leaves,
                           .index = malloc(m->leaves * sizeof *domain->index),
                           .pressure = malloc(m->leaves * sizeof *domain->pressure),
                           .weight = malloc(m->leaves * sizeof *domain->weight),
                           .each = (double)whole->n / (double)m->leaves};
    LAC_FAIL_MEMORY_IF(domain->index == NULL || domain->pressure == NULL || domain->weight == NULL,
                       err);
    gather(m, whole->pressure, domain->pressure);
    for (size_t i = 0; i < m->leaves; i++) {
        domain->index[i] = whole->index[m->kept[i]];
        domain->weight[i] = m->weight[i] / domain->each;
    }
    return LAC_OK;
}

static lac_status make_problem(const making *m, lac_lump *lump, lac_error *err)
{
    const lac_problem_def *whole = &m->source->whole;
    lump->loads = whole->loads;
    if (whole->loads.shape != NULL) {
        lump->loads.shape = malloc(m->leaves * sizeof *lump->loads.shape);
        LAC_FAIL_MEMORY_IF(lump->loads.shape == NULL, err);
        gather(m, whole->loads.shape, lump->loads.shape);
    }
    LAC_TRY_RETURN(lac_friction_pick(whole->friction, m->kept, m->leaves, &lump->friction, err));
    double *start = malloc(2 * m->leaves * sizeof *start);
    LAC_FAIL_MEMORY_IF(start == NULL, err);
    gather(m, whole->log_rate, start);
    gather(m, whole->log_state, start + m->leaves);
    const lac_transfer transfer = lac_transfer_of_classes(lump->classes);
    lac_problem_def def = *whole;
    def.domain = lump->domain;
    def.friction = lump->friction;
    def.transfer = &transfer;
    def.loads = lump->loads;
    def.log_rate = start;
    def.log_state = start + m->leaves;
    const lac_status status = lac_problem_create(&def, &lump->problem, err);
    free(start);
    return status;
}

// Takes all blocks of the level.
static lac_status try_level(making *m, lac_error *err)
{
    const size_t blocks = lac_hierarchy_blocks(m->source->blocks, m->level);
    double by[LAC_LUMP_LEVELS] = {0.0};
    m->leaves = 0;
    m->breaks = 0.0;
    for (size_t l = 0; l < m->level; l++) {
        const double k = lac_lump_stiffness(m->source, l);
        by[l] = k > 0.0 ? 1.0 / k : 0.0; // of a level that ties nothing
    }
    lac_lump_apart(m->source, &m->field, m->level, by);
    for (size_t b = 0; b < blocks; b++) {
        LAC_TRY_RETURN(take_block(m, b, err));
    }
    return LAC_OK;
}

// Frees what it has.
static void clear(lac_lump *lump)
{
    lac_problem_free(lump->problem);
    lac_classes_free(lump->classes);
    lac_friction_free(lump->friction);
    free(lump->loads.shape);
    lac_domain_free(lump->domain);
    free(lump->leaf);
    free(lump->kept);
    *lump = (lac_lump){0};
}

// The problem of the cells that stay.
static lac_status settle(making *m, lac_lump *lump, lac_error *err)
{
    clear(lump);
    lump->level = m->level;
    lump->blocks = lac_hierarchy_blocks(m->source->blocks, m->level);
    lump->stretch = m->stretch;
    lump->arrival = m->way.arrival;
    LAC_TRY_RETURN(make_classes(m, lump, err));
    LAC_TRY_RETURN(make_domain(m, &lump->domain, err));
    return make_problem(m, lump, err);
}

// Settles it: by how much its end is off that of all cells, by their way. NAN: it has none
static lac_status compare(making *m, lac_lump *lump, double *off, lac_error *err)
{
    LAC_TRY_RETURN(settle(m, lump, err));
    double value = m->breaks > m->stretch ? (double)NAN : m->way.value;
    if (m->level > 0 && !isnan(value)) {
        LAC_TRY_RETURN(lac_lump_walk(lump->problem, m->source->ends, false, &m->way, &value, err));
    }
    lump->comes_to = value;
    *off = value / m->way.value - 1.0;
    return LAC_OK;
}

// Ties leaves more or less tightly until they end as all cells do. How far they come apart is in
// inverse proportion to what ties them.
static lac_status stretch(making *m, lac_lump *lump, double *off, lac_error *err)
{
    const double most = 2.0;
    double slack = 1.0, next = 1.1, was = *off;
    for (int k = 0; k < 4 && fabs(*off) > 1e-7; k++) {
        m->stretch = 1.0 / next;
        LAC_TRY_RETURN(compare(m, lump, off, err));
        const double by = *off * (next - slack) / (*off - was);
        slack = next;
        was = *off;
        next = fmax(1.0 / most, fmin(slack - by, most));
    }
    return LAC_OK;
}

// The leaves of a level, and how far off they are.
static lac_status judge(making *m, double most, lac_lump *lump, lac_error *err)
{
    const double least = 1.5e-5;
    double off;
    m->stretch = 1.0;
    LAC_TRY_RETURN(try_level(m, err));
    LAC_TRY_RETURN(compare(m, lump, &off, err));
    const double before = fabs(off), plain = least + 2.0 * (before + m->way.apart);
    double bound = plain;
    if (plain > most && least + before < most) {
        LAC_TRY_RETURN(stretch(m, lump, &off, err));
        bound = least + 2.0 * fabs(off) + m->way.apart + before;
        if (!(bound < plain)) { // they do not end alike, or come to no end: as it was
            m->stretch = 1.0;
            LAC_TRY_RETURN(compare(m, lump, &off, err));
            bound = plain;
        }
    }
    lump->error = m->level == 0 ? least : isfinite(bound) ? bound : (double)INFINITY;
    return LAC_OK;
}

static lac_status make(making *m, const lac_lump_def *def, lac_lump *lump, lac_error *err)
{
    const lac_lump_source *s = m->source;
    const size_t n = s->whole.domain->n, levels = lac_hierarchy_levels(s->blocks);
    LAC_TRY_RETURN(lac_lump_look(s, &m->field, err));
    m->level = s->like != NULL   ? s->like->level
               : def->level >= 0 ? ((size_t)def->level < levels ? (size_t)def->level : levels)
                                 : lac_lump_choose_level(s, &m->field, def->error);
    m->most = def->nodes >= 0                ? (size_t)def->nodes
              : s->whole.loads.shape != NULL ? FUNCTIONS
                                             : FUNCTIONS - 1;
    m->least = 0.03 * def->error / m->field.gain;
    m->leaf = malloc(n * sizeof *m->leaf);
    m->kept = malloc((2 * n + 1) * sizeof *m->kept);
    m->weight = malloc(2 * n * sizeof *m->weight);
    LAC_FAIL_MEMORY_IF(m->leaf == NULL || m->kept == NULL || m->weight == NULL, err);
    m->begin = m->kept + n;
    m->bond = m->weight + n;
    if (s->like != NULL) {
        m->stretch = s->like->stretch;
        LAC_TRY_RETURN(try_level(m, err));
        return settle(m, lump, err);
    }
    LAC_TRY_RETURN(lac_lump_walk(s->problem, s->ends, true, &m->way, &m->way.value, err));
    LAC_TRY_RETURN(judge(m, def->error, lump, err));
    // Smaller blocks; where nothing is gained any more, or all cells come to no end, all cells.
    while (def->level < 0 && m->level > 0 && (2 * m->leaves > n || lump->error > def->error)) {
        m->level = 2 * m->leaves > n || isnan(m->way.value) ? 0 : m->level - 1;
        LAC_TRY_RETURN(judge(m, def->error, lump, err));
    }
    return LAC_OK;
}

lac_status lac_lump_create(const lac_lump_source *source, const lac_lump_def *def, lac_lump **out,
                           lac_error *err)
{
    lac_status status;
    making m = {.source = source};
    lac_lump *lump = NULL;
    *out = NULL;
    LAC_LEAVE_IF(source->whole.loads.varies, err, LAC_EINPUT,
                 "solver.fidelity lumped knows no load that differs from cell to cell");
    lump = calloc(1, sizeof *lump);
    LAC_TRY(lump != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(make(&m, def, lump, err));
    lump->leaf = m.leaf;
    lump->kept = m.kept;
    m.leaf = m.kept = NULL;
    *out = lump;
    lump = NULL;
out:
    free(m.field.memory);
    free(m.way.stage);
    free(m.leaf);
    free(m.kept);
    free(m.weight);
    lac_lump_free(lump);
    return status;
}

void lac_lump_free(lac_lump *lump)
{
    if (lump != NULL) {
        clear(lump);
        free(lump);
    }
}

double lac_lump_error(const lac_lump *lump, bool by_time, double value)
{
    const double most = 0.15; // long steps are off by percents: those off by more tell nothing
    const bool told = by_time == (lump->arrival == LAC_LUMP_AT_TIME) &&
                      !(fabs(value / lump->comes_to - 1.0) > most);
    return lump->level == 0 || told ? lump->error : (double)INFINITY;
}

lac_status lac_lump_judge(const lac_lump *lump, double error, double most, lac_error *err)
{
    const char *advice = "a lower solver.lump.level opens blocks, fidelity ode resolves all cells";
    LAC_FAIL_IF(
        isinf(error), err, LAC_ENUMERIC,
        "solver.fidelity lumped cannot estimate its error: some cells slip by themselves, or a "
        "short run of all to compare with comes to no end or another one (level %zu); %s",
        lump->level, advice);
    LAC_FAIL_IF(!(error <= most), err, LAC_ENUMERIC,
                "solver.fidelity lumped may be off by %.2g, more than solver.lump.error %g: the "
                "cells of a block slip too far apart (level %zu); %s",
                error, most, lump->level, advice);
    return LAC_OK;
}
