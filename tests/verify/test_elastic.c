// SPDX-License-Identifier: GPL-3.0-or-later
// The elastic transfer against plane waves, dense matrices and cracks with closed forms.
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/half_space.h"
#include "support/test.h"
#include "support/trees.h"
#include "transfer/transfer.h"

static const double pi = 3.14159265358979323846;

typedef struct scene {
    rock_def rock;
    lac_domain *domain;
    lac_hierarchy *h;
    lac_transfer transfer;
    size_t n;
    double *x, *y, *d, *work;
} scene;

// What a scene is asked to be beside its rock: antiplane where nu = 0.
typedef struct choice {
    double fraction; // of cells in contact, at random; 2: all
    bool creeping, surface;
    double tolerance;
} choice;

static scene scene_of(lac_grid grid, rock_def rock, choice how)
{
    scene s = {.rock = rock};
    double *pressure = new_doubles(lac_grid_cells(&grid));
    for (size_t i = 0; i < lac_grid_cells(&grid); i++) {
        pressure[i] = draw_uniform(5, i, 0, 1) < how.fraction ? 1 : 0;
    }
    lac_error err = {""};
    assert_int_equal(lac_domain_create(&grid, pressure, &s.domain, &err), LAC_OK);
    free(pressure);
    s.h = hierarchy_of(s.domain);
    s.n = s.domain->n;
    lac_model model = {0};
    for (size_t i = 0; lac_transfer_kind_get(i) != NULL; i++) {
        const lac_model_info *info = &lac_transfer_kind_get(i)->info;
        model.info = strcmp(info->name, "elastic") == 0 ? info : model.info;
    }
    lac_transfer_elastic params = {.mode = rock.nu == 0,
                                   .outside = how.creeping,
                                   .boundary = how.surface,
                                   .thickness = isinf(rock.height) ? (double)NAN : rock.height,
                                   .tolerance = how.tolerance,
                                   .newton_tolerance = how.tolerance};
    model.params = &params;
    // Antiplane must not look at Poisson's ratio.
    lac_transfer_scene from = {s.domain,  s.h,   rock.g, rock.nu == 0 ? 0.4 : rock.nu,
                               rock.line, false, NULL};
    if (lac_transfer_create(&model, &from, &s.transfer, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    s.x = new_doubles(s.n);
    s.y = new_doubles(s.n);
    s.d = new_doubles(s.n);
    s.work = new_doubles(s.transfer.kind->work(s.transfer.state));
    return s;
}

static void scene_free(scene *s)
{
    lac_transfer_clear(&s->transfer);
    lac_hierarchy_free(s->h);
    lac_domain_free(s->domain);
    free(s->x);
    free(s->y);
    free(s->d);
    free(s->work);
}

static void apply(scene *s) { s->transfer.kind->apply(s->transfer.state, s->x, s->y, s->work); }

// Every wave of slip is a wave of traction, S times as high.
static void check_waves(lac_grid grid, rock_def rock)
{
    scene s = scene_of(grid, rock, (choice){2, false, false, 1e-9});
    double worst = 0;
    for (size_t p = 0; p <= grid.nx / 2; p++) {
        for (size_t q = 0; q < grid.ny; q++) {
            double k = wave_stiffness(&rock, &grid, p, q), top = 0;
            for (size_t i = 0; i < s.n; i++) {
                double at_x = (double)(s.domain->index[i] % grid.nx) / (double)grid.nx;
                double at_y = (double)(s.domain->index[i] / grid.nx) / (double)grid.ny;
                s.x[i] = cos(2 * pi * ((double)p * at_x + (double)q * at_y) + 0.3);
                top = fmax(top, fabs(s.x[i]));
            }
            apply(&s);
            for (size_t i = 0; i < s.n; i++) {
                worst = fmax(worst, fabs(s.y[i] - k * s.x[i]) / (rock.g * top));
            }
        }
    }
    print_message("waves on %zu x %zu, nu %g, height %g: %.1e G/r\n", grid.nx, grid.ny, rock.nu,
                  rock.height, worst);
    assert_true(worst < 1e-11);
    scene_free(&s);
}

static void waves_have_closed_forms(void **state)
{
    (void)state;
    const lac_grid line = {31, 1, 1, 1, true}, plane = {13, 17, 1, 1.5, true};
    check_waves(line, (rock_def){2, 0, INFINITY, false});
    check_waves(line, (rock_def){2, 0.3, INFINITY, true});
    check_waves(line, (rock_def){2, 0, 7, true});
    check_waves(line, (rock_def){2, 0.3, 7, true});
    check_waves(line, (rock_def){2, 0.45, 0.4, true});
    check_waves(plane, (rock_def){2, 0, INFINITY, false});
    check_waves(plane, (rock_def){2, 0.25, INFINITY, false});
    check_waves(plane, (rock_def){2, 0.25, 5, false});
    check_waves(plane, (rock_def){2, 0, 5, false});
    check_waves((lac_grid){1, 1, 1, 1, true}, (rock_def){2, 0.25, 5, false});
    check_waves((lac_grid){1, 1, 1, 1, true}, (rock_def){2, 0.25, INFINITY, false});
}

// K, and a solve with D of both signs, against the dense matrix.
static void check_dense(lac_grid grid, rock_def rock, double fraction, double quadrature)
{
    scene s = scene_of(grid, rock, (choice){fraction, false, false, 1e-13});
    size_t n = s.n;
    double *dense = new_doubles(n * n), *expected = new_doubles(n);
    long double *a = calloc(n * n, sizeof *a), *x = calloc(n, sizeof *x);
    assert_true(a != NULL && x != NULL);
    dense_elastic(&rock, s.domain, dense);
    const double k_mean = 0.3;
    for (size_t i = 0; i < n; i++) {
        s.x[i] = draw_uniform(8, i, -1, 1);
        s.d[i] = draw_uniform(9, i, -0.15, 1);
        x[i] = s.x[i];
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            expected[i] += dense[i * n + j] * s.x[j];
            a[i * n + j] = dense[i * n + j] + (i == j ? s.d[i] : 0) + k_mean / (double)n;
        }
    }
    apply(&s);
    double stress = relative_error(n, s.y, expected);
    dense_solve(n, a, x);
    assert_true(s.transfer.kind->solve(s.transfer.state, k_mean, s.d, s.x, s.y, s.work));
    for (size_t i = 0; i < n; i++) {
        expected[i] = (double)x[i];
    }
    double solved = relative_error(n, s.y, expected);
    print_message("%zu cells of %zu x %zu%s: stress off by %.1e, solution by %.1e\n", n, grid.nx,
                  grid.ny, grid.periodic ? "" : ", free", stress, solved);
    assert_true(stress < 1e-11 + quadrature && solved < 1e-9 + 10 * quadrature);
    free(dense);
    free(expected);
    free(a);
    free(x);
    scene_free(&s);
}

static void gaps_slip_freely_as_in_dense_matrices(void **state)
{
    (void)state;
    const rock_def plane = {2, 0.25, INFINITY, false}, line = {2, 0.25, INFINITY, true};
    check_dense((lac_grid){14, 14, 1, 1, true}, plane, 0.5, 0);
    check_dense((lac_grid){17, 11, 1, 0.6, true}, (rock_def){2, 0, INFINITY, false}, 0.3, 0);
    check_dense((lac_grid){67, 1, 1, 1, true}, line, 0.6, 0);
    check_dense((lac_grid){12, 12, 1, 1, true}, (rock_def){2, 0.25, 3, false}, 0.5, 0);
    check_dense((lac_grid){64, 1, 1, 1, true}, (rock_def){2, 0, 9, true}, 0.5, 0);
    check_dense((lac_grid){10, 10, 1, 1, true}, (rock_def){2, 0.25, 3, false}, 2, 0);
    check_dense((lac_grid){12, 12, 1, 1, false}, plane, 0.5, 1e-5);
    check_dense((lac_grid){9, 9, 1, 1, false}, plane, 2, 1e-5);
    check_dense((lac_grid){48, 1, 0.5, 1, false}, line, 0.6, 1e-7);
    check_dense((lac_grid){30, 1, 0.5, 1, false}, line, 2, 1e-7);
    check_dense((lac_grid){30, 1, 0.5, 2, false}, plane, 2, 1e-5); // a strip
}

static void check_definite(double low)
{
    const rock_def rock = {2, 0.25, INFINITY, false};
    scene s = scene_of((lac_grid){10, 10, 1, 1, true}, rock, (choice){0.6, false, false, 1e-10});
    size_t n = s.n, agreed = 0, definite = 0;
    double *dense = new_doubles(n * n);
    long double *a = calloc(n * n, sizeof *a);
    assert_non_null(a);
    dense_elastic(&rock, s.domain, dense);
    for (uint64_t seed = 0; seed < 40; seed++) {
        for (size_t i = 0; i < n; i++) {
            s.d[i] = draw_uniform(seed, i, low * (double)seed / 40, 1);
            s.x[i] = draw_uniform(seed, 1000 + i, -1, 1);
        }
        for (size_t i = 0; i < n * n; i++) {
            a[i] = dense[i] + (i % (n + 1) == 0 ? s.d[i / n] : 0);
        }
        bool is = dense_positive(n, a);
        bool solved = s.transfer.kind->solve(s.transfer.state, 0, s.d, s.x, s.y, s.work);
        definite += is;
        agreed += is == solved;
        assert_true(is || !solved || low > -1);
    }
    print_message("D from %g: %zu of 40 definite, %zu decided alike\n", low, definite, agreed);
    assert_true(agreed >= 34 && definite > 0);
    free(dense);
    free(a);
    scene_free(&s);
}

static void systems_that_are_not_definite_are_refused(void **state)
{
    (void)state;
    check_definite(-0.2);
    check_definite(-3);
}

static void check_uniform(lac_grid grid, rock_def rock, double fraction)
{
    scene s = scene_of(grid, rock, (choice){fraction, false, false, 1e-9});
    double top = 0;
    for (size_t i = 0; i < s.n; i++) {
        s.x[i] = 1 / 3.0;
    }
    apply(&s);
    for (size_t i = 0; i < s.n; i++) {
        top = fmax(top, fabs(s.y[i]));
    }
    assert_true(top <= 1e-12 * rock.g / grid.dx);
    for (size_t i = 0; i < s.n; i++) {
        s.x[i] += draw_uniform(4, i, -1, 1);
    }
    apply(&s);
    double sum = 0, size = 0;
    for (size_t i = 0; i < s.n; i++) {
        sum += s.y[i];
        size += fabs(s.y[i]);
    }
    assert_true(fabs(sum) <= 1e-14 * size);
    scene_free(&s);
}

static void uniform_slip_costs_nothing_and_forces_balance(void **state)
{
    (void)state;
    const rock_def plane = {2, 0.25, INFINITY, false}, line = {2, 0.25, INFINITY, true};
    for (int periodic = 0; periodic < 2; periodic++) {
        check_uniform((lac_grid){32, 32, 1, 1, periodic == 1}, plane, 2);
        check_uniform((lac_grid){37, 23, 1, 1, periodic == 1}, plane, 0.1);
        check_uniform((lac_grid){128, 1, 1, 1, periodic == 1}, line, 0.4);
        check_uniform((lac_grid){64, 64, 1, 1, periodic == 1}, plane, 1e-3); // a few cells
        check_uniform((lac_grid){1, 1, 1, 1, periodic == 1}, plane, 2);
    }
}

// Slips that differ by little, down to rounding: the stress of what they differ by, which the
// difference from one of them gives exactly.
static void check_alike(lac_grid grid, rock_def rock, double tolerance)
{
    scene s = scene_of(grid, rock, (choice){0.6, false, false, tolerance});
    double *of_all = new_doubles(s.n);
    for (uint64_t seed = 0; seed < 60; seed++) {
        const double mean = draw_uniform(seed, 1000, 0.1, 1);
        const double spread = pow(10, -10 - (double)(seed % 7));
        double size = 0, off = 0;
        for (size_t i = 0; i < s.n; i++) {
            s.x[i] = mean * (1 + spread * draw_uniform(seed, i, -1, 1));
        }
        apply(&s);
        memcpy(of_all, s.y, s.n * sizeof *of_all);
        for (size_t i = s.n; i-- > 0;) {
            s.x[i] -= s.x[0];
        }
        apply(&s);
        for (size_t i = 0; i < s.n; i++) {
            assert_true(isfinite(of_all[i]) && isfinite(s.y[i]));
            size = fmax(size, fabs(s.y[i]));
            off = fmax(off, fabs(of_all[i] - s.y[i]));
        }
        const double rounding = 4 * DBL_EPSILON * mean * rock.g / grid.dx;
        assert_true(off <= 100 * tolerance * size + rounding);
    }
    free(of_all);
    scene_free(&s);
}

static void slips_that_hardly_differ_have_their_stress(void **state)
{
    (void)state;
    const rock_def plane = {2, 0.25, INFINITY, false}, line = {2, 0.25, INFINITY, true};
    for (int periodic = 0; periodic < 2; periodic++) {
        for (double tolerance = 1e-9; tolerance > 1e-13; tolerance /= 1000) {
            check_alike((lac_grid){16, 16, 0.5, 0.5, periodic == 1}, plane, tolerance);
            check_alike((lac_grid){128, 1, 1, 1, periodic == 1}, line, tolerance);
        }
    }
}

// Outside creeping: the traction that slip of one cell puts on the others, by quadrature.
static void check_creeping(lac_grid grid, rock_def rock, bool surface)
{
    scene s = scene_of(grid, rock, (choice){2, true, surface, 1e-12});
    size_t source = s.n / 3;
    double own = held_traction(&rock, grid.dx, rock.line ? 0 : grid.dy, 0, 0), worst = 0;
    s.x[source] = 1;
    apply(&s);
    for (size_t i = 0; i < s.n; i++) {
        size_t a = s.domain->index[i], b = s.domain->index[source];
        double x = ((double)(a % grid.nx) - (double)(b % grid.nx)) * grid.dx;
        double y = ((double)(a / grid.nx) - (double)(b / grid.nx)) * grid.dy;
        double expected = held_traction(&rock, grid.dx, rock.line ? 0 : grid.dy, x, y);
        expected = surface ? traction_below_surface(&rock, &grid, a, b) : expected;
        worst = fmax(worst, fabs(s.y[i] - expected) / own);
    }
    print_message("creeping%s, %zu x %zu: off by %.1e of a cell's own\n",
                  surface ? " below a surface" : "", grid.nx, grid.ny, worst);
    assert_true(worst < 2e-4);
    scene_free(&s);
}

static void creeping_surroundings_hold_as_by_quadrature(void **state)
{
    (void)state;
    check_creeping((lac_grid){7, 7, 1, 1, false}, (rock_def){2, 0.25, INFINITY, false}, false);
    check_creeping((lac_grid){8, 5, 2, 1.5, false}, (rock_def){2, 0.4, INFINITY, false}, false);
    check_creeping((lac_grid){6, 6, 1, 1, false}, (rock_def){2, 0, INFINITY, false}, false);
    check_creeping((lac_grid){9, 1, 1, 3, false}, (rock_def){2, 0.25, INFINITY, false}, false);
    check_creeping((lac_grid){23, 1, 0.5, 1, false}, (rock_def){2, 0.25, INFINITY, true}, false);
    check_creeping((lac_grid){23, 1, 0.5, 1, false}, (rock_def){2, 0, INFINITY, true}, false);
    check_creeping((lac_grid){1, 1, 0.5, 1, false}, (rock_def){2, 0.25, INFINITY, false}, false);
    check_creeping((lac_grid){23, 1, 0.5, 1, false}, (rock_def){2, 0, INFINITY, true}, true);
    check_creeping((lac_grid){1, 1, 0.5, 1, false}, (rock_def){2, 0, INFINITY, true}, true);
    check_creeping((lac_grid){20, 7, 1, 1.5, false}, (rock_def){2, 0.25, INFINITY, false}, true);
    check_creeping((lac_grid){5, 1, 1, 1, false}, (rock_def){2, 0.25, INFINITY, false}, true);
    check_creeping((lac_grid){1, 9, 2, 1, false}, (rock_def){2, 0.4, INFINITY, false}, true);
}

// A crack of the whole line under a uniform drop of stress: 2 (1 - nu)/G sqrt(c^2 - x^2).
static double line_crack_error(size_t cells, double nu)
{
    scene s = scene_of((lac_grid){cells, 1, 2.0 / (double)cells, 1, false},
                       (rock_def){2, nu, INFINITY, true}, (choice){2, true, false, 1e-12});
    double squares = 0, size = 0;
    for (size_t i = 0; i < s.n; i++) {
        s.x[i] = 1;
        s.d[i] = 1e-12;
    }
    assert_true(s.transfer.kind->solve(s.transfer.state, 0, s.d, s.x, s.y, s.work));
    for (size_t i = 0; i < s.n; i++) {
        double x = ((double)i + 0.5) * 2 / (double)cells - 1;
        double exact = 2 * (1 - nu) / 2 * sqrt(1 - x * x);
        squares += (s.y[i] - exact) * (s.y[i] - exact);
        size += exact * exact;
    }
    scene_free(&s);
    return sqrt(squares / size);
}

static void a_crack_in_a_line_opens_into_an_ellipse(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        double coarse = line_crack_error(64, k == 0 ? 0 : 0.3);
        double fine = line_crack_error(256, k == 0 ? 0 : 0.3);
        print_message("line crack: rms error %.4f with 64 cells, %.4f with 256\n", coarse, fine);
        assert_true(fine < 0.006 && coarse / fine > 3.5 && coarse / fine < 4.5);
    }
}

// A circular crack, the rest of the plane locked: 8 (1 - nu)/(pi (2 - nu)) drop/G sqrt(a^2 - r^2)
// (Eshelby 1957); 24/(7 pi) for nu = 1/4.
static double circular_crack_error(size_t side, double nu, double *peak)
{
    const double a = 1, length = 2.5;
    double r = length / (double)side, squares = 0, size = 0;
    scene s = scene_of((lac_grid){side, side, r, r, false}, (rock_def){2, nu, INFINITY, false},
                       (choice){2, true, false, 1e-10});
    double *exact = new_doubles(s.n);
    for (size_t i = 0; i < s.n; i++) {
        double x = ((double)(s.domain->index[i] % side) + 0.5) * r - length / 2;
        double y = ((double)(s.domain->index[i] / side) + 0.5) * r - length / 2;
        double inside = a * a - x * x - y * y;
        exact[i] = inside > 0 ? 8 * (1 - nu) / (pi * (2 - nu)) / 2 * sqrt(inside) : 0;
        s.x[i] = inside > 0 ? 1 : 0;
        s.d[i] = inside > 0 ? 1e-9 : 1e12;
    }
    assert_true(s.transfer.kind->solve(s.transfer.state, 0, s.d, s.x, s.y, s.work));
    *peak = 0;
    for (size_t i = 0; i < s.n; i++) {
        squares += (s.y[i] - exact[i]) * (s.y[i] - exact[i]);
        size += exact[i] * exact[i];
        *peak = fmax(*peak, s.y[i]);
    }
    *peak /= 8 * (1 - nu) / (pi * (2 - nu)) / 2;
    free(exact);
    scene_free(&s);
    return sqrt(squares / size);
}

static void a_circular_crack_opens_into_an_ellipsoid(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        double peak, nu = k == 0 ? 0.25 : 0.4;
        double coarse = circular_crack_error(32, nu, &peak);
        double fine = circular_crack_error(128, nu, &peak);
        print_message("circular crack, nu %g: rms error %.4f on 32 x 32, %.4f on 128 x 128, peak "
                      "%.4f\n",
                      nu, coarse, fine, peak);
        assert_true(fine < 0.03 && fine < 0.45 * coarse && fabs(peak - 1) < 0.03);
    }
}

// Newton's systems span thirty decades.
static void extreme_diagonals_are_solved(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        scene s = scene_of((lac_grid){24, 24, 1, 1, true},
                           (rock_def){2, 0.25, k == 2 ? 5 : INFINITY, false},
                           (choice){k == 0 ? 2 : 0.4, false, false, 1e-6});
        for (int e = -20; e <= 20; e += 4) {
            double *residual = new_doubles(s.n), mean = 0;
            for (size_t i = 0; i < s.n; i++) {
                s.d[i] = pow(10, e) * draw_log(6, i, 1e-3, 1e3);
                residual[i] = draw_uniform(7, i, -1, 1);
                mean += residual[i] / (double)s.n;
            }
            // The soft mean slip under a net force would hide the rest behind its rounding.
            for (size_t i = 0; i < s.n; i++) {
                residual[i] -= mean;
            }
            assert_true(s.transfer.kind->solve(s.transfer.state, 0, s.d, residual, s.x, s.work));
            apply(&s);
            double squares = 0, size = 0;
            for (size_t i = 0; i < s.n; i++) {
                // in the norm of 1/(D + G/r)
                double off = residual[i] - s.d[i] * s.x[i] - s.y[i];
                squares += off * off / (s.d[i] + 2);
                size += residual[i] * residual[i] / (s.d[i] + 2);
            }
            assert_true(sqrt(squares / size) < 3e-6);
            free(residual);
        }
        scene_free(&s);
    }
}

static void refuse(lac_grid grid, double fraction, lac_transfer_elastic params, double nu,
                   const char *says)
{
    scene s = scene_of(grid, (rock_def){2, 0.25, INFINITY, false},
                       (choice){fraction, false, false, 1e-3});
    lac_model model = {&s.transfer.kind->info, &params};
    lac_transfer_scene from = {s.domain, s.h, 2, nu, false, false, NULL};
    lac_transfer transfer;
    lac_error err = {""};
    assert_int_equal(lac_transfer_create(&model, &from, &transfer, &err), LAC_EINPUT);
    if (strstr(err.message, says) == NULL) {
        fail_msg("\"%s\" does not say \"%s\"", err.message, says);
    }
    scene_free(&s);
}

static void bad_parameters_are_refused(void **state)
{
    (void)state;
    const lac_grid torus = {8, 8, 1, 1, true}, alone = {8, 8, 1, 1, false};
    lac_transfer_elastic slab = {.thickness = 3, .tolerance = 1e-9, .newton_tolerance = 1e-3};
    lac_transfer_elastic creeping = slab, thin = slab;
    creeping.outside = 1;
    creeping.thickness = NAN;
    thin.thickness = -3;
    refuse(torus, 2, creeping, 0.2, "needs interface.boundary: free");
    refuse(alone, 0.5, creeping, 0.2, "{full: {}}");
    refuse(alone, 2, slab, 0.2, "periodic");
    refuse(torus, 2, thin, 0.2, "thickness: -3");
    refuse(torus, 2, slab, 0.7, "Poisson");
    refuse(torus, 2, slab, NAN, "material");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(waves_have_closed_forms),
        cmocka_unit_test(gaps_slip_freely_as_in_dense_matrices),
        cmocka_unit_test(systems_that_are_not_definite_are_refused),
        cmocka_unit_test(uniform_slip_costs_nothing_and_forces_balance),
        cmocka_unit_test(slips_that_hardly_differ_have_their_stress),
        cmocka_unit_test(creeping_surroundings_hold_as_by_quadrature),
        cmocka_unit_test(a_crack_in_a_line_opens_into_an_ellipse),
        cmocka_unit_test(a_circular_crack_opens_into_an_ellipsoid),
        cmocka_unit_test(extreme_diagonals_are_solved),
        cmocka_unit_test(bad_parameters_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
