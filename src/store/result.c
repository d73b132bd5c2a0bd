// SPDX-License-Identifier: GPL-3.0-or-later
// How a run ended, as attributes that its file gets last: failure, time reached, counts.
#include <math.h>

#include "base/date.h"
#include "store/internal.h"

static lac_status put_date(const lac_store *s, const char *name, double seconds, lac_error *err)
{
    char date[32];
    return lac_nc_text(&s->file, NC_GLOBAL, name, lac_date_format(seconds, date, sizeof date), err);
}

static lac_status put_failure(const lac_store *s, const lac_run_result *r, lac_error *err)
{
    lac_status status = LAC_OK;
    if (r->end == LAC_END_ERROR) {
        return status; // nobody knows
    }
    LAC_TRY(lac_nc_integer(&s->file, NC_GLOBAL, "failed", r->failed ? 1 : 0, err));
    if (isfinite(r->failure.rate)) {
        LAC_TRY(lac_nc_real(&s->file, NC_GLOBAL, "failure_rate_m_s", r->failure.rate, err));
    }
    if (r->failure.lowered) {
        LAC_TRY(lac_nc_text(&s->file, NC_GLOBAL, "failure_rate_comment",
                            "a p/eta at the start: radiation damping holds the joint below "
                            "time.failure.mean_slip_rate; judged by all cells as one",
                            err));
    }
    if (isfinite(r->failure.slip)) {
        LAC_TRY(lac_nc_real(&s->file, NC_GLOBAL, "failure_slip_m", r->failure.slip, err));
    }
    if (status != LAC_OK || !r->failed) {
        return status;
    }
    double time = r->failure_origin + r->failure_local;
    LAC_TRY(lac_nc_real(&s->file, NC_GLOBAL, "failure_time_s", time, err));
    if (s->dated) {
        LAC_TRY(put_date(s, "failure_date", s->start_date + time, err));
    }
out:
    return status;
}

static lac_status put_counts(const lac_store *s, const lac_run_result *r, lac_error *err)
{
    const struct {
        const char *name;
        int64_t value;
    } counts[] = {
        {"steps", r->steps},
        {"rhs_evaluations", r->rhs_evaluations},
        {"newton_iterations", r->newton_iterations},
        {"linear_solves", r->linear_solves},
        {"error_test_fails", r->error_test_fails},
        {"nonlinear_fails", r->nonlinear_fails},
        {"restarts", r->restarts},
    };
    lac_status status = LAC_OK;
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        LAC_TRY(lac_nc_integer(&s->file, NC_GLOBAL, counts[i].name, counts[i].value, err));
    }
out:
    return status;
}

static lac_status put_run(const lac_store *s, const lac_run_result *r, lac_error *err)
{
    const struct {
        const char *name;
        double value;
    } reals[] = {
        {"time_reached_s", r->time},
        {"max_slip_rate_m_s", r->max_slip_rate},
        {"mean_slip_m", r->mean_slip},
        {"balance_residual_max", r->balance_residual},
    };
    lac_status status = LAC_OK;
    LAC_TRY(put_failure(s, r, err));
    LAC_TRY(lac_nc_text(&s->file, NC_GLOBAL, "ended_by", lac_end_name(r->end), err));
    for (size_t i = 0; i < sizeof reals / sizeof reals[0]; i++) {
        if (isfinite(reals[i].value)) {
            LAC_TRY(lac_nc_real(&s->file, NC_GLOBAL, reals[i].name, reals[i].value, err));
        }
    }
    LAC_TRY(put_counts(s, r, err));
    if (s->dated) {
        LAC_TRY(put_date(s, "time_coverage_end", s->start_date + r->time, err));
    }
out:
    return status;
}

lac_status lac_store_put_result(const lac_store *s, const char *run_status,
                                const lac_run_result *result, double wall_time, lac_error *err)
{
    lac_status status = LAC_OK;
    if (result != NULL) {
        LAC_TRY(put_run(s, result, err));
    }
    LAC_TRY(lac_nc_real(&s->file, NC_GLOBAL, "wall_time_s", wall_time, err));
    LAC_TRY(put_date(s, "date_modified", s->now + wall_time, err));
    LAC_TRY(lac_nc_text(&s->file, NC_GLOBAL, "status", run_status, err));
out:
    return status;
}
