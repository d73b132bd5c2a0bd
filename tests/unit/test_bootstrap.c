// SPDX-License-Identifier: GPL-3.0-or-later
// When the bootstrap of a renormalization map gives an error, and when it must not.
#include <stdlib.h>

#include <math.h>

#include "rg/rg_study.h"
#include "support/test.h"

enum { MOST = 12, PAIRS = 3 };

static double at(double logit) { return 1.0 / (1.0 + exp(-logit)); }

// Groups of three pairs on logit s' = 1.5 logit s + 0.2, spread a little; those of the last
// `empty` groups lie where a map is not fitted, so that a draw of these alone has none.
static lac_rg_fit resample(size_t groups, size_t empty, size_t resamplings)
{
    size_t first[MOST + 1];
    double s[MOST * PAIRS], next[MOST * PAIRS];
    lac_rg_fit fit;
    for (size_t g = 0; g <= groups; g++) {
        first[g] = PAIRS * g;
    }
    for (size_t i = 0; i < PAIRS * groups; i++) {
        const double x = -1.0 + (double)(i % PAIRS) + 0.1 * sin(3.0 * (double)i);
        const bool none = i >= PAIRS * (groups - empty);
        s[i] = none ? 0.99 : at(x);
        next[i] = at(1.5 * x + 0.2 + 0.05 * cos(5.0 * (double)i));
    }
    assert_int_equal(lac_rg_map_resample(groups, first, s, next, resamplings, 1, &fit, NULL),
                     LAC_OK);
    return fit;
}

static void assert_estimated(const lac_rg_estimate *e, bool estimated)
{
    assert_true(isfinite(e->value));
    assert_true(isfinite(e->error) == estimated && isfinite(e->low) == estimated &&
                isfinite(e->high) == estimated);
    if (estimated) {
        assert_true(e->error > 0.0 && e->low < e->high);
    }
}

static void assert_all_estimated(const lac_rg_fit *fit, bool estimated)
{
    assert_estimated(&fit->fixed_point, estimated);
    assert_estimated(&fit->lambda, estimated);
    assert_estimated(&fit->nu, estimated);
}

// From fewer than 20 draws no interval of 95 % is told, and one group alone has no spread.
static void few_draws_tell_no_error(void **state)
{
    (void)state;
    for (size_t resamplings = 18; resamplings <= 21; resamplings++) {
        const lac_rg_fit fit = resample(10, 0, resamplings);
        assert_all_estimated(&fit, resamplings >= 20);
    }
    const lac_rg_fit one = resample(1, 0, 400);
    assert_all_estimated(&one, false);
}

// A draw has no map where it takes the empty groups alone: by chance (empty/groups)^groups. Errors
// of what is left would be too small, so there are none where that is a tenth or more.
static void errors_need_a_map_of_nine_draws_in_ten(void **state)
{
    (void)state;
    enum { RESAMPLINGS = 40000 }; // the share is known to 0.0015
    static const struct {
        size_t groups, empty;
    } cases[] = {{3, 1}, {4, 2}, {6, 4}, {10, 8}, {2, 1}, {3, 2}};
    size_t estimated = 0;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double groups = (double)cases[i].groups;
        const double none = pow((double)cases[i].empty / groups, groups);
        assert_true(fabs(none - 0.1) > 0.006);
        const lac_rg_fit fit = resample(cases[i].groups, cases[i].empty, RESAMPLINGS);
        assert_all_estimated(&fit, none < 0.1);
        estimated += none < 0.1 ? 1 : 0;
    }
    assert_int_equal(estimated, 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(few_draws_tell_no_error),
        cmocka_unit_test(errors_need_a_map_of_nine_draws_in_ten),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
