// SPDX-License-Identifier: GPL-3.0-or-later
// Many joints, each with its blocks at many places: means, scatter, and one map of them all.
#include "rg/tree.h"

#include <gsl/gsl_statistics_double.h>

#include "base/rng.h"

const char *const lac_rg_rule_names[] = {"fix", "cons", "lump", NULL};
const char *const lac_rg_field_names[] = {"elastic", "equal", "uniform", NULL};

enum { LEAST_BLOCKS = 8, LEAST_LOADS = 10, MOST = 1 << 16 };

struct lac_rg_study {
    lac_rg_study_def def;
    size_t joints, levels;
    double *load;             // [loads]
    lac_rg_sample **of_joint; // [joints][places]
    double *cluster;          // [loads] sum over joints
    lac_rg_result *result;
};

lac_rg_study_def lac_rg_study_default(void)
{
    return (lac_rg_study_def){
        .rule = LAC_RG_FIX, .places = 16, .loads = 60, .resamplings = 400, .seed = 1};
}

lac_status lac_rg_study_create(const lac_rg_study_def *def, lac_rg_study **out, lac_error *err)
{
    *out = NULL;
    LAC_FAIL_IF(
        def->places < 1 || def->places >= MOST || def->loads < LEAST_LOADS || def->loads >= MOST,
        err, LAC_EINPUT,
        "%zu places and %zu loads are not possible: at least 1 and %d, fewer than %d of each",
        def->places, def->loads, LEAST_LOADS, MOST);
    lac_rg_study *study = *out = calloc(1, sizeof *study);
    LAC_FAIL_MEMORY_IF(study == NULL, err);
    study->def = *def;
    study->load = malloc(def->loads * sizeof *study->load);
    study->cluster = calloc(def->loads, sizeof *study->cluster);
    study->result = calloc(1, sizeof *study->result);
    const bool room = study->load != NULL && study->cluster != NULL && study->result != NULL;
    const lac_status status = room ? LAC_OK : lac_fail_memory(err);
    LAC_MADE(status, out, lac_rg_study_free);
}

// Evenly along the path: to its end, and from its start where the joint is loaded there.
static void set_loads(lac_rg_study *study, const lac_rg_path *path)
{
    const size_t n = study->def.loads;
    for (size_t i = 0; i < n; i++) {
        double part = lac_rg_path_is_preloaded(path) ? (double)i / (double)(n - 1)
                                                     : (double)(i + 1) / (double)n;
        study->load[i] = lac_rg_path_load(path, part);
    }
}

static void free_samples(lac_rg_sample *samples)
{
    if (samples != NULL) {
        free(samples->fraction); // those of all places
        free(samples->size);
    }
    free(samples);
}

static void free_result(lac_rg_result *result)
{
    if (result != NULL) {
        free(result->fraction);
        free(result->of_joint);
        free(result->cell_load);
        free(result->size);
    }
    free(result);
}

void lac_rg_study_free(lac_rg_study *study)
{
    if (study == NULL) {
        return;
    }
    for (size_t j = 0; j < study->joints; j++) {
        free_samples(study->of_joint[j]);
    }
    free(study->of_joint);
    free_result(study->result);
    free(study->cluster);
    free(study->load);
    free(study);
}

static size_t length_over(size_t loads, size_t levels)
{
    return loads * (levels + 2) + 3 * (levels + 1);
}

// Doubles of a sample: its fractions, and behind them the other arrays.
static size_t length_of(const lac_rg_study *study)
{
    return length_over(study->def.loads, study->levels);
}

static lac_status create_samples(const lac_rg_study *study, lac_rg_sample **out, lac_error *err)
{
    const size_t loads = study->def.loads;
    const size_t levels = study->levels + 1;
    const size_t places = study->def.places;
    lac_rg_sample *samples = *out = calloc(places, sizeof *samples);
    LAC_FAIL_MEMORY_IF(samples == NULL, err);
    samples->fraction = malloc(places * length_of(study) * sizeof *samples->fraction);
    samples->size = malloc(places * levels * sizeof *samples->size);
    LAC_FAIL_MEMORY_IF(samples->fraction == NULL || samples->size == NULL, err);
    for (size_t i = 0; i < places; i++) {
        lac_rg_sample *s = &samples[i];
        s->size = samples->size + i * levels;
        s->fraction = samples->fraction + i * length_of(study);
        s->block = s->fraction + loads * levels;
        s->blocks = s->block + loads;
        s->slipping = s->blocks + levels;
        s->begin = s->slipping + levels;
    }
    return LAC_OK;
}

// Where the grid of blocks lies; the first place is the grid's own.
static void draw_place(const lac_rg_study *study, const lac_grid *grid, size_t place, size_t *dx,
                       size_t *dy)
{
    uint64_t bits[4];
    lac_random(study->def.seed, LAC_STREAM_PLACE, study->def.first + study->joints, place, bits);
    *dx = place > 0 ? (size_t)(bits[0] % grid->nx) : 0;
    *dy = place > 0 ? (size_t)(bits[1] % grid->ny) : 0;
}

static lac_status take_samples(const lac_rg_study *study, const lac_rg_joint *joint,
                               lac_rg_sample *samples, lac_rg_order *order, lac_error *err)
{
    const int places = (int)study->def.places;
    lac_status worst = LAC_OK;
#pragma omp parallel for schedule(dynamic)
    for (int i = 0; i < places; i++) {
        lac_error own = {""};
        size_t dx, dy;
        draw_place(study, &joint->domain->grid, (size_t)i, &dx, &dy);
        lac_status status = lac_rg_sample_take(joint, &study->def, dx, dy, study->load,
                                               i == 0 ? order : NULL, &samples[i], &own);
        if (status != LAC_OK) {
#pragma omp critical
            {
                worst = status;
                if (err != NULL) {
                    *err = own;
                }
            }
        }
    }
    return worst;
}

// One place after the other: the contact solver has the threads.
static lac_status solve_samples(const lac_rg_study *study, const lac_rg_joint *joint,
                                lac_rg_sample *samples, lac_error *err)
{
    for (size_t i = 0; joint->press != NULL && i < study->def.places; i++) {
        size_t dx, dy;
        draw_place(study, &joint->domain->grid, i, &dx, &dy);
        LAC_TRY_RETURN(lac_rg_sample_solve(joint, &study->def, dx, dy, &samples[i], err));
    }
    return LAC_OK;
}

// Clusters and the order of slipping, at the grid's own place.
static void keep_order(lac_rg_study *study, lac_rg_order *order)
{
    lac_rg_result *r = study->result;
    for (size_t i = 0; i < study->def.loads; i++) {
        study->cluster[i] += order->cluster[i];
    }
    free(r->cell_load);
    r->cell_load = order->cell_load;
    r->own_level = order->own_level;
    r->last_n = order->domain->n;
    order->cell_load = NULL;
}

// Room for one more joint, and its samples.
static lac_status begin_joint(lac_rg_study *study, const lac_grid *grid, lac_rg_sample **samples,
                              lac_error *err)
{
    const size_t levels = lac_rg_levels_over(grid);
    LAC_FAIL_IF(study->joints > 0 && levels != study->levels, err, LAC_EINPUT,
                "a joint of %zu levels cannot join one of %zu", levels, study->levels);
    study->levels = levels;
    lac_rg_sample **grown = realloc(study->of_joint, (study->joints + 1) * sizeof *study->of_joint);
    LAC_FAIL_MEMORY_IF(grown == NULL, err);
    study->of_joint = grown;
    return create_samples(study, samples, err);
}

lac_status lac_rg_study_add(lac_rg_study *study, const lac_rg_joint *joint, lac_error *err)
{
    lac_rg_sample *samples = NULL;
    lac_rg_order order = {0};
    lac_status status;
    if (study->joints == 0) {
        set_loads(study, joint->path);
    }
    LAC_TRY(begin_joint(study, &joint->domain->grid, &samples, err));
    LAC_TRY(lac_rg_order_create(joint->domain, study->def.loads, &order, err));
    LAC_TRY(take_samples(study, joint, samples, &order, err));
    LAC_TRY(solve_samples(study, joint, samples, err));
    keep_order(study, &order);
    study->of_joint[study->joints++] = samples;
    samples = NULL;
out:
    lac_rg_order_clear(&order);
    free_samples(samples);
    return status;
}

size_t lac_rg_study_part_size(const lac_rg_study_def *def, const lac_grid *grid)
{
    const size_t levels = lac_rg_levels_over(grid);
    const size_t doubles = 1 + length_over(def->loads, levels);
    return 2 * def->loads * sizeof(double) +
           def->places * (doubles * sizeof(double) + (levels + 1) * sizeof(lac_rg_sizes));
}

// @return what follows in the part
static unsigned char *copy(void *own, unsigned char *part, size_t bytes, bool take)
{
    memcpy(take ? own : part, take ? part : own, bytes);
    return part + bytes;
}

// What a joint gave at its places, to a part or from there.
static void copy_samples(const lac_rg_study *study, lac_rg_sample *samples, unsigned char *part,
                         bool take)
{
    const size_t places = study->def.places;
    for (size_t i = 0; i < places; i++) {
        part = copy(&samples[i].critical, part, sizeof samples[i].critical, take);
    }
    part =
        copy(samples->fraction, part, places * length_of(study) * sizeof *samples->fraction, take);
    (void)copy(samples->size, part, places * (study->levels + 1) * sizeof *samples->size, take);
}

void lac_rg_study_give(const lac_rg_study *study, void *part)
{
    const size_t bytes = study->def.loads * sizeof *study->load;
    unsigned char *to = copy(study->load, part, bytes, false);
    to = copy(study->cluster, to, bytes, false);
    copy_samples(study, study->of_joint[0], to, false);
}

lac_status lac_rg_study_take(lac_rg_study *study, const lac_grid *grid, const void *part,
                             lac_error *err)
{
    const size_t loads = study->def.loads;
    const double *from = part;
    lac_rg_sample *samples = NULL;
    lac_status status = begin_joint(study, grid, &samples, err);
    if (status != LAC_OK) {
        free_samples(samples);
        return status;
    }
    memcpy(study->load, from, loads * sizeof *from); // those of all joints
    for (size_t i = 0; i < loads; i++) {
        study->cluster[i] += from[loads + i];
    }
    copy_samples(study, samples, (unsigned char *)(from + 2 * loads), true);
    study->of_joint[study->joints++] = samples;
    return LAC_OK;
}

// Mean and standard deviation of n values, `apart` from each other
static void spread(size_t n, const double *x, size_t apart, double *mean, double *sd)
{
    *mean = gsl_stats_mean(x, apart, n);
    *sd = n > 1 ? gsl_stats_sd_m(x, apart, n, *mean) : 0.0;
}

static lac_status critical_force(const lac_rg_study *study, lac_rg_result *r, lac_error *err)
{
    const size_t places = study->def.places;
    const size_t apart = sizeof(lac_rg_sample) / sizeof(double);
    free(r->of_joint);
    r->of_joint = malloc(study->joints * sizeof *r->of_joint);
    LAC_FAIL_MEMORY_IF(r->of_joint == NULL, err);
    r->place_sd = 0.0;
    for (size_t j = 0; j < study->joints; j++) {
        double sd;
        spread(places, &study->of_joint[j]->critical, apart, &r->of_joint[j], &sd);
        r->place_sd += sd / (double)study->joints;
    }
    spread(study->joints, r->of_joint, 1, &r->critical, &r->critical_sd);
    r->critical_error = r->critical_sd / sqrt((double)study->joints);
    if (study->joints == 1) {
        r->critical_sd = r->place_sd;
        r->critical_error = r->place_sd / sqrt((double)places);
    }
    if (places == 1) { // one place says nothing of others
        r->place_sd = NAN;
    }
    if (study->joints == 1 && places == 1) {
        r->critical_sd = NAN;
        r->critical_error = NAN;
    }
    return LAC_OK;
}

static lac_status create_means(const lac_rg_study *study, lac_rg_result *r, lac_error *err)
{
    const size_t loads = study->def.loads;
    const size_t levels = study->levels + 1;
    free(r->fraction);
    free(r->size);
    r->fraction = calloc(length_of(study) + 2 * loads, sizeof *r->fraction);
    r->size = calloc(levels, sizeof *r->size);
    LAC_FAIL_MEMORY_IF(r->fraction == NULL || r->size == NULL, err);
    r->block = r->fraction + loads * levels; // as in a sample
    r->blocks = r->block + loads;
    r->slipping = r->blocks + levels;
    r->begin = r->slipping + levels;
    r->load = r->begin + levels;
    r->cluster = r->load + loads;
    return LAC_OK;
}

static void mean_sizes(const lac_rg_study *study, lac_rg_result *r)
{
    for (size_t level = 0; level <= study->levels; level++) {
        double counted = 0.0;
        lac_rg_sizes *to = &r->size[level];
        for (size_t k = 0; k < study->joints * study->def.places; k++) {
            const size_t j = k / study->def.places;
            const lac_rg_sizes *from = &study->of_joint[j][k % study->def.places].size[level];
            if (from->blocks > 0) {
                to->blocks += from->blocks;
                to->load += from->load;
                to->strength += from->strength;
                to->spread += from->spread;
                counted += 1.0;
            }
        }
        to->load /= counted;
        to->strength /= counted;
        to->spread /= counted;
    }
}

static void means(const lac_rg_study *study, lac_rg_result *r)
{
    const double weight = 1.0 / ((double)study->joints * (double)study->def.places);
    for (size_t j = 0; j < study->joints; j++) {
        for (size_t i = 0; i < study->def.places; i++) {
            for (size_t k = 0; k < length_of(study); k++) {
                r->fraction[k] += weight * study->of_joint[j][i].fraction[k];
            }
        }
    }
    for (size_t k = 0; k < study->def.loads; k++) {
        r->load[k] = study->load[k];
        r->cluster[k] = study->cluster[k] / (double)study->joints;
    }
    mean_sizes(study, r);
}

// Pairs (s_l, s_{l+1}) of one sample; returns how many.
static size_t pairs_of(const lac_rg_study *study, const lac_rg_sample *sample, double *s,
                       double *s_next)
{
    const size_t levels = study->levels + 1;
    size_t n = 0;
    for (size_t i = 0; i < study->def.loads; i++) {
        const double *at = &sample->fraction[i * levels];
        for (size_t level = 0; level + 1 < levels; level++) {
            if (sample->blocks[level + 1] >= LEAST_BLOCKS) {
                s[n] = at[level];
                s_next[n++] = at[level + 1];
            }
        }
    }
    return n;
}

// The map of all pairs, resampled by joint, or by place where there is one joint.
static lac_status fit_map(const lac_rg_study *study, lac_rg_result *r, lac_error *err)
{
    const size_t samples = study->joints * study->def.places;
    const size_t most = samples * study->def.loads * (study->levels + 1);
    double *s = malloc((2 * most + 1) * sizeof *s);
    size_t *first = malloc((samples + 1) * sizeof *first);
    lac_status status = s != NULL && first != NULL ? LAC_OK : lac_fail_memory(err);
    if (status == LAC_OK) {
        size_t groups = 0, n = 0;
        for (size_t k = 0; k < samples; k++) {
            size_t place = k % study->def.places;
            if (place == 0 || study->joints == 1) {
                first[groups++] = n;
            }
            n += pairs_of(study, &study->of_joint[k / study->def.places][place], s + n,
                          s + most + n);
        }
        first[groups] = n;
        status = lac_rg_map_resample(groups, first, s, s + most, study->def.resamplings,
                                     study->def.seed, &r->fit, err);
    }
    free(first);
    free(s);
    return status;
}

lac_status lac_rg_study_finish(lac_rg_study *study, const lac_rg_result **result, lac_error *err)
{
    lac_rg_result *r = study->result;
    LAC_FAIL_IF(study->joints == 0, err, LAC_EINPUT, "no joint was added to the study");
    r->joints = study->joints;
    r->places = study->def.places;
    r->levels = study->levels;
    r->loads = study->def.loads;
    LAC_TRY_RETURN(create_means(study, r, err));
    means(study, r);
    LAC_TRY_RETURN(critical_force(study, r, err));
    LAC_TRY_RETURN(fit_map(study, r, err));
    r->cluster_law = lac_rg_power_fit(r->loads, r->load, r->cluster, r->critical);
    r->block_law = lac_rg_power_fit(r->loads, r->load, r->block, r->critical);
    *result = r;
    return LAC_OK;
}
