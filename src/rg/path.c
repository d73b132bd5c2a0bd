// SPDX-License-Identifier: GPL-3.0-or-later
// How the load grows, and what stress it puts on every cell: equal shares, or the elastic solution.
#include <assert.h>
#include <gsl/gsl_sort.h>

#include "rg/tree.h"

struct lac_rg_path {
    size_t n;
    bool uniform;     // equal without caps
    double from, to;  // Q/Q_nom at its start and end
    double *strength; // [n] equal: f p of each cell
    double *shear;    // [n] equal: what each carries before; NULL: nothing
    double *sorted;   // [n] equal: what each can take up, ascending
    double *below;    // [n + 1] equal: sums of those
    double nominal;   // equal: sum of f p
    size_t loads;     // 0: equal
    double *load;     // [loads] elastic: Q/Q_nom, ascending
    double *left;     // [loads * n] elastic: f p(P - Q/f)
    double memory[];  // of all these
};

void lac_rg_path_free(lac_rg_path *path) { free(path); }

// Copies the cells, and sorts what each can still take up.
static void fill_equal(lac_rg_path *path, const double *strength, const double *shear)
{
    const size_t n = path->n;
    double carried = 0.0;
    memcpy(path->strength, strength, n * sizeof *strength);
    for (size_t i = 0; i < n; i++) {
        path->sorted[i] = shear != NULL ? fmax(strength[i] - shear[i], 0.0) : strength[i];
        path->nominal += strength[i];
        carried += shear != NULL ? shear[i] : 0.0;
    }
    gsl_sort(path->sorted, 1, n);
    path->below[0] = 0.0;
    for (size_t i = 0; i < n; i++) {
        path->below[i + 1] = path->below[i] + path->sorted[i];
    }
    path->to = 1.0;
    if (shear != NULL) {
        memcpy(path->shear, shear, n * sizeof *shear);
        path->from = carried / path->nominal;
        path->to = (carried + path->below[n]) / path->nominal;
    }
}

// Whether strengths are > 0 and can be added up.
static lac_status check_strengths(size_t n, const double *strength, lac_error *err)
{
    LAC_FAIL_IF(n == 0, err, LAC_EINPUT, "no cell is in contact");
    double total = 0.0;
    for (size_t i = 0; i < n; i++) {
        LAC_FAIL_IF(!(strength[i] > 0.0 && isfinite(strength[i])), err, LAC_EINPUT,
                    "the strength of cell %zu must be > 0 Pa, not %g", i, strength[i]);
        total += strength[i];
    }
    return isfinite(total) ? LAC_OK
                           : lac_fail(err, LAC_EINPUT, "the strengths are too large to add up");
}

lac_status lac_rg_path_further(size_t n, const double *strength, const double *shear,
                               lac_rg_path **out, lac_error *err)
{
    *out = NULL;
    LAC_TRY_RETURN(check_strengths(n, strength, err));
    for (size_t i = 0; shear != NULL && i < n; i++) {
        LAC_FAIL_IF(!isfinite(shear[i]), err, LAC_EINPUT, "the traction of cell %zu is %g Pa", i,
                    shear[i]);
    }
    lac_rg_path *path = calloc(1, sizeof *path + (4 * n + 1) * sizeof *path->memory);
    LAC_FAIL_MEMORY_IF(path == NULL, err);
    path->n = n;
    path->strength = path->memory;
    path->sorted = path->strength + n;
    path->below = path->sorted + n;
    path->shear = shear != NULL ? path->below + n + 1 : NULL;
    fill_equal(path, strength, shear);
    if (!isfinite(path->from) || !isfinite(path->to)) {
        free(path);
        return lac_fail(err, LAC_EINPUT,
                        "the tractions are too large beside the strengths to add up");
    }
    *out = path;
    return LAC_OK;
}

lac_status lac_rg_path_uniform(size_t n, const double *strength, lac_rg_path **out, lac_error *err)
{
    lac_status status = lac_rg_path_further(n, strength, NULL, out, err);
    if (status == LAC_OK) {
        (*out)->uniform = true;
    }
    return status;
}

lac_status lac_rg_path_elastic(const lac_rg_series *series, lac_rg_path **out, lac_error *err)
{
    const size_t n = series->n, loads = series->loads;
    *out = NULL;
    assert(loads >= 2 && series->part[0] == 1.0 && series->part[loads - 1] == 0.0);
    LAC_TRY_RETURN(check_strengths(n, series->pressure, err));
    lac_rg_path *path = calloc(1, sizeof *path + loads * (n + 1) * sizeof *path->memory);
    LAC_FAIL_MEMORY_IF(path == NULL, err);
    path->n = n;
    path->loads = loads;
    path->to = 1.0;
    path->load = path->memory;
    path->left = path->load + loads;
    for (size_t k = 0; k < loads; k++) {
        path->load[k] = 1.0 - series->part[k];
        for (size_t i = 0; i < n; i++) {
            path->left[k * n + i] = series->friction * series->pressure[k * n + i];
        }
    }
    *out = path;
    return LAC_OK;
}

bool lac_rg_path_is_preloaded(const lac_rg_path *path) { return path->shear != NULL; }

double lac_rg_path_load(const lac_rg_path *path, double part)
{
    return part == 1.0 ? path->to : path->from + part * (path->to - path->from);
}

// The stress added to every cell [Pa]: sum min(tau, what a cell can take up) is the load less the
// one that the path begins at.
static double stress_at(const lac_rg_path *path, double load)
{
    const size_t n = path->n;
    double force =
        path->shear != NULL ? (load - path->from) * path->nominal : load * path->below[n];
    if (path->uniform) {
        return force / (double)n;
    }
    size_t low = 0; // cells at their cap
    size_t high = n - 1;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        double reached = path->below[middle] + (double)(n - middle) * path->sorted[middle];
        if (reached < force) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return (force - path->below[low]) / (double)(n - low);
}

static void equal_at(const lac_rg_path *path, double load, double *shear, double *gap)
{
    double tau = stress_at(path, load);
    for (size_t i = 0; i < path->n; i++) {
        double q = path->shear != NULL ? path->shear[i] : 0.0;
        shear[i] = path->uniform ? tau : fmax(q, fmin(q + tau, path->strength[i]));
        gap[i] = path->strength[i] - q - tau;
    }
}

static void elastic_at(const lac_rg_path *path, double load, double *shear, double *gap)
{
    size_t k = 1;
    while (k + 1 < path->loads && path->load[k] < load) {
        k++;
    }
    const double *from = &path->left[(k - 1) * path->n];
    const double *to = &path->left[k * path->n];
    double x = (load - path->load[k - 1]) / (path->load[k] - path->load[k - 1]);
    for (size_t i = 0; i < path->n; i++) {
        gap[i] = from[i] + x * (to[i] - from[i]);
        shear[i] = path->left[i] - gap[i];
    }
}

void lac_rg_path_eval(const lac_rg_path *path, double load, double *shear, double *gap)
{
    if (path->loads == 0) {
        equal_at(path, load, shear, gap);
    } else {
        elastic_at(path, load, shear, gap);
    }
}

void lac_rg_loads(size_t loads, double *part)
{
    const size_t even = (10 * loads + 12) / 24; // 10 of 24: 1, 0.9 ... 0.1
    const size_t falling = loads - even - 1;
    for (size_t k = 0; k < loads; k++) {
        double x = (double)k;
        part[k] = k < even ? 1.0 - 0.9 * x / (double)(even - 1)
                           : 0.1 * pow(0.02, (x - (double)even + 1.0) / (double)falling);
    }
    part[loads - 1] = 0.0;
}

lac_status lac_rg_series_solve(const lac_contact_def *contact, const lac_domain *domain,
                               size_t loads, double *pressure, lac_error *err)
{
    const size_t n = domain->n;
    double part[LAC_RG_MOST_LOADS];
    lac_contact_def def = *contact;
    lac_status status;
    double *p = calloc(lac_grid_cells(&contact->grid), sizeof *p);
    LAC_TRY(p != NULL ? LAC_OK : lac_fail_memory(err));
    lac_rg_loads(loads, part);
    def.start = p;
    for (size_t i = 0; i < n; i++) {
        p[domain->index[i]] = domain->pressure[i];
    }
    for (size_t k = 0; k < loads; k++) {
        if (k > 0 && part[k] > 0.0) {
            def.mean_pressure = part[k] * contact->mean_pressure;
            LAC_TRY(lac_contact_solve(&def, p, NULL, NULL, err));
        }
        for (size_t i = 0; i < n; i++) {
            pressure[k * n + i] = part[k] > 0.0 ? p[domain->index[i]] : 0.0;
        }
    }
out:
    free(p);
    return status;
}
