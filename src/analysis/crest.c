// SPDX-License-Identifier: GPL-3.0-or-later
// The largest slip rate of a cell between the ends of steps: the top of a cubic through ln |v| at
// four of them, in Newton's form.
#include "analysis/crest.h"

#include "lacuna/simulation.h"

lac_status lac_crest_create(size_t n, lac_crest *out, lac_error *err)
{
    *out = (lac_crest){.n = n, .block = calloc(3 * n, sizeof *out->block)};
    for (size_t k = 0; k < 3 && out->block != NULL; k++) {
        out->rate[k] = out->block + k * n;
    }
    return out->block != NULL ? LAC_OK : lac_fail_memory(err);
}

void lac_crest_clear(lac_crest *c)
{
    free(c->block);
    *c = (lac_crest){0};
}

double lac_crest_share_at(double before, double after, double limit)
{
    double share = log(limit / before) / log(after / before);
    return share >= 0.0 && share <= 1.0 ? share : 1.0; // from v = 0: at the very end
}

// u(s) = left s + bend s (s + h) + twist s (s + h)(s - next), s from the end of the last step, at
// -h, 0 and next those of steps.
typedef struct cubic {
    double h, next;
    double left, bend, twist;
} cubic;

static double value_at(const cubic *c, double s)
{
    return s * (c->left + (s + c->h) * (c->bend + c->twist * (s - c->next)));
}

// Where the top is, between -h and next; at one of these where there is none.
static double top_of(const cubic *c)
{
    const double a = 3.0 * c->twist;
    const double b = 2.0 * (c->bend + c->twist * (c->h - c->next));
    const double slope = c->left + c->h * (c->bend - c->twist * c->next);
    const double root = sqrt(b * b - 4.0 * a * slope); // NaN: there is none
    const double s = 2.0 * slope / (root - b);
    return fmin(fmax(s, -c->h), c->next);
}

double lac_crest_top(const lac_crest *c, const lac_step *step, size_t cell, double *since)
{
    const double resolved = 1.0; // e-folds a step, at most
    const double middle = c->rate[0][cell], after = fabs(step->slip_rate[cell]);
    if (c->known < 2 || !(step->step > 0.0) || !(middle >= after) ||
        !(middle >= c->rate[1][cell])) {
        return 0.0;
    }
    const double fall = log(middle / after), rise = log(middle / c->rate[1][cell]);
    if (!(rise + fall > 0.0) || fall > resolved || rise > resolved) {
        return 0.0;
    }
    cubic u = {.h = c->step[0], .next = step->step, .left = rise / c->step[0]};
    u.bend = -(fall / u.next + u.left) / (u.h + u.next);
    double s = top_of(&u), height = value_at(&u, s);
    if (c->known > 2) {
        const double earlier = log(c->rate[1][cell] / c->rate[2][cell]) / c->step[1];
        const double bend = (u.left - earlier) / (u.h + c->step[1]);
        cubic bent = u;
        bent.twist = (u.bend - bend) / (u.h + u.next + c->step[1]);
        const double at = top_of(&bent), by = value_at(&bent, at);
        const bool smooth = by >= 0.0 && by <= 2.0 * height; // else it does not go with the others
        s = smooth ? at : s;
        height = smooth ? by : height;
    }
    if (since != NULL) {
        *since = s;
    }
    return middle * exp(height);
}

void lac_crest_take(lac_crest *c, const lac_step *step)
{
    if (step->changed != NULL) { // cells at steps of their own
        for (size_t k = 0; k < step->changes; k++) {
            c->rate[0][step->changed[k]] = fabs(step->slip_rate[step->changed[k]]);
        }
        c->known = 1;
        return;
    }
    double *oldest = c->rate[2];
    c->rate[2] = c->rate[1];
    c->rate[1] = c->rate[0];
    c->rate[0] = oldest;
    c->step[1] = c->step[0];
    c->step[0] = step->step;
    c->known = !(step->step > 0.0) ? 1 : c->known < 3 ? c->known + 1 : 3;
    for (size_t i = 0; i < c->n; i++) {
        oldest[i] = fabs(step->slip_rate[i]);
    }
}

void lac_crest_serialize(lac_crest *c, lac_archive *archive)
{
    for (size_t k = 0; k < 3; k++) {
        lac_archive_pass(archive, c->rate[k], c->n * sizeof *c->rate[k]);
    }
    LAC_PASS(archive, c->step);
    LAC_PASS(archive, c->known);
    if (c->known < 0 || c->known > 3) {
        archive->short_of = true;
        c->known = 0;
    }
}
