// SPDX-License-Identifier: GPL-3.0-or-later
// The indicator `events`: a catalogue of micro-slips, followed at every step;
// docs/theory/events.md.
#include "analysis/analysis.h"
#include "analysis/catalogue.h"
#include "base/units.h"

#define FIELD(name) offsetof(lac_analysis_events, name)

static const lac_param params[] = {
    LAC_REAL("slip_rate", "m/s", FIELD(slip_rate), 1e-3, 0, 1e4, LAC_ABOVE_MIN,
             "a cell begins to move when it comes to this slip rate, of either sign"),
    LAC_REAL("hold", "1", FIELD(hold), 0.5, 0, 1, LAC_ABOVE_MIN,
             "and moves until its slip rate falls below this part of slip_rate"),
};

enum { RESULTS = 7, LINES = 1 };

typedef struct events {
    lac_catalogue catalogue;
    double slip_rate;
    lac_analysis_result result[RESULTS];
    lac_analysis_line line[LINES];
} events;

static void clear(void *state) { lac_catalogue_clear(&((events *)state)->catalogue); }

static lac_status create(const lac_analysis_scene *scene, const void *p, lac_indicator *self,
                         lac_error *err)
{
    const lac_analysis_events *def = p;
    events *e = self->state;
    e->slip_rate = def->slip_rate;
    return lac_catalogue_create(scene->domain, def->slip_rate, def->slip_rate * def->hold,
                                scene->shear_modulus, &e->catalogue, err);
}

static lac_status step(lac_indicator *self, const lac_step *step, const lac_sink *next,
                       lac_error *err)
{
    events *e = self->state;
    return lac_catalogue_step(&e->catalogue, step, next, err);
}

static void keep(lac_indicator *self, lac_archive *archive)
{
    events *e = self->state;
    lac_catalogue_serialize(&e->catalogue, archive);
}

static void set_line(events *e, lac_analysis_line *line)
{
    const lac_catalogue *c = &e->catalogue;
    char rate[64], size[64];
    (void)lac_units_format(e->slip_rate, "m/s", rate, sizeof rate);
    line->label = "events";
    (void)snprintf(line->text, LAC_ANALYSIS_TEXT, "%lld from %s on", (long long)c->events, rate);
    if (c->events > 0) {
        lac_append(line->text, LAC_ANALYSIS_TEXT,
                   ", the longest %s; %lld cut by the ends of the run",
                   lac_units_format(c->largest_size, "m", size, sizeof size), (long long)c->cut);
    }
}

static lac_status finish(lac_indicator *self, const lac_run_result *result, const lac_sink *next,
                         lac_error *err)
{
    (void)result;
    events *e = self->state;
    lac_catalogue *c = &e->catalogue;
    lac_status status = lac_catalogue_close(c, next, err);
    const double area = lac_grid_cell_area(&c->domain->grid);
    const lac_analysis_result rows[] = {
        {"events", (double)c->events, NULL},
        {"events_cut", (double)c->cut, NULL},
        {"event_potency_m3", area * c->slip_sum, NULL},
        {"event_moment_N_m", c->modulus * area * c->slip_sum, NULL},
        {"event_potency_max_m3", area * c->largest_slip, NULL},
        {"event_moment_max_N_m", c->modulus * area * c->largest_slip, NULL},
        {"event_size_max_m", c->largest_size, NULL},
    };
    memcpy(e->result, rows, sizeof rows);
    set_line(e, e->line);
    self->results = RESULTS;
    self->result = e->result;
    self->lines = LINES;
    self->line = e->line;
    return status;
}

const lac_indicator_kind lac_indicator_events = {
    .info = LAC_ABOUT("events",
                      "catalogue of micro-slips: clusters of moving cells from their start to "
                      "their end, with moment, size and origin",
                      "Aki (1966), Bull. Earthq. Res. Inst. 44, 73-88, for the moment",
                      LAC_ROWS(params, lac_analysis_events)),
    .state_size = sizeof(events),
    .create = create,
    .clear = clear,
    .step = step,
    .finish = finish,
    .serialize = keep,
};
