// SPDX-License-Identifier: GPL-3.0-or-later
// Ways to choose members: where each lies along every axis, in (0, 1). A row of the table is a
// design.
#include <gsl/gsl_qrng.h>

#include "base/rng.h"
#include "sweep/sweep.h"

// A number of an axis that neither its place among the axes nor the others decide.
static uint64_t name_of(const lac_sweep *sweep, size_t axis)
{
    size_t p = 0;
    while (sweep->param[p].axis != axis) {
        p++;
    }
    const char *key = sweep->param[p].key;
    return lac_sum_bytes(LAC_SUM_OF_NOTHING, key, strlen(key));
}

static double drawn(const lac_sweep *sweep, size_t axis, uint64_t member)
{
    return lac_random_uniform(sweep->seed, LAC_STREAM_SWEEP, member, name_of(sweep, axis));
}

static void place_random(const lac_sweep *sweep, size_t member, double *u)
{
    for (size_t k = 0; k < sweep->axes; k++) {
        u[k] = drawn(sweep, k, member);
    }
}

// The last axis runs fastest.
static void place_grid(const lac_sweep *sweep, size_t member, double *u)
{
    for (size_t k = sweep->axes; k-- > 0;) {
        const size_t n = sweep->positions[k];
        u[k] = ((double)(member % n) + 0.5) / (double)n;
        member /= n;
    }
}

// In each of as many equal parts as there are members one lies, anywhere in it (McKay et al. 1979,
// doi 10.2307/1268522).
static void place_lhs(const lac_sweep *sweep, size_t member, double *u)
{
    for (size_t k = 0; k < sweep->axes; k++) {
        const double part = sweep->points[member * sweep->width + k];
        u[k] = (part + drawn(sweep, k, member)) / (double)sweep->members;
    }
}

// Sobol's sequence, all of it moved by numbers of the seed (Cranley & Patterson 1976).
static double moved(const lac_sweep *sweep, size_t row, size_t k)
{
    const double shift = lac_random_uniform(sweep->seed, LAC_STREAM_SWEEP, UINT64_MAX, k);
    const double u = sweep->points[row * sweep->width + k] + shift;
    const double in = u - floor(u);
    return in > 0.0 ? in : 0.5 / 4294967296.0; // of the sequence's own bits
}

static void place_sobol(const lac_sweep *sweep, size_t member, double *u)
{
    for (size_t k = 0; k < sweep->axes; k++) {
        u[k] = moved(sweep, member, k);
    }
}

// Row r of A, of B, and of A with one axis of B at a time (Saltelli et al. 2010).
static void place_saltelli(const lac_sweep *sweep, size_t member, double *u)
{
    const size_t block = sweep->axes + 2, row = member / block, k = member % block;
    for (size_t d = 0; d < sweep->axes; d++) {
        const bool of_b = k == 1 || k == d + 2;
        u[d] = moved(sweep, row, d + (of_b ? sweep->axes : 0));
    }
}

// The base, then each axis low and high alone; NaN: as the case has it.
static void place_tornado(const lac_sweep *sweep, size_t member, double *u)
{
    for (size_t k = 0; k < sweep->axes; k++) {
        const bool own = member > 0 && (member - 1) / 2 == k;
        u[k] = !own ? NAN : member % 2 == 1 ? 0.1 : 0.9;
    }
}

static const lac_design designs[] = {
    {"grid", "each value of the lists with every other", LAC_SAMPLE_DRAWN, true, true, 0, 0,
     place_grid},
    {"random", "independent draws", LAC_SAMPLE_DRAWN, false, false, 1, 0, place_random},
    {"lhs",
     "a Latin hypercube: each key's range in as many equally likely parts as there are "
     "members, one in each",
     LAC_SAMPLE_DRAWN, false, false, 1, 0, place_lhs},
    {"sobol", "Sobol's sequence, which fills evenly", LAC_SAMPLE_DRAWN, false, false, 1, 0,
     place_sobol},
    {"saltelli", "for Sobol's indices: keys + 2 members a row", LAC_SAMPLE_SALTELLI, false, false,
     2, 1, place_saltelli},
    {"tornado",
     "one key at a time: the case, then each key low and high (of what is drawn, 10 "
     "and 90 %; of a list, the first and the last)",
     LAC_SAMPLE_TORNADO, false, true, 1, 2, place_tornado},
};

const lac_design *lac_design_get(size_t index)
{
    return index < sizeof designs / sizeof *designs ? &designs[index] : NULL;
}

typedef struct ranked {
    uint64_t by[2];
    size_t index;
} ranked;

static int compare(const void *a, const void *b)
{
    const ranked *x = a, *y = b;
    return x->by[0] != y->by[0] ? (x->by[0] < y->by[0] ? -1 : 1) : x->index < y->index ? -1 : 1;
}

// The part of every member along each axis: an order by random numbers.
static lac_status shuffle(lac_sweep *sweep, lac_error *err)
{
    const size_t n = sweep->members;
    ranked *order = malloc(n * sizeof *order);
    LAC_FAIL_MEMORY_IF(order == NULL, err);
    for (size_t k = 0; k < sweep->axes; k++) {
        for (size_t i = 0; i < n; i++) {
            uint64_t random[4];
            lac_random(sweep->seed, LAC_STREAM_SWEEP, i, ~name_of(sweep, k), random);
            order[i] = (ranked){{random[0], random[1]}, i};
        }
        qsort(order, n, sizeof *order, compare);
        for (size_t i = 0; i < n; i++) {
            sweep->points[order[i].index * sweep->width + k] = (double)i;
        }
    }
    free(order);
    return LAC_OK;
}

static lac_status fill_sobol(lac_sweep *sweep, size_t rows, lac_error *err)
{
    const size_t most = gsl_qrng_sobol->max_dimension;
    LAC_FAIL_IF(sweep->width > most, err, LAC_EINPUT,
                "--design: \"%s\" takes at most %zu keys: Sobol's sequence has %zu dimensions here",
                sweep->design->name, most * sweep->axes / sweep->width, most);
    gsl_qrng *sobol = gsl_qrng_alloc(gsl_qrng_sobol, (unsigned)sweep->width);
    LAC_FAIL_MEMORY_IF(sobol == NULL, err);
    for (size_t r = 0; r < rows; r++) {
        if (r > 0 || sweep->width > sweep->axes) { // GSL leaves zero out, without which 2^k points
                                                   // are not even; rows of two need not be
            (void)gsl_qrng_get(sobol, sweep->points + r * sweep->width);
        }
    }
    gsl_qrng_free(sobol);
    return LAC_OK;
}

static lac_status make_points(lac_sweep *sweep, lac_error *err)
{
    const bool lhs = sweep->design->place == place_lhs,
               two = sweep->design->place == place_saltelli;
    if (!lhs && !two && sweep->design->place != place_sobol) {
        return LAC_OK;
    }
    const size_t rows = two ? sweep->members / (sweep->axes + 2) : sweep->members;
    sweep->width = two ? 2 * sweep->axes : sweep->axes;
    sweep->points = calloc(rows * sweep->width, sizeof *sweep->points);
    LAC_FAIL_MEMORY_IF(sweep->points == NULL, err);
    return lhs ? shuffle(sweep, err) : fill_sobol(sweep, rows, err);
}

static lac_status find_design(lac_sweep *sweep, const char *name, lac_error *err)
{
    bool drawn_any = false;
    char names[96] = "";
    for (size_t p = 0; p < sweep->params; p++) {
        drawn_any = drawn_any || sweep->param[p].drawn != NULL;
    }
    const char *wanted = name != NULL ? name : drawn_any ? "random" : "grid";
    for (size_t i = 0; i < sizeof designs / sizeof *designs; i++) {
        lac_append(names, sizeof names, "%s%s", i > 0 ? ", " : "", designs[i].name);
        sweep->design = strcmp(wanted, designs[i].name) == 0 ? &designs[i] : sweep->design;
    }
    LAC_FAIL_IF(sweep->design == NULL, err, LAC_EINPUT, "--design: \"%s\" must be one of %s", name,
                names);
    for (size_t p = 0; p < sweep->params; p++) {
        const lac_swept *param = &sweep->param[p];
        LAC_FAIL_IF(sweep->design->lists && param->drawn != NULL, err, LAC_EINPUT,
                    "--design: \"grid\" takes lists, and %s is drawn from \"%s\": name its values, "
                    "or another design",
                    param->key, param->said);
    }
    return LAC_OK;
}

// How many: those of a grid, else what is asked for, or usual, as a whole design.
static lac_status count_members(lac_sweep *sweep, int64_t asked, lac_error *err)
{
    const lac_design *d = sweep->design;
    const double most = 1e9;
    double n = 1.0;
    LAC_FAIL_IF(asked < 0 || (double)asked > most, err, LAC_EINPUT,
                "--members: \"%lld\" must be a number from 1 to 1000000000", (long long)asked);
    for (size_t k = 0; d->lists && k < sweep->axes; k++) {
        n *= (double)sweep->positions[k];
    }
    LAC_FAIL_IF(n > most, err, LAC_EINPUT, "--design: \"grid\" has %.3g members here: at most 1e9",
                n);
    const size_t unit = d->fixed + d->each * sweep->axes;
    const size_t own = d->lists ? (size_t)n : unit;
    LAC_FAIL_IF(d->once && asked > 0 && (size_t)asked != own, err, LAC_EINPUT,
                "--members: \"%lld\" must be left out: \"%s\" has %zu members here",
                (long long)asked, d->name, own);
    sweep->members = d->once ? own : asked > 0 ? (size_t)asked : unit > 1 ? 128 * unit : 100;
    LAC_FAIL_IF(
        sweep->members % (d->once ? 1 : unit) != 0 || sweep->members < unit, err, LAC_EINPUT,
        "--members: \"%lld\" must be a multiple of %zu, the number of keys and two, such as "
        "%zu",
        (long long)asked, unit, (sweep->members / unit + 1) * unit);
    return LAC_OK;
}

lac_status lac_sweep_arrange(lac_sweep *sweep, const lac_sweep_request *request, lac_error *err)
{
    LAC_TRY_RETURN(find_design(sweep, request->design, err));
    LAC_FAIL_IF(request->table != NULL && sweep->design->sample != LAC_SAMPLE_DRAWN, err,
                LAC_EINPUT,
                "--design: \"%s\" moves one key without the others, which --table holds together",
                sweep->design->name);
    LAC_TRY_RETURN(count_members(sweep, request->members, err));
    return make_points(sweep, err);
}
