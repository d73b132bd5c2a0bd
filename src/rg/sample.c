// SPDX-License-Identifier: GPL-3.0-or-later
// One joint with its blocks at one place, loaded along the path: what slips at every load,
// when each block does, and what it carries then: the strength of blocks by their size; and the
// load at which all of it does.
#include "fractal/fractal.h"
#include "rg/tree.h"

// The smallest load at which the whole joint slides: a scan of the path, then a closing bracket;
// and on contacts solved for the loads at hand, not interpolated between others.

// Two loads of a path, the joint sticking at the lower and sliding at the higher one.
typedef struct bracket {
    double low, high;       // Q/Q_nom
    double at_low, at_high; // threshold of the root there [Pa]; INFINITY: not known
} bracket;

// Takes note of the threshold of the root at a load. Returns whether the joint sticks there.
static bool bracket_note(bracket *b, const lac_rg_tree *tree, double load, double root)
{
    const bool stuck = !lac_rg_slips(tree, root);
    *(stuck ? &b->low : &b->high) = load;
    *(stuck ? &b->at_low : &b->at_high) = root;
    return stuck;
}

// Where to look next inside a bracket, to close it to `within`, after `step` loads: twice a little
// beyond the chord through the thresholds, on the side that was not seen last, then in the middle.
// LUMP has no thresholds to draw a chord through.
static double next_load(const bracket *b, int step, bool stuck, double within)
{
    const double width = b->high - b->low;
    double x = b->low + width * b->at_low / (b->at_low - b->at_high);
    if (step > 0) {
        double beyond = fmax(0.4 * within, 0.02 * width);
        x += stuck ? beyond : -beyond;
    }
    return step % 3 < 2 && x > b->low && x < b->high ? x : 0.5 * (b->low + b->high);
}

// One search: the contact that was solved last, and what follows from it.
typedef struct search {
    const lac_rg_resolve_def *press;
    lac_rg_tree *tree;
    lac_rg_rule rule;
    double *map;         // [ny * nx] pressures
    double *shear, *gap; // [n]
} search;

// The threshold of the root at a load. Where nothing presses any more, all has slipped.
static lac_status root_at(search *s, double load, double *root, lac_error *err)
{
    const lac_domain *domain = s->press->domain;
    lac_contact_def def = *s->press->contact;
    const double part = 1.0 - load;
    lac_status status = LAC_OK;
    if (part > LAC_RG_WITHIN_SOLVED) {
        def.mean_pressure = part * s->press->contact->mean_pressure;
        def.start = s->map;
        status = lac_contact_solve(&def, s->map, NULL, NULL, err);
    }
    for (size_t i = 0; i < domain->n; i++) {
        double left = part > LAC_RG_WITHIN_SOLVED ? s->map[domain->index[i]] : 0.0;
        s->gap[i] = s->press->friction * left;
        s->shear[i] = s->press->friction * domain->pressure[i] - s->gap[i];
    }
    *root = lac_rg_pass(s->tree, s->rule, s->shear, s->gap);
    return status;
}

static lac_status narrow(search *s, double load, bracket *b, bool *stuck, lac_error *err)
{
    double root = NAN;
    lac_status status = root_at(s, load, &root, err);
    *stuck = bracket_note(b, s->tree, load, root);
    return status;
}

// From a guess away, in steps that double, until the joint is seen to stick and to slide.
static lac_status find(search *s, double guess, bracket *b, lac_error *err)
{
    bool stuck = false;
    double step = 0.002;
    lac_status status = narrow(s, guess, b, &stuck, err);
    const bool up = stuck;
    while (status == LAC_OK && stuck == up && b->low < b->high) {
        double load = up ? fmin(b->low + step, 1.0) : fmax(b->high - step, 0.0);
        status = narrow(s, load, b, &stuck, err);
        step *= 2.0;
    }
    return status;
}

// Begins at the interpolated state: the contact next to the one looked for.
static void start_at(search *s, const lac_rg_path *path, double load)
{
    const lac_domain *domain = s->press->domain;
    lac_rg_path_eval(path, load, s->shear, s->gap);
    for (size_t i = 0; i < domain->n; i++) {
        s->map[domain->index[i]] = s->gap[i] / s->press->friction;
    }
}

lac_status lac_rg_critical_solved(lac_rg_tree *tree, lac_rg_rule rule,
                                  const lac_rg_resolve_def *press, const lac_rg_path *path,
                                  double *critical, lac_error *err)
{
    const size_t n = press->domain->n;
    bool stuck = false;
    bracket b = {0.0, 1.0, INFINITY, 0.0};
    lac_status status;
    search s = {.press = press, .tree = tree, .rule = rule};
    s.map = calloc(lac_grid_cells(&press->domain->grid), sizeof *s.map);
    s.shear = malloc(2 * n * sizeof *s.shear);
    LAC_TRY(s.map != NULL && s.shear != NULL ? LAC_OK : lac_fail_memory(err));
    s.gap = s.shear + n;
    double guess = lac_rg_critical(tree, rule, path, s.shear);
    start_at(&s, path, guess);
    LAC_TRY(find(&s, guess, &b, err));
    for (int step = 0; b.high - b.low > LAC_RG_WITHIN_SOLVED || step == 0; step++) {
        double load = next_load(&b, step, stuck, LAC_RG_WITHIN_SOLVED);
        LAC_TRY(narrow(&s, load, &b, &stuck, err));
    }
    LAC_TRY(narrow(&s, b.low, &b, &stuck, err)); // leaves the tree just before the joint slides
    *critical = b.high;
out:
    free(s.shear);
    free(s.map);
    return status;
}

double lac_rg_root(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path, double load,
                   double *work)
{
    double *shear = work;
    double *gap = work + lac_rg_blocks_at(tree, 0);
    lac_rg_path_eval(path, load, shear, gap);
    return lac_rg_pass(tree, rule, shear, gap);
}

// The load between the two at which the joint slides, to 1e-9.
static double close_bracket(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path, bracket b,
                            double *work)
{
    // a joint far from 0, by tractions beside small strengths, has no loads so close together
    const double within = fmax(1e-9, 4 * DBL_EPSILON * fmax(fabs(b.low), fabs(b.high)));
    bool stuck = false;
    for (int step = 0; b.high - b.low > within; step++) {
        double load = next_load(&b, step, stuck, within);
        stuck = bracket_note(&b, tree, load, lac_rg_root(tree, rule, path, load, work));
    }
    return b.high;
}

double lac_rg_critical(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path, double *work)
{
    // a joint may slide, stick and slide again as its tractions rearrange
    bracket b = {lac_rg_path_load(path, 0.0), lac_rg_path_load(path, 1.0), INFINITY, 0.0};
    if (lac_rg_path_is_preloaded(path)) {
        b.at_low = lac_rg_root(tree, rule, path, b.low, work);
        if (lac_rg_slips(tree, b.at_low)) {
            return b.low;
        }
    }
    for (int i = 1; i <= LAC_RG_SCAN; i++) {
        double load = lac_rg_path_load(path, (double)i / LAC_RG_SCAN);
        if (!bracket_note(&b, tree, load, lac_rg_root(tree, rule, path, load, work))) {
            break;
        }
    }
    return close_bracket(tree, rule, path, b, work);
}

lac_status lac_rg_states_create(const lac_rg_tree *tree, lac_rg_block_state **states,
                                lac_error *err)
{
    size_t total = 0;
    for (size_t k = 0; k < tree->layers; k++) {
        total += tree->layer[k].count;
    }
    *states = calloc(total + 1, sizeof **states);
    for (size_t i = 0; *states != NULL && i < total; i++) {
        (*states)[i].gap = INFINITY; // nothing is known before the first load
        (*states)[i].fall = NAN;
    }
    return *states != NULL ? LAC_OK : lac_fail_memory(err);
}

// Part of the step to `gap` after which the block slipped. Under `elastic` a threshold ends at 0,
// that of its cells that have slipped long before, and does not tell how far beyond it the load is.
static double part_of_step(const lac_rg_block_state *s, double gap, double step, double tolerance)
{
    if (!isfinite(s->gap) || step <= 0.0) {
        return step > 0.0 && isinf(gap - s->gap) ? 0.5 : 1.0;
    }
    double fall = gap < -tolerance || !(s->fall > 0.0) ? s->gap - gap : s->fall * step;
    double x = fall > 0.0 ? s->gap / fall : 1.0;
    return fmin(fmax(x, 0.0), 1.0);
}

void lac_rg_states_note(const lac_rg_tree *tree, double before, double load, lac_rg_block_state *s)
{
    for (size_t k = 0; k < tree->layers; k++) {
        const lac_rg_layer *layer = &tree->layer[k];
        for (size_t b = 0; b < layer->count; b++, s++) {
            double gap = layer->gap[b];
            if (!s->slipped && gap <= tree->tolerance) {
                s->slipped = true;
                double x = part_of_step(s, gap, load - before, tree->tolerance);
                s->load = before + x * (load - before);
                s->carried = k == 0 && isfinite(s->gap)
                                 ? s->force + s->gap // a cell: its strength
                                 : s->force + x * (layer->shear[b] - s->force);
            }
            s->fall = (s->gap - gap) / (load - before);
            s->gap = gap;
            s->force = layer->shear[b];
        }
    }
}

static void summarise(size_t count, const lac_rg_block_state *s, double cells, lac_rg_sizes *out)
{
    double load = 0.0, sum = 0.0, square = 0.0;
    *out = (lac_rg_sizes){0};
    for (size_t b = 0; b < count; b++) {
        if (s[b].slipped) {
            double q = s[b].carried / cells;
            out->blocks++;
            load += s[b].load;
            sum += q;
            square += q * q;
        }
    }
    double n = (double)out->blocks;
    out->load = load / n;
    out->strength = sum / n;
    out->spread = sqrt(fmax(0.0, square / n - out->strength * out->strength));
}

void lac_rg_states_summarise(const lac_rg_tree *tree, const lac_rg_block_state *s, bool line,
                             lac_rg_sizes *sizes)
{
    for (size_t level = 0; level <= tree->levels; level++) {
        size_t k = tree->of_level[level];
        const lac_rg_block_state *of_layer = s;
        for (size_t below = 0; below < k; below++) {
            of_layer += tree->layer[below].count;
        }
        double cells = pow(line ? 2.0 : 4.0, (double)level);
        summarise(tree->layer[k].count, of_layer, cells, &sizes[level]);
    }
}

// The block that is the whole joint slips at its critical load, whatever the scan saw.
static void close_sizes(const lac_rg_tree *tree, bool line, double critical, lac_rg_sizes *sizes)
{
    const size_t top = tree->layers - 1;
    for (size_t level = 0; level <= tree->levels; level++) {
        if (tree->of_level[level] == top && sizes[level].blocks > 0) {
            sizes[level].load = critical;
            sizes[level].strength =
                critical * tree->layer[top].strength[0] / pow(line ? 2.0 : 4.0, (double)level);
        }
    }
}

// Side of the largest block that slips as a whole at each load [m].
static void largest_block(const lac_rg_tree *tree, const lac_grid *grid, size_t loads,
                          lac_rg_sample *out)
{
    const size_t levels = lac_rg_levels(tree);
    const double side = fmax(grid->dx, grid->dy);
    for (size_t i = 0; i < loads; i++) {
        out->block[i] = 0.0;
        for (size_t level = 0; level <= levels; level++) {
            if (out->fraction[i * (levels + 1) + level] > 0.0) {
                out->block[i] = ldexp(side, (int)level);
            }
        }
    }
}

// What slips by itself just before the joint slides.
static void count_at_critical(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path,
                              double *work, lac_rg_sample *out)
{
    double *gap = work + lac_rg_blocks_at(tree, 0);
    double least = lac_rg_path_load(path, 0.0);
    lac_rg_path_eval(path, fmax(least, out->critical - 2e-9), work, gap);
    (void)lac_rg_pass(tree, rule, work, gap);
    for (size_t level = 0; level <= lac_rg_levels(tree); level++) {
        out->blocks[level] = (double)lac_rg_blocks_at(tree, level);
        out->slipping[level] = (double)lac_rg_slipping(tree, level);
    }
}

lac_status lac_rg_order_create(const lac_domain *domain, size_t loads, lac_rg_order *order,
                               lac_error *err)
{
    *order = (lac_rg_order){.domain = domain};
    order->part.grid = domain->grid;
    order->part.index = malloc(domain->n * sizeof *order->part.index);
    order->slipped = malloc(domain->n);
    order->cell_load = malloc((2 * domain->n + loads) * sizeof *order->cell_load);
    LAC_FAIL_MEMORY_IF(
        order->part.index == NULL || order->slipped == NULL || order->cell_load == NULL, err);
    order->own_level = order->cell_load + domain->n;
    order->cluster = order->own_level + domain->n;
    for (size_t c = 0; c < 2 * domain->n; c++) {
        order->cell_load[c] = NAN;
    }
    return LAC_OK;
}

void lac_rg_order_clear(lac_rg_order *order)
{
    free(order->part.index);
    free(order->slipped);
    free(order->cell_load);
    *order = (lac_rg_order){0};
}

// Longer side of the largest cluster of slipped cells [m].
static lac_status largest_cluster(const lac_domain *domain, const uint8_t *slipped,
                                  lac_domain *part, double *extent, lac_error *err)
{
    lac_clusters *clusters = NULL;
    *extent = 0.0;
    part->n = 0;
    for (size_t i = 0; i < domain->n; i++) {
        part->index[part->n] = domain->index[i];
        part->n += slipped[i];
    }
    lac_status status = part->n > 0 ? lac_clusters_create(part, &clusters, err) : LAC_OK;
    for (size_t c = 0; clusters != NULL && c < clusters->n; c++) {
        *extent = fmax(*extent, lac_cluster_extent(clusters, &domain->grid, c));
    }
    lac_clusters_free(clusters);
    return status;
}

// Takes note of the cells that have slipped in the end at load i; the loads rise.
static lac_status note_order(lac_rg_order *order, lac_rg_tree *tree, size_t i, double load,
                             lac_error *err)
{
    const lac_domain *domain = order->domain;
    const bool was_whole = i > 0 && order->part.n == domain->n;
    size_t count = 0;
    lac_rg_resolve(tree, order->slipped, NULL);
    for (size_t c = 0; c < domain->n; c++) {
        double at = order->cell_load[c];
        order->cell_load[c] = order->slipped[c] == 0 || !isnan(at) ? at : load;
        count += order->slipped[c];
    }
    if (was_whole && count == domain->n) {
        order->cluster[i] = order->cluster[i - 1];
        return LAC_OK;
    }
    return largest_cluster(domain, order->slipped, &order->part, &order->cluster[i], err);
}

// Along a path: every pass tells of the blocks that slip, and one of them that the joint does.
typedef struct scan {
    lac_rg_tree *tree;
    const lac_rg_path *path;
    lac_rg_rule rule;
    double *work;
    lac_rg_block_state *states;
    bracket bracket;
    double at; // the load reached
    bool slides;
    lac_rg_order *order; // NULL: not wanted
} scan;

static void scan_to(scan *s, double load)
{
    double root = lac_rg_root(s->tree, s->rule, s->path, load, s->work);
    lac_rg_states_note(s->tree, s->at, load, s->states);
    s->slides = s->slides || !bracket_note(&s->bracket, s->tree, load, root);
    s->at = load;
}

// Slipped fractions at the loads asked for; between them as many more as it takes to see where the
// joint slides.
static lac_status scan_path(scan *s, size_t loads, const double *load, lac_rg_sample *out,
                            lac_error *err)
{
    const size_t levels = lac_rg_levels(s->tree) + 1;
    const size_t parts = (LAC_RG_SCAN + loads - 1) / loads;
    scan_to(s, s->at);
    for (size_t level = 0; level < levels; level++) {
        out->begin[level] = (double)lac_rg_slipping(s->tree, level);
    }
    if (s->order != NULL && lac_rg_path_is_preloaded(s->path)) {
        lac_rg_own_levels(s->tree, s->order->own_level);
    }
    for (size_t i = 0; i < loads; i++) {
        double from = s->at;
        for (size_t k = 1; k < parts; k++) {
            scan_to(s, from + (load[i] - from) * (double)k / (double)parts);
        }
        scan_to(s, load[i]);
        for (size_t level = 0; level < levels; level++) {
            out->fraction[i * levels + level] =
                (double)lac_rg_slipping(s->tree, level) / (double)lac_rg_blocks_at(s->tree, level);
        }
        LAC_TRY_RETURN(s->order != NULL ? note_order(s->order, s->tree, i, load[i], err) : LAC_OK);
    }
    return LAC_OK;
}

lac_status lac_rg_sample_take(const lac_rg_joint *joint, const lac_rg_study_def *def, size_t dx,
                              size_t dy, const double *load, lac_rg_order *order,
                              lac_rg_sample *out, lac_error *err)
{
    const lac_domain *domain = joint->domain;
    scan s = {.path = joint->path,
              .rule = def->rule,
              .at = lac_rg_path_load(joint->path, 0.0),
              .order = order};
    s.work = malloc(2 * domain->n * sizeof *s.work);
    lac_status status = s.work != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    LAC_TRY(lac_rg_tree_create_at(domain, dx, dy, joint->strength, joint->drop, &s.tree, err));
    LAC_TRY(lac_rg_states_create(s.tree, &s.states, err));
    s.bracket = (bracket){s.at, s.at, INFINITY, INFINITY};
    LAC_TRY(scan_path(&s, def->loads, load, out, err));
    lac_rg_states_summarise(s.tree, s.states, domain->grid.ny == 1, out->size);
    out->critical = s.slides ? close_bracket(s.tree, s.rule, s.path, s.bracket, s.work) : s.at;
    close_sizes(s.tree, domain->grid.ny == 1, out->critical, out->size);
    largest_block(s.tree, &domain->grid, def->loads, out);
    count_at_critical(s.tree, def->rule, joint->path, s.work, out);
out:
    free(s.states);
    lac_rg_tree_free(s.tree);
    free(s.work);
    return status;
}

lac_status lac_rg_sample_solve(const lac_rg_joint *joint, const lac_rg_study_def *def, size_t dx,
                               size_t dy, lac_rg_sample *sample, lac_error *err)
{
    lac_rg_tree *tree = NULL;
    lac_status status;
    LAC_TRY(lac_rg_tree_create_at(joint->domain, dx, dy, joint->strength, joint->drop, &tree, err));
    LAC_TRY(
        lac_rg_critical_solved(tree, def->rule, joint->press, joint->path, &sample->critical, err));
    for (size_t level = 0; level <= lac_rg_levels(tree); level++) {
        sample->slipping[level] = (double)lac_rg_slipping(tree, level);
    }
    close_sizes(tree, joint->domain->grid.ny == 1, sample->critical, sample->size);
out:
    lac_rg_tree_free(tree);
    return status;
}
