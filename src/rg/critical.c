// SPDX-License-Identifier: GPL-3.0-or-later
// The smallest load at which the whole joint slides: a scan of the path, then a closing bracket;
// and on contacts solved for the loads at hand, not interpolated between others.
#include "rg/tree.h"

bool lac_rg_bracket_note(lac_rg_bracket *b, const lac_rg_tree *tree, double load, double root)
{
    const bool stuck = !lac_rg_slips(tree, root);
    *(stuck ? &b->low : &b->high) = load;
    *(stuck ? &b->at_low : &b->at_high) = root;
    return stuck;
}

// Where to look next inside a bracket, to close it to `within`, after `step` loads: twice a little
// beyond the chord through the thresholds, on the side that was not seen last, then in the middle.
// LUMP has no thresholds to draw a chord through.
static double next_load(const lac_rg_bracket *b, int step, bool stuck, double within)
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

static lac_status narrow(search *s, double load, lac_rg_bracket *b, bool *stuck, lac_error *err)
{
    double root = NAN;
    lac_status status = root_at(s, load, &root, err);
    *stuck = lac_rg_bracket_note(b, s->tree, load, root);
    return status;
}

// From a guess away, in steps that double, until the joint is seen to stick and to slide.
static lac_status find(search *s, double guess, lac_rg_bracket *b, lac_error *err)
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
    lac_rg_bracket b = {0.0, 1.0, INFINITY, 0.0};
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

double lac_rg_close(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path, lac_rg_bracket b,
                    double *work)
{
    // a joint far from 0, by tractions beside small strengths, has no loads so close together
    const double within = fmax(1e-9, 4 * DBL_EPSILON * fmax(fabs(b.low), fabs(b.high)));
    bool stuck = false;
    for (int step = 0; b.high - b.low > within; step++) {
        double load = next_load(&b, step, stuck, within);
        stuck = lac_rg_bracket_note(&b, tree, load, lac_rg_root(tree, rule, path, load, work));
    }
    return b.high;
}

double lac_rg_critical(lac_rg_tree *tree, lac_rg_rule rule, const lac_rg_path *path, double *work)
{
    // a joint may slide, stick and slide again as its tractions rearrange
    lac_rg_bracket b = {lac_rg_path_load(path, 0.0), lac_rg_path_load(path, 1.0), INFINITY, 0.0};
    if (lac_rg_path_is_preloaded(path)) {
        b.at_low = lac_rg_root(tree, rule, path, b.low, work);
        if (lac_rg_slips(tree, b.at_low)) {
            return b.low;
        }
    }
    for (int i = 1; i <= LAC_RG_SCAN; i++) {
        double load = lac_rg_path_load(path, (double)i / LAC_RG_SCAN);
        if (!lac_rg_bracket_note(&b, tree, load, lac_rg_root(tree, rule, path, load, work))) {
            break;
        }
    }
    return lac_rg_close(tree, rule, path, b, work);
}
