// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna rg CASE|FILE.nc: the cascade of slip over a joint that is made, or over stored cells; the
// interfaces of an ensemble in processes of the pool, each kept as soon as it is done.
#include "cli/common/command.h"
#include "cli/common/keep.h"
#include "cli/common/output.h"
#include "cli/common/pool.h"
#include "cli/common/words.h"
#include "cli/report/report.h"
#include "scene/scene_rg.h"

// The cascade over the interfaces of a case: all but the last one are parts, made in processes of
// the pool and kept for --resume. The last one, whose cells the file shows, is made in the end, or
// is the only one.
typedef struct parts {
    const cli_request *request;
    const lac_case *source; // its rg.seeds interfaces
    cli_pool pool;
    cli_keep keep;
    size_t n, next;
    unsigned char **part; // [n] of lac_scene_rg_part; NULL: not made yet
} parts;

// Of a process. An interface that cannot be followed is the case's doing: --resume would not help.
typedef struct answer {
    lac_status status;
    lac_error why;
    max_align_t part[];
} answer;

static lac_status work(void *context, size_t task, void *result, lac_error *err)
{
    const parts *p = context;
    answer *said = result;
    (void)err;
    said->status = lac_scene_rg_part(p->source, task, said->part, &said->why);
    return LAC_OK;
}

static size_t next(void *context)
{
    parts *p = context;
    while (p->next < p->n && p->part[p->next] != NULL) {
        p->next++;
    }
    return p->next < p->n ? p->next++ : CLI_POOL_NONE;
}

static void take_over(void *context, uint64_t key, const void *content)
{
    parts *p = context;
    if (key < p->n && p->part[key] == NULL && (p->part[key] = malloc(p->keep.size)) != NULL) {
        memcpy(p->part[key], content, p->keep.size);
        p->pool.done++;
    }
}

static lac_status take(void *context, size_t task, const void *result, const cli_pool_end *end,
                       lac_error *err)
{
    parts *p = context;
    const answer *said = result;
    char reason[200];
    if (said == NULL) {
        cli_pool_reason(end, reason, sizeof reason);
        return lac_fail(err, LAC_ENUMERIC, "interface %zu of %zu: %s; --resume goes on", task + 1,
                        p->n + 1, reason);
    }
    LAC_FAIL_IF(said->status != LAC_OK, err, said->status, "%s", said->why.message);
    p->part[task] = malloc(p->keep.size);
    LAC_FAIL_MEMORY_IF(p->part[task] == NULL, err);
    memcpy(p->part[task], said->part, p->keep.size);
    return cli_keep_add(&p->keep, task, said->part, err);
}

static lac_status open_parts(parts *p, const char *path, lac_error *err)
{
    const bool resume = cli_given(p->request, CLI_OPT_RESUME);
    p->n = (size_t)p->source->rg.seeds - 1;
    LAC_FAIL_IF(resume && p->n == 0, err, LAC_EINPUT,
                "--resume: of one interface nothing is kept that it could go on from");
    p->keep = (cli_keep){.command = "rg", .size = lac_scene_rg_part_size(p->source)};
    p->pool = (cli_pool){.what = "interfaces",
                         .total = p->n + 1,
                         .size = sizeof(answer) + p->keep.size,
                         .context = p,
                         .next = next,
                         .work = work,
                         .take = take};
    LAC_TRY_RETURN(cli_pool_jobs(p->request->trade.jobs, &p->pool.jobs, err));
    p->part = calloc(p->n + 1, sizeof *p->part);
    LAC_FAIL_MEMORY_IF(p->part == NULL, err);
    if (p->n == 0) {
        return LAC_OK;
    }
    LAC_TRY_RETURN(cli_case_sum(p->request, p->source, &p->keep.mark, err));
    LAC_TRY_RETURN(cli_keep_open(&p->keep, path, resume, take_over, p, err));
    p->pool.journal = lac_kept_file(p->keep.done);
    return LAC_OK;
}

static bool go_on(void *context, size_t done, size_t seeds)
{
    if (seeds > 1) {
        cli_say(((const parts *)context)->request, "interface %zu of %zu", done + 1, seeds);
    }
    return !cli_signals_stop(NULL);
}

static const void *made(void *context, size_t seed) { return ((const parts *)context)->part[seed]; }

static lac_status run_parts(parts *p, lac_scene_rg *out, lac_error *err)
{
    const lac_rg_watch watch = {p, go_on, made};
    cli_progress progress = {0};
    lac_error why = {""};
    lac_status status = LAC_OK;
    if (p->n > 0) {
        cli_progress_start(&progress, p->request);
        p->pool.progress = &progress;
        status = cli_pool_run(&p->pool, err);
        cli_progress_clear(&progress);
    }
    LAC_TRY_RETURN(status);
    status = lac_scene_rg_run(p->source, &watch, out, &why);
    LAC_FAIL_IF(status != LAC_OK, err, status, "%s%s", why.message,
                status == LAC_EINTERRUPT && p->n > 0 ? "; --resume goes on" : "");
    return LAC_OK;
}

// Everything that the command holds.
typedef struct rg_job {
    const cli_request *request;
    lac_case *source;
    bool stored; // the argument is a file: `cells` hold
    lac_stored_cells cells;
    parts parts;
    lac_scene_rg rg;
    char *path;
} rg_job;

// A file holds one interface with its tractions: only rg's own keys can differ, and not all.
static lac_status check_override(const lac_override *set, lac_error *err)
{
    static const char *const rules[][3] = {
        {"rg.field", "equal", "must be equal: a further load on the tractions of a file"},
        {"rg.seeds", "1", "must be 1: a file holds one interface"},
        {"rg.path", "",
         "has no meaning for a file, whose cells are loaded further without new contacts"},
        {"rg.contacts", "",
         "has no meaning for a file, whose cells are loaded further without new contacts"},
    };
    LAC_FAIL_IF(strncmp(set->key, "rg.", 3) != 0, err, LAC_EINPUT,
                "--set: %s: cannot be changed in a file that holds its results; only keys of rg "
                "can, such as rg.beta",
                set->key);
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) {
        LAC_FAIL_IF(strcmp(set->key, rules[i][0]) == 0 && strcmp(set->value, rules[i][1]) != 0, err,
                    LAC_EINPUT, "--set: %s: \"%s\" %s", set->key, set->value, rules[i][2]);
    }
    return LAC_OK;
}

static lac_status read_case(const cli_request *request, const char *text, lac_case **c,
                            lac_error *err)
{
    lac_case_issues report = {0};
    const lac_case_request how = {LAC_FOR_CELLS, request->overrides, request->set_count};
    for (size_t i = 0; i < request->set_count; i++) {
        LAC_TRY_RETURN(check_override(&request->overrides[i], err));
    }
    lac_status status =
        lac_case_read_text(request->argument[0], text, strlen(text), &how, c, &report, err);
    cli_report_print_of(&report, request, "rg"); // other warnings were given when it was made
    if (report.errors > 0) {
        err->message[0] = '\0'; // said already, line by line
    }
    lac_case_issues_clear(&report);
    return status;
}

// The case that a file holds, and its cells at the snapshot asked for.
static lac_status read_file(rg_job *job, lac_error *err)
{
    const char *path = job->request->argument[0], *text = job->request->snapshot;
    const bool last = text == NULL || strcmp(text, "last") == 0;
    // a time only when the case is known, which says from when it counts
    const bool by_time = !last && text[strspn(text, "0123456789")] != '\0';
    lac_snapshot_choice choice = {.by = last || by_time ? LAC_SNAPSHOT_LAST : LAC_SNAPSHOT_INDEX};
    lac_status status;
    if (choice.by == LAC_SNAPSHOT_INDEX) {
        choice.index = (size_t)strtoull(text, NULL, 10); // the largest where too large
    }
    LAC_TRY(lac_stored_cells_read(path, &choice, &job->cells, err));
    LAC_TRY(read_case(job->request, job->cells.case_text, &job->source, err));
    if (by_time) {
        status = cli_parse_time(text, job->source, &choice.time, err);
        LAC_TRY(status != LAC_EINPUT
                    ? status
                    : lac_fail(err, status,
                               "--snapshot: \"%s\" must be last, a number from 0, or a time such "
                               "as \"10 day\"%s",
                               text, job->source->dated ? " or a date" : ""));
        lac_stored_cells_clear(&job->cells);
        choice.by = LAC_SNAPSHOT_TIME;
        LAC_TRY(lac_stored_cells_read(path, &choice, &job->cells, err));
    }
    job->source->rg.field = LAC_RG_EQUAL; // of the further load, whatever the case says
    job->source->rg.seeds = 1;
out:
    return status;
}

static void print_file(const lac_stored_cells *cells, const lac_scene_rg *rg)
{
    if (cells->kind == LAC_STORED_RUN) {
        cli_row("snapshot", "%zu (0 to %zu), at %s; the run is %s", cells->index,
                cells->snapshots - 1, cli_amount(cells->time, "s").s, cells->status);
    } else if (cells->kind == LAC_STORED_HISTORY) {
        cli_row("step", "%zu (0 to %zu) of a history", cells->index, cells->snapshots - 1);
    } else {
        cli_row("contact", "without shear");
    }
    if (rg->now.share != 1.0) {
        cli_row("effective pressure", "%.4g %% of the total", 100.0 * rg->now.share);
    }
    cli_row("Q/Q_nom now", "%.4f", rg->now.load);
    cli_row("weakest cell", "at (%.4g, %.4g) m, lacks %s", rg->now.weakest[0], rg->now.weakest[1],
            cli_amount(rg->now.weakest_gap, "Pa").s);
}

static cli_text with_error(double value, double error)
{
    return isnan(value)   ? cli_format("none")
           : isnan(error) ? cli_format("%.4f", value)
                          : cli_format("%.4f +/- %.4f", value, error);
}

// An estimate with its 95 % interval.
static cli_text with_interval(const lac_rg_estimate *e)
{
    const bool all = isfinite(e->value) && isfinite(e->low) && isfinite(e->high);
    return all ? cli_format("%.4f +/- %.4f (%.4f to %.4f)", e->value, e->error, e->low, e->high)
               : with_error(e->value, e->error);
}

static void print_law(const char *label, const lac_rg_power *law)
{
    if (law->holds) {
        cli_row(label, "~ (1 - Q/Q_crit)^-%.2f +/- %.2f", law->exponent, law->error);
    } else if (isnan(law->exponent)) {
        cli_row(label, "none: too few loads below Q_crit");
    } else {
        cli_row(label, "no power law over this range (slope %.2f, bent by %.1f errors)",
                law->exponent, fabs(law->curvature));
    }
}

static void print_levels(const lac_rg_result *r, const lac_scene_rg *rg)
{
    const double cell = fmax(rg->grid.dx, rg->grid.dy);
    printf("\n  %12s %10s %16s %16s%s\n", "block", "N_tot", "N_slip at Q_crit", "strength (Pa)",
           rg->now.loaded ? "       N_slip now" : "");
    for (size_t level = 0; level <= r->levels; level++) {
        printf("  %12s %10.1f %16.1f %16.4g", cli_amount(ldexp(cell, (int)level), "m").s,
               r->blocks[level], r->slipping[level], r->size[level].strength);
        if (rg->now.loaded) {
            printf(" %16.1f", r->begin[level]);
        }
        printf("\n");
    }
}

static void print_curve(const lac_rg_result *r)
{
    printf("\n  %8s", "Q/Q_nom");
    for (size_t level = 0; level <= r->levels; level++) {
        printf("  level %zu", level);
    }
    printf("\n");
    for (size_t i = 0; i < r->loads; i++) {
        printf("  %8.4f", r->load[i]);
        for (size_t level = 0; level <= r->levels; level++) {
            printf(" %8.4f", r->fraction[i * (r->levels + 1) + level]);
        }
        printf("\n");
    }
}

static void print_now(const lac_rg_result *r, const lac_scene_rg_now *now)
{
    if (r->begin[r->levels] > 0.0) {
        cli_row("slides now", "at %.3g %% of the places", 100.0 * r->begin[r->levels]);
    }
    cli_row("to Q_crit", "%.4f of Q_nom", r->critical - now->load);
    cli_row("slipping cells", "%.0f of %.0f by themselves", r->begin[0], r->blocks[0]);
    cli_row("xi now", "%s (clusters), %.4g m (blocks)", cli_amount(r->cluster[0], "m").s,
            r->block[0]);
}

static void print_beta(const lac_scene_rg *rg, size_t k, bool from_law, bool verbose)
{
    const lac_rg_result *r = rg->result[k];
    const cli_text critical = with_error(r->critical, r->critical_error);
    printf("\n");
    cli_row("beta", from_law ? "%.4f (from the friction law, mean)" : "%.4g", rg->beta[k]);
    if (r->joints > 1 && r->places > 1) {
        cli_row("Q_crit/Q_nom", "%s (sd %.4f among interfaces, %.4f among places)", critical.s,
                r->critical_sd, r->place_sd);
    } else if (r->joints > 1) {
        cli_row("Q_crit/Q_nom", "%s (sd %.4f among interfaces)", critical.s, r->critical_sd);
    } else if (r->places > 1) {
        cli_row("Q_crit/Q_nom", "%s (sd %.4f among places)", critical.s, r->place_sd);
    } else {
        cli_row("Q_crit/Q_nom", "%s", critical.s);
    }
    if (rg->now.loaded) {
        print_now(r, &rg->now);
    } else {
        double place[2];
        const size_t first = lac_scene_rg_first(rg, r, place);
        if (first != SIZE_MAX) {
            cli_row("slips first", "the cell at (%.4g, %.4g) m%s, by Q/Q_nom = %.4g", place[0],
                    place[1], rg->seeds > 1 ? " of the last interface" : "", r->cell_load[first]);
        }
    }
    const bool vague = r->fit.lambda.value > 1.0 && r->fit.lambda.low <= 1.0;
    const char *none = vague ? " (lambda may be 1: then none)" : "";
    cli_row("fixed point C", "%s%s", with_interval(&r->fit.fixed_point).s, none);
    cli_row("lambda", "%s", with_interval(&r->fit.lambda).s);
    cli_row("nu", "%s%s", with_interval(&r->fit.nu).s, none);
    print_law("xi of clusters", &r->cluster_law);
    print_law("xi of blocks", &r->block_law);
    if (verbose) {
        print_levels(r, rg);
        print_curve(r);
    }
}

static void print_rg(const rg_job *job)
{
    const lac_case *c = job->source;
    const lac_scene_rg *rg = &job->rg;
    if (c->title != NULL) {
        puts(c->title);
    }
    if (job->stored) {
        print_file(&job->cells, rg);
    }
    cli_row("rule, field", "%s, %s", lac_scene_rg_rule(c), lac_scene_rg_field(c));
    cli_row("interfaces", "%zu of %zu x %zu cells, the blocks at %zu places of each", rg->seeds,
            rg->grid.nx, rg->grid.ny, rg->result[0]->places);
    cli_row_quantity("nominal pressure", rg->mean.pressure, "Pa");
    cli_row("contact", "%.3g %% of the area", 100 * rg->mean.contact_fraction);
    if (isfinite(rg->mean.dimension)) {
        cli_row("D_box", "%.3f", rg->mean.dimension);
    }
    if (isfinite(rg->mean.dyadic)) {
        cli_row("D of all blocks", "%.4f", rg->mean.dyadic);
    }
    cli_row_quantity("f p", rg->strength, "Pa");
    for (size_t k = 0; k < rg->betas; k++) {
        print_beta(rg, k, c->rg.betas == 0, cli_given(job->request, CLI_OPT_VERBOSE));
    }
    cli_row("file", "%s", job->path);
}

lac_status cli_rg(const cli_request *request, lac_error *err)
{
    const cli_request plain = cli_request_anew(request, false);
    rg_job job = {.request = request};
    lac_dataset *dataset = NULL;
    lac_status status;
    const char *name = request->argument[0];
    job.stored = name[cli_stem(name, ".nc")] != '\0' || lac_stored_is_netcdf(name);
    if (job.stored) {
        LAC_TRY(read_file(&job, err));
    } else if (request->snapshot != NULL) {
        LAC_TRY(
            lac_fail(err, LAC_EINPUT, "--snapshot: %s is a case; only files have snapshots", name));
    } else {
        LAC_TRY(cli_case_read(request, LAC_FOR_RG, &job.source, NULL, err));
    }
    LAC_TRY(cli_output_path(&plain, job.source, NULL, "-rg.nc", &job.path, err));
    job.parts = (parts){.request = request, .source = job.source};
    LAC_TRY(open_parts(&job.parts, job.path, err));
    const lac_rg_cells cells = {job.cells.domain, job.cells.shear, job.cells.time};
    cli_say(request, "following the cascade of %s", name);
    cli_signals_hold();
    status = job.stored ? lac_scene_rg_cells(job.source, &cells, &job.rg, err)
                        : run_parts(&job.parts, &job.rg, err);
    LAC_TRY(cli_blame(job.source, status, err));
    const lac_rg_outcome outcome = {
        .source = job.source, .rg = &job.rg, .file = name, .cells = job.stored ? &job.cells : NULL};
    LAC_TRY(lac_scene_rg_describe(&outcome, &dataset, err));
    LAC_TRY(cli_store_dataset(request, job.source, INT64_MIN, job.path, dataset, err));
    if (cli_given(request, CLI_OPT_JSON)) {
        cli_print_json(dataset, job.path);
    } else {
        print_rg(&job);
    }
out:
    lac_dataset_free(dataset);
    for (size_t i = 0; job.parts.part != NULL && i < job.parts.n; i++) {
        free(job.parts.part[i]);
    }
    free(job.parts.part);
    // not needed any more once all is written, or where the case cannot be followed
    cli_keep_close(&job.parts.keep, status == LAC_OK || status == LAC_EINPUT);
    lac_scene_rg_clear(&job.rg);
    lac_stored_cells_clear(&job.cells);
    lac_case_free(job.source);
    free(job.path);
    return status;
}
