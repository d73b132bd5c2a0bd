// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces, transforms, contacts and their domains of ranks against those of one, to the bit.
#include "base/fft.h"
#include "base/filter.h"
#include "contact/contact.h"
#include "fractal/fractal.h"
#include "support/ranks.h"
#include "support/test.h"
#include "surface/surface.h"
#include "transfer/compliance.h"

// What a rank may still allocate; the linker hands the library's calls to these.
static _Thread_local long left = LONG_MAX;

void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_aligned_alloc(size_t align, size_t size);
void *__wrap_malloc(size_t size) { return left-- == 0 ? NULL : __real_malloc(size); }
void *__wrap_calloc(size_t n, size_t size) { return left-- == 0 ? NULL : __real_calloc(n, size); }
void *__wrap_aligned_alloc(size_t align, size_t size)
{
    return left-- == 0 ? NULL : __real_aligned_alloc(align, size);
}

static const int numbers[] = {3, 1, 2, 5, 8};

// One field of what a body makes on a grid: of each rank its rows.
typedef struct field {
    size_t nx, ny;
    double *values;
} field;

// All numbers of ranks against one.
static void compare(size_t nx, size_t ny, size_t values,
                    void (*body)(lac_team *team, void *context), void *context, field *out)
{
    const size_t n = nx * ny * values;
    double *one = calloc(n, sizeof *one), *many = malloc(n * sizeof *many);
    *out = (field){nx, ny, one};
    (void)ranks_do(0, body, context);
    out->values = many;
    for (size_t k = 0; k < test_some(sizeof numbers / sizeof *numbers); k++) {
        memset(many, 0, n * sizeof *many);
        (void)ranks_do(numbers[k], body, context);
        assert_memory_equal(many, one, n * sizeof *one);
    }
    free(one);
    free(many);
}

static double uniform(size_t i)
{
    uint64_t z = (i + 1) * UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53 - 0.5;
}

static void transform_back(lac_team *team, void *context)
{
    const field *out = context;
    lac_fft *fft = NULL;
    assert_int_equal(lac_fft_share(out->nx, out->ny, team, &fft, NULL), LAC_OK);
    const size_t wide = fft->nkx, first = fft->strip.first;
    for (size_t i = 0; i < wide * fft->strip.n; i++) {
        fft->spectrum[i] = uniform(first * wide + i) + uniform(first * wide + i + 7) * I;
    }
    lac_fft_inverse(fft);
    memcpy(&out->values[first * out->nx], fft->real, out->nx * fft->strip.n * sizeof(double));
    lac_fft_free(fft);
}

// The rock's tables and its filter, as its calibration and the elastic transfer use them.
static void transform_table(lac_team *team, void *context)
{
    const field *out = context;
    lac_fft *fft = NULL;
    assert_int_equal(lac_fft_share(out->nx, out->ny, team, &fft, NULL), LAC_OK);
    for (size_t i = 0; i < out->nx * fft->strip.n; i++) {
        fft->real[i] = uniform(fft->strip.first * out->nx + i);
    }
    lac_fft_table(fft, &out->values[fft->columns.first * out->ny]); // nx/2 + 1 < nx of them
    lac_fft_free(fft);
}

static void pass_filter(lac_team *team, void *context)
{
    const field *out = context;
    const size_t mx = 2 * out->nx, my = 2 * out->ny;
    lac_fft *fft = NULL;
    if (team == NULL) {
        assert_int_equal(lac_fft_create(mx, my, &fft, NULL), LAC_OK);
        assert_int_equal(lac_fft_plan_filter(fft, out->ny, NULL), LAC_OK);
    } else {
        assert_int_equal(lac_fft_share_filter(mx, my, out->ny, team, &fft, NULL), LAC_OK);
    }
    const lac_strip rows = lac_strip_rows(team, out->ny);
    double *table = malloc((fft->columns.n * my + 1) * sizeof *table);
    for (size_t i = 0; i < fft->columns.n * my; i++) {
        table[i] = uniform(fft->columns.first * my + i);
    }
    memset(fft->real, 0, mx * rows.n * sizeof *fft->real);
    for (size_t j = 0; j < rows.n; j++) {
        for (size_t i = 0; i < out->nx; i++) {
            fft->real[j * mx + i] = uniform((rows.first + j) * out->nx + i);
        }
    }
    lac_fft_filter(fft, table);
    for (size_t j = 0; j < rows.n; j++) {
        memcpy(&out->values[(rows.first + j) * out->nx], &fft->real[j * mx],
               out->nx * sizeof *table);
    }
    free(table);
    lac_fft_free(fft);
}

static void transform_even(lac_team *team, void *context)
{
    const field *out = context;
    const lac_strip rows = lac_filter_columns(team, out->ny);
    double *own = &out->values[rows.first * out->nx];
    for (size_t i = 0; i < rows.n * out->nx; i++) {
        own[i] = uniform(rows.first * out->nx + i);
    }
    assert_int_equal(lac_fft_share_even(&rows, out->nx, false, own, NULL), LAC_OK);
}

// FFTW's plans in two dimensions and those in one that ranks have.
static void transforms_have_the_bits_of_one(void **state)
{
    const size_t sides[][2] = {{8, 8},    {32, 32},  {64, 64},  {33, 65}, {96, 20},
                               {100, 45}, {128, 90}, {243, 50}, {17, 6},  {2, 40}};
    (void)state;
    for (size_t k = 0; k < sizeof sides / sizeof *sides; k++) {
        field out;
        compare(sides[k][0], sides[k][1], 1, transform_back, &out, &out);
        compare(sides[k][0], sides[k][1], 1, transform_even, &out, &out);
        compare(sides[k][0], sides[k][1], 2, transform_table, &out, &out);
        compare(sides[k][0], sides[k][1], 1, pass_filter, &out, &out);
    }
}

static const lac_model_info *source(const char *name)
{
    size_t i = 0;
    while (strcmp(lac_surface_source_get(i)->info.name, name) != 0) {
        i++;
    }
    return &lac_surface_source_get(i)->info;
}

// A rough joint, what is asked of it, and its heights, pressures and gaps, one after the other.
typedef struct joint {
    field out;
    lac_grid grid;
    lac_self_affine rough;
    bool benchmark;
    lac_contact_control control;
    double pressure, dimension; // [Pa]; 0: the pressure is given
} joint;

static void make_heights(const joint *j, lac_team *team, double *heights)
{
    lac_benchmark given = {LAC_BENCHMARK_A08, NAN, 0.002, 3};
    lac_self_affine rough = j->rough;
    const lac_model model = {source(j->benchmark ? "benchmark" : "self-affine"),
                             j->benchmark ? (void *)&given : (void *)&rough};
    assert_int_equal(lac_surface_share(&model, &j->grid, team, heights, NULL, NULL), LAC_OK);
}

static void check_domain(const joint *j, lac_team *team, const double *pressure)
{
    lac_domain *domain = NULL;
    const size_t n = lac_grid_cells(&j->grid);
    size_t found = 0;
    assert_int_equal(lac_domain_gather(&j->grid, team, pressure, &domain, NULL), LAC_OK);
    for (size_t i = 0; i < domain->n; i++) {
        const uint32_t at = domain->index[i];
        const double p = j->out.values[n + at];
        assert_memory_equal(&domain->pressure[i], &p, sizeof p);
    }
    for (size_t i = 1; i < domain->n; i++) {
        const size_t a = domain->index[i - 1], b = domain->index[i], nx = j->grid.nx;
        assert_true(lac_morton((uint32_t)(a % nx), (uint32_t)(a / nx)) <
                    lac_morton((uint32_t)(b % nx), (uint32_t)(b / nx)));
    }
    for (size_t i = 0; i < n; i++) {
        found += j->out.values[n + i] > 0.0;
    }
    assert_int_equal(domain->n, found);
    lac_domain_free(domain);
}

static void press(lac_team *team, void *context)
{
    const joint *j = context;
    const lac_strip rows = lac_strip_rows(team, j->grid.ny);
    const size_t n = lac_grid_cells(&j->grid), first = rows.first * j->grid.nx;
    double *heights = &j->out.values[first];
    lac_contact_stats found;
    lac_error err = {""};
    make_heights(j, team, heights);
    lac_contact_def def = lac_contact_default();
    def.grid = j->grid;
    def.team = team;
    def.heights = heights;
    def.e_star = 1e9;
    def.control = j->control;
    def.mean_pressure = j->pressure;
    def.approach = 0.002;
    const lac_status status =
        j->dimension > 0.0
            ? lac_dimension_solve(&def, j->dimension, heights + n, heights + 2 * n, &found, &err)
            : lac_contact_solve(&def, heights + n, heights + 2 * n, &found, &err);
    assert_string_equal(err.message, "");
    assert_int_equal(status, LAC_OK);
    uint64_t nothing = 0;
    if (team != NULL) {
        team->join(team, &nothing, 1); // all have written
    }
    check_domain(j, team, heights + n);
}

static void contacts_have_the_bits_of_one(void **state)
{
    (void)state;
    const lac_self_affine rough = {.hurst = 0.8,
                                   .rms_height = 1e-3,
                                   .rms_slope = NAN,
                                   .rolloff = NAN,
                                   .shortest = NAN,
                                   .seed = 3,
                                   .anisotropy = 1.0};
    lac_self_affine skewed = rough, point = rough;
    skewed.skewness = -0.7;
    point.sampling = 1;
    point.shortest = 0.02;
    const joint joints[] = {
        {.grid = {64, 64, 0.01, 0.01, true}, .rough = rough, .pressure = 1e6},
        {.grid = {64, 64, 0.01, 0.01, false}, .rough = rough, .pressure = 1e6},
        {.grid = {70, 45, 0.01, 0.02, false}, .rough = skewed, .control = LAC_CONTROL_APPROACH},
        {.grid = {70, 45, 0.01, 0.02, true}, .rough = skewed, .control = LAC_CONTROL_APPROACH},
        {.grid = {40, 33, 0.02, 0.02, true}, .rough = point, .pressure = 1e12}, // full
        {.grid = {64, 64, 0.01, 0.01, true}, .rough = rough, .dimension = 1.5},
        {.grid = {64, 64, 0.01, 0.01, true}, .benchmark = true, .pressure = 1e6},
        {.grid = {64, 1, 0.01, 0.01, true}, .rough = rough, .pressure = 1e6},
        {.grid = {4, 6, 0.2, 0.2, false}, .rough = rough, .pressure = 1e6},
        {.grid = {100, 37, 0.01, 0.02, false}, .rough = skewed, .pressure = 1e5},
    };
    for (size_t k = 0; k < sizeof joints / sizeof *joints; k++) {
        joint j = joints[k];
        compare(j.grid.nx, j.grid.ny, 3, press, &j, &j.out);
    }
}

// What is wrong on one rank is said by all, and an error has one place.
typedef struct wrong {
    lac_grid grid;
    int rank;
    lac_error err[8];
} wrong;

static void refuse(lac_team *team, void *context)
{
    wrong *w = context;
    double heights[16 * 16] = {0}, pressure[16 * 16];
    lac_contact_def def = lac_contact_default();
    def.grid = w->grid;
    def.team = team;
    def.heights = heights;
    def.e_star = 1.0;
    def.mean_pressure = (int)team->rank == w->rank ? (double)NAN : 1.0;
    assert_int_equal(lac_contact_solve(&def, pressure, NULL, NULL, &w->err[team->rank]),
                     LAC_EINPUT);
}

static void an_error_of_one_is_that_of_all(void **state)
{
    (void)state;
    wrong w = {.grid = {16, 16, 1.0, 1.0, true}, .rank = 5};
    (void)ranks_do(8, refuse, &w);
    for (int rank = 0; rank < 8; rank++) {
        assert_non_null(strstr(w.err[rank].message, "mean pressure"));
    }
}

// One rank of three finds no memory for its k-th array: all must say so, and none wait.
typedef struct want {
    lac_status (*make)(lac_team *team);
    long k;
    lac_status status[3];
} want;

static void run_short(lac_team *team, void *context)
{
    want *w = context;
    left = team->rank == 1 ? w->k : LONG_MAX;
    const lac_status status = w->make(team);
    left = LONG_MAX;
    w->status[team->rank] = lac_team_agree(team, status, NULL);
}

static lac_status make_transform(lac_team *team)
{
    lac_fft *fft = NULL;
    const lac_status status = lac_fft_share(16, 16, team, &fft, NULL);
    if (status == LAC_OK) {
        lac_fft_inverse(fft);
    }
    lac_fft_free(fft);
    return status;
}

static lac_status make_contact(lac_team *team)
{
    double heights[16 * 16] = {0}, pressure[16 * 16];
    lac_contact_def def = lac_contact_default();
    def.grid = (lac_grid){16, 16, 1.0, 1.0, false};
    heights[3] = 1e-3;
    def.team = team;
    def.heights = heights;
    def.e_star = def.mean_pressure = 1.0;
    return lac_contact_solve(&def, pressure, NULL, NULL, NULL);
}

enum { TOUCHING = 600 };

// Slip and traction of rock. @param x  [2 * TOUCHING]
static lac_status strain(lac_team *team, bool periodic, double *x)
{
    uint32_t index[TOUCHING];
    for (uint32_t i = 0; i < TOUCHING; i++) {
        index[i] = i * (256 * 256 / TOUCHING);
        x[i] = x[TOUCHING + i] = uniform(i);
    }
    const lac_domain domain = {
        .grid = {256, 256, 1.0, 1.0, periodic}, .n = TOUCHING, .index = index};
    const lac_rock rock = {
        .shear_modulus = 1.0, .poisson = 0.25, .thickness = INFINITY, .team = team};
    lac_compliance *c = NULL;
    const lac_status status = lac_compliance_create(&domain, &rock, &c, NULL);
    if (status == LAC_OK) {
        lac_compliance_slip(c, x, x);
        lac_compliance_traction(c, x + TOUCHING, x + TOUCHING);
    }
    lac_compliance_free(c);
    return status;
}

static lac_status make_rock(lac_team *team)
{
    double x[2 * TOUCHING];
    return strain(team, false, x);
}

static void strain_both(lac_team *team, void *context)
{
    const field *out = context;
    double x[2 * TOUCHING];
    for (size_t k = 0; k < 2; k++) {
        assert_int_equal(strain(team, k == 1, x), LAC_OK);
        memcpy(&out->values[2 * k * TOUCHING], x, sizeof x); // every rank has all
    }
}

static void rock_has_the_bits_of_one(void **state)
{
    field out;
    (void)state;
    compare(TOUCHING, 4, 1, strain_both, &out, &out);
}

static void none_waits_for_a_rank_without_memory(void **state)
{
    lac_status (*const makes[])(lac_team *) = {make_transform, make_contact, make_rock};
    (void)state;
    for (size_t i = 0; i < sizeof makes / sizeof *makes; i++) {
        want w = {makes[i], 0, {LAC_ENOMEM}};
        for (w.k = 0; w.k < 1000 && w.status[0] != LAC_OK; w.k++) {
            (void)ranks_do(3, run_short, &w);
            assert_int_equal(w.status[0], w.status[1]);
            assert_int_equal(w.status[0], w.status[2]);
            assert_true(w.status[0] == LAC_OK || w.status[0] == LAC_ENOMEM);
        }
        assert_true(w.k > 4 && w.status[0] == LAC_OK);
    }
}

static void fill_row(void *context, size_t j, void *row)
{
    const field *of = context;
    memset(row, 0, of->nx * sizeof(float));
    ((float *)row)[0] = (float)j;
}

static void even_symbol(const void *context, size_t k, void *factor)
{
    const field *of = context;
    for (size_t j = 0; j <= of->ny; j++) {
        ((float *)factor)[j] = (float)k;
    }
}

static void filter(lac_team *team, void *context)
{
    const field *of = context;
    lac_filter *f = NULL;
    const size_t sides[] = {of->nx, of->ny}, twice[] = {2 * of->nx, 2 * of->ny};
    assert_int_equal(lac_filter_create(sides, twice, team, &f, NULL), LAC_OK);
    for (size_t part = 0; part < lac_filter_parts(f, LAC_SINGLE); part++) {
        lac_filter_fill(f, LAC_SINGLE, part, fill_row, context);
        (void)lac_filter_power(f, even_symbol, context);
        lac_filter_multiply(f, even_symbol, context, NULL);
    }
    lac_filter_free(f);
}

// docs/howto-cluster.md, "What a step sends".
static void a_transform_tells_what_the_page_says(void **state)
{
    (void)state;
    double values[64 * 48];
    field of = {64, 48, NULL}, out = {64, 48, values};
    for (size_t ranks = 2; ranks <= 8; ranks *= 2) {
        const size_t all = 3 * 8 * of.ny * (of.nx + 1);
        assert_int_equal(ranks_do((int)ranks, filter, &of), all / ranks * (ranks - 1));
        const size_t rock = 2 * 16 * of.ny * (of.nx + 1);
        assert_int_equal(ranks_do((int)ranks, pass_filter, &out), rock / ranks * (ranks - 1));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(transforms_have_the_bits_of_one),
        cmocka_unit_test(contacts_have_the_bits_of_one),
        cmocka_unit_test(an_error_of_one_is_that_of_all),
        cmocka_unit_test(rock_has_the_bits_of_one),
        cmocka_unit_test(none_waits_for_a_rank_without_memory),
        cmocka_unit_test(a_transform_tells_what_the_page_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
