// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna trade CASE: what is asked for, the case of each run, and what comes out.
#include "cli/trade/trade.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/archive.h"
#include "base/units.h"
#include "cli/common/command.h"
#include "cli/common/inputs.h"
#include "cli/common/libraries.h"
#include "cli/common/output.h"
#include "cli/common/signals.h"
#include "cli/common/words.h"
#include "cli/report/report.h"
#include "data/dataset.h"
#include "lacuna/version.h"

static void job_clear(cli_trade_job *job)
{
    lac_trade_plan_clear(&job->plan);
    lac_case_free(job->source);
    free(job->measure);
    free(job->settings);
    free(job->path);
    free(job->folder);
}

static lac_status read_quantity(const char *text, lac_trade_request *ask, lac_error *err)
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
static lac_status read_reach(const lac_units *units, const char *text, lac_trade_request *ask,
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

static lac_status read_amounts(const cli_trade_words *words, lac_trade_request *ask, lac_error *err)
{
    lac_units *units = NULL;
    ask->reach = ask->within = ask->budget = NAN;
    if (words->reach == NULL && words->budget == NULL) {
        return LAC_OK;
    }
    lac_status status;
    LAC_TRY(lac_units_create(&units, err));
    if (words->reach != NULL) {
        LAC_TRY(read_reach(units, words->reach, ask, err));
    }
    if (words->budget != NULL &&
        (lac_units_parse(units, words->budget, "s", &ask->budget, NULL) != LAC_OK ||
         !(ask->budget > 0.0))) {
        LAC_TRY(wrong("spend", words->budget, "a time > 0 such as \"10 min\"", err));
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

static lac_case_purpose purpose_of(lac_trade_of of)
{
    return of == LAC_OF_CASCADE ? LAC_FOR_RG : of == LAC_OF_CONTACT ? LAC_FOR_CONTACT : LAC_FOR_RUN;
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
    return status == LAC_OK ? cli_case_read(job->request, purpose_of(*of), &job->source, NULL, err)
                            : status;
}

// What the user sets, then what the settings set, which goes before it.
static size_t gather(const cli_trade_job *job, size_t run, lac_override *out)
{
    const cli_request *request = job->request;
    const lac_trade_plan *plan = &job->plan;
    size_t n = request->set_count;
    if (n > 0) {
        memcpy(out, request->overrides, n * sizeof *out);
    }
    if (lac_trade_of_run(plan, run) == LAC_OF_CASCADE) {
        out[n++] = (lac_override){"solver.fidelity", "static"};
    }
    for (size_t d = 0; d < plan->settings; d++) {
        const int at = plan->run[run].at[d];
        if (at >= 0) {
            out[n++] =
                (lac_override){plan->setting[d].setting->key, plan->setting[d].value[at].yaml};
        }
    }
    return n;
}

static lac_status first_issue(const lac_case_issues *report, lac_status status, lac_error *err)
{
    char text[512];
    for (size_t i = 0; i < report->count; i++) {
        LAC_FAIL_IF(!report->issue[i].warning, err, status, "%s",
                    lac_case_issue_format(&report->issue[i], text, sizeof text));
    }
    return status;
}

lac_status cli_trade_case(const cli_trade_job *job, size_t run, lac_case **c, lac_error *err)
{
    const cli_request *request = job->request;
    const lac_trade_of of = lac_trade_of_run(&job->plan, run);
    lac_case_issues report = {0};
    *c = NULL;
    lac_override *set = malloc((request->set_count + LAC_SETTINGS + 1) * sizeof *set);
    LAC_FAIL_MEMORY_IF(set == NULL, err);
    const lac_case_request how = {purpose_of(of), set, gather(job, run, set)};
    lac_status status = lac_case_read(request->argument[0], &how, c, &report, err);
    if (status != LAC_OK) {
        (void)first_issue(&report, status, err);
    } else {
        status = of == LAC_OF_RUN ? cli_until(request, *c, &(*c)->run.end, err) : LAC_OK;
    }
    lac_case_issues_clear(&report);
    free(set);
    return status;
}

static uint64_t add(uint64_t sum, const char *text)
{
    return lac_sum_bytes(sum, text, strlen(text));
}

static lac_status describe(const cli_trade_job *job, const lac_case *c, lac_trade_settings *out,
                           lac_error *err)
{
    char libraries[256], end[32];
    char *text = lac_case_text(c), *sums = cli_inputs_sums(c);
    lac_status status = text == NULL || sums == NULL ? lac_fail_memory(err) : LAC_OK;
    if (status == LAC_OK) {
        (void)snprintf(end, sizeof end, "%a", c->run.end);
        out->key = add(LAC_SUM_OF_NOTHING, text);
        out->key = add(add(out->key, sums), end);
        out->key = add(add(out->key, LACUNA_VERSION), cli_libraries(libraries, sizeof libraries));
        for (size_t d = 0; d < job->plan.settings; d++) {
            lac_setting_current(job->plan.setting[d].setting, c, out->label[d]);
        }
    }
    free(text);
    free(sums);
    return status;
}

// Settings that are another run's make no run of their own; what it is for goes over to that one.
static void find_twin(cli_trade_job *job, size_t run)
{
    lac_trade_plan *plan = &job->plan;
    for (size_t i = 0; i < run; i++) {
        if (job->measure[i].end == LAC_TRADE_PENDING &&
            job->settings[i].key == job->settings[run].key) {
            job->measure[run].end = LAC_TRADE_TWIN;
            plan->run[i].why |= plan->run[run].why;
            plan->reference = plan->reference == run ? i : plan->reference;
            for (size_t d = 0; d < plan->settings; d++) {
                plan->coarser[d] = plan->coarser[d] == run ? i : plan->coarser[d];
                plan->coarsest[d] = plan->coarsest[d] == run ? i : plan->coarsest[d];
            }
            return;
        }
    }
}

// Why no run may have a position; NULL: one may.
static const char *refusal(const cli_trade_job *job, size_t setting, size_t position)
{
    const char *why = NULL;
    for (size_t run = 0; run < job->plan.runs; run++) {
        if (job->plan.run[run].at[setting] != (short)position) {
            continue;
        }
        if (job->measure[run].end != LAC_TRADE_REFUSED) {
            return NULL;
        }
        why = why != NULL ? why : job->measure[run].message;
    }
    return why;
}

// Settings that do not go together are left out, but not a position that was asked for and goes
// with nothing: most likely it is misspelt.
static lac_status check_named(const cli_trade_job *job, lac_error *err)
{
    static const char set[] = "--set: ";
    const lac_trade_plan *plan = &job->plan;
    for (size_t d = 0; d < plan->settings; d++) {
        for (size_t p = 0; plan->setting[d].named && p < plan->setting[d].shown; p++) {
            const char *why = refusal(job, d, p);
            if (why != NULL) {
                why += strncmp(why, set, sizeof set - 1) == 0 ? sizeof set - 1 : 0;
                return lac_fail(err, LAC_EINPUT, "--dials: %s=%s: %s",
                                plan->setting[d].setting->name, plan->setting[d].value[p].label,
                                why);
            }
        }
    }
    return LAC_OK;
}

// Looks up the settings of all runs; those that are refused or twice there are marked.
static lac_status resolve(cli_trade_job *job, lac_error *err)
{
    lac_status status = describe(job, job->source, &job->own, err);
    for (size_t run = 0; run < job->plan.runs && status == LAC_OK; run++) {
        lac_case *c = NULL;
        lac_error why = {""};
        lac_trade_measure *m = &job->measure[run];
        status = cli_trade_case(job, run, &c, &why);
        if (status == LAC_OK) {
            status = describe(job, c, &job->settings[run], err);
            find_twin(job, run);
        } else if (status == LAC_EINPUT) {
            m->end = LAC_TRADE_REFUSED;
            (void)snprintf(m->message, sizeof m->message, "%s", why.message);
            status = LAC_OK;
        } else {
            *err = why;
        }
        lac_case_free(c);
    }
    return status == LAC_OK ? check_named(job, err) : status;
}

static lac_status name_files(cli_trade_job *job, lac_error *err)
{
    cli_request plain = *job->request;
    plain.given &= ~(unsigned)CLI_OPT_RESUME; // goes on from the folder, not from the file
    LAC_TRY_RETURN(cli_output_path(&plain, job->source, NULL, "-trade.nc", &job->path, err));
    const size_t size = strlen(job->path) + sizeof ".runs";
    job->folder = malloc(size);
    LAC_FAIL_MEMORY_IF(job->folder == NULL, err);
    (void)snprintf(job->folder, size, "%s.runs", job->path);
    return LAC_OK;
}

static lac_status prepare(cli_trade_job *job, lac_error *err)
{
    const cli_request *request = job->request;
    lac_trade_of of = LAC_OF_RUN;
    double end;
    lac_status status;
    LAC_TRY(read_quantity(request->trade.quantity, &job->ask, err));
    LAC_TRY(read_amounts(&request->trade, &job->ask, err));
    LAC_TRY(read_jobs(request->trade.jobs, &job->jobs, err));
    LAC_TRY(read_source(job, &of, err));
    if (request->until != NULL && isnan(job->source->run.end)) {
        LAC_TRY(wrong("until", request->until, "left out: the case has no time", err));
    }
    LAC_TRY(cli_until(request, job->source, &end, err));
    LAC_TRY(name_files(job, err));
    LAC_TRY(lac_trade_plan_create(job->source, of, request->trade.settings,
                                  request->trade.crossed != NULL, &job->plan, err));
    job->measure = calloc(job->plan.runs, sizeof *job->measure);
    job->settings = calloc(job->plan.runs, sizeof *job->settings);
    if (job->measure == NULL || job->settings == NULL) {
        LAC_TRY(lac_fail_memory(err));
    }
    LAC_TRY(resolve(job, err));
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

static void print_json(const cli_trade_job *job, const lac_dataset *dataset)
{
    lac_json json = {.out = stdout};
    lac_json_open(&json, NULL, '{');
    lac_dataset_json(dataset, &json);
    lac_json_number(&json, "wall_time_s", cli_clock() - job->started);
    lac_json_text(&json, "output", job->path);
    lac_json_close(&json, '}');
}

static lac_status put_out(const cli_trade_job *job, lac_error *err)
{
    char sentence[1024];
    lac_trade_result verdict = {0};
    lac_trade_outcome outcome = {.title = job->source->title,
                                 .sentence = sentence,
                                 .plan = &job->plan,
                                 .measure = job->measure,
                                 .settings = job->settings,
                                 .own = &job->own,
                                 .verdict = &verdict};
    lac_dataset *dataset = NULL;
    lac_status status = lac_trade_judge(&job->plan, job->measure, &job->ask, &verdict, err);
    LAC_TRY(cli_blame(job->source, status, err));
    LAC_TRY(lac_trade_list(&outcome, err));
    cli_trade_sentence(&outcome, &job->ask, sentence, sizeof sentence);
    LAC_TRY(lac_trade_describe(&outcome, &dataset, err));
    LAC_TRY(cli_store_dataset(job->request, job->source, INT64_MIN, job->path, dataset, err));
    if (cli_given(job->request, CLI_OPT_JSON)) {
        print_json(job, dataset);
    } else {
        cli_trade_print(&outcome, job->request);
        cli_row("file", "%s", job->path);
    }
out:
    lac_dataset_free(dataset);
    lac_trade_outcome_clear(&outcome);
    lac_trade_result_clear(&verdict);
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
