// SPDX-License-Identifier: GPL-3.0-or-later
// From positions of dials to the case of a run.
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/common/inputs.h"
#include "cli/common/libraries.h"
#include "cli/report/report.h"
#include "cli/trade/trade.h"
#include "lacuna/version.h"

// What the user sets, then what the dials set, which goes before it.
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
    for (size_t d = 0; d < plan->dials; d++) {
        const int at = plan->run[run].at[d];
        if (at >= 0) {
            out[n++] = (lac_override){plan->dial[d].dial->key, plan->dial[d].value[at].yaml};
        }
    }
    return n;
}

static lac_status first_issue(const lac_case_report *report, lac_status status, lac_error *err)
{
    char text[512];
    for (size_t i = 0; i < report->count; i++) {
        if (!report->issue[i].warning) {
            return lac_fail(err, status, "%s",
                            lac_case_issue_format(&report->issue[i], text, sizeof text));
        }
    }
    return status;
}

// --until, which has been looked at with the case itself.
static lac_status shorten(const cli_request *request, lac_case *c, lac_error *err)
{
    double until;
    if (request->until == NULL) {
        return LAC_OK;
    }
    lac_status status = cli_parse_time(request->until, c, &until, err);
    if (status == LAC_OK && until < c->run.end) {
        c->run.end = until;
    }
    return status;
}

lac_case_purpose cli_trade_purpose(lac_trade_of of)
{
    return of == LAC_OF_CASCADE ? LAC_FOR_RG : of == LAC_OF_CONTACT ? LAC_FOR_CONTACT : LAC_FOR_RUN;
}

lac_status cli_trade_case(const cli_trade_job *job, size_t run, lac_case **c, lac_error *err)
{
    const cli_request *request = job->request;
    const lac_trade_of of = lac_trade_of_run(&job->plan, run);
    lac_case_report report = {0};
    *c = NULL;
    lac_override *set = malloc((request->set_count + LAC_DIALS + 1) * sizeof *set);
    if (set == NULL) {
        return lac_fail_memory(err);
    }
    const lac_case_request how = {cli_trade_purpose(of), set, gather(job, run, set)};
    lac_status status = lac_case_read(request->argument[0], &how, c, &report, err);
    if (status != LAC_OK) {
        (void)first_issue(&report, status, err);
    } else {
        status = of == LAC_OF_RUN ? shorten(request, *c, err) : LAC_OK;
    }
    lac_case_report_clear(&report);
    free(set);
    return status;
}

// FNV-1a
static uint64_t add(uint64_t sum, const char *text)
{
    for (; *text != '\0'; text++) {
        sum = (sum ^ (unsigned char)*text) * UINT64_C(0x100000001b3);
    }
    return sum;
}

static lac_status describe(const cli_trade_job *job, const lac_case *c, cli_trade_settings *out,
                           lac_error *err)
{
    char libraries[256], end[32];
    char *text = lac_case_text(c), *sums = cli_inputs_sums(c);
    lac_status status = text == NULL || sums == NULL ? lac_fail_memory(err) : LAC_OK;
    if (status == LAC_OK) {
        (void)snprintf(end, sizeof end, "%a", c->run.end);
        out->key = add(UINT64_C(0xcbf29ce484222325), text);
        out->key = add(add(out->key, sums), end);
        out->key = add(add(out->key, LACUNA_VERSION), cli_libraries(libraries, sizeof libraries));
        for (size_t d = 0; d < job->plan.dials; d++) {
            lac_dial_current(job->plan.dial[d].dial, c, out->label[d]);
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
            for (size_t d = 0; d < plan->dials; d++) {
                plan->coarser[d] = plan->coarser[d] == run ? i : plan->coarser[d];
                plan->coarsest[d] = plan->coarsest[d] == run ? i : plan->coarsest[d];
            }
            return;
        }
    }
}

// Why no run may have a position; NULL: one may.
static const char *refusal(const cli_trade_job *job, size_t dial, size_t position)
{
    const char *why = NULL;
    for (size_t run = 0; run < job->plan.runs; run++) {
        if (job->plan.run[run].at[dial] != (short)position) {
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
    for (size_t d = 0; d < plan->dials; d++) {
        for (size_t p = 0; plan->dial[d].named && p < plan->dial[d].shown; p++) {
            const char *why = refusal(job, d, p);
            if (why != NULL) {
                why += strncmp(why, set, sizeof set - 1) == 0 ? sizeof set - 1 : 0;
                return lac_fail(err, LAC_EINPUT, "--dials: %s=%s: %s", plan->dial[d].dial->name,
                                plan->dial[d].value[p].label, why);
            }
        }
    }
    return LAC_OK;
}

lac_status cli_trade_resolve(cli_trade_job *job, lac_error *err)
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

const char *cli_trade_options(const cli_trade_job *job, size_t run, char *text, size_t size)
{
    const lac_trade_plan *plan = &job->plan;
    text[0] = '\0';
    for (size_t d = 0; d < plan->dials; d++) {
        const int at = plan->run[run].at[d];
        const char *label = job->settings[run].label[d];
        const lac_dial_value *value = at >= 0 ? &plan->dial[d].value[at] : NULL;
        const char *yaml = value != NULL ? value->yaml : label;
        const bool named = value != NULL && strcmp(value->yaml, value->label) != 0;
        if (strcmp(label, job->own.label[d]) == 0 && !named) {
            continue;
        }
        const size_t used = strlen(text);
        const char *quote = strchr(yaml, ' ') != NULL || strchr(yaml, '{') != NULL ? "'" : "";
        (void)snprintf(text + used, size - used, "%s--set %s%s=%s%s", used > 0 ? " " : "", quote,
                       plan->dial[d].dial->key, yaml, quote);
    }
    return text;
}
