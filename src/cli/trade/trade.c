// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna trade CASE: what is asked for, the case of each run, and what comes out, in words.
#include "cli/trade/trade.h"

#include <unistd.h>

#include "base/units.h"
#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/common/words.h"
#include "cli/report/report.h"

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
        ask->unit = lac_quantities[quantity[i]].unit;
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
        *of = lac_quantities[quantity].contact ? LAC_OF_CONTACT : LAC_OF_RUN;
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

// What the user sets, then what the settings set, which goes before it.
static size_t gather(const cli_trade_job *job, const lac_trade_run *run, lac_override *out)
{
    const cli_request *request = job->request;
    const lac_trade *trade = &job->trade;
    size_t n = request->set_count;
    if (n > 0) {
        memcpy(out, request->overrides, n * sizeof *out);
    }
    if (lac_trade_of_run(trade, run) == LAC_OF_CASCADE) {
        out[n++] = (lac_override){"solver.fidelity", "static"};
    } else if (job->fidelity != NULL) {
        out[n++] = (lac_override){"solver.fidelity", job->fidelity};
    }
    for (size_t d = 0; d < job->trade.settings; d++) {
        const lac_trade_setting *setting = &trade->setting[d];
        if (run->at[d] < 0) {
            continue;
        }
        const lac_setting_value *value = &setting->value[run->at[d]];
        out[n++] = (lac_override){setting->setting->key, value->yaml};
        if (setting->setting->coarse != NULL &&
            strcmp(value->label, setting->setting->coarse) != 0) {
            out[n++] = (lac_override){setting->setting->coarse_keys, "{}"};
        }
    }
    return n;
}

lac_status cli_trade_case(const cli_trade_job *job, const lac_trade_run *run, lac_case **c,
                          lac_error *err)
{
    const cli_request *request = job->request;
    const lac_trade_of of = lac_trade_of_run(&job->trade, run);
    char text[512];
    lac_case_issues report = {0};
    *c = NULL;
    lac_override *set = malloc((request->set_count + LAC_SETTINGS + 2) * sizeof *set);
    LAC_FAIL_MEMORY_IF(set == NULL, err);
    const lac_case_request how = {purpose_of(of), set, gather(job, run, set)};
    lac_status status = lac_case_read(request->argument[0], &how, c, &report, err);
    for (size_t i = report.count; status != LAC_OK && i-- > 0;) {
        if (!report.issue[i].warning) { // the first one stays
            (void)lac_fail(err, status, "%s",
                           lac_case_issue_format(&report.issue[i], text, sizeof text));
        }
    }
    if (status == LAC_OK && of == LAC_OF_RUN) {
        status = cli_until(request, *c, &(*c)->run.end, err);
    }
    lac_case_issues_clear(&report);
    free(set);
    return status;
}

// Settings that are another run's make no run of their own; what it is for goes over to that one.
static void find_twin(lac_trade *trade, size_t run)
{
    size_t i = 0;
    while (i < run &&
           (trade->run[i].end != LAC_TRADE_PENDING || trade->run[i].key != trade->run[run].key)) {
        i++;
    }
    if (i == run) {
        return;
    }
    trade->run[run].end = LAC_TRADE_TWIN;
    trade->run[i].why |= trade->run[run].why;
    trade->finest = trade->finest == run ? i : trade->finest;
    for (size_t k = 0; k < 2 * trade->settings; k++) {
        size_t *rung = &trade->coarser[k / 2][k % 2];
        *rung = *rung == run ? i : *rung;
    }
}

// Why no run may have a position; NULL: one may.
static const char *refusal(const lac_trade *trade, size_t setting, size_t position)
{
    const char *why = NULL;
    for (size_t i = trade->runs; i-- > 0;) {
        const lac_trade_run *run = &trade->run[i];
        if (run->at[setting] == (short)position) {
            if (run->end != LAC_TRADE_REFUSED) {
                return NULL;
            }
            why = run->message;
        }
    }
    return why;
}

// Settings that do not go together are left out, but not a position that was asked for and goes
// with nothing: most likely it is misspelt.
static lac_status check_named(const lac_trade *trade, lac_error *err)
{
    static const char set[] = "--set: ";
    for (size_t d = 0; d < trade->settings; d++) {
        const lac_trade_setting *setting = &trade->setting[d];
        for (size_t p = 0; setting->named && p < setting->shown; p++) {
            const char *why = refusal(trade, d, p);
            const bool own = why != NULL && strncmp(why, set, sizeof set - 1) == 0;
            LAC_FAIL_IF(why != NULL, err, LAC_EINPUT, "--dials: %s=%s: %s", setting->setting->name,
                        setting->value[p].label, own ? why + sizeof set - 1 : why);
        }
    }
    return LAC_OK;
}

// Looks up the settings of all runs; those that are refused or twice there are marked.
static lac_status resolve(const cli_trade_job *job, lac_trade *trade, lac_error *err)
{
    const size_t finest = trade->finest;
    for (size_t i = 0; i < trade->runs; i++) {
        lac_case *c = NULL;
        lac_error why = {""};
        lac_trade_run *run = &trade->run[i];
        lac_status status = cli_trade_case(job, run, &c, &why);
        if (status == LAC_OK) {
            status = cli_case_sum(job->request, c, &run->key, &why);
            run->key = lac_sum_bytes(run->key, &c->run.end, sizeof c->run.end);
            for (size_t d = 0; d < trade->settings; d++) {
                lac_setting_current(trade->setting[d].setting, c, run->label[d]);
            }
            find_twin(trade, i);
        } else if (status == LAC_EINPUT) {
            run->end = LAC_TRADE_REFUSED;
            (void)snprintf(run->message, sizeof run->message, "%s", why.message);
            status = LAC_OK;
        }
        const bool coarse = c != NULL && i == finest && c->run.fidelity == LAC_FIDELITY_LUMPED;
        lac_case_free(c);
        LAC_FAIL_IF(status != LAC_OK, err, status, "%s", why.message);
        LAC_FAIL_IF(coarse, err, LAC_EINPUT,
                    "--dials: fidelity: all is compared with the last position, which cannot be "
                    "lumped: name a finer one after it");
    }
    return check_named(trade, err);
}

static lac_status prepare(cli_trade_job *job, lac_error *err)
{
    const cli_request *request = job->request, plain = cli_request_anew(request, false);
    lac_trade_of of = LAC_OF_RUN;
    double end;
    job->ask.quantity = -1;
    if (request->trade.quantity != NULL) {
        const lac_quantity_about *found = cli_find("--quantity: ", request->trade.quantity,
                                                   "quantity", lac_quantities, sizeof *found, err);
        LAC_TRY_RETURN(found != NULL ? LAC_OK : LAC_EINPUT);
        job->ask.quantity = (int)(found - lac_quantities);
    }
    LAC_TRY_RETURN(read_amounts(&request->trade, &job->ask, err));
    LAC_TRY_RETURN(cli_pool_jobs(request->trade.jobs, &job->pool.jobs, err));
    LAC_TRY_RETURN(find_out(job, &of, err));
    LAC_TRY_RETURN(cli_case_read(request, purpose_of(of), &job->source, NULL, err));
    if (request->until != NULL && isnan(job->source->run.end)) {
        return wrong("until", request->until, "left out: the case has no time", err);
    }
    LAC_TRY_RETURN(cli_until(request, job->source, &end, err));
    LAC_TRY_RETURN(cli_output_path(&plain, job->source, NULL, "-trade.nc", &job->path, err));
    if (of == LAC_OF_RUN) {
        cli_trade_settle(job);
    }
    LAC_TRY_RETURN(lac_trade_create(job->source, of, request->trade.settings,
                                    request->trade.crossed != NULL, &job->trade, err));
    return resolve(job, &job->trade, err);
}

// "0.12 %", "3e-07"
static cli_text error_text(double error)
{
    return isnan(error)        ? cli_format("-")
           : error >= 9.995e-4 ? cli_format("%.2g %%", 100.0 * error)
                               : cli_format("%.1e", error);
}

static cli_text asked_text(const lac_trade_request *ask, const char *unit)
{
    cli_text error = {""};
    if (!isnan(ask->within)) {
        error = cli_exact(ask->within, unit);
    } else if (!isnan(ask->reach) || isnan(ask->budget)) {
        error = cli_format("%.3g %%", 100.0 * (isnan(ask->reach) ? 0.01 : ask->reach));
    }
    const bool both = error.s[0] != '\0' && !isnan(ask->budget);
    return cli_format("%s%s%s", error.s, both ? " within " : "",
                      isnan(ask->budget) ? "" : cli_amount(ask->budget, "s").s);
}

// "--set solver.rtol=0.001"; what is no run in time has its command named.
static cli_text choice_text(const lac_trade_run *run)
{
    char options[LAC_TEXT_ROOM];
    const char *command = lac_trade_command(run);
    if (*lac_trade_options(run, options) == '\0') {
        return cli_format("the case as it is");
    }
    return strcmp(command, "run") == 0 ? cli_format("%s", options)
                                       : cli_format("lacuna %s with %s", command, options);
}

static void write_sentence(lac_trade *t, const lac_trade_request *ask)
{
    const size_t size = sizeof t->sentence;
    const cli_text asked = asked_text(ask, lac_quantities[t->quantity].unit);
    const lac_trade_run *run = t->recommended != NULL ? t->recommended : t->closest;
    if (run == NULL) {
        (void)snprintf(t->sentence, size, "No run that was tried has this quantity.");
    } else {
        (void)snprintf(t->sentence, size, "%s %s%s %s (error %s +- %s, %s of CPU, %.3g MB).",
                       run == t->recommended ? "For" : "Nothing tried keeps to", asked.s,
                       run == t->recommended ? ":" : "; the closest is", choice_text(run).s,
                       error_text(run->error).s, error_text(run->uncertainty).s,
                       cli_amount(run->m.cpu_time, "s").s, run->m.memory / 1e6);
    }
    if (isnan(t->reference->uncertainty)) {
        lac_append(t->sentence, size,
                   " The reference's own error is not known: no coarser run was done.");
    }
}

// The settings of a run, or their names, as wide as the widest of the table.
static void print_dials(const lac_trade *t, const lac_trade_run *run)
{
    for (size_t d = 0; d < t->settings; d++) {
        const char *name = t->setting[d].setting->name;
        size_t width = strlen(name);
        for (size_t i = 0; i < t->rows; i++) {
            const size_t n = strlen(t->row[i]->label[d]);
            width = n > width ? n : width;
        }
        if (t->setting[d].shown > 0) {
            printf(" %-*s", (int)width, run != NULL ? run->label[d] : name);
        }
    }
}

static void print_row(const lac_trade *t, const lac_trade_run *run)
{
    const bool none = lac_trade_of_run(t, run) == LAC_OF_CASCADE; // it has no steps
    printf("%c ", run->on_front ? '*' : ' ');
    print_dials(t, run);
    if (run->end != LAC_TRADE_DONE) {
        printf("  %s: %s\n", lac_trade_end_name(run->end), run->message);
        return;
    }
    printf(" %9s +- %-7s %10s %10s %8.3g %9s\n", error_text(run->error).s,
           error_text(run->uncertainty).s, cli_amount(run->m.cpu_time, "s").s,
           cli_amount(run->m.wall_time, "s").s, run->m.memory / 1e6,
           none ? "-" : cli_format("%.0f", run->m.steps).s);
}

static void print_text(const lac_trade *t, const cli_request *request)
{
    char settings[LAC_TEXT_ROOM];
    const lac_quantity_about *info = &lac_quantities[t->quantity];
    if (t->title != NULL) {
        puts(t->title);
    }
    cli_row(info->doc, "%s +- %s", cli_amount(t->reference->value, info->unit).s,
            error_text(t->reference->uncertainty).s);
    cli_row("reference", "%s", lac_trade_settings_text(t->reference, settings));
    printf("\n  ");
    print_dials(t, NULL);
    printf(" %9s    %-7s %10s %10s %8s %9s\n", "error", "", "CPU", "wall", "MB", "steps");
    for (size_t i = 0; i < t->rows; i++) {
        print_row(t, t->row[i]);
    }
    for (size_t i = 0; i < t->refusals; i++) {
        cli_say(request, "refused: %s", t->row[t->rows + i]->message);
    }
    printf("  * on the front: no other errs and costs less%s\n\n",
           t->refusals > 0 ? "; settings that do not go together were left out (-v)" : "");
    cli_wrap("", t->sentence);
    cli_row("file", "%s", t->path);
}

static lac_status put_out(cli_trade_job *job, lac_error *err)
{
    lac_trade *trade = &job->trade;
    lac_dataset *dataset = NULL;
    lac_status status;
    LAC_TRY(cli_blame(job->source, lac_trade_judge(trade, &job->ask, err), err));
    trade->title = job->source->title;
    trade->path = job->path;
    write_sentence(trade, &job->ask);
    LAC_TRY(lac_trade_describe(trade, &dataset, err));
    LAC_TRY(cli_store_dataset(job->request, job->source, INT64_MIN, job->path, dataset, err));
    if (cli_given(job->request, CLI_OPT_JSON)) {
        lac_json json = {.out = stdout};
        trade->wall_time = cli_clock() - job->started;
        lac_json_open(&json, NULL, '{');
        lac_dataset_json(dataset, &json);
        lac_json_close(&json, '}');
    } else {
        print_text(trade, job->request);
    }
out:
    lac_dataset_free(dataset);
    return status;
}

lac_status cli_trade(const cli_request *request, lac_error *err)
{
    cli_trade_job job = {.request = request,
                         .keep = {"trade", .size = sizeof(lac_trade_run)},
                         .started = cli_clock()};
    lac_status status;
    LAC_TRY(prepare(&job, err));
    LAC_TRY(cli_keep_open(&job.keep, job.path, cli_given(request, CLI_OPT_RESUME),
                          cli_trade_take_over, &job, err));
    cli_say(request, "%zu combinations, %d at a time", job.trade.runs, job.pool.jobs);
    cli_signals_hold();
    cli_progress_start(&job.progress, request);
    status = cli_trade_run(&job, err);
    cli_progress_clear(&job.progress);
    LAC_TRY(status);
    LAC_TRY(put_out(&job, err));
out:
    // A question that had no answer can be put again without the runs being made again.
    cli_keep_close(&job.keep, status == LAC_OK);
    lac_trade_clear(&job.trade);
    lac_case_free(job.source);
    free(job.path);
    return status;
}
