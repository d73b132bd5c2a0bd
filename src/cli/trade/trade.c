// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna trade CASE
#include "cli/trade/trade.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/units.h"
#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/common/signals.h"
#include "cli/common/words.h"
#include "cli/report/report.h"

static void job_clear(cli_trade_job *job)
{
    lac_trade_verdict_clear(&job->verdict);
    lac_trade_plan_clear(&job->plan);
    lac_case_free(job->source);
    free(job->measure);
    free(job->settings);
    free(job->path);
    free(job->folder);
}

static lac_status read_quantity(const char *text, lac_trade_ask *ask, lac_error *err)
{
    const char *names[LAC_QUANTITIES];
    ask->quantity = -1;
    for (int q = 0; text != NULL && q < LAC_QUANTITIES; q++) {
        names[q] = lac_quantity_about_of(q)->name;
        if (strcmp(text, names[q]) == 0) {
            ask->quantity = q;
        }
    }
    return text == NULL || ask->quantity >= 0
               ? LAC_OK
               : cli_unknown("--quantity: ", text, "quantity", names, LAC_QUANTITIES, err);
}

static lac_status wrong(const char *option, const char *text, const char *allowed, lac_error *err)
{
    return lac_fail(err, LAC_EINPUT, "--%s: \"%s\" must be %s", option, text, allowed);
}

// 1%, 0.01, or an amount of the quantity itself; where that is left to the case, of any that it may
// choose.
static lac_status read_reach(const lac_units *units, const char *text, lac_trade_ask *ask,
                             lac_error *err)
{
    static const int usual[] = {LAC_QUANTITY_FAILURE, LAC_QUANTITY_SLIP};
    const bool named = ask->quantity >= 0;
    const int *quantity = named ? &ask->quantity : usual;
    double value = NAN;
    if (lac_units_parse(units, text, "1", &value, NULL) == LAC_OK) {
        ask->reach = value;
    }
    for (size_t i = 0; isnan(value) && i < (named ? 1 : sizeof usual / sizeof *usual); i++) {
        ask->unit = lac_quantity_about_of(quantity[i])->unit;
        (void)lac_units_parse(units, text, ask->unit, &value, NULL);
        ask->within = value;
    }
    return value > 0.0 && isfinite(value)
               ? LAC_OK
               : wrong("reach", text, "an error > 0 such as 1%, or an amount of the quantity", err);
}

static lac_status read_amounts(const cli_trade_words *words, lac_trade_ask *ask, lac_error *err)
{
    lac_units *units = NULL;
    ask->reach = ask->within = ask->spend = NAN;
    if (words->reach == NULL && words->spend == NULL) {
        return LAC_OK;
    }
    lac_status status;
    LAC_TRY(lac_units_create(&units, err));
    if (words->reach != NULL) {
        LAC_TRY(read_reach(units, words->reach, ask, err));
    }
    if (words->spend != NULL &&
        (lac_units_parse(units, words->spend, "s", &ask->spend, NULL) != LAC_OK ||
         !(ask->spend > 0.0))) {
        LAC_TRY(wrong("spend", words->spend, "a time > 0 such as \"10 min\"", err));
    }
out:
    lac_units_free(units);
    return status;
}

static lac_status read_jobs(const char *text, int *jobs, lac_error *err)
{
    long n = sysconf(_SC_NPROCESSORS_ONLN);
    char *end = NULL;
    if (text != NULL) {
        n = strtol(text, &end, 10);
        if (end == text || *end != '\0' || n < 1 || n > 64) {
            return wrong("jobs", text, "a number from 1 to 64", err);
        }
    }
    *jobs = (int)(n < 1 ? 1 : n > 64 ? 64 : n);
    return LAC_OK;
}

// What is computed for the quantity. Where none is asked for, a case that is static by what it
// names has its cascade traded, or else its contact; Q_crit without a section rg is what a run's
// load comes to.
static lac_status find_out(const cli_trade_job *job, lac_trade_of *of, lac_error *err)
{
    const int quantity = job->ask.quantity;
    if (quantity >= 0 && quantity != LAC_QUANTITY_CRITICAL) {
        *of = lac_quantity_about_of(quantity)->contact ? LAC_OF_CONTACT : LAC_OF_RUN;
        return LAC_OK;
    }
    lac_case *c = NULL;
    cli_request quiet = *job->request; // its warnings are said when it is read for what it is
    quiet.given |= CLI_OPT_QUIET;
    const bool critical = quantity == LAC_QUANTITY_CRITICAL;
    lac_status status = cli_case_read(&quiet, LAC_FOR_CHECK, &c, NULL, err);
    if (status == LAC_OK) {
        const bool is_static = critical || isnan(c->run.end);
        *of = c->rg.named && is_static ? LAC_OF_CASCADE
              : is_static && !critical ? LAC_OF_CONTACT
                                       : LAC_OF_RUN;
    }
    lac_case_free(c);
    return status;
}

static lac_status read_source(cli_trade_job *job, lac_trade_of *of, lac_error *err)
{
    lac_status status = find_out(job, of, err);
    return status == LAC_OK
               ? cli_case_read(job->request, cli_trade_purpose(*of), &job->source, NULL, err)
               : status;
}

static lac_status check_until(const cli_trade_job *job, lac_error *err)
{
    double until = NAN;
    const char *text = job->request->until;
    if (text == NULL) {
        return LAC_OK;
    }
    if (isnan(job->source->run.end)) {
        return wrong("until", text, "left out: the case has no time", err);
    }
    lac_status status = cli_parse_time(text, job->source, &until, err);
    if (status == LAC_OK && !(until > 0.0 && until <= job->source->run.end)) {
        status = wrong("until", text, "> 0 and no later than time.end", err);
    }
    return status;
}

static lac_status name_files(cli_trade_job *job, lac_error *err)
{
    cli_request plain = *job->request;
    plain.given &= ~(unsigned)CLI_OPT_RESUME; // goes on from the folder, not from the file
    lac_status status = cli_output_path(&plain, job->source, NULL, "-trade.nc", &job->path, err);
    if (status != LAC_OK) {
        return status;
    }
    const size_t size = strlen(job->path) + sizeof ".runs";
    job->folder = malloc(size);
    if (job->folder == NULL) {
        return lac_fail_memory(err);
    }
    (void)snprintf(job->folder, size, "%s.runs", job->path);
    return LAC_OK;
}

static lac_status prepare(cli_trade_job *job, lac_error *err)
{
    const cli_request *request = job->request;
    lac_trade_of of = LAC_OF_RUN;
    lac_status status;
    LAC_TRY(read_quantity(request->trade.quantity, &job->ask, err));
    LAC_TRY(read_amounts(&request->trade, &job->ask, err));
    LAC_TRY(read_jobs(request->trade.jobs, &job->jobs, err));
    LAC_TRY(read_source(job, &of, err));
    LAC_TRY(check_until(job, err));
    LAC_TRY(name_files(job, err));
    LAC_TRY(lac_trade_plan_create(job->source, of, request->trade.dials,
                                  request->trade.crossed != NULL, &job->plan, err));
    job->measure = calloc(job->plan.runs, sizeof *job->measure);
    job->settings = calloc(job->plan.runs, sizeof *job->settings);
    if (job->measure == NULL || job->settings == NULL) {
        LAC_TRY(lac_fail_memory(err));
    }
    LAC_TRY(cli_trade_resolve(job, err));
out:
    return status;
}

static lac_status measure(cli_trade_job *job, lac_error *err)
{
    cli_say(job->request, "%zu combinations, %d at a time", job->plan.runs, job->jobs);
    cli_signals_hold();
    cli_progress_start(&job->progress, job->request);
    lac_status status = cli_trade_run(job, err);
    cli_progress_clear(&job->progress);
    return status;
}

static lac_status put_out(cli_trade_job *job, lac_error *err)
{
    lac_status status = lac_trade_judge(&job->plan, job->measure, &job->ask, &job->verdict, err);
    if (status != LAC_OK) {
        return cli_blame(job->source, status, err);
    }
    status = cli_trade_store(job, err);
    if (status == LAC_OK && cli_given(job->request, CLI_OPT_JSON)) {
        cli_trade_json(job);
    } else if (status == LAC_OK) {
        cli_trade_print(job);
    }
    return status;
}

lac_status cli_trade(const cli_request *request, lac_error *err)
{
    cli_trade_job job = {.request = request, .kept = -1, .started = cli_clock()};
    lac_status status;
    LAC_TRY(prepare(&job, err));
    LAC_TRY(cli_trade_keep_open(&job, err));
    LAC_TRY(measure(&job, err));
    LAC_TRY(put_out(&job, err));
out:
    // A question that had no answer can be put again without the runs being made again.
    cli_trade_keep_close(&job, status == LAC_OK);
    job_clear(&job);
    return status;
}
