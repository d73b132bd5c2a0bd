// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/pressed.h"

#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "base/rng.h"
#include "support/test.h"

int set_up(void **state)
{
    fixture *f = calloc(1, sizeof *f);
    if (f == NULL) {
        return -1;
    }
    f->def = lac_contact_default();
    f->def.grid = (lac_grid){8, 8, 1.0, 1.0, true};
    f->def.heights = f->h;
    f->def.e_star = 40e9;
    f->def.mean_pressure = 1e6;
    *state = f;
    return 0;
}

int tear_down(void **state)
{
    free(*state);
    return 0;
}

lac_status solve(fixture *f)
{
    f->err.message[0] = '\0';
    return lac_contact_solve(&f->def, f->p, f->gap, &f->report, &f->err);
}

void must_solve(fixture *f)
{
    if (solve(f) != LAC_OK) {
        fail_msg("%s", f->err.message);
    }
}

double mean(const double *x, size_t n)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += x[i];
    }
    return sum / (double)n;
}

static double rms(const double *x, size_t n)
{
    double m = mean(x, n);
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += (x[i] - m) * (x[i] - m);
    }
    return sqrt(sum / (double)n);
}

// Free faces are judged by what the load dents, where that is more than the roughness.
static double dent(const fixture *f)
{
    const lac_grid *grid = &f->def.grid;
    double longest = fmax((double)grid->nx * grid->dx, (double)grid->ny * grid->dy);
    return f->def.mean_pressure * longest / (3.14159265358979 * f->def.e_star);
}

// p >= 0, g >= 0 where p = 0, p g = 0, and the load: each to the tolerance it was solved to.
void check_solution_at(const fixture *f, double load)
{
    size_t n = lac_grid_cells(&f->def.grid);
    double scale = f->def.grid.periodic ? rms(f->h, n) : fmax(rms(f->h, n), dent(f));
    double pg = 0.0;
    size_t cells = 0;
    for (size_t i = 0; i < n; i++) {
        assert_true(isfinite(f->p[i]) && isfinite(f->gap[i]));
        assert_true(f->p[i] >= 0.0);
        assert_true(f->p[i] > 0.0 || f->gap[i] >= -f->def.tolerance * scale);
        pg += f->p[i] / load * fabs(f->gap[i]) / (double)n;
        cells += f->p[i] > 0.0 ? 1 : 0;
    }
    assert_true(pg <= f->def.tolerance * scale);
    assert_true(fabs(mean(f->p, n) / load - 1.0) < 1e-12);
    assert_int_equal(cells, f->report.n_cells);
    if (f->def.grid.periodic) {
        assert_true(fabs(mean(f->gap, n) - f->report.approach) <= 1e-9 * scale);
    }
}

void check_solution(const fixture *f) { check_solution_at(f, f->def.mean_pressure); }

void fill_random(fixture *f, uint64_t seed)
{
    for (size_t i = 0; i < lac_grid_cells(&f->def.grid); i++) {
        f->h[i] = lac_random_uniform(seed, LAC_STREAM_TEST, i, 0) * 1e-3;
    }
}

void refuse(fixture *f, const char *word)
{
    assert_int_equal(solve(f), LAC_EINPUT);
    if (strstr(f->err.message, word) == NULL) {
        fail_msg("\"%s\" does not speak of \"%s\"", f->err.message, word);
    }
}
