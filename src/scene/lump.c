// SPDX-License-Identifier: GPL-3.0-or-later
// A scene on fewer cells: of each block some cells stay that stand for all, with weights by which
// sums over the block keep their values; what holds them against each other is what held the
// block's cells, by how they would slip apart. docs/theory/lumped.md.
#include "scene/lump.h"

#include "base/cubature.h"
#include "scene/internal.h"

enum { MOST_VARIABLES = 24, PATTERNS = 6, ANSWERS = 3, STAGES = 3, FEWEST_NODES = 4, MOST_NODES = 10 };

// What the cells differ in: of all of them, scaled block by block.
typedef struct variable {
    double *value; // [n]
    double mean, scale;
} variable;

typedef struct field {
    size_t n, variables;
    variable of[MOST_VARIABLES];
    double *pattern; // [PATTERNS][n] what friction may leave a cell apart by, in parts of p
    double *force;   // [PATTERNS][n + 1] sums up to a cell of p times a pattern
    double *held;    // [STAGES][n] part of friction by the state, after so much slip
    double per_dc;   // mean of 1/dc [1/m]
    double rate;     // mean slip rate at the start [m/s]
    double gain;     // of lac_lump
    double apart_by[64]; // squares of slip over dc by which each level may come apart
    bool apart;      // a load acts on the cells otherwise than their pressures do
    double *memory;
} field;

// The cells of one block as points.
typedef struct block {
    const double *pressure; // [n] from its first cell on
    size_t first, n;
    size_t active; // variables that are no straight line of those before them
    const variable *at[MOST_VARIABLES];
    double mean[MOST_VARIABLES], scale[MOST_VARIABLES];
    double share[MOST_VARIABLES][MOST_VARIABLES]; // of the ones before it that each is less
    double mean_pressure;
    size_t degree;
    bool apart; // leaves keep pressures of their own
} block;

// Products of the variables of degree at most `left`, from variable v on, times `product`.
static double *products(const block *b, const double *z, size_t v, size_t left, double product,
                        double *out)
{
    if (v == b->active) {
        *out = product;
        return out + 1;
    }
    for (size_t k = 0; k <= left; k++, product *= z[v]) {
        out = products(b, z, v + 1, left - k, product, out);
    }
    return out;
}

// The first variables of a cell: each less what those before it have of it, its mean 0, its
// deviation 1, by pressure.
static void coordinates(const block *b, size_t variables, size_t point, double *z)
{
    for (size_t v = 0; v < variables; v++) {
        z[v] = b->at[v]->value[b->first + point] - b->mean[v];
        for (size_t u = 0; u < v; u++) {
            z[v] -= b->share[v][u] * z[u];
        }
        z[v] /= b->scale[v];
    }
}

static void values_at(const void *context, size_t point, double *value)
{
    const block *b = context;
    double z[MOST_VARIABLES];
    const double p = b->pressure[point] / b->mean_pressure;
    coordinates(b, b->active, point, z);
    double *end = products(b, z, 0, b->degree, p, value);
    if (b->apart) {
        end[0] = 1.0;
        end[1] = p * p;
    }
}

static size_t count_products(size_t variables, size_t degree)
{
    double count = 1.0; // binomial(variables + degree, degree)
    for (size_t k = 1; k <= degree; k++) {
        count = count * (double)(variables + k) / (double)k;
    }
    return (size_t)(count + 0.5);
}

// Sums of one variable are kept up to the degree of Gauss's nodes; of more, less.
static size_t degree_of(size_t variables, size_t nodes)
{
    static const size_t less[] = {0, 0, 0, 1, 2, 3, 3};
    const size_t degree = variables == 1 ? 2 * nodes - 1 : nodes + 1 - less[variables < 7 ? variables : 6];
    return variables > 6 || degree > 2 * nodes ? 2 : degree > 2 ? degree : 2;
}

// Takes a variable up among those of a block, if it tells more than those before it.
static void take_variable(const variable *of, double sum, block *b)
{
    const double *x = of->value + b->first;
    const size_t v = b->active;
    double mean = 0.0, square = 0.0, z[MOST_VARIABLES];
    for (size_t i = 0; i < b->n; i++) {
        mean += b->pressure[i] * x[i] / sum;
    }
    b->at[v] = of;
    b->mean[v] = mean;
    b->scale[v] = 1.0;
    memset(b->share[v], 0, sizeof b->share[v]);
    for (size_t i = 0; i < b->n; i++) {
        coordinates(b, v, i, z);
        for (size_t u = 0; u < v; u++) {
            b->share[v][u] += b->pressure[i] / sum * z[u] * (x[i] - mean);
        }
    }
    for (size_t i = 0; i < b->n; i++) {
        coordinates(b, v + 1, i, z);
        square += b->pressure[i] / sum * z[v] * z[v];
    }
    b->scale[v] = sqrt(square);
    b->active += b->scale[v] > 1e-6 * of->scale ? 1 : 0;
}

static void look_at_block(const field *of, const double *pressure, size_t first, size_t n,
                          size_t nodes, block *b)
{
    double sum = 0.0;
    memset(b, 0, sizeof *b);
    b->pressure = pressure + first;
    b->first = first;
    b->n = n;
    for (size_t i = 0; i < n; i++) {
        sum += b->pressure[i];
    }
    b->mean_pressure = sum / (double)n;
    for (size_t v = 0; v < of->variables; v++) {
        take_variable(&of->of[v], sum, b);
    }
    b->apart = of->apart;
    b->degree = b->active > 0 ? degree_of(b->active, nodes) : 0;
}

// Adds a variable unless the cells are alike in it. @param size  what a difference is beside
static void add_variable(field *f, const double *x, double size)
{
    double least = INFINITY, most = -INFINITY;
    for (size_t i = 0; i < f->n; i++) {
        least = fmin(least, x[i]);
        most = fmax(most, x[i]);
    }
    if (most - least > 1e-7 * size && f->variables < MOST_VARIABLES) {
        variable *v = &f->of[f->variables];
        v->value = f->memory + f->variables++ * f->n;
        v->scale = size;
        memcpy(v->value, x, f->n * sizeof *x);
    }
}

static void add_column(field *f, const lac_cellwise *column, double *room)
{
    double size = 0.0;
    for (size_t i = 0; column->value != NULL && column->mask != 0 && i < f->n; i++) {
        room[i] = lac_cellwise_of(column, i);
        size = fmax(size, fabs(room[i]));
    }
    if (size > 0.0) {
        add_variable(f, room, size);
    }
}

// A state x of the steady one at the start leaves it at a rate that 1 - 1/x sets: there what is
// wrong of x counts 1/(x - 1) times.
static double gain_of(const lac_lump_source *s, const field *f)
{
    const double most = 100.0;
    double sum = 0.0, pressure = 0.0;
    for (size_t i = 0; i < f->n; i++) {
        const double dc = lac_cellwise_of(&s->whole.friction->column[LAC_DC], i);
        const double p = s->whole.domain->pressure[i];
        sum += p * (s->whole.log_state[i] + log(f->rate / dc));
        pressure += p;
    }
    const double x = exp(sum / pressure);
    const double gain = x / fabs(x - 1.0);
    return gain > 1.0 ? fmin(gain, most) : 1.0;
}

// What friction may leave a cell apart by, in parts of its pressure: by the renewal of its state
// over some slip, its state and rate at the start, what it weakens by, and its friction where water
// takes off its pressure.
static void fill_patterns(const lac_lump_source *s, field *f)
{
    const lac_problem_parts parts = lac_problem_parts_of(s->problem);
    const lac_friction *friction = s->whole.friction;
    double dc = 0.0;
    for (size_t i = 0; i < f->n; i++) {
        dc += 1.0 / lac_cellwise_of(&friction->column[LAC_DC], i) / (double)f->n;
    }
    f->per_dc = dc;
    f->rate = 0.0;
    for (size_t i = 0; i < f->n; i++) {
        f->rate += exp(s->whole.log_rate[i]) / (double)f->n;
    }
    f->gain = gain_of(s, f);
    for (size_t i = 0; i < f->n; i++) {
        const double a = lac_cellwise_of(&friction->column[LAC_A], i);
        const double b = lac_cellwise_of(&friction->column[LAC_B], i);
        double *at = f->pattern + i;
        at[0] = b / lac_cellwise_of(&friction->column[LAC_DC], i) / dc;
        at[f->n] = b * s->whole.log_state[i];
        at[2 * f->n] = b * lac_cellwise_of(&friction->ln_dc, i);
        at[3 * f->n] = a * s->whole.log_rate[i];
        at[4 * f->n] = 5.0 * (b - a);
        at[5 * f->n] = 0.05 * (parts.traction[i] / parts.pressure[i]);
    }
}

// Takes the states of cells through slip at the joint's rate at the start, by steps so short that
// they go where the law takes them: what it makes of the cells is what a quadrature has to know.
static void fill_held(const lac_lump_source *s, field *f)
{
    enum { STEPS = 8 };
    const double step = 0.15 / f->per_dc / f->rate; // [s]
    const lac_friction *friction = s->whole.friction;
    double w[LAC_FRICTION_BLOCK], u[LAC_FRICTION_BLOCK], v[LAC_FRICTION_BLOCK];
    double g[LAC_FRICTION_BLOCK];
    for (size_t i = 0; i < LAC_FRICTION_BLOCK; i++) {
        v[i] = f->rate;
        u[i] = log(f->rate);
    }
    for (size_t first = 0; first < f->n; first += LAC_FRICTION_BLOCK) {
        const size_t left = f->n - first, n = left < LAC_FRICTION_BLOCK ? left : LAC_FRICTION_BLOCK;
        const lac_friction_cells cells = {.first = first, .n = n, .u = u, .w = w, .v = v};
        memcpy(w, s->whole.log_state + first, n * sizeof *w);
        for (size_t k = 1; k <= STEPS; k++) {
            lac_friction_evaluate(friction, &cells, &(lac_friction_values){.g = g}, NULL);
            for (size_t i = 0; i < n; i++) {
                w[i] += step * g[i];
            }
            for (size_t i = 0; k % 3 == 2 && i < n; i++) {
                const double b = lac_cellwise_of(&friction->column[LAC_B], first + i);
                f->held[k / 3 * f->n + first + i] = b * w[i];
            }
        }
    }
}

// What moves the cells: their parameters, but f0, of which only the friction at the start counts;
// rate and state at the start; what loads do to each.
static lac_status look_at_cells(const lac_lump_source *s, field *f, lac_error *err)
{
    const lac_friction *friction = s->whole.friction;
    const lac_problem_parts parts = lac_problem_parts_of(s->problem);
    const size_t n = s->whole.domain->n;
    *f = (field){.n = n};
    f->memory = malloc((MOST_VARIABLES + 2 * PATTERNS + STAGES) * (n + 1) * sizeof *f->memory);
    LAC_FAIL_MEMORY_IF(f->memory == NULL, err);
    f->pattern = f->memory + MOST_VARIABLES * n;
    f->held = f->pattern + PATTERNS * n;
    f->force = f->held + STAGES * n;
    add_column(f, &friction->ln_dc, f->pattern);
    add_variable(f, s->whole.log_state, 1.0);
    add_variable(f, s->whole.log_rate, 1.0);
    for (size_t c = LAC_A; c < friction->columns; c++) {
        if (c != LAC_DC) {
            add_column(f, &friction->column[c], f->pattern);
        }
    }
    for (size_t i = 0; i < n; i++) {
        f->pattern[i] = parts.traction[i] / parts.pressure[i];
    }
    add_variable(f, f->pattern, 1.0);
    if (s->whole.loads.shape != NULL) {
        add_variable(f, s->whole.loads.shape, 1.0);
    }
    for (size_t i = 0; i < s->whole.loads.count; i++) {
        const lac_load *load = &s->whole.loads.load[i];
        f->apart = f->apart || load->share != LAC_SHARE_PRESSURE || load->kind->stiffness != NULL;
    }
    for (size_t i = 0; f->apart && i < n; i++) {
        f->pattern[i] = log(parts.pressure[i]);
    }
    if (f->apart) {
        add_variable(f, f->pattern, 1.0);
    }
    fill_patterns(s, f);
    fill_held(s, f);
    return LAC_OK;
}

// Sums of p times each pattern, less its mean by p, over the cells from `first` on.
static void sum_forces(const lac_lump_source *s, field *f, size_t first, size_t end)
{
    const double *p = s->whole.domain->pressure;
    for (size_t which = 0; which < PATTERNS; which++) {
        const double *pattern = f->pattern + which * f->n;
        double *force = f->force + which * (f->n + 1);
        double sum = 0.0, mean = 0.0;
        for (size_t i = first; i < end; i++) {
            sum += p[i];
            mean += p[i] * pattern[i];
        }
        mean /= sum;
        force[first] = 0.0;
        for (size_t i = first; i < end; i++) {
            force[i + 1] = force[i] + p[i] * (pattern[i] - mean);
        }
    }
}

// Of each two patterns.
typedef struct products_of {
    double of[PATTERNS][PATTERNS];
} pairs;

static void add_pairs(const pairs *x, double times, pairs *sum)
{
    for (size_t a = 0; a < PATTERNS; a++) {
        for (size_t b = 0; b < PATTERNS; b++) {
            sum->of[a][b] += times * x->of[a][b];
        }
    }
}

// The first block of a level that begins at a cell.
static size_t block_at(const lac_hierarchy *h, size_t level, size_t first)
{
    const uint32_t *begin = lac_hierarchy_offsets(h, level);
    size_t low = 0, high = lac_hierarchy_blocks(h, level);
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (begin[middle] < first) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

// Sums over the blocks of a level in [first, end) of products of their sums, over their cells.
static pairs pairs_of(const lac_lump_source *s, const field *f, size_t level, size_t first,
                      size_t end)
{
    const uint32_t *begin = lac_hierarchy_offsets(s->blocks, level);
    pairs out = {0};
    for (size_t b = block_at(s->blocks, level, first); begin[b] < end; b++) {
        double sum[PATTERNS];
        for (size_t which = 0; which < PATTERNS; which++) {
            const double *force = f->force + which * (f->n + 1);
            sum[which] = force[begin[b + 1]] - force[begin[b]];
        }
        const double cells = (double)(begin[b + 1] - begin[b]);
        for (size_t a = 0; a < PATTERNS; a++) {
            for (size_t c = 0; c < PATTERNS; c++) {
                out.of[a][c] += sum[a] * sum[c] / cells;
            }
        }
        if (begin[b + 1] == end) {
            break;
        }
    }
    return out;
}

// What the patterns have of each level below `top` within [first, end): products of the means of
// its blocks less those of the next ones'. @param out  [top]; added to
static void add_levels(const lac_lump_source *s, field *f, size_t top, size_t first, size_t end,
                       pairs *out)
{
    sum_forces(s, f, first, end);
    pairs finer = pairs_of(s, f, 0, first, end);
    for (size_t l = 0; l < top; l++) {
        const pairs coarser = pairs_of(s, f, l + 1, first, end);
        add_pairs(&finer, 1.0, &out[l]);
        add_pairs(&coarser, -1.0, &out[l]);
        finer = coarser;
    }
}

// Of patterns by themselves.
static double trace(const pairs *x)
{
    double sum = 0.0;
    for (size_t a = 0; a < PATTERNS; a++) {
        sum += fmax(0.0, x->of[a][a]);
    }
    return sum;
}

static double stiffness(const lac_lump_source *s, size_t level)
{
    const lac_transfer *transfer = s->whole.transfer;
    return transfer->kind->stiffness(transfer->state, level);
}

// The level whose blocks are taken together: above it slip over dc by which blocks would come apart
// is small, or no larger than that of single cells.
static lac_status choose_level(const lac_lump_source *s, field *f, double error, size_t *level,
                               lac_error *err)
{
    const size_t levels = lac_hierarchy_levels(s->blocks);
    pairs *of = calloc(levels + 1, sizeof *of);
    LAC_FAIL_MEMORY_IF(of == NULL, err);
    add_levels(s, f, levels, 0, f->n, of);
    double finest = 0.0;
    *level = levels;
    for (size_t l = levels; l-- > 0;) {
        const double apart = f->per_dc / stiffness(s, l);
        const double square = trace(&of[l]);
        f->apart_by[l] = square > 0.0 ? square * apart * apart / (double)f->n : 0.0;
    }
    finest = f->apart_by[0];
    for (size_t l = levels; l-- > 1;) {
        *level = f->apart_by[l] > fmax(0.1 * error, 2.0 * finest) ? l : *level;
    }
    free(of);
    return LAC_OK;
}

// One lump as it is made.
typedef struct making {
    const lac_lump_source *source;
    field field;
    size_t level, nodes;
    size_t leaves;   // so far
    uint32_t *kept;  // [n] cells that stay
    double *weight;  // [n] of them, as the force on them counts
    double *pressure; // [n] on each: the mean of its block, unless a load tells them apart
    uint32_t *begin; // [blocks + 1] the first leaf of each block
    double *bond;    // [blocks] what holds its leaves against each other
    uint32_t *leaf;  // [n] which leaf stands for a cell
    double rest[STAGES];
    pairs soft, few; // how far cells, and leaves, would slip apart
} making;

// Adds what all cells of a block are held by less what its leaves are, after each stage of slip.
static void add_rest(making *m, size_t first, size_t end, size_t leaves)
{
    const double *pressure = m->source->whole.domain->pressure;
    for (size_t k = 0; k < STAGES; k++) {
        const double *held = m->field.held + k * m->field.n;
        double sum = 0.0;
        for (size_t i = first; i < end; i++) {
            sum += pressure[i] * held[i];
        }
        for (size_t i = m->leaves; i < m->leaves + leaves; i++) {
            sum -= m->weight[i] * m->pressure[i] * held[m->kept[i]];
        }
        m->rest[k] += sum;
    }
}

// What is left of that over the direct effect of all cells: how far the rate is off.
static double rest_of(const making *m)
{
    const lac_lump_source *s = m->source;
    double direct = 0.0, most = 0.0;
    for (size_t i = 0; i < m->field.n; i++) {
        direct += s->whole.domain->pressure[i] *
                  lac_cellwise_of(&s->whole.friction->column[LAC_A], i);
    }
    for (size_t k = 0; k < STAGES; k++) {
        most = fmax(most, fabs(m->rest[k]) / direct);
    }
    return most;
}

// By how far the cells of a block would slip apart under each pattern, and what that does to all of
// each, the stiffness that does the same to its leaves.
static lac_status bond_of(making *m, size_t first, size_t end, size_t leaves, double *bond,
                          lac_error *err)
{
    const lac_lump_source *s = m->source;
    const uint32_t *kept = m->kept + m->leaves;
    const double *weight = m->weight + m->leaves, *pressure = m->pressure + m->leaves;
    pairs *of = calloc(m->level + 1, sizeof *of);
    pairs soft = {0}, few = {0};
    double mean[PATTERNS] = {0.0}, sum = 0.0;
    const double nothing = pow(1e-9 * pressure[0], 2.0); // rounding of what cells are alike in
    LAC_FAIL_MEMORY_IF(of == NULL, err);
    add_levels(s, &m->field, m->level, first, end, of);
    for (size_t l = 0; l < m->level; l++) {
        const double k = stiffness(s, l);
        if (trace(&of[l]) > nothing * (double)(end - first)) {
            add_pairs(&of[l], 1.0 / k, &soft);
        }
    }
    free(of);
    for (size_t i = 0; i < leaves; i++) {
        sum += weight[i] * pressure[i];
        for (size_t a = 0; a < PATTERNS; a++) {
            mean[a] += weight[i] * pressure[i] * m->field.pattern[a * m->field.n + kept[i]];
        }
    }
    for (size_t i = 0; i < leaves; i++) {
        double g[PATTERNS];
        for (size_t a = 0; a < PATTERNS; a++) {
            const double *pattern = m->field.pattern + a * m->field.n;
            g[a] = pressure[i] * (pattern[kept[i]] - mean[a] / sum);
        }
        for (size_t a = 0; a < PATTERNS; a++) {
            for (size_t b = 0; b < PATTERNS; b++) {
                few.of[a][b] += weight[i] * g[a] * g[b];
            }
        }
    }
    *bond = stiffness(s, 0);
    if (trace(&soft) > 0.0 && trace(&few) > 0.0) {
        *bond = trace(&few) / trace(&soft);
        add_pairs(&few, 1.0 / *bond, &m->few);
        add_pairs(&soft, 1.0, &m->soft);
    }
    return LAC_OK;
}

// By how much one stiffness for all patterns is off: of what each does to the two that tell how
// friction answers to slip.
static double mismatch_of(const making *m)
{
    double off = 0.0;
    for (size_t a = 0; a < ANSWERS; a++) {
        for (size_t b = 0; b < PATTERNS; b++) {
            off += fabs(m->soft.of[a][b] - m->few.of[a][b]);
        }
    }
    return off > 0.0 && trace(&m->soft) > 0.0 ? off / trace(&m->soft) : 0.0;
}

static double weakness_of(const making *m)
{
    const lac_friction *friction = m->source->whole.friction;
    const size_t blocks = lac_hierarchy_blocks(m->source->blocks, m->level);
    double most = 0.0;
    for (size_t b = 0; b < blocks; b++) {
        double sum = 0.0;
        for (uint32_t i = m->begin[b]; i < m->begin[b + 1]; i++) {
            const uint32_t c = m->kept[i];
            sum += m->weight[i] * m->pressure[i] * lac_cellwise_of(&friction->column[LAC_B], c) /
                   lac_cellwise_of(&friction->column[LAC_DC], c);
        }
        const uint32_t *begin = lac_hierarchy_offsets(m->source->blocks, m->level);
        const double cells = (double)(begin[b + 1] - begin[b]);
        most = m->bond[b] > 0.0 ? fmax(most, sum / cells / m->bond[b]) : most;
    }
    return most;
}

// Each cell goes to the leaf that is most like it.
// @param room  [leaves][active]
static void assign(making *m, const block *b, size_t leaves, double *room)
{
    const uint32_t *kept = m->kept + m->leaves;
    double z[MOST_VARIABLES];
    for (size_t c = 0; c < leaves; c++) {
        coordinates(b, b->active, kept[c] - b->first, room + c * b->active);
    }
    for (size_t i = 0; i < b->n; i++) {
        double nearest = INFINITY;
        coordinates(b, b->active, i, z);
        for (size_t c = 0; c < leaves; c++) {
            const double *at = room + c * b->active;
            double apart = 0.0;
            for (size_t v = 0; v < b->active; v++) {
                apart += (z[v] - at[v]) * (z[v] - at[v]);
            }
            if (apart < nearest) {
                nearest = apart;
                m->leaf[b->first + i] = (uint32_t)(m->leaves + c);
            }
        }
    }
}

static lac_status take_block(making *m, size_t number, lac_error *err)
{
    const lac_lump_source *s = m->source;
    const uint32_t *begin = lac_hierarchy_offsets(s->blocks, m->level);
    const size_t first = begin[number], n = begin[number + 1] - first;
    uint32_t *kept = m->kept + m->leaves;
    size_t leaves;
    block b;
    look_at_block(&m->field, s->whole.domain->pressure, first, n, m->nodes, &b);
    const lac_cubature of = {.points = n,
                             .functions = count_products(b.active, b.degree) + (b.apart ? 2 : 0),
                             .at = values_at,
                             .context = &b};
    LAC_TRY_RETURN(lac_cubature_thin(&of, kept, m->weight + m->leaves, &leaves, err));
    for (size_t i = 0; i < leaves; i++) {
        const double p = b.pressure[kept[i]];
        m->weight[m->leaves + i] *= b.apart ? 1.0 : p / b.mean_pressure;
        m->pressure[m->leaves + i] = b.apart ? p : b.mean_pressure;
        kept[i] += (uint32_t)first;
    }
    m->begin[number] = (uint32_t)m->leaves;
    add_rest(m, first, first + n, leaves);
    m->bond[number] = 0.0;
    if (leaves > 1) {
        LAC_TRY_RETURN(bond_of(m, first, first + n, leaves, &m->bond[number], err));
    }
    double *room = malloc((leaves * b.active + 1) * sizeof *room);
    LAC_FAIL_MEMORY_IF(room == NULL, err);
    assign(m, &b, leaves, room);
    free(room);
    m->leaves += leaves;
    m->begin[number + 1] = (uint32_t)m->leaves;
    return LAC_OK;
}

// Ties the blocks of the level, whose nodes are in `node`, over the levels above.
static void tie_levels(const making *m, uint32_t *node, lac_classes *classes, uint32_t next)
{
    const lac_hierarchy *h = m->source->blocks;
    for (size_t l = m->level; l < lac_hierarchy_levels(h); l++) {
        const size_t count = lac_hierarchy_blocks(h, l);
        if (lac_hierarchy_blocks(h, l + 1) == count) {
            continue;
        }
        const uint32_t *parent = lac_hierarchy_parents(h, l);
        for (size_t c = 0, end; c < count; c = end) {
            for (end = c + 1; end < count && parent[end] == parent[c]; end++) {
            }
            const uint32_t b = parent[c];
            if (end - c == 1) {
                node[b] = node[c];
                continue;
            }
            for (size_t i = c; i < end; i++) {
                classes->parent[node[i]] = next;
                classes->weight[next] += classes->weight[node[i]];
            }
            classes->k[next] = stiffness(m->source, l);
            node[b] = next++;
        }
    }
    classes->nodes = next;
    classes->parent[next - 1] = next - 1;
}

static lac_status make_classes(const making *m, lac_lump *lump, lac_error *err)
{
    const size_t blocks = lac_hierarchy_blocks(m->source->blocks, m->level);
    uint32_t *node = malloc(blocks * sizeof *node);
    LAC_FAIL_MEMORY_IF(node == NULL, err);
    lac_status status = lac_classes_create(m->leaves, m->leaves + 3 * blocks, &lump->classes, err);
    lac_classes *classes = lump->classes;
    uint32_t next = (uint32_t)m->leaves;
    for (size_t b = 0; status == LAC_OK && b < blocks; b++) {
        const uint32_t first = m->begin[b], end = m->begin[b + 1];
        node[b] = end - first == 1 ? first : next++;
        for (uint32_t i = first; i < end; i++) {
            classes->weight[i] = m->weight[i];
            classes->parent[i] = node[b];
            classes->weight[node[b]] += node[b] != i ? m->weight[i] : 0.0;
        }
        if (node[b] >= m->leaves) {
            classes->k[node[b]] = m->bond[b];
        }
    }
    lump->inner = next - m->leaves;
    if (status == LAC_OK) {
        tie_levels(m, node, classes, next);
        lump->bond = malloc(classes->nodes * sizeof *lump->bond);
        status = lump->bond != NULL ? LAC_OK : lac_fail_memory(err);
    }
    if (status == LAC_OK) {
        memcpy(lump->bond, classes->k, classes->nodes * sizeof *lump->bond);
    }
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
    memcpy(domain->pressure, m->pressure, m->leaves * sizeof *m->pressure);
    for (size_t i = 0; i < m->leaves; i++) {
        domain->index[i] = whole->index[m->kept[i]];
        domain->weight[i] = m->weight[i] / domain->each;
    }
    return LAC_OK;
}

static lac_status make_friction(const making *m, double *room, lac_friction **out, lac_error *err)
{
    const lac_model *model = m->source->model;
    LAC_TRY_RETURN(lac_friction_create(model, m->leaves, out, err));
    for (size_t k = 0; k < model->info->param_count; k++) {
        const char *key = model->info->params[k].key;
        const lac_cellwise *column = lac_friction_values_of(m->source->whole.friction, key);
        if (column != NULL && column->mask != 0) {
            gather(m, column->value, room);
            LAC_TRY_RETURN(lac_friction_set(*out, key, room, err));
        }
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
    lac_status status = make_friction(m, start, &lump->friction, err);
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

// Takes all blocks of the level, with the nodes that there are.
static lac_status take_blocks(making *m, lac_error *err)
{
    const size_t blocks = lac_hierarchy_blocks(m->source->blocks, m->level);
    m->leaves = 0;
    memset(m->rest, 0, sizeof m->rest);
    m->soft = m->few = (pairs){0};
    for (size_t b = 0; b < blocks; b++) {
        LAC_TRY_RETURN(take_block(m, b, err));
    }
    return LAC_OK;
}

// Room for the blocks of a level, and what is made of them with as many nodes as it takes, if that
// is left open.
static lac_status try_level(making *m, const lac_lump_def *def, lac_error *err)
{
    const bool open = def->nodes < 0;
    const size_t n = m->field.n, blocks = lac_hierarchy_blocks(m->source->blocks, m->level);
    free(m->kept);
    free(m->weight);
    m->kept = malloc((n + blocks + 1) * sizeof *m->kept);
    m->weight = malloc((2 * n + blocks) * sizeof *m->weight);
    LAC_FAIL_MEMORY_IF(m->kept == NULL || m->weight == NULL, err);
    m->begin = m->kept + n;
    m->pressure = m->weight + n;
    m->bond = m->pressure + n;
    m->nodes = open ? FEWEST_NODES : (size_t)def->nodes;
    LAC_TRY_RETURN(take_blocks(m, err));
    while (open && m->field.gain * rest_of(m) > 0.02 * def->error && m->nodes < MOST_NODES) {
        m->nodes++;
        LAC_TRY_RETURN(take_blocks(m, err));
    }
    return LAC_OK;
}

static lac_status make(making *m, const lac_lump_def *def, lac_lump *lump, lac_error *err)
{
    const lac_lump_source *s = m->source;
    const size_t n = s->whole.domain->n, levels = lac_hierarchy_levels(s->blocks);
    LAC_TRY_RETURN(look_at_cells(s, &m->field, err));
    LAC_TRY_RETURN(choose_level(s, &m->field, def->error, &m->level, err));
    if (def->level >= 0) {
        m->level = (size_t)def->level > levels ? levels : (size_t)def->level;
    }
    m->leaf = lump->leaf = malloc(n * sizeof *lump->leaf);
    LAC_FAIL_MEMORY_IF(lump->leaf == NULL, err);
    LAC_TRY_RETURN(try_level(m, def, err));
    // Smaller blocks, whose quadratures err apart; where nothing is gained any more, all cells.
    while (def->level < 0 && m->level > 0 &&
           (2 * m->leaves > n || m->field.gain * rest_of(m) > 0.2 * def->error)) {
        m->level = 2 * m->leaves > n ? 0 : m->level - 1;
        LAC_TRY_RETURN(try_level(m, def, err));
    }
    lump->level = m->level;
    lump->blocks = lac_hierarchy_blocks(s->blocks, m->level);
    lump->nodes = m->nodes;
    lump->rest = rest_of(m);
    lump->gain = m->field.gain;
    lump->mismatch = mismatch_of(m);
    lump->weakness = weakness_of(m);
    LAC_TRY_RETURN(make_classes(m, lump, err));
    LAC_TRY_RETURN(make_domain(m, &lump->domain, err));
    return make_problem(m, lump, err);
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
        free(lump);
    }
}

void lac_lump_soften(lac_lump *lump, double softness)
{
    for (size_t i = 0; i < lump->classes->nodes; i++) {
        const bool inner = i < lump->classes->leaves + lump->inner;
        lump->classes->k[i] = lump->bond[i] / (inner ? softness : 1.0);
    }
}
