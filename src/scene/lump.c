// SPDX-License-Identifier: GPL-3.0-or-later
// A scene on fewer cells: of each block some cells stay that stand for all, with weights by which
// sums over the block keep their values; what holds them against each other is what held the
// block's cells, by how they would slip apart. docs/theory/lumped.md.
#include "base/cubature.h"
#include "scene/lump_parts.h"

// One lump as it is made.
typedef struct making {
    const lac_lump_source *source;
    lac_lump_cells field;
    size_t level;
    size_t most;     // leaves of a block, at most
    double least;    // of what a sum is worth keeping
    size_t leaves;   // so far
    uint32_t *kept;  // [n] cells that stay
    double *weight;  // [n] cells that each stands for
    uint32_t *begin; // [blocks + 1] the first leaf of each block
    double *bond;    // [blocks] what holds its leaves against each other
    uint32_t *leaf;  // [n] which leaf stands for a cell
    double rest[LAC_LUMP_TESTS];
    double softer, fewer;     // as the traces of soft and few, of squares of compliances
    lac_lump_pairs soft, few; // how far cells, and leaves, would slip apart
} making;

// A block of it.
typedef struct taking {
    const making *of;
    size_t first;
} taking;

// Sums of the cells themselves and of what moves them apart, before those of what friction holds.
enum {
    COUNTED = 4,
    BEFORE = COUNTED + LAC_LUMP_PATTERNS - 1,
    FUNCTIONS = BEFORE + LAC_LUMP_KEPT + 1 // the last where loads have a shape
};

// What the leaves of a block keep the sums of: cells, pressure and its square, slip rate at the
// start, the shape of a load; and friction along some histories. Where a case says how many leaves,
// the first of those with the cells and their pressure.
static void values_of(const void *context, size_t point, double *value)
{
    const taking *t = context;
    const making *m = t->of;
    const lac_lump_cells *f = &m->field;
    const lac_problem_def *whole = &m->source->whole;
    const size_t i = t->first + point;
    const double p = whole->domain->pressure[i] / f->pressure;
    double all[FUNCTIONS] = {1.0, p, p * p, exp(whole->log_rate[i]) / f->mean_rate};
    for (size_t a = 1; a < LAC_LUMP_PATTERNS; a++) {
        all[COUNTED + a - 1] = p * (p * f->pattern[i] - f->answer) * f->pattern[a * f->n + i];
    }
    for (size_t k = 0; k < LAC_LUMP_KEPT; k++) {
        all[BEFORE + k] = p * f->friction[k * f->n + i];
    }
    all[FUNCTIONS - 1] = whole->loads.shape != NULL ? whole->loads.shape[i] : 0.0;
    const size_t first = m->most < FUNCTIONS - 1 ? 2 : m->most;
    memcpy(value, all, first * sizeof *value);
    for (size_t k = first; k < m->most; k++) {
        value[k] = all[BEFORE + k - first];
    }
}

// Adds what friction holds of all cells of a block less what it does of its leaves, at the stages
// that the leaves were not made for.
static void add_rest(making *m, size_t first, size_t end, size_t leaves)
{
    const double *pressure = m->source->whole.domain->pressure;
    for (size_t k = 0; k < LAC_LUMP_TESTS; k++) {
        const double *held = m->field.friction + (LAC_LUMP_KEPT + k) * m->field.n;
        double sum = 0.0;
        for (size_t i = first; i < end; i++) {
            sum += pressure[i] * held[i];
        }
        for (size_t i = m->leaves; i < m->leaves + leaves; i++) {
            sum -= m->weight[i] * pressure[m->kept[i]] * held[m->kept[i]];
        }
        m->rest[k] += sum;
    }
}

// What is left of that over the direct effect of all cells: how far the rate is off.
static double rest_of(const making *m)
{
    double most = 0.0;
    for (size_t k = 0; k < LAC_LUMP_TESTS; k++) {
        most = fmax(most, fabs(m->rest[k]));
    }
    return most / m->field.pressure / (double)m->field.n;
}

// How far the leaves of a block would slip apart if 1 held them.
static lac_lump_pairs leaves_of(const making *m, size_t leaves)
{
    const uint32_t *kept = m->kept + m->leaves;
    const double *weight = m->weight + m->leaves, *p = m->source->whole.domain->pressure;
    lac_lump_pairs few = {0};
    double mean[LAC_LUMP_PATTERNS] = {0.0}, sum = 0.0, count = 0.0, answer = 0.0;
    for (size_t i = 0; i < leaves; i++) {
        count += weight[i];
        sum += weight[i] * p[kept[i]];
        for (size_t a = 0; a < LAC_LUMP_PATTERNS; a++) {
            mean[a] += weight[i] * p[kept[i]] * m->field.pattern[a * m->field.n + kept[i]];
        }
    }
    answer = mean[LAC_LUMP_ANSWER] / count;
    for (size_t i = 0; i < leaves; i++) {
        double g[LAC_LUMP_PATTERNS];
        for (size_t a = 0; a < LAC_LUMP_PATTERNS; a++) {
            const double of = m->field.pattern[a * m->field.n + kept[i]];
            g[a] = p[kept[i]] * (a == LAC_LUMP_ANSWER ? of : of - mean[a] / sum);
        }
        g[LAC_LUMP_ANSWER] -= answer;
        lac_lump_add(g, g, weight[i], &few);
    }
    return few;
}

// By how far the cells of a block would slip apart under each pattern, and what that does to all of
// each, the stiffness that does the same to its leaves.
static double bond_of(making *m, size_t first, size_t end, size_t leaves)
{
    const lac_lump_source *s = m->source;
    const double nothing = pow(1e-9 * m->field.pressure, 2.0); // rounding of what is alike
    lac_lump_pairs of[LAC_LUMP_LEVELS] = {0}, soft = {0};
    double softer = 0.0;
    lac_lump_add_levels(s, &m->field, m->level, first, end, of);
    for (size_t l = 0; l < m->level; l++) {
        const double k = lac_lump_stiffness(s, l), trace = lac_lump_trace(&of[l]);
        if (trace > nothing * (double)(end - first)) {
            lac_lump_add_pairs(&of[l], 1.0 / k, &soft);
            softer += trace / k / k;
        }
    }
    const lac_lump_pairs few = leaves_of(m, leaves);
    const double all = lac_lump_trace(&soft), kept = lac_lump_trace(&few);
    if (!(all > 0.0 && kept > 0.0)) {
        return lac_lump_stiffness(s, 0);
    }
    const double bond = kept / all;
    lac_lump_add_pairs(&few, 1.0 / bond, &m->few);
    lac_lump_add_pairs(&soft, 1.0, &m->soft);
    m->softer += softer;
    m->fewer += all / bond;
    return bond;
}

// By how much one stiffness for all patterns is off: of what each does to friction.
static double mismatch_of(const making *m)
{
    const double(*soft)[LAC_LUMP_PATTERNS] = m->soft.of, (*few)[LAC_LUMP_PATTERNS] = m->few.of;
    double off = 0.0;
    for (size_t a = 0; a < LAC_LUMP_PATTERNS; a++) {
        for (size_t b = LAC_LUMP_ANSWER + 1; b < LAC_LUMP_PATTERNS; b++) {
            off += fabs(soft[a][b] - few[a][b]);
        }
    }
    // On a line all levels have as much of slip apart, so that a few coarse blocks decide it.
    const double least = m->source->whole.domain->grid.ny == 1 ? 0.5 : 0.0;
    const double all = lac_lump_trace(&m->soft);
    return off > 0.0 && all > 0.0 ? fmax(least, off / all) : 0.0;
}

// What friction makes of slip apart over what holds it.
static double weakness_of(const making *m)
{
    const lac_lump_cells *f = &m->field;
    double answer = 0.0;
    for (size_t i = 0; i < f->n; i++) {
        answer += m->source->whole.domain->pressure[i] * f->friction[LAC_LUMP_ANSWER * f->n + i];
    }
    const double soft = lac_lump_trace(&m->soft);
    answer *= f->direct * f->per_dc / (double)f->n;
    return soft > 0.0 ? answer * (m->softer - 0.5 * m->fewer) / soft : 0.0;
}

// Which of the leaves of a block each of its cells is most like.
static void assign(making *m, size_t first, size_t end, size_t leaves)
{
    for (size_t i = first; i < end; i++) {
        double nearest = INFINITY;
        for (size_t c = m->leaves; c < m->leaves + leaves; c++) {
            const double *row = m->field.friction;
            double apart = 0.0;
            for (size_t k = 0; k < LAC_LUMP_KEPT && apart < nearest; k++, row += m->field.n) {
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
    const taking t = {m, first};
    const lac_cubature of = {.points = end - first,
                             .functions = m->most,
                             .least = m->least,
                             .at = values_of,
                             .context = &t};
    if (s->like != NULL) {
        leaves = take_like(m, first, end);
    } else {
        LAC_TRY_RETURN(lac_cubature_thin(&of, kept, m->weight + m->leaves, &leaves, err));
        for (size_t i = 0; i < leaves; i++) {
            kept[i] += (uint32_t)first;
        }
    }
    assign(m, first, end, leaves);
    add_rest(m, first, end, leaves);
    m->begin[number] = (uint32_t)m->leaves;
    m->bond[number] = leaves > 1 ? bond_of(m, first, end, leaves) : 0.0;
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
    lump->bond = malloc(most * sizeof *lump->bond);
    LAC_TRY(status);
    LAC_TRY(lump->bond != NULL ? LAC_OK : lac_fail_memory(err));
    lac_classes *classes = lump->classes;
    classes->nodes = m->leaves;
    memcpy(classes->weight, m->weight, m->leaves * sizeof *m->weight);
    for (uint32_t i = 0; i < m->leaves; i++) {
        node[i] = i;
    }
    for (size_t b = 0; b < blocks; b++) {
        block[b] = tie(classes, node + m->begin[b], m->begin[b + 1] - m->begin[b], m->bond[b]);
    }
    lump->inner = classes->nodes - m->leaves;
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
    memcpy(lump->bond, classes->k, classes->nodes * sizeof *lump->bond);
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
    const lac_lump_source *s = m->source;
    const lac_problem_def *whole = &s->whole;
    lac_problem_def def = *whole;
    double *start = malloc(2 * m->leaves * sizeof *start);
    LAC_FAIL_MEMORY_IF(start == NULL, err);
    lac_status status =
        lac_friction_pick(whole->friction, m->kept, m->leaves, &lump->friction, err);
    lump->loads = whole->loads;
    if (whole->loads.shape != NULL) {
        lump->loads.shape = malloc(m->leaves * sizeof *lump->loads.shape);
        status = lump->loads.shape == NULL ? lac_fail_memory(err) : status;
    }
    if (status == LAC_OK) {
        const lac_transfer transfer = lac_transfer_of_classes(lump->classes);
        if (whole->loads.shape != NULL) {
            gather(m, whole->loads.shape, lump->loads.shape);
        }
        gather(m, whole->log_rate, start);
        gather(m, whole->log_state, start + m->leaves);
        def.domain = lump->domain;
        def.friction = lump->friction;
        def.transfer = &transfer;
        def.loads = lump->loads;
        def.log_rate = start;
        def.log_state = start + m->leaves;
        status = lac_problem_create(&def, &lump->problem, err);
    }
    free(start);
    return status;
}

// What a lump cannot stand for; docs/theory/lumped.md lists it.
static lac_status check_source(const lac_lump_source *s, lac_error *err)
{
    const lac_problem_def *whole = &s->whole;
    const lac_transfer_kind *kind = whole->transfer->kind;
    LAC_FAIL_IF(kind->blocks == NULL && whole->domain->n > 1, err, LAC_EINPUT,
                "solver.fidelity lumped goes with transfer hierarchy, not with %s",
                kind->info.name);
    LAC_FAIL_IF(lac_load_set_varies(&whole->loads), err, LAC_EINPUT,
                "solver.fidelity lumped knows no load that differs from cell to cell");
    return LAC_OK;
}

// Takes all blocks of the level.
static lac_status try_level(making *m, lac_error *err)
{
    const size_t n = m->field.n, blocks = lac_hierarchy_blocks(m->source->blocks, m->level);
    free(m->kept);
    free(m->weight);
    m->kept = malloc((n + blocks + 1) * sizeof *m->kept);
    m->weight = malloc((n + blocks) * sizeof *m->weight);
    LAC_FAIL_MEMORY_IF(m->kept == NULL || m->weight == NULL, err);
    m->begin = m->kept + n;
    m->bond = m->weight + n;
    m->leaves = 0;
    memset(m->rest, 0, sizeof m->rest);
    m->soft = m->few = (lac_lump_pairs){0};
    m->softer = m->fewer = 0.0;
    for (size_t b = 0; b < blocks; b++) {
        LAC_TRY_RETURN(take_block(m, b, err));
    }
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
    m->leaf = lump->leaf = malloc(n * sizeof *lump->leaf);
    LAC_FAIL_MEMORY_IF(lump->leaf == NULL, err);
    LAC_TRY_RETURN(try_level(m, err));
    // Smaller blocks, whose quadratures err apart; where nothing is gained any more, all cells.
    while (def->level < 0 && s->like == NULL && m->level > 0 &&
           (2 * m->leaves > n || m->field.gain * rest_of(m) > 0.2 * def->error)) {
        m->level = 2 * m->leaves > n ? 0 : m->level - 1;
        LAC_TRY_RETURN(try_level(m, err));
    }
    lump->level = m->level;
    lump->blocks = lac_hierarchy_blocks(s->blocks, m->level);
    lump->rest = rest_of(m);
    lump->gain = m->field.gain;
    lump->mismatch = mismatch_of(m);
    lump->weakness = weakness_of(m);
    LAC_TRY_RETURN(make_classes(m, lump, err));
    LAC_TRY_RETURN(make_domain(m, &lump->domain, err));
    LAC_TRY_RETURN(make_problem(m, lump, err));
    lump->kept = m->kept;
    m->kept = NULL;
    return LAC_OK;
}

lac_status lac_lump_create(const lac_lump_source *source, const lac_lump_def *def, lac_lump **out,
                           lac_error *err)
{
    lac_status status;
    making m = {.source = source};
    lac_lump *lump = NULL;
    *out = NULL;
    LAC_TRY(check_source(source, err));
    lump = calloc(1, sizeof *lump);
    LAC_TRY(lump != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(make(&m, def, lump, err));
    *out = lump;
    lump = NULL;
out:
    free(m.field.memory);
    free(m.kept);
    free(m.weight);
    lac_lump_free(lump);
    return status;
}

void lac_lump_free(lac_lump *lump)
{
    if (lump != NULL) {
        lac_problem_free(lump->problem);
        lac_classes_free(lump->classes);
        lac_friction_free(lump->friction);
        free(lump->loads.shape);
        lac_domain_free(lump->domain);
        free(lump->bond);
        free(lump->leaf);
        free(lump->kept);
        free(lump);
    }
}
