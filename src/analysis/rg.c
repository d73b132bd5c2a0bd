// SPDX-License-Identifier: GPL-3.0-or-later
// The cascade in time: what slips at each level, how far that is from the fixed point of the
// renormalization map, and the longest slipping cluster; docs/theory/rg-in-time.md.
#include "analysis/slipping.h"
#include "base/rows.h"
#include "base/units.h"
#include "lacuna/simulation.h"

#define FIELD(name) offsetof(lac_analysis_rg, name)

static const lac_param params[] = {
    LAC_REAL("slipping_strength", "1", FIELD(slipping_strength), NAN, 0, 1,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "a cell slips while its strength f(v0, theta) is at most this part of what it was at "
             "the start; halfway between beta and 1 if no slipping_... is given"),
    LAC_REAL("slipping_rate", "m/s", FIELD(slipping_rate), NAN, 0, 1e4,
             LAC_OPTIONAL | LAC_ABOVE_MIN, "a cell slips while it is at least this fast"),
    LAC_REAL("critical_fraction", "1", FIELD(critical_fraction), NAN, 0, 1,
             LAC_OPTIONAL | LAC_ABOVE_MIN,
             "fixed point of the map; from the static cascade that the section rg says if absent"),
};

static const char *fault(const void *p)
{
    const lac_analysis_rg *rg = p;
    return !isnan(rg->slipping_strength) && !isnan(rg->slipping_rate)
               ? "says in more than one way when a cell slips: at most one of slipping_strength "
                 "and slipping_rate is allowed"
               : NULL;
}

enum { N_SLIP, FRACTION, CRITICALITY, XI, ONCE, EXTRAS = ONCE + 9 };
enum { CRITICAL, CRITICAL_LOW, CRITICAL_HIGH, RUN_C, RUN_C_LOW, RUN_C_HIGH, RUN_L };
enum { RESULTS = 18, LINES = 4 };
enum { STATES = 64, STRETCH = 4, LEAST_BLOCKS = 8, RESAMPLINGS = 400 };

// Pairs (s_l, s_{l+1}) of a run, taken when the slip fraction first comes to each 1/64.
typedef struct run_map {
    size_t states;            // taken so far
    size_t reached;           // 64ths that have been
    size_t first[STATES + 1]; // pair of each state
    double *s, *s_next;       // [64 levels]
} run_map;

typedef struct rg {
    lac_slipping slipping;
    lac_slip_blocks blocks;
    lac_slip_clusters clusters;
    run_map map;
    lac_critical_fraction critical;
    size_t cells;
    double fraction, longest; // at the last record; longest xi of any [m]
    double most;              // largest criticality
    bool reached;             // it has come to 1 at
    double origin, local;
    char definition[LAC_ANALYSIS_TEXT], source[LAC_ANALYSIS_TEXT + 64];
    lac_extra extra[EXTRAS];
    double once[EXTRAS - ONCE];
    lac_analysis_result result[RESULTS];
    lac_analysis_line line[LINES];
} rg;

#define ONE(name, words, remark)                                \
    {                                                           \
        name, "1", words, remark, NULL, LAC_OVER_NOTHING, false \
    }

// What a file says of each quantity; those after XI are over nothing, in the order of `once`.
static const lac_extra table[EXTRAS] = {
    {"n_slip", "1", "blocks of this level all of whose contact cells slip", NULL, NULL,
     LAC_OVER_LEVELS, true},
    {"slip_fraction", "1", "part of the contact cells that slip", NULL, "time: point",
     LAC_OVER_TIME, false},
    {"criticality", "1", "slip_fraction over critical_fraction",
     "1: as many cells slip as at the fixed point; missing where there is none", "time: point",
     LAC_OVER_TIME, false},
    {"correlation_length", "m", "longest side of a connected cluster of slipping cells",
     "8 neighbours, through the edges where periodic; 0 where no cell slips; missing for some "
     "records where many cells slip and others stick again all the time",
     "time: point", LAC_OVER_TIME, false},
    ONE("critical_fraction",
        "slipped fraction at the unstable fixed point of the renormalization map", NULL),
    ONE("critical_fraction_low", "lower end of the 95 % interval of critical_fraction", NULL),
    ONE("critical_fraction_high", "upper end of the 95 % interval of critical_fraction", NULL),
    ONE("run_critical_fraction", "fixed point of the map fitted to the run's own slipped fractions",
        "pairs of neighbouring levels as slip_fraction first comes to each 1/64; missing where "
        "that map does not cross the diagonal, and until the run is over"),
    ONE("run_critical_fraction_low", "lower end of the 95 % interval of run_critical_fraction",
        NULL),
    ONE("run_critical_fraction_high", "upper end of the 95 % interval of run_critical_fraction",
        NULL),
    ONE("run_lambda", "slope of the run's own map in logits", NULL),
    ONE("run_lambda_low", "lower end of the 95 % interval of run_lambda", NULL),
    ONE("run_lambda_high", "upper end of the 95 % interval of run_lambda", NULL),
};

static void clear(void *state)
{
    rg *r = state;
    lac_slipping_clear(&r->slipping);
    lac_slip_blocks_clear(&r->blocks);
    lac_slip_clusters_clear(&r->clusters);
    free(r->map.s);
}

static void describe(rg *r, lac_indicator *self)
{
    lac_slipping_describe(&r->slipping, r->definition, sizeof r->definition);
    memcpy(r->extra, table, sizeof table);
    for (size_t i = 0; i < EXTRAS - ONCE; i++) {
        r->once[i] = NAN;
    }
    r->extra[N_SLIP].comment = r->definition;
    r->extra[FRACTION].comment = r->definition;
    r->extra[ONCE + CRITICAL].comment = r->critical.source;
    r->once[CRITICAL] = r->critical.value;
    r->once[CRITICAL_LOW] = r->critical.low;
    r->once[CRITICAL_HIGH] = r->critical.high;
    self->extras = EXTRAS;
    self->extra = r->extra;
    self->once = r->once;
}

static lac_status create(const lac_analysis_scene *scene, const void *p, lac_indicator *self,
                         lac_error *err)
{
    const lac_analysis_rg *def = p;
    rg *r = self->state;
    bool none = isnan(def->slipping_strength) && isnan(def->slipping_rate);
    double strength = none ? 0.5 * (1.0 + scene->critical.beta) : def->slipping_strength;
    r->critical = scene->critical;
    r->cells = scene->domain->n;
    LAC_TRY_RETURN(
        lac_slipping_create(scene->friction, strength, def->slipping_rate, &r->slipping, err));
    LAC_TRY_RETURN(lac_slip_blocks_create(scene->hierarchy, &r->blocks, err));
    LAC_TRY_RETURN(lac_slip_clusters_create(scene->domain, &r->clusters, err));
    const size_t pairs = STATES * r->blocks.levels;
    r->map.s = malloc((2 * pairs + 1) * sizeof *r->map.s);
    LAC_FAIL_MEMORY_IF(r->map.s == NULL, err);
    r->map.s_next = r->map.s + pairs;
    describe(r, self);
    return LAC_OK;
}

static double slipped(const lac_slip_blocks *b, size_t level)
{
    return (double)b->slipping[level] / (double)lac_hierarchy_blocks(b->h, level);
}

// Takes the pairs of levels with 8 blocks at least, where it is time to.
static void take_pairs(run_map *map, const lac_slip_blocks *b)
{
    size_t now = (size_t)(STATES * slipped(b, 0));
    if (now <= map->reached) {
        return;
    }
    map->reached = now;
    size_t n = map->first[map->states];
    for (size_t level = 0; level < b->levels; level++) {
        if (lac_hierarchy_blocks(b->h, level + 1) >= LEAST_BLOCKS) {
            map->s[n] = slipped(b, level);
            map->s_next[n++] = slipped(b, level + 1);
        }
    }
    map->first[++map->states] = n;
}

// The map and its intervals, by resampling stretches of four states: neighbouring states of one run
// hang together.
static lac_status fit_map(const run_map *map, lac_rg_fit *fit, lac_error *err)
{
    size_t first[STATES / STRETCH + 2];
    size_t groups = 0;
    for (size_t state = 0; state < map->states; state += STRETCH) {
        first[groups++] = map->first[state];
    }
    first[groups] = map->first[map->states];
    return lac_rg_map_resample(groups, first, map->s, map->s_next, RESAMPLINGS, 1, fit, err);
}

static void follow(rg *r, const lac_record *record, double criticality)
{
    r->longest = fmax(r->longest, r->clusters.extent);
    r->most = fmax(r->most, criticality);
    if (!r->reached && criticality >= 1.0) {
        r->reached = true;
        r->origin = record->time_origin;
        r->local = record->time_local;
    }
}

static void observe(lac_indicator *self, const lac_record *record, double *values)
{
    rg *r = self->state;
    lac_slipping *s = &r->slipping;
    const size_t levels = r->blocks.levels + 1;
    lac_slipping_evaluate(s, record);
    for (size_t k = 0; k < s->changes; k++) {
        lac_slip_blocks_change(&r->blocks, s->changed[k], s->slips[s->changed[k]]);
    }
    lac_slip_clusters_update(&r->clusters, s->slips, r->blocks.slipping[0], s->changed, s->changes);
    if (s->changes > 0) {
        take_pairs(&r->map, &r->blocks);
    }
    for (size_t level = 0; level < levels; level++) {
        values[level] = (double)r->blocks.slipping[level];
    }
    r->fraction = values[0] / (double)r->cells;
    double criticality = r->fraction / r->critical.value;
    follow(r, record, criticality);
    values[levels] = r->fraction;
    values[levels + 1] = criticality;
    values[levels + 2] = r->clusters.extent;
}

static void set_lines(rg *r, double lead)
{
    char text[64];
    lac_analysis_line *line = r->line;
    line[0].label = "slipping at the end";
    (void)snprintf(line[0].text, LAC_ANALYSIS_TEXT, "%.4g %% of the cells: %s", 100 * r->fraction,
                   r->definition);
    line[1].label = "critical fraction";
    if (isnan(r->critical.value)) {
        (void)snprintf(line[1].text, LAC_ANALYSIS_TEXT, "%s", r->critical.source);
    } else if (isnan(r->critical.low)) {
        (void)snprintf(line[1].text, LAC_ANALYSIS_TEXT, "%.4g, %s", r->critical.value,
                       r->critical.source);
    } else {
        (void)snprintf(line[1].text, LAC_ANALYSIS_TEXT, "%.4g (%.4g to %.4g), %s",
                       r->critical.value, r->critical.low, r->critical.high, r->critical.source);
    }
    line[2].label = "criticality";
    if (isnan(r->critical.value)) {
        (void)snprintf(line[2].text, LAC_ANALYSIS_TEXT, "unknown");
    } else if (isnan(lead)) {
        (void)snprintf(line[2].text, LAC_ANALYSIS_TEXT, "%.4g at most", r->most);
    } else {
        (void)snprintf(line[2].text, LAC_ANALYSIS_TEXT, "1 reached %s before failure",
                       lac_units_format(lead, "s", text, sizeof text));
    }
    line[3].label = "longest cluster";
    (void)snprintf(line[3].text, LAC_ANALYSIS_TEXT, "%s",
                   lac_units_format(r->longest, "m", text, sizeof text));
}

static lac_status finish(lac_indicator *self, const lac_run_result *result, const lac_sink *next,
                         lac_error *err)
{
    (void)next;
    rg *r = self->state;
    lac_rg_fit fit;
    LAC_TRY_RETURN(fit_map(&r->map, &fit, err));
    const lac_rg_estimate *estimates[] = {&fit.fixed_point, &fit.lambda};
    for (size_t i = 0; i < 2; i++) {
        r->once[RUN_C + 3 * i] = estimates[i]->value;
        r->once[RUN_C + 3 * i + 1] = estimates[i]->low;
        r->once[RUN_C + 3 * i + 2] = estimates[i]->high;
    }
    bool critical = isfinite(r->critical.value);
    double lead = r->reached && result->failed
                      ? (result->failure_origin - r->origin) + (result->failure_local - r->local)
                      : NAN;
    const lac_analysis_result rows[] = {
        {"slip_fraction", r->fraction, NULL},
        {"slipping_cell", NAN, r->definition},
        {"correlation_length_m", r->clusters.extent, NULL},
        {"correlation_length_max_m", r->longest, NULL},
        {"critical_fraction", r->critical.value, NULL},
        {"critical_fraction_low", r->critical.low, NULL},
        {"critical_fraction_high", r->critical.high, NULL},
        {"critical_fraction_source", NAN, r->critical.source},
        {"criticality_max", critical ? r->most : NAN, NULL},
        {"critical_time_s", r->reached ? r->origin + r->local : NAN, NULL},
        {"critical_lead_time_s", lead, NULL},
        {"run_critical_fraction", fit.fixed_point.value, NULL},
        {"run_critical_fraction_low", fit.fixed_point.low, NULL},
        {"run_critical_fraction_high", fit.fixed_point.high, NULL},
        {"run_lambda", fit.lambda.value, NULL},
        {"run_lambda_low", fit.lambda.low, NULL},
        {"run_lambda_high", fit.lambda.high, NULL},
        {"run_map_points", (double)fit.map.points, NULL},
    };
    memcpy(r->result, rows, sizeof rows);
    set_lines(r, lead);
    self->results = RESULTS;
    self->result = r->result;
    self->lines = LINES;
    self->line = r->line;
    return LAC_OK;
}

static void keep_map(run_map *map, size_t levels, lac_archive *archive)
{
    LAC_PASS(archive, map->states);
    LAC_PASS(archive, map->reached);
    LAC_PASS(archive, map->first);
    size_t pairs = map->states <= STATES ? map->first[map->states] : SIZE_MAX;
    if (pairs > STATES * levels) {
        archive->short_of = true;
        return;
    }
    lac_archive_pass(archive, map->s, pairs * sizeof *map->s);
    lac_archive_pass(archive, map->s_next, pairs * sizeof *map->s_next);
}

static void keep(lac_indicator *self, lac_archive *archive)
{
    rg *r = self->state;
    lac_slipping_serialize(&r->slipping, archive);
    if (archive->loading && lac_archive_good(archive)) {
        // Which blocks slip follows from which cells do.
        for (size_t i = 0; i < r->cells; i++) {
            if (r->slipping.slips[i]) {
                lac_slip_blocks_change(&r->blocks, (uint32_t)i, true);
            }
        }
    }
    lac_slip_clusters_serialize(&r->clusters, archive);
    keep_map(&r->map, r->blocks.levels, archive);
    LAC_PASS(archive, r->fraction);
    LAC_PASS(archive, r->longest);
    LAC_PASS(archive, r->most);
    LAC_PASS(archive, r->reached);
    LAC_PASS(archive, r->origin);
    LAC_PASS(archive, r->local);
}

const lac_indicator_kind lac_indicator_rg = {
    .info = LAC_ABOUT("rg",
                      "slipping cells and blocks of each level against the fixed point of the "
                      "renormalization map, and the longest slipping cluster",
                      "Borri-Brunetto, Carpinteri & Chiaia (2004) Rock Mech. Rock Eng. 37, "
                      "117; docs/theory/rg-in-time.md",
                      LAC_ROWS(params, lac_analysis_rg), .validate = fault),
    .state_size = sizeof(rg),
    .create = create,
    .clear = clear,
    .observe = observe,
    .finish = finish,
    .serialize = keep,
    .cascade = true,
};
