// SPDX-License-Identifier: GPL-3.0-or-later
// Spreads of a parameter over the cells: distributions, products, sizes and maps.
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <math.h>
#include <netcdf.h>
#include <stdio.h>

#include "base/rng.h"
#include "scene/internal.h"
#include "store/store_cells.h"
#include "support/slot.h"
#include "support/test.h"

enum { SIDE = 32, CELLS = SIDE * SIDE };

// A domain with its hierarchy.
typedef struct joint {
    lac_domain *domain;
    lac_hierarchy *hierarchy;
    lac_heterogeneity_place place;
} joint;

static joint joint_of(size_t nx, size_t ny, const double *pressure)
{
    joint j = {0};
    lac_grid grid = {.nx = nx, .ny = ny, .dx = 0.5, .dy = 0.5, .periodic = false};
    assert_int_equal(lac_domain_create(&grid, pressure, &j.domain, NULL), LAC_OK);
    assert_int_equal(lac_hierarchy_create(j.domain, &j.hierarchy, NULL), LAC_OK);
    j.place = (lac_heterogeneity_place){j.domain, j.hierarchy};
    return j;
}

static joint full_joint(size_t nx, size_t ny)
{
    double pressure[CELLS];
    for (size_t i = 0; i < nx * ny; i++) {
        pressure[i] = 1e6;
    }
    return joint_of(nx, ny, pressure);
}

static void joint_clear(joint *j)
{
    lac_hierarchy_free(j->hierarchy);
    lac_domain_free(j->domain);
}

static lac_heterogeneity spread_of(const char *name)
{
    static char key[] = "dc";
    lac_heterogeneity spread = {.key = key};
    for (size_t i = 0; lac_heterogeneity_kind_get(i) != NULL; i++) {
        const lac_model_info *info = &lac_heterogeneity_kind_get(i)->info;
        if (strcmp(info->name, name) == 0) {
            assert_int_equal(lac_model_create(info, &spread.model, NULL), LAC_OK);
            return spread;
        }
    }
    fail_msg("no spread %s", name);
    return spread;
}

static lac_heterogeneity random_spread(const char *name, double width, int64_t seed)
{
    lac_heterogeneity spread = spread_of(name);
    lac_heterogeneity_random *p = spread.model.params;
    p->width = width;
    p->seed = seed;
    return spread;
}

static lac_status fill(const joint *j, lac_heterogeneity *spreads, size_t count, double nominal,
                       double *values, lac_error *err)
{
    lac_heterogeneity_list list = {.count = count, .item = spreads};
    return lac_heterogeneity_fill(&j->place, &list, "dc", "m", nominal, values, err);
}

static double phi(double z) { return 0.5 * erfc(-z / sqrt(2)); }

static double cdf_lognormal(double x, double width) { return phi(log(x) / width); }
static double cdf_normal(double x, double width) { return phi((x - 1) / width); }
static double cdf_uniform(double x, double width) { return (x - 1 + width) / (2 * width); }
static double cdf_weibull(double x, double width) { return -expm1(-pow(x, width)); }
static double cdf_exponential(double x, double width)
{
    (void)width;
    return -expm1(-x);
}

static const struct {
    const char *name;
    double width, lowest, highest; // a range that cuts both tails
    double (*cdf)(double x, double width);
} known[] = {{"lognormal", 0.5, 0.6, 1.5, cdf_lognormal},
             {"normal", 0.2, 0.9, 1.3, cdf_normal},
             {"uniform", 0.5, 0.7, 1.4, cdf_uniform},
             {"weibull", 3, 0.5, 1.2, cdf_weibull},
             {"exponential", 1, 0.1, 2, cdf_exponential}};
enum { KNOWN = sizeof known / sizeof known[0] };

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// Kolmogorov and Smirnov's distance to the distribution between the limits, times sqrt(n).
static double distance(double *values, size_t k, double lowest, double highest)
{
    double low = known[k].cdf(lowest, known[k].width), worst = 0;
    double span = (isinf(highest) ? 1 : known[k].cdf(highest, known[k].width)) - low;
    qsort(values, CELLS, sizeof *values, by_value);
    for (size_t i = 0; i < CELLS; i++) {
        double want = (known[k].cdf(values[i] / 3, known[k].width) - low) / span;
        worst =
            fmax(worst, fmax(fabs(want - (double)i / CELLS), fabs(want - (double)(i + 1) / CELLS)));
    }
    return worst * sqrt(CELLS);
}

static void distributions_are_as_said(void **state)
{
    (void)state;
    joint j = full_joint(SIDE, SIDE);
    double values[CELLS];
    size_t drawn = 0;
    for (size_t i = 0; lac_heterogeneity_kind_get(i) != NULL; i++) {
        drawn += lac_heterogeneity_kind_get(i)->draw != NULL;
    }
    assert_int_equal(drawn, KNOWN);
    for (size_t k = 0; k < KNOWN; k++) {
        lac_heterogeneity spread = random_spread(known[k].name, known[k].width, 5);
        lac_heterogeneity_random *p = spread.model.params;
        double floor = strcmp(known[k].name, "uniform") == 0  ? 1 - known[k].width
                       : strcmp(known[k].name, "normal") == 0 ? -INFINITY
                                                              : 0;
        assert_int_equal(fill(&j, &spread, 1, 3, values, NULL), LAC_OK);
        assert_true(distance(values, k, floor, INFINITY) < 1.63); // passed by 99 % of samples
        p->lowest = known[k].lowest;
        p->highest = known[k].highest;
        assert_int_equal(fill(&j, &spread, 1, 3, values, NULL), LAC_OK);
        assert_true(distance(values, k, p->lowest, p->highest) < 1.63);
        assert_true(values[0] >= 3 * p->lowest && values[CELLS - 1] <= 3 * p->highest);
        lac_model_clear(&spread.model);
    }
    joint_clear(&j);
}

// FNV-1a
static uint64_t hash_of(const char *key)
{
    uint64_t hash = 14695981039346656037u;
    for (; *key != '\0'; key++) {
        hash = (hash ^ (unsigned char)*key) * 1099511628211u;
    }
    return hash;
}

static void numbers_are_those_of_the_place(void **state)
{
    (void)state;
    joint j = full_joint(8, 8);
    double values[64], normal[2];
    const uint64_t key = hash_of("dc");
    lac_heterogeneity spread = random_spread("lognormal", 0.3, 9);
    assert_int_equal(fill(&j, &spread, 1, 2, values, NULL), LAC_OK);
    for (size_t i = 0; i < 64; i++) {
        lac_random_normal(9, LAC_STREAM_SPREAD, j.domain->index[i], key, normal);
        assert_true(values[i] == 2 * exp(0.3 * normal[0]));
    }
    lac_model_clear(&spread.model);
    joint_clear(&j);
}

// A case of 4 x 4 cells: all that may vary of a law is given, 0.01 in SI if not what stands in its
// row, and one parameter is spread.
static lac_case *spread_case(const lac_model_info *law, const char *key)
{
    char text[2048], list[1024] = "";
    lac_case *c = NULL;
    lac_case_issues report;
    const lac_case_request how = {LAC_FOR_RUN, NULL, 0};
    for (size_t k = 0; k < law->param_count; k++) {
        const lac_param *p = &law->params[k];
        const size_t used = strlen(list);
        if ((p->flags & LAC_CELLWISE) != 0) {
            (void)snprintf(list + used, sizeof list - used, "%s%s: \"%g %s\"", used > 0 ? ", " : "",
                           p->key, isnan(p->fallback) ? 0.01 : p->fallback, p->unit);
        }
    }
    (void)snprintf(text, sizeof text,
                   "lacuna: 1\n"
                   "interface: {size: \"4 m\", levels: 2, domain: {full: {}}}\n"
                   "load: {normal: {pressure: \"1 MPa\"}}\n"
                   "friction: {%s: {%s}, spread: {%s: {lognormal: {sigma: 0.3, seed: 9}}}}\n"
                   "initial: {slip_rate: \"1 um/s\", state: steady}\n"
                   "inertia: {mass_per_area: \"5e5 kg/m2\"}\n" // for flash heating
                   "time: {end: \"1 s\"}\n",
                   law->name, list, key);
    if (lac_case_read_text("case.yaml", text, strlen(text), &how, &c, &report, NULL) != LAC_OK) {
        fail_msg("%s", text);
    }
    lac_case_issues_clear(&report);
    return c;
}

// Whatever may vary does, the last row of a law's table as well as the first.
static void every_parameter_of_a_law_spreads(void **state)
{
    (void)state;
    for (size_t i = 0; lac_friction_law_get(i) != NULL; i++) {
        const lac_model_info *law = &lac_friction_law_get(i)->info;
        for (size_t k = 0; k < law->param_count; k++) {
            const lac_param *p = &law->params[k];
            if ((p->flags & LAC_CELLWISE) == 0) {
                continue;
            }
            lac_scene *scene = NULL;
            lac_case *c = spread_case(law, p->key);
            assert_int_equal(lac_scene_create(c, NULL, &scene, NULL), LAC_OK);
            const lac_cellwise *has = lac_friction_values_of(scene->friction, p->key);
            for (size_t cell = 0; cell < 16; cell++) {
                double normal[2], middle = isnan(p->fallback) ? 0.01 : p->fallback;
                lac_random_normal(9, LAC_STREAM_SPREAD, scene->contact.domain->index[cell],
                                  hash_of(p->key), normal);
                assert_true(lac_cellwise_of(has, cell) == middle * exp(0.3 * normal[0]));
            }
            lac_scene_free(scene);
            lac_case_free(c);
        }
    }
}

// Spreads of one parameter multiply; two alike draw numbers of their own.
static void spreads_multiply(void **state)
{
    (void)state;
    joint j = full_joint(SIDE, SIDE);
    static double one[CELLS], both[CELLS], same[CELLS];
    lac_heterogeneity spreads[2] = {random_spread("normal", 0.1, 4), spread_of("size")};
    lac_heterogeneity_size *size = spreads[1].model.params;
    size->reference = 4;
    size->exponent = 2;
    assert_int_equal(fill(&j, spreads, 1, 2, one, NULL), LAC_OK);
    assert_int_equal(fill(&j, spreads, 2, 2, both, NULL), LAC_OK);
    double covariance = 0;
    lac_heterogeneity twice[2] = {spreads[0], spreads[0]};
    assert_int_equal(fill(&j, twice, 2, 2, same, NULL), LAC_OK);
    for (size_t i = 0; i < CELLS; i++) {
        assert_true(fabs(both[i] / one[i] - 16) < 1e-12); // a patch of 16 m
        covariance += (one[i] / 2 - 1) * (same[i] / one[i] - 1) / CELLS;
    }
    assert_true(fabs(covariance) < 0.1 * 0.1 * 0.1);
    lac_model_clear(&spreads[0].model);
    lac_model_clear(&spreads[1].model);
    joint_clear(&j);
}

// Patches touch by sides or corners; full blocks are those of the grid.
static void sizes_are_those_of_patches_and_blocks(void **state)
{
    (void)state;
    static const char *const touching[8] = {"####..#.", "####....", "####....", "####....",
                                            "....#...", ".##.....", "###.....", ".......#"};
    static const char *const block[8] = {"8888..2.", "8888....", "8888....", "8888....",
                                         "....2...", ".22.....", "222.....", ".......2"};
    static const size_t patch[] = {17, 1, 5, 1};
    double pressure[64], size[64];
    for (size_t i = 0; i < 64; i++) {
        pressure[i] = touching[i / 8][i % 8] == '#' ? 1 : 0;
    }
    joint j = joint_of(8, 8, pressure);
    assert_int_equal(lac_heterogeneity_sizes(&j.place, LAC_SIZE_BLOCK, size, NULL), LAC_OK);
    for (size_t i = 0; i < j.domain->n; i++) {
        size_t at = j.domain->index[i];
        assert_true(size[i] == 0.25 * (block[at / 8][at % 8] - '0')); // cells of 0.5 m
    }
    assert_int_equal(lac_heterogeneity_sizes(&j.place, LAC_SIZE_PATCH, size, NULL), LAC_OK);
    for (size_t i = 0; i < j.domain->n; i++) {
        size_t at = j.domain->index[i], x = at % 8, y = at / 8;
        size_t which = y == 0 && x == 6 ? 1 : y == 7 ? 3 : y > 4 ? 2 : 0;
        assert_true(fabs(size[i] - 0.5 * sqrt((double)patch[which])) < 1e-15);
    }
    joint_clear(&j);

    // on a line two neighbours are a block of twice the length
    joint line = joint_of(8, 1, (double[]){1, 1, 1, 1, 0, 1, 1, 1});
    static const double lengths[] = {2, 2, 2, 2, 0.5, 1, 1};
    assert_int_equal(lac_heterogeneity_sizes(&line.place, LAC_SIZE_BLOCK, size, NULL), LAC_OK);
    assert_memory_equal(size, lengths, sizeof lengths);
    joint_clear(&line);
}

static void impossible_ranges_are_refused(void **state)
{
    (void)state;
    joint j = full_joint(8, 8);
    double values[64];
    lac_error err;
    lac_heterogeneity spread = random_spread("lognormal", 0.1, 1);
    lac_heterogeneity_random *p = spread.model.params;
    p->lowest = 3;
    assert_int_equal(fill(&j, &spread, 1, 1, values, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "none of 1000 factors"));
    p->highest = 2;
    assert_non_null(spread.model.info->validate(p));
    lac_model_clear(&spread.model);
    joint_clear(&j);
}

// A file with one variable over two dimensions; NULL: that attribute or axis is left out.
static void write_map(const char *path, const char *const dim[2], const size_t length[2],
                      const char *unit, const double *values, bool falling)
{
    int id, dims[2], var, axis;
    size_t rank = dim[1] != NULL ? 2 : 1;
    assert_int_equal(nc_create(path, NC_NETCDF4 | NC_CLOBBER, &id), NC_NOERR);
    for (size_t k = 0; k < rank; k++) {
        assert_int_equal(nc_def_dim(id, dim[k], length[k], &dims[k]), NC_NOERR);
    }
    assert_int_equal(nc_def_var(id, dim[0], NC_DOUBLE, 1, dims, &axis), NC_NOERR);
    assert_int_equal(nc_def_var(id, "dc", NC_DOUBLE, (int)rank, dims, &var), NC_NOERR);
    if (unit != NULL) {
        assert_int_equal(nc_put_att_text(id, var, "units", strlen(unit), unit), NC_NOERR);
    }
    for (size_t i = 0; i < length[0]; i++) {
        double at = falling ? -(double)i : (double)i;
        assert_int_equal(nc_put_var1_double(id, axis, &i, &at), NC_NOERR);
    }
    assert_int_equal(nc_put_var_double(id, var, values), NC_NOERR);
    assert_int_equal(nc_close(id), NC_NOERR);
}

static const char *const yx[2] = {"y", "x"}, *const xy[2] = {"x", "y"}, *const cell[2] = {"cell"};

static void maps_are_read_in_any_shape(void **state)
{
    (void)state;
    char path[] = "/tmp/lacuna-map-XXXXXX";
    int fd = mkstemp(path);
    double pressure[6] = {1, 0, 1, 1, 1, 0}, got[4];
    double stored[6] = {10, 11, 12, 20, 21, 22}, turned[6] = {10, 20, 11, 21, 12, 22};
    joint j = joint_of(3, 2, pressure);
    lac_map_def def = {.path = path, .unit = "m"};
    assert_true(fd >= 0);
    for (int k = 0; k < 3; k++) {
        double by_cell[4];
        for (size_t i = 0; i < j.domain->n; i++) {
            by_cell[i] = stored[j.domain->index[i]];
        }
        write_map(path,
                  k == 0   ? yx
                  : k == 1 ? xy
                           : cell,
                  k == 0   ? (size_t[]){2, 3}
                  : k == 1 ? (size_t[]){3, 2}
                           : (size_t[]){4, 0},
                  "mm",
                  k == 0   ? stored
                  : k == 1 ? turned
                           : by_cell,
                  false);
        assert_int_equal(lac_map_read(&def, j.domain, got, NULL), LAC_OK);
        for (size_t i = 0; i < j.domain->n; i++) {
            assert_true(fabs(got[i] - 1e-3 * stored[j.domain->index[i]]) < 1e-15);
        }
    }
    lac_heterogeneity spread = spread_of("map");
    lac_heterogeneity_map *map = spread.model.params;
    double values[4];
    map->path = strdup(path);
    assert_int_equal(fill(&j, &spread, 1, NAN, values, NULL), LAC_OK); // no nominal value
    assert_memory_equal(values, got, sizeof got);
    lac_model_clear(&spread.model);
    joint_clear(&j);
    (void)close(fd);
    (void)unlink(path);
}

static void wrong_maps_are_told(void **state)
{
    (void)state;
    char path[] = "/tmp/lacuna-map-XXXXXX";
    int fd = mkstemp(path);
    double stored[6] = {10, 11, 12, NAN, 21, 22}, got[6];
    lac_error err;
    joint j = full_joint(3, 2);
    lac_map_def def = {.path = path, .unit = "m"};
    static const struct {
        size_t length[2];
        const char *unit;
        bool falling;
        const char *said;
    } wrong[] = {{{3, 2}, "m", false, "must be numbers over (y, x) = (2, 3)"},
                 {{2, 3}, "s", false, "must be a length"},
                 {{2, 3}, NULL, false, "has no units"},
                 {{2, 3}, "m", true, "must rise"},
                 {{2, 3}, "m", false, "no value at ix = 0, iy = 1"}};
    assert_true(fd >= 0);
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        write_map(path, yx, wrong[k].length, wrong[k].unit, stored, wrong[k].falling);
        assert_int_equal(lac_map_read(&def, j.domain, got, &err), LAC_EINPUT);
        if (strstr(err.message, wrong[k].said) == NULL) {
            fail_msg("\"%s\" does not say \"%s\"", err.message, wrong[k].said);
        }
    }
    def.variable = "none";
    assert_int_equal(lac_map_read(&def, j.domain, got, &err), LAC_EINPUT);
    assert_int_equal(ftruncate(fd, 300), 0);
    assert_int_equal(lac_map_read(&def, j.domain, got, &err), LAC_EIO);
    assert_int_equal(ftruncate(fd, 0), 0);
    assert_int_equal(lac_map_read(&def, j.domain, got, &err), LAC_EIO);
    (void)close(fd);
    (void)unlink(path);
    assert_int_equal(lac_map_read(&def, j.domain, got, &err), LAC_EIO);
    joint_clear(&j);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distributions_are_as_said),
        cmocka_unit_test(numbers_are_those_of_the_place),
        cmocka_unit_test(every_parameter_of_a_law_spreads),
        cmocka_unit_test(spreads_multiply),
        cmocka_unit_test(sizes_are_those_of_patches_and_blocks),
        cmocka_unit_test(impossible_ranges_are_refused),
        cmocka_unit_test(maps_are_read_in_any_shape),
        cmocka_unit_test(wrong_maps_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
