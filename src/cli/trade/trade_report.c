// SPDX-License-Identifier: GPL-3.0-or-later
// What a trade came to.
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "cli/common/output.h"
#include "cli/common/words.h"
#include "cli/trade/trade.h"
#include "data/json.h"
#include "store/store.h"

enum { SENTENCE = 1024, SETTINGS = 512 };

static bool is_row(const cli_trade_job *job, size_t run)
{
    const lac_trade_end end = job->measure[run].end;
    return (job->plan.run[run].why & LAC_TRADE_TRIED) != 0 &&
           (end == LAC_TRADE_DONE || end == LAC_TRADE_BROKEN || end == LAC_TRADE_GIVEN_UP);
}

static const char *end_word(lac_trade_end end)
{
    return end == LAC_TRADE_DONE ? "done" : end == LAC_TRADE_GIVEN_UP ? "given up" : "broken";
}

// Numbers by value, from small to large; else by name.
static int compare_labels(const char *a, const char *b)
{
    char *end_a, *end_b;
    const double x = strtod(a, &end_a), y = strtod(b, &end_b);
    const bool numbers = end_a != a && end_b != b && *end_a == '\0' && *end_b == '\0';
    return !numbers ? strcmp(a, b) : (x > y) - (x < y);
}

// The rows in the order of a table: what is turned against a rung of the ladder stays together.
static bool stands_before(const cli_trade_job *job, size_t a, size_t b)
{
    const lac_trade_plan *plan = &job->plan;
    for (size_t d = 0; d < plan->dials; d++) {
        const int order = compare_labels(job->settings[a].label[d], job->settings[b].label[d]);
        if (d != plan->ladder && order != 0) {
            return order < 0;
        }
    }
    return plan->ladder != SIZE_MAX &&
           plan->run[a].at[plan->ladder] < plan->run[b].at[plan->ladder];
}

// The row after `last` in that order, SIZE_MAX: the first; SIZE_MAX after the last one.
static size_t next_row(const cli_trade_job *job, size_t last)
{
    size_t next = SIZE_MAX;
    for (size_t i = 0; i < job->plan.runs; i++) {
        const bool after = last == SIZE_MAX || stands_before(job, last, i) ||
                           (!stands_before(job, i, last) && i > last);
        if (is_row(job, i) && after && (next == SIZE_MAX || stands_before(job, i, next))) {
            next = i;
        }
    }
    return next;
}

// "solver.rtol=1e-05 solver.method=bdf": all dials, as the run has them in the end.
static const char *settings_text(const cli_trade_job *job, size_t run, char *text, size_t size)
{
    text[0] = '\0';
    for (size_t d = 0; d < job->plan.dials; d++) {
        const size_t used = strlen(text);
        (void)snprintf(text + used, size - used, "%s%s=%s", used > 0 ? " " : "",
                       job->plan.dial[d].dial->key, job->settings[run].label[d]);
    }
    return text;
}

// "0.12 %", "3e-07"
static cli_text error_text(double error)
{
    return isnan(error)        ? cli_format("-")
           : error >= 9.995e-4 ? cli_format("%.2g %%", 100.0 * error)
                               : cli_format("%.1e", error);
}

static cli_text asked_text(const cli_trade_job *job)
{
    const lac_trade_ask *ask = &job->ask;
    cli_text error = {""};
    if (!isnan(ask->within)) {
        error = cli_exact(ask->within, lac_quantity_about_of(job->verdict.quantity)->unit);
    } else if (!isnan(ask->reach) || isnan(ask->spend)) {
        error = cli_format("%.3g %%", 100.0 * (isnan(ask->reach) ? 0.01 : ask->reach));
    }
    const bool both = error.s[0] != '\0' && !isnan(ask->spend);
    return cli_format("%s%s%s", error.s, both ? " within " : "",
                      isnan(ask->spend) ? "" : cli_amount(ask->spend, "s").s);
}

// "error 0.05 % +- 1e-07, 0.12 s of CPU, 24 MB"
static cli_text run_text(const cli_trade_job *job, size_t run)
{
    const lac_trade_measure *m = &job->measure[run];
    return cli_format("error %s +- %s, %s of CPU, %.3g MB", error_text(job->verdict.error[run]).s,
                      error_text(job->verdict.uncertainty).s, cli_amount(m->cpu_time, "s").s,
                      (double)m->memory / 1e6);
}

// The command that the settings are for.
static const char *command_of(const cli_trade_job *job, size_t run)
{
    const lac_trade_of of = lac_trade_of_run(&job->plan, run);
    return of == LAC_OF_CASCADE ? "rg" : of == LAC_OF_CONTACT ? "contact" : "run";
}

// "--set solver.rtol=0.001"; what is no run in time has its command named.
static const char *choice_text(const cli_trade_job *job, size_t run, char *text, size_t size)
{
    char options[SETTINGS];
    const char *command = command_of(job, run);
    if (*cli_trade_options(job, run, options, sizeof options) == '\0') {
        (void)snprintf(text, size, "the case as it is");
    } else if (strcmp(command, "run") == 0) {
        (void)snprintf(text, size, "%s", options);
    } else {
        (void)snprintf(text, size, "lacuna %s with %s", command, options);
    }
    return text;
}

const char *cli_trade_sentence(const cli_trade_job *job, char *text, size_t size)
{
    char choice[SETTINGS + 32];
    const lac_trade_verdict *v = &job->verdict;
    const cli_text asked = asked_text(job);
    if (v->recommended != SIZE_MAX) {
        (void)snprintf(text, size, "For %s: %s (%s).", asked.s,
                       choice_text(job, v->recommended, choice, sizeof choice),
                       run_text(job, v->recommended).s);
    } else if (v->closest != SIZE_MAX) {
        (void)snprintf(text, size, "Nothing tried does for %s; the closest is %s (%s).", asked.s,
                       choice_text(job, v->closest, choice, sizeof choice),
                       run_text(job, v->closest).s);
    } else {
        (void)snprintf(text, size, "Nothing tried has this quantity.");
    }
    if (isnan(v->uncertainty)) {
        const size_t used = strlen(text);
        (void)snprintf(text + used, size - used,
                       " The reference's own error is not known: no coarser run was "
                       "done.");
    }
    return text;
}

static int width_of(const cli_trade_job *job, size_t d)
{
    size_t width = strlen(job->plan.dial[d].dial->name);
    for (size_t i = 0; i < job->plan.runs; i++) {
        const size_t n = strlen(job->settings[i].label[d]);
        width = is_row(job, i) && n > width ? n : width;
    }
    return (int)width;
}

static void print_row(const cli_trade_job *job, size_t run)
{
    const lac_trade_measure *m = &job->measure[run];
    printf("%c ", job->verdict.on_front[run] ? '*' : ' ');
    for (size_t d = 0; d < job->plan.dials; d++) {
        if (job->plan.dial[d].shown > 0) {
            printf(" %-*s", width_of(job, d), job->settings[run].label[d]);
        }
    }
    if (m->end != LAC_TRADE_DONE) {
        printf("  %s: %s\n", end_word(m->end), m->message);
        return;
    }
    const bool none = lac_trade_of_run(&job->plan, run) == LAC_OF_CASCADE; // it has no steps
    printf(" %9s +- %-7s %10s %10s %8.3g %9s\n", error_text(job->verdict.error[run]).s,
           error_text(job->verdict.uncertainty).s, cli_amount(m->cpu_time, "s").s,
           cli_amount(m->wall_time, "s").s, (double)m->memory / 1e6,
           none ? "-" : cli_format("%" PRId64, m->steps).s);
}

static void print_head(const cli_trade_job *job)
{
    const lac_trade_verdict *v = &job->verdict;
    const lac_quantity_about *about = lac_quantity_about_of(v->quantity);
    char settings[SETTINGS];
    if (job->source->title != NULL) {
        puts(job->source->title);
    }
    cli_row(about->doc, "%s +- %s", cli_amount(v->value, about->unit).s,
            error_text(v->uncertainty).s);
    cli_row("reference", "%s", settings_text(job, v->reference, settings, sizeof settings));
    printf("\n  ");
    for (size_t d = 0; d < job->plan.dials; d++) {
        if (job->plan.dial[d].shown > 0) {
            printf(" %-*s", width_of(job, d), job->plan.dial[d].dial->name);
        }
    }
    printf(" %9s    %-7s %10s %10s %8s %9s\n", "error", "", "CPU", "wall", "MB", "steps");
}

static void print_left_out(const cli_trade_job *job)
{
    size_t refused = 0;
    for (size_t i = 0; i < job->plan.runs; i++) {
        const lac_trade_measure *m = &job->measure[i];
        if (m->end == LAC_TRADE_REFUSED) {
            refused++;
            cli_say(job->request, "refused: %s", m->message);
        }
    }
    printf("  * on the front: no other errs and costs less%s\n",
           refused > 0 ? "; settings that do not go together were left out (-v)" : "");
}

void cli_trade_print(const cli_trade_job *job)
{
    char text[SENTENCE];
    print_head(job);
    for (size_t i = next_row(job, SIZE_MAX); i != SIZE_MAX; i = next_row(job, i)) {
        print_row(job, i);
    }
    print_left_out(job);
    puts("");
    cli_wrap("", cli_trade_sentence(job, text, sizeof text));
    cli_row("file", "%s", job->path);
}

static void write_settings(lac_json *json, const cli_trade_job *job, size_t run)
{
    lac_json_open(json, "settings", '{');
    for (size_t d = 0; d < job->plan.dials; d++) {
        const char *label = job->settings[run].label[d];
        char *end;
        const double value = strtod(label, &end);
        if (*label != '\0' && *end == '\0') {
            lac_json_number(json, job->plan.dial[d].dial->key, value);
        } else {
            lac_json_text(json, job->plan.dial[d].dial->key, label);
        }
    }
    lac_json_close(json, '}');
}

static void write_run(lac_json *json, const char *key, const cli_trade_job *job, size_t run)
{
    const lac_trade_measure *m = &job->measure[run];
    const bool done = m->end == LAC_TRADE_DONE;
    char options[SETTINGS];
    lac_json_open(json, key, '{');
    write_settings(json, job, run);
    lac_json_text(json, "command", command_of(job, run));
    lac_json_text(json, "options", cli_trade_options(job, run, options, sizeof options));
    lac_json_text(json, "end", end_word(m->end));
    lac_json_text(json, "message", m->message[0] != '\0' ? m->message : NULL);
    lac_json_number(json, "value", done ? m->value[job->verdict.quantity] : NAN);
    lac_json_number(json, "error", job->verdict.error[run]);
    lac_json_number(json, "error_uncertainty", job->verdict.uncertainty);
    lac_json_number(json, "wall_time_s", m->wall_time);
    lac_json_number(json, "cpu_time_s", m->cpu_time);
    lac_json_integer(json, "peak_memory_bytes", m->memory);
    lac_json_integer(json, "output_bytes", m->output);
    lac_json_integer(json, "steps", m->steps);
    lac_json_integer(json, "rhs_evaluations", m->evaluations);
    lac_json_integer(json, "n_cells", m->cells);
    lac_json_boolean(json, "on_front", job->verdict.on_front[run]);
    lac_json_close(json, '}');
}

static void write_refused(lac_json *json, const cli_trade_job *job)
{
    lac_json_open(json, "refused", '[');
    for (size_t i = 0; i < job->plan.runs; i++) {
        if (job->measure[i].end == LAC_TRADE_REFUSED) {
            lac_json_text(json, NULL, job->measure[i].message);
        }
    }
    lac_json_close(json, ']');
}

void cli_trade_json(const cli_trade_job *job)
{
    lac_json json = {.out = stdout};
    char text[SENTENCE];
    const lac_trade_verdict *v = &job->verdict;
    const lac_quantity_about *about = lac_quantity_about_of(v->quantity);
    lac_json_open(&json, NULL, '{');
    lac_json_text(&json, "title", job->source->title);
    lac_json_text(&json, "quantity", about->name);
    lac_json_text(&json, "unit", about->unit);
    write_run(&json, "reference", job, v->reference);
    lac_json_open(&json, "runs", '[');
    for (size_t i = next_row(job, SIZE_MAX); i != SIZE_MAX; i = next_row(job, i)) {
        write_run(&json, NULL, job, i);
    }
    lac_json_close(&json, ']');
    write_refused(&json, job);
    if (v->recommended != SIZE_MAX) {
        write_run(&json, "recommended", job, v->recommended);
    } else {
        lac_json_null(&json, "recommended");
    }
    lac_json_text(&json, "recommendation", cli_trade_sentence(job, text, sizeof text));
    lac_json_number(&json, "wall_time_s", cli_clock() - job->started);
    lac_json_text(&json, "output", job->path);
    lac_json_close(&json, '}');
}

static void fill_row(const cli_trade_job *job, size_t run, char *settings, lac_trade_row *row)
{
    const lac_trade_measure *m = &job->measure[run];
    const lac_trade_verdict *v = &job->verdict;
    *row = (lac_trade_row){.settings = settings_text(job, run, settings, SETTINGS),
                           .end = end_word(m->end),
                           .value = m->end == LAC_TRADE_DONE ? m->value[v->quantity] : NAN,
                           .error = v->error[run],
                           .uncertainty = v->uncertainty,
                           .wall_time = m->wall_time,
                           .cpu_time = m->cpu_time,
                           .memory = (double)m->memory,
                           .output = (double)m->output,
                           .steps = (double)m->steps,
                           .evaluations = (double)m->evaluations,
                           .on_front = v->on_front[run]};
}

static lac_status write_store(const cli_trade_job *job, size_t rows, lac_trade_row *row,
                              char (*settings)[SETTINGS], lac_error *err)
{
    char reference[SETTINGS], sentence[SENTENCE], recommended[SETTINGS];
    const lac_trade_verdict *v = &job->verdict;
    const lac_quantity_about *about = lac_quantity_about_of(v->quantity);
    size_t n = 0;
    for (size_t i = next_row(job, SIZE_MAX); i != SIZE_MAX && n < rows; i = next_row(job, i)) {
        fill_row(job, i, settings[n], &row[n]);
        n++;
    }
    const bool any = v->recommended != SIZE_MAX;
    const lac_trade_view view = {
        .quantity = about->name,
        .unit = about->unit,
        .about = about->doc,
        .value = v->value,
        .uncertainty = v->uncertainty,
        .reference = settings_text(job, v->reference, reference, sizeof reference),
        .recommended =
            any ? settings_text(job, v->recommended, recommended, sizeof recommended) : NULL,
        .sentence = cli_trade_sentence(job, sentence, sizeof sentence),
        .runs = n,
        .row = row};
    lac_dataset *dataset = NULL;
    lac_status status = lac_trade_describe(&view, &dataset, err);
    if (status == LAC_OK) {
        status = cli_store_dataset(job->request, job->source, INT64_MIN, job->path, dataset, err);
    }
    lac_dataset_free(dataset);
    return status;
}

lac_status cli_trade_store(const cli_trade_job *job, lac_error *err)
{
    size_t rows = 0;
    for (size_t i = 0; i < job->plan.runs; i++) {
        rows += is_row(job, i) ? 1 : 0;
    }
    lac_trade_row *row = calloc(rows + 1, sizeof *row);
    char(*settings)[SETTINGS] = calloc(rows + 1, sizeof *settings);
    lac_status status = row != NULL && settings != NULL ? write_store(job, rows, row, settings, err)
                                                        : lac_fail_memory(err);
    free(row);
    free(settings);
    return status;
}
