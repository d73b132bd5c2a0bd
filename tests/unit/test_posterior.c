// SPDX-License-Identifier: GPL-3.0-or-later
// Draws of a posterior against the same integrals on a dense grid.
#include <stdlib.h>

#include <math.h>
#include <string.h>

#include "base/rng.h"
#include "forecast/kinds.h"
#include "support/test.h"

enum { N = 24, GRID = 160 };
static const double share[LAC_FORECAST_LEVELS] = {0.05, 0.25, 0.5, 0.75, 0.95};

// d = c_0 + c_1 (ln of the time left, bent by the second shape)
static void curve(const lac_projection *self, const double *p, double *columns)
{
    const lac_window *w = self->window;
    for (size_t i = 0; i < w->n; i++) {
        columns[i] = 1.0;
        columns[w->n + i] =
            -log1p(-w->time[i] * exp(-p[0])) + 0.4 * tanh(p[1]) * w->time[i] / w->time[0];
    }
}

static double place(const lac_projection *self, size_t shape, double part)
{
    (void)self, (void)shape;
    return 4.0 * part - 2.0;
}

static double time_[N], displacement[N], weight[N];
static const double centre[2] = {0.0, 0.3}, width[2] = {INFINITY, 0.7};

static lac_projection make(lac_window *w, double noise)
{
    *w = (lac_window){.n = N, .time = time_, .displacement = displacement, .weight = weight};
    for (size_t i = 0; i < N; i++) {
        double z[2];
        lac_random_normal(5, LAC_STREAM_TEST, i, 0, z);
        time_[i] = (double)i - N + 1.0;
        displacement[i] = -log1p(-time_[i] / 6.0) + 0.1 * time_[i] / N + noise * z[0];
        weight[i] = 1.0;
    }
    return (lac_projection){.window = w,
                            .columns = 2,
                            .shapes = 2,
                            .curve = curve,
                            .place = place,
                            .grid = {20, 8},
                            .centre = centre,
                            .width = width};
}

// Quantiles of p[0] by the trapezoidal rule over both shapes.
static void integrate(lac_projection *law, double effective, const lac_forecast_fit *info,
                      double *quantile)
{
    static double density[GRID];
    const double middle = log(info->remaining);
    const double half = 6.0 * info->error; // to beyond the farthest
    const double best = N * info->rms * info->rms;
    double all = 0.0;
    for (size_t i = 0; i < GRID; i++) {
        double p[2] = {middle + half * (2.0 * (double)i / (GRID - 1) - 1.0), 0.0};
        density[i] = 0.0;
        for (size_t j = 0; p[0] < log(20.0 * (N - 1)) && j < GRID; j++) {
            p[1] = centre[1] + 4.0 * width[1] * (2.0 * (double)j / (GRID - 1) - 1.0);
            const double off = (p[1] - centre[1]) / width[1];
            const double sum = lac_projection_eval(law, p);
            density[i] += law->c[1] > 0.0
                              ? exp(-0.5 * (effective - 2.0) * log(sum / best) - 0.5 * off * off)
                              : 0.0;
        }
        all += density[i];
    }
    double before = 0.0;
    size_t k = 0;
    for (size_t i = 0; i < GRID && k < LAC_FORECAST_LEVELS; i++) {
        const double next = before + density[i] / all;
        while (k < LAC_FORECAST_LEVELS && next >= share[k]) {
            const double at = (double)i - 0.5 + (share[k] - before) / (next - before);
            quantile[k++] = middle + half * (2.0 * at / (GRID - 1) - 1.0);
        }
        before = next;
    }
}

static void draws_are_the_posterior(void **state)
{
    (void)state;
    static const double noises[] = {0.01, 0.03};
    for (size_t k = 0; k < sizeof noises / sizeof *noises; k++) {
        lac_window w;
        lac_projection law = make(&w, noises[k]);
        lac_draw draw[LAC_POSTERIOR_DRAWS];
        lac_forecast_fit found = {.count = 0};
        double p[LAC_SHAPES_MAX], expected[LAC_FORECAST_LEVELS];
        assert_int_equal(lac_projection_fit(&law, p, &found, NULL), LAC_OK);
        const double error = found.error;
        lac_posterior_draw(&law, p, 16.0, N * found.rms * found.rms, draw);
        lac_posterior_finish(LAC_POSTERIOR_DRAWS, draw, &found);
        assert_true(found.posterior);
        lac_forecast_fit info = found;
        info.error = error;
        integrate(&law, 16.0, &info, expected);
        for (size_t q = 0; q < LAC_FORECAST_LEVELS; q++) {
            const double off = found.quantile[q] - expected[q];
            if (!(fabs(off) < 0.025 * (expected[4] - expected[0]))) {
                fail_msg("noise %g, quantile %g: %g, by the grid %g", noises[k], share[q],
                         found.quantile[q], expected[q]);
            }
        }
        lac_projection_clear(&law);
    }
}

static void weights_are_counted(void **state)
{
    (void)state;
    lac_draw draw[] = {{3.0, log(2.0)}, {1.0, log(1.0)}, {2.0, log(5.0)}, {9.0, -INFINITY}};
    lac_forecast_fit found = {.count = 0};
    lac_posterior_finish(4, draw, &found);
    assert_true(fabs(found.quantile[2] - (2.0 + 0.5 / 3.5)) <
                1e-12); // 1 and half of 5 in 8 before 2
    lac_draw none[] = {{3.0, -INFINITY}, {1.0, -INFINITY}};
    found = (lac_forecast_fit){.count = 0};
    lac_posterior_finish(2, none, &found);
    assert_false(found.posterior);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(draws_are_the_posterior),
        cmocka_unit_test(weights_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
