// SPDX-License-Identifier: GPL-3.0-or-later
// initial.run: a run goes on from another one. Its state is taken from the checkpoint or a snapshot
// of that one's file, run on under its own loads to the time of the branch, and handed to the
// problem of the case that goes on; docs/theory/restart.md.
#define _GNU_SOURCE // open_memstream
#include "simulation/branch.h"

#include <stdarg.h>

#include "base/date.h"
#include "base/units.h"
#include "scene/estimate.h"
#include "store/store_cells.h"

void lac_branch_free(lac_branch *branch)
{
    if (branch == NULL) {
        return;
    }
    lac_run_start_clear(&branch->start);
    lac_stored_past_clear(&branch->past);
    lac_case_free(branch->source);
    free(branch->changes);
    free(branch);
}

#define SAY(b, ...) lac_append((b)->text, sizeof(b)->text, __VA_ARGS__)

// --- What the case changes.

// Whether a key is `part` or below it.
static bool below(const char *key, const char *part)
{
    const size_t length = strlen(part);
    return strncmp(key, part, length) == 0 && (key[length] == '\0' || key[length] == '.');
}

static bool any_below(const char *key, const char *const *parts)
{
    bool found = false;
    for (; *parts != NULL && !found; parts++) {
        found = below(key, *parts);
    }
    return found;
}

typedef struct finding {
    lac_branch *branch;
    FILE *list;
    lac_error refused;
} finding;

static void on_change(void *context, const char *key, const char *before, const char *after)
{
    static const char *const kept[] = {"interface",  "initial",      "load.normal", "weakening",
                                       "time.start", "load.history", NULL};
    static const char *const beside[] = {
        "time",        "output", "analysis",         "rg", "fit", "compare", "title", "references",
        "institution", "lacuna", "solver.max_steps", NULL};
    static const char *const rock[] = {"transfer", "material", "solver.fft_planning", NULL};
    finding *f = context;
    if (below(key, "initial.run")) {
        return;
    }
    if (any_below(key, kept) && f->refused.message[0] == '\0') {
        (void)lac_fail(&f->refused, LAC_EINPUT,
                       "%s: \"%s\" cannot become \"%s\": a run that goes on from another keeps its "
                       "cells, what presses them, its start and its weakening",
                       key, before, after);
    }
    f->branch->same = f->branch->same && any_below(key, beside);
    f->branch->new_scene = f->branch->new_scene || any_below(key, rock);
    if (!below(key, "output") && !below(key, "title")) {
        (void)fprintf(f->list, "%s%s: %s -> %s", ftell(f->list) > 0 ? "; " : "", key,
                      before[0] != '\0' ? before : "(none)", after[0] != '\0' ? after : "(none)");
    }
}

static lac_status find_changes(lac_branch *b, lac_error *err)
{
    size_t size = 0;
    finding f = {.branch = b, .list = open_memstream(&b->changes, &size)};
    LAC_FAIL_MEMORY_IF(f.list == NULL, err);
    b->same = true;
    const lac_status status = lac_case_compare(b->source, b->to, on_change, &f, err);
    const bool whole = ferror(f.list) == 0;
    LAC_FAIL_MEMORY_IF(fclose(f.list) != 0 || !whole, err);
    LAC_TRY_RETURN(status);
    return f.refused.message[0] != '\0' ? lac_fail(err, LAC_EINPUT, "%s", f.refused.message)
                                        : LAC_OK;
}

// --- Where it begins.

static lac_status parse_at(const lac_branch *b, const char *at, double *time, lac_error *err)
{
    lac_units *units = NULL;
    double date;
    if (b->to->dated && lac_date_parse(at, &date)) {
        *time = date - b->to->start_date;
        return LAC_OK;
    }
    LAC_TRY_RETURN(lac_units_create(&units, err));
    const lac_status status = lac_units_parse(units, at, "s", time, NULL);
    lac_units_free(units);
    return status == LAC_OK
               ? LAC_OK
               : lac_fail(err, LAC_EINPUT,
                          "initial.run.at: \"%s\" must be last, a time such as \"30 day\"%s or the "
                          "number of a snapshot",
                          at, b->to->dated ? ", a date" : "");
}

// The snapshots that hold all that the run needs. @param lacks  what they lack besides; NULL where
// no snapshot could hold it; "": nothing
static size_t usable_snapshots(const lac_branch *b, const char **lacks)
{
    lac_weakening_set weak = {0};
    const lac_model_list *list = &b->source->weakening;
    (void)lac_weakening_set_create(list->item, list->count, &weak, NULL); // read once already
    *lacks = "";
    for (size_t k = 0; *lacks != NULL && k < weak.count; k++) {
        const char *field = lac_stored_past_field(&weak.item[k]);
        *lacks = field == NULL || !lac_stored_past_has(&b->past, field) ? field : *lacks;
    }
    return *lacks != NULL && **lacks == '\0' ? b->past.snapshots : 0;
}

static lac_status fail_nothing(const lac_branch *b, lac_error *err)
{
    const lac_stored_past *past = &b->past;
    const char *file = b->to->from.file, *lacks;
    (void)usable_snapshots(b, &lacks);
    LAC_FAIL_IF(lacks == NULL, err, LAC_EINPUT,
                "%s: weakening depends on more than its snapshots can keep: only the checkpoint of "
                "a run that was stopped does, by output.checkpoint",
                file);
    LAC_FAIL_IF(past->lacks[0] != '\0' || lacks[0] != '\0', err, LAC_EINPUT,
                "%s: %s%s%s; and output.fields_every: as often as runs may branch off, or "
                "output.checkpoint, whose last one is kept until the run is complete",
                file, past->lacks,
                past->lacks[0] == '\0'
                    ? "keeps no field that its weakening needs: output.fields: with "
                : lacks[0] != '\0' ? " with "
                                   : "",
                lacks);
    return lac_fail(err, LAC_EINPUT, "%s: keeps no snapshot and no checkpoint%s", file,
                    past->has_checkpoint ? " at or before that time" : "");
}

// The last state that is kept no later than the time.
static lac_status find_kept(lac_branch *b, lac_error *err)
{
    const lac_stored_past *past = &b->past;
    const double kept = past->checkpoint.from.time;
    const char *lacks;
    const size_t snapshots = usable_snapshots(b, &lacks);
    bool found = false;
    for (size_t i = 0; i < snapshots && past->time[i] <= b->time; i++) {
        b->snapshot = i;
        b->from = past->time[i];
        found = true;
    }
    if (past->has_checkpoint && kept <= b->time && (!found || kept >= b->from)) {
        b->snapshot = SIZE_MAX;
        b->from = kept;
        found = true;
    }
    return found ? LAC_OK : fail_nothing(b, err);
}

static lac_status find_place(lac_branch *b, lac_error *err)
{
    const lac_stored_past *past = &b->past;
    const char *at = b->to->from.at != NULL ? b->to->from.at : "last";
    const char *file = b->to->from.file;
    const bool index = at[0] != '\0' && at[strspn(at, "0123456789")] == '\0';
    const char *lacks;
    const size_t usable = usable_snapshots(b, &lacks);
    b->time = INFINITY;
    if (index) {
        const unsigned long long k = strtoull(at, NULL, 10);
        LAC_TRY_RETURN(usable == 0 ? fail_nothing(b, err) : LAC_OK);
        LAC_FAIL_IF(k >= usable, err, LAC_EINPUT,
                    "%s: has no such snapshot as initial.run.at: %s: they are 0 to %zu", file, at,
                    usable - 1);
        b->snapshot = (size_t)k;
        b->time = b->from = past->time[k];
        return LAC_OK;
    }
    const bool last = strcmp(at, "last") == 0;
    LAC_TRY_RETURN(last ? LAC_OK : parse_at(b, at, &b->time, err));
    LAC_FAIL_IF(
        !last && !(b->time >= past->first && b->time <= past->last), err, LAC_EINPUT,
        "initial.run.at: \"%s\", %.9g s, is not within the run in %s, from %.9g s to %.9g s", at,
        b->time, file, past->first, past->last);
    LAC_TRY_RETURN(find_kept(b, err));
    b->time = last ? b->from : b->time;
    return LAC_OK;
}

static void tell_plan(lac_branch *b)
{
    const double hour = 3600.0;
    SAY(b, "goes on from %s at %.9g s", b->to->from.file, b->time);
    if (b->time >= hour) {
        SAY(b, " (%.6g day)", b->time / (24.0 * hour));
    }
    if (b->snapshot != SIZE_MAX) {
        SAY(b, ", from its snapshot %zu", b->snapshot);
    } else {
        SAY(b, ", from its checkpoint");
    }
    if (b->from < b->time) {
        SAY(b, " at %.9g s, run on to there under its own loads", b->from);
    }
    SAY(b, "; %s%.300s%s", b->changes[0] != '\0' ? "changed: " : "nothing is changed", b->changes,
        strlen(b->changes) > 300 ? " ..." : "");
}

// What goes on does so as it was begun.
static void keep_fidelity(lac_case *c, const lac_case *source)
{
    char why[LAC_FIDELITY_ROOM];
    if (c->run.fidelity != LAC_FIDELITY_AUTO) {
        return;
    }
    c->run.fidelity = LAC_FIDELITY_ODE;
    if (source->run.fidelity == LAC_FIDELITY_ASYNC && !lac_fidelity_refused(c, why)) {
        c->run.fidelity = LAC_FIDELITY_ASYNC;
        c->formulation = LAC_FORMULATION_RATE;
    }
}

lac_status lac_branch_open(lac_case *c, lac_branch **out, lac_error *err)
{
    lac_status status;
    lac_branch *b = *out = calloc(1, sizeof *b);
    LAC_FAIL_MEMORY_IF(b == NULL, err);
    b->to = c;
    LAC_TRY(lac_stored_past_open(c->from.file, &b->past, err));
    const char *text = b->past.case_text;
    (void)snprintf(b->sum, sizeof b->sum, "%016" PRIx64,
                   lac_sum_bytes(LAC_SUM_OF_NOTHING, text, strlen(text)));
    // files that it names are looked for where those of the case are
    status = lac_case_read_text(c->path, text, strlen(text), NULL, &b->source, NULL, err);
    LAC_TRY(lac_fail_within(err, status, "the case in %s", c->from.file));
    LAC_LEAVE_IF(b->source->run.fidelity == LAC_FIDELITY_LUMPED, err, LAC_EINPUT,
                 "initial.run.file: %s is of a lumped run, in which cells have no state of their "
                 "own: go on from one of fidelity ode",
                 c->from.file);
    keep_fidelity(c, b->source);
    LAC_TRY(find_changes(b, err));
    LAC_TRY(find_place(b, err));
    LAC_LEAVE_IF(!(b->time < c->run.end), err, LAC_EINPUT,
                 "time.end: the run would end at %.9g s and goes on from %s at %.9g s", c->run.end,
                 c->from.file, b->time);
    tell_plan(b);
out:
    LAC_MADE(status, out, lac_branch_free);
}

// --- On the way to it.

// The cells that the file has must be those that the case makes.
static lac_status check_cells(const lac_branch *b, const lac_domain *domain, const char *whose,
                              lac_error *err)
{
    lac_domain *kept = NULL;
    const char *file = b->to->from.file;
    LAC_TRY_RETURN(lac_stored_domain_read(file, &kept, err));
    bool same = kept->n == domain->n;
    for (size_t i = 0; same && i < domain->n; i++) {
        same = kept->index[i] == domain->index[i] && kept->pressure[i] == domain->pressure[i];
    }
    lac_domain_free(kept);
    LAC_FAIL_IF(!same, err, LAC_EINPUT,
                "%s: its contact cells or their pressures are not those that %s makes: material or "
                "a file that it reads has changed",
                file, whose);
    return LAC_OK;
}

// State of the snapshot as a start of the source's problem.
static lac_status take_snapshot(const lac_branch *b, const lac_problem *problem,
                                lac_run_start *start, lac_error *err)
{
    start->origin = b->from;
    LAC_TRY_RETURN(lac_problem_state_create(problem, &start->state, err));
    return lac_stored_past_state(&b->past, b->snapshot, problem, &start->state, err);
}

// A run over no time, for what is kept at the time itself.
static lac_status stand_still(const lac_branch *b, const lac_problem *problem, lac_run_start *start,
                              lac_error *err)
{
    lac_run_start *out = (lac_run_start *)&b->start;
    const size_t unknowns = lac_problem_unknowns(problem), n = start->state.n;
    double *y = calloc(unknowns + n + lac_problem_work(problem), sizeof *y);
    LAC_FAIL_MEMORY_IF(y == NULL, err);
    const lac_status status = lac_run_start_take(start, problem, y, y + unknowns, err);
    if (status == LAC_OK) {
        lac_problem_forget(problem, y + unknowns + n);
        lac_problem_give(problem, b->time, y, y + unknowns, &start->state, y + unknowns + n);
        *out = *start;
        *start = (lac_run_start){0};
    }
    free(y);
    return status;
}

static lac_status run_on(lac_branch *b, const lac_simulation_options *options,
                         const lac_problem *problem, lac_error *err)
{
    lac_run_start begin = {0};
    lac_run_result result;
    lac_run_def def = b->source->run;
    lac_status status = LAC_OK;
    def.end = b->time;
    def.snapshots = false;
    def.reached = &b->start;
    def.interrupted = options->interrupted;
    def.progress = options->progress;
    def.context = options->context;
    if (b->snapshot == SIZE_MAX) {
        def.resume = &b->past.checkpoint.from;
    } else {
        LAC_TRY(take_snapshot(b, problem, &begin, err));
        if (!(b->from < b->time)) {
            status = stand_still(b, problem, &begin, err);
            goto out;
        }
        def.start = &begin;
    }
    LAC_TRY(lac_run(problem, &def, NULL, &result, err));
    LAC_LEAVE_IF(result.end != LAC_END_TIME, err, LAC_EINPUT,
                 "initial.run.at: the run in %s ends at %.9g s (%s), before %.9g s",
                 b->to->from.file, result.time, lac_end_name(result.end), b->time);
out:
    lac_run_start_clear(&begin);
    return status;
}

// Mean slip rate and shear force over the nominal area.
static lac_status observe(const lac_branch *b, const lac_problem *problem, bool to, double out[2],
                          lac_error *err)
{
    const size_t unknowns = lac_problem_unknowns(problem), n = lac_problem_cells(problem);
    lac_observation seen;
    double *y = calloc(unknowns + n + lac_problem_work(problem), sizeof *y);
    LAC_FAIL_MEMORY_IF(y == NULL, err);
    const lac_run_start own = {.origin = b->start.origin,
                               .base = b->start.base,
                               .state = b->start.state,
                               .same = !to,
                               .y = b->start.y,
                               .slip = b->start.slip,
                               .formulation = b->start.formulation};
    const lac_status status =
        lac_run_start_take(to ? &b->start : &own, problem, y, y + unknowns, err);
    if (status == LAC_OK) {
        double *work = y + unknowns + n;
        const double *slip =
            lac_problem_has_slip(problem) ? y + lac_problem_slip_place(problem) : y + unknowns;
        lac_problem_forget(problem, work);
        lac_problem_observe(problem, b->time, y, slip, false, &seen, work);
        out[0] = seen.mean_rate;
        out[1] = seen.shear_force;
    }
    free(y);
    return status;
}

// Where slip rate and state fix the load at the start, another friction would make it another load.
static lac_status check_load(const lac_branch *b, const double *before, const lac_problem *problem,
                             lac_error *err)
{
    const double *after = lac_problem_parts_of(problem).traction;
    const lac_initial_def *initial = &b->to->initial;
    const bool fixed = !isnan(initial->slip_rate) && initial->state != LAC_STATE_FROM_LOAD;
    for (size_t i = 0; fixed && i < lac_problem_cells(problem); i++) {
        LAC_FAIL_IF(fabs(after[i] - before[i]) > 1e-9 * fabs(before[i]), err, LAC_EINPUT,
                    "initial.slip_rate and initial.state fix the shear load by friction and pore "
                    "pressure at the start, which cannot be other ones then (%s): let load.shear "
                    "fix it",
                    b->changes);
    }
    return LAC_OK;
}

static void tell_jump(lac_branch *b, const double before[2], const double after[2])
{
    if (b->same) {
        return;
    }
    SAY(b,
        "; mean slip rate %.4g -> %.4g m/s, shear force %.6g -> %.6g N, slip and state of the "
        "cells as they were",
        before[0], after[0], before[1], after[1]);
}

lac_status lac_branch_reach(lac_branch *b, const lac_simulation_options *options, lac_scene **scene,
                            lac_error *err)
{
    double before[2], after[2];
    double *traction = NULL;
    lac_status status;
    const char *file = b->to->from.file;
    LAC_TRY(lac_fail_within(err, lac_scene_create(b->source, NULL, scene, err), "%s", file));
    LAC_TRY(check_cells(b, (*scene)->contact.domain, file, err));
    const size_t n = (*scene)->contact.domain->n;
    LAC_TRY(lac_fail_within(err, run_on(b, options, (*scene)->problem, err), "%s", file));
    LAC_TRY(observe(b, (*scene)->problem, false, before, err));
    traction = malloc(n * sizeof *traction);
    LAC_TRY(traction != NULL ? LAC_OK : lac_fail_memory(err));
    memcpy(traction, lac_problem_parts_of((*scene)->problem).traction, n * sizeof *traction);
    if (b->new_scene) {
        lac_scene_free(*scene);
        *scene = NULL;
        LAC_TRY(lac_scene_create(b->to, NULL, scene, err));
        LAC_TRY(check_cells(b, (*scene)->contact.domain, "the case", err));
    } else {
        (*scene)->source = b->to;
        LAC_TRY(lac_scene_renew(*scene, NULL, true, err));
    }
    b->start.same = b->same && b->start.y != NULL;
    LAC_TRY(check_load(b, traction, (*scene)->problem, err));
    LAC_TRY(observe(b, (*scene)->problem, true, after, err));
    tell_jump(b, before, after);
out:
    free(traction);
    return status;
}
